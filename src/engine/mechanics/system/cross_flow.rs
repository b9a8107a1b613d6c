//! Quadratic drag and added mass of rods in air or water, by Morison's equation and the cross-flow
//! principle.
//!
//! With the velocity w = v − U relative to the fluid, its parts wₜ = s t along the unit tangent t
//! and wₙ = w − wₜ, and the acceleration a relative to that of the fluid, the force on a rod of
//! radius h per natural length is given by
//!
//! ```text
//! −f = −½ ρ 2h Cₙ |wₙ| wₙ − ½ ρ 2πh Cₜ |s| s t − Cₐ ρ π h² aₙ
//! ```
//!
//! (Morison et al. 1950; Hoerner 1965 for the independence of the normal force from s). Each edge
//! gives half of its length to either node, with the velocity of the node. With the projector P =
//! 1 − t tᵀ and the unit vector n along wₙ,
//!
//! ```text
//! ∂(|wₙ| wₙ)/∂w = |wₙ| P + n wₙᵀ,     ∂(|wₙ| wₙ)/∂t = −|wₙ| (s 1 + t wᵀ) − s n wₙᵀ
//! ∂(|s| s t)/∂w = 2 |s| t tᵀ,         ∂(|s| s t)/∂t = |s| s 1 + 2 |s| t wᵀ
//! ∂aₙ/∂a = P,                         ∂aₙ/∂t = −(a·t) 1 − t aᵀ,      ∂t/∂e = P/|e|
//! ```
//!
//! for the vector e of the edge. In a stage of a time step w = (q − qₙ)/h − U(q), in an equilibrium
//! w = −U(q), and a = 0. The force has no potential.
//!
//! **Omitted.** The pressure gradient of the flow (buoyancy, and the Froude–Krylov force of a flow
//! that accelerates), vortex-induced vibration and galloping: the force is that of a steady flow.

use super::System;
use super::build::Assembly;
use super::demand::Demand;
use super::follower::element_of_edge;
use super::newton_matrix::Entries;
use super::stage::Stage;
use super::term::{Configuration, Kind, Term};
use crate::linalg::Element;
use crate::mechanics::fluid::{BackgroundFlow, FluidModel};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::position;
use crate::mechanics::scene::Scene;
use crate::mechanics::{Matrix3, SceneError, Vector3};
use std::f64::consts::PI;

const NO_PATH: SceneError = SceneError::Unsuitable(
    "a path of equilibria supports no fluid: use static runs at several speeds of the flow",
);

/// Quadratic drag of all rods.
#[derive(Clone, Debug, Default)]
pub(crate) struct CrossFlow {
    edges: Vec<EdgeDrag>,
    flow: Option<BackgroundFlow>,
    /// Whether rods count as at rest in a stage, too.
    is_still: bool,
}

/// Coefficients of the half edge at either node.
#[derive(Clone, Copy, Debug)]
struct EdgeDrag {
    start: usize,
    end: usize,
    /// ½ ρ 2h Cₙ times the half length, kg/m.
    normal: f64,
    /// ½ ρ 2πh Cₜ times the half length, kg/m.
    tangential: f64,
    /// Cₐ ρ π h² times the half length, kg.
    added_mass: f64,
}

/// Motion of a node relative to the fluid, and its derivatives with respect to the node.
struct Motion {
    /// w, m/s, and ∂w/∂x, 1/s.
    velocity: Vector3,
    over_place: Matrix3,
    /// a, m/s², and ∂a/∂x, 1/s².
    acceleration: Vector3,
    acceleration_over_place: Matrix3,
}

/// The force f of a half edge and its derivatives.
struct Force {
    /// N.
    force: Vector3,
    /// ∂f/∂w, N s/m.
    over_velocity: Matrix3,
    /// ∂f/∂a, kg.
    over_acceleration: Matrix3,
    /// ∂f/∂t for changes of the tangent, N.
    over_tangent: Matrix3,
}

impl EdgeDrag {
    /// The force for a relative velocity and acceleration at a tangent.
    fn force(&self, w: &Vector3, a: &Vector3, tangent: &Vector3) -> Force {
        let identity = Matrix3::identity();
        let projector = identity - tangent * tangent.transpose();
        let along = w.dot(tangent);
        let across = w - tangent * along;
        let speed = across.norm();
        // At zero speed the terms with the direction of the normal velocity vanish.
        let direction = if speed > 0.0 {
            across / speed
        } else {
            Vector3::zeros()
        };
        let swirl = direction * across.transpose();
        let pulled = a.dot(tangent);
        let leaning = tangent * w.transpose();
        Force {
            force: across * (self.normal * speed)
                + tangent * (self.tangential * along.abs() * along)
                + (a - tangent * pulled) * self.added_mass,
            over_velocity: (projector * speed + swirl) * self.normal
                + tangent * tangent.transpose() * (2.0 * self.tangential * along.abs()),
            over_acceleration: projector * self.added_mass,
            over_tangent: ((identity * along + leaning) * speed + swirl * along) * -self.normal
                + (identity * along + leaning * 2.0) * (self.tangential * along.abs())
                - (identity * pulled + tangent * a.transpose()) * self.added_mass,
        }
    }
}

impl CrossFlow {
    /// Sets whether rods count as at rest in a stage, too: for the stiffness of small motions,
    /// without drag and added mass.
    pub(crate) fn set_still(&mut self, is_still: bool) {
        self.is_still = is_still;
    }

    /// Forces of the fluid on nodes at these places (m) and velocities (m/s), without added mass,
    /// N; empty without quadratic drag.
    pub(crate) fn forces(
        &self,
        positions: &[Vector3],
        velocities: &[Vector3],
        time: f64,
    ) -> Vec<Vector3> {
        if self.edges.is_empty() {
            return Vec::new();
        }
        let mut forces = vec![Vector3::zeros(); positions.len()];
        for edge in &self.edges {
            let tangent = (positions[edge.end] - positions[edge.start]).normalize();
            for node in [edge.start, edge.end] {
                let flow = self.flow.as_ref();
                let flow =
                    flow.map_or_else(Vector3::zeros, |flow| flow.velocity(&positions[node], time));
                let relative = velocities[node] - flow;
                forces[node] -= edge.force(&relative, &Vector3::zeros(), &tangent).force;
            }
        }
        forces
    }

    fn motion(&self, at: &Configuration, node: usize) -> Motion {
        let x = position(at.unknowns, node);
        let (mut velocity, mut over_place) = (Vector3::zeros(), Matrix3::zeros());
        let (mut acceleration, mut acceleration_over_place) = (velocity, over_place);
        let stage = at.stage.filter(|_| !self.is_still);
        if let Some(stage) = stage {
            let own = (x - position(&stage.start, node)) / stage.step;
            velocity += own;
            over_place += Matrix3::identity() / stage.step;
            acceleration += (own - position(&stage.velocity, node)) / stage.acceleration_step;
            acceleration_over_place += Matrix3::identity() / (stage.step * stage.acceleration_step);
        }
        if let Some(flow) = &self.flow {
            velocity -= flow.velocity(&x, at.time);
            over_place -= flow.gradient(&x, at.time);
            if stage.is_some() {
                let (of_fluid, over) = flow.acceleration(&x, at.time);
                acceleration -= of_fluid;
                acceleration_over_place -= over;
            }
        }
        Motion {
            velocity,
            over_place,
            acceleration,
            acceleration_over_place,
        }
    }

    /// Tangent and length of an edge.
    fn edge(at: &Configuration, edge: &EdgeDrag) -> (Vector3, f64) {
        let along = position(at.unknowns, edge.end) - position(at.unknowns, edge.start);
        let length = along.norm();
        (along / length, length)
    }

    /// Products of the derivatives of the residual of a stage, with respect to its start and to
    /// the velocity there, with changes of these; the derivatives are symmetric.
    pub(crate) fn add_start_forces(
        &self,
        at: &Configuration,
        stage: &Stage,
        [start, velocity]: [&[f64]; 2],
        forces: &mut [f64],
    ) {
        for edge in &self.edges {
            let (tangent, _) = Self::edge(at, edge);
            for node in [edge.start, edge.end] {
                let motion = self.motion(at, node);
                let found = edge.force(&motion.velocity, &motion.acceleration, &tangent);
                let moved = position(start, node) / stage.step;
                let sped = (moved + position(velocity, node)) / stage.acceleration_step;
                let force = found.over_velocity * moved + found.over_acceleration * sped;
                for axis in 0..3 {
                    forces[STRIDE * node + axis] -= force[axis];
                }
            }
        }
    }
}

impl System {
    /// Adds the change of the residual of a stage, solved at `unknowns`, under quadratic drag when
    /// the start of the stage and the velocity there change. In this direction the derivatives are
    /// symmetric, so that these are also the derivatives of the work of the residual in a virtual
    /// motion with respect to the start, or to the velocity, if the motion takes its place.
    pub(crate) fn add_start_forces(
        &self,
        unknowns: &[f64],
        stage: &Stage,
        changes: [&[f64]; 2],
        forces: &mut [f64],
    ) {
        let at = self.at(unknowns, Some(stage));
        self.terms
            .cross_flow
            .add_start_forces(&at, stage, changes, forces);
    }

    /// Forces of quadratic drag on nodes at these places (m) and velocities (m/s), without added
    /// mass, N; empty without it.
    pub(crate) fn quadratic_drag(
        &self,
        positions: &[Vector3],
        velocities: &[Vector3],
    ) -> Vec<Vector3> {
        (self.terms.cross_flow).forces(positions, velocities, self.time)
    }
}

impl Term for CrossFlow {
    fn new(scene: &Scene, assembly: &mut Assembly) -> Result<Self, SceneError> {
        let Some(FluidModel::Quadratic {
            density,
            normal,
            tangential,
            added_mass,
        }) = scene.fluid
        else {
            return Ok(Self::default());
        };
        let edges = assembly.rods.edges.iter().filter_map(|edge| {
            let (number, along) = assembly.locate(edge.start);
            let rod = &scene.rods[number];
            let radius = rod.section(along).radius;
            let half = 0.5 * edge.natural_length;
            (!rod.held).then_some(EdgeDrag {
                start: edge.start,
                end: edge.end,
                normal: density * radius * normal * half,
                tangential: density * PI * radius * tangential * half,
                added_mass: added_mass * density * PI * radius * radius * half,
            })
        });
        Ok(Self {
            edges: edges.collect(),
            flow: scene.flow.clone(),
            is_still: false,
        })
    }

    fn kind(&self) -> Kind {
        Kind::Load
    }

    fn has_copies(&self) -> bool {
        self.edges.is_empty()
    }

    fn elements(&self, _: &Assembly) -> Vec<Element> {
        let edges = self.edges.iter();
        edges
            .map(|edge| element_of_edge(edge.start, edge.end))
            .collect()
    }

    fn has_potential(&self) -> bool {
        self.edges.is_empty()
    }

    fn add_forces(&self, at: &Configuration, residual: &mut [f64]) {
        for edge in &self.edges {
            let (tangent, _) = Self::edge(at, edge);
            for node in [edge.start, edge.end] {
                let motion = self.motion(at, node);
                let force = edge.force(&motion.velocity, &motion.acceleration, &tangent);
                for axis in 0..3 {
                    residual[STRIDE * node + axis] += force.force[axis];
                }
            }
        }
    }

    fn add_jacobian(&self, at: &Configuration, entries: &mut Entries) {
        for (edge, matrix) in self.edges.iter().zip(entries.elements()) {
            let (tangent, length) = Self::edge(at, edge);
            let turning = (Matrix3::identity() - tangent * tangent.transpose()) / length;
            for (row, node) in [(0, edge.start), (4, edge.end)] {
                let motion = self.motion(at, node);
                let found = edge.force(&motion.velocity, &motion.acceleration, &tangent);
                let own = found.over_velocity * motion.over_place
                    + found.over_acceleration * motion.acceleration_over_place;
                let over_edge = found.over_tangent * turning;
                for i in 0..3 {
                    for j in 0..3 {
                        matrix[row + i][row + j] += own[(i, j)];
                        matrix[row + i][j] -= over_edge[(i, j)];
                        matrix[row + i][4 + j] += over_edge[(i, j)];
                    }
                }
            }
        }
    }

    /// Adds the forces, which may balance each other.
    fn add_sizes(&self, at: &Configuration, forces: &mut [f64]) {
        let mut own = vec![0.0; forces.len()];
        self.add_forces(at, &mut own);
        for (sum, own) in forces.iter_mut().zip(own) {
            *sum += own.abs();
        }
    }

    fn refuses(&self, demand: Demand) -> Option<SceneError> {
        (demand == Demand::Path && !self.edges.is_empty()).then_some(NO_PATH)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::fluid::FlowKind;
    use crate::mechanics::scene::RodDescription;
    use crate::mechanics::test_support::{clamp, section};

    /// A curved rod in a rotating flow that grows.
    fn scene() -> Scene {
        let node = |k: i32| {
            let angle = 0.3 * f64::from(k);
            Vector3::new(libm::sin(angle), 1.0 - libm::cos(angle), 0.1 * f64::from(k))
        };
        let stiffness = section(30.0, [1.0, 2.0], 1.5);
        Scene {
            rods: vec![RodDescription::uniform(
                "rod",
                (0..=4).map(node).collect(),
                stiffness,
                0.05,
                0.3,
            )],
            clamps: vec![clamp(0, 0)],
            fluid: Some(FluidModel::Quadratic {
                density: 20.0,
                normal: 1.2,
                tangential: 0.1,
                added_mass: 1.0,
            }),
            flow: Some(BackgroundFlow {
                kind: FlowKind::Rotation {
                    point: Vector3::new(0.2, -0.3, 0.1),
                    angular_velocity: Vector3::new(0.5, 0.7, -1.1),
                },
                schedule: vec![(-1.0, 0.0), (1.0, 2.0)],
            }),
            ..Scene::default()
        }
    }

    fn stage(unknowns: &[f64], nodes: usize) -> Stage {
        let moved = |k: usize| 0.02 * libm::sin(1.7 * k as f64);
        let start = unknowns.iter().enumerate().map(|(k, x)| x - moved(k));
        Stage {
            step: 0.02,
            acceleration_step: 0.015,
            keeps_spin: false,
            start: start.collect(),
            velocity: (0..unknowns.len()).map(|k| 3.0 * moved(k + 1)).collect(),
            drag: Vec::new(),
            drag_velocity: Vec::new(),
            resistance: Vec::new(),
            flow_torque: Vec::new(),
            positions: (0..nodes).map(|node| position(unknowns, node)).collect(),
            angles: vec![0.0; nodes],
        }
    }

    #[test]
    fn the_jacobian_is_the_derivative_of_the_residual_in_motion_and_at_rest() {
        let mut system = System::new(&scene()).unwrap();
        assert!(!system.is_symmetric());
        let unknowns = system.assembly.unknowns.clone();
        let stage = stage(&unknowns, system.assembly.rods.nodes);
        for stage in [Some(&stage), None] {
            let matrix = system.linearize_whole(&unknowns, stage);
            let step = 1e-6;
            for k in 0..unknowns.len() {
                let mut residuals = [1.0, -1.0].map(|sign| {
                    let mut moved = unknowns.clone();
                    moved[k] += sign * step;
                    system.evaluate(&moved, stage);
                    system.residual.clone()
                });
                let minus = residuals[1].clone();
                for (plus, minus) in residuals[0].iter_mut().zip(minus) {
                    *plus = (*plus - minus) / (2.0 * step);
                }
                let mut change = vec![0.0; unknowns.len()];
                change[k] = 1.0;
                let product = matrix.multiply(&change);
                let scale = product.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
                for (found, exact) in residuals[0].iter().zip(&product) {
                    assert!((found - exact).abs() < 1e-6 * scale, "{k}: {found} {exact}");
                }
            }
        }
    }

    #[test]
    fn forces_are_those_of_the_cross_flow_principle() {
        let edge = EdgeDrag {
            start: 0,
            end: 1,
            normal: 3.0,
            tangential: 0.5,
            added_mass: 2.0,
        };
        let tangent = Vector3::new(0.6, 0.8, 0.0);
        let none = Vector3::zeros();
        let along = edge.force(&(tangent * -2.0), &none, &tangent).force;
        assert!((along + tangent * 2.0).norm() < 1e-14);
        let across = edge.force(&(Vector3::z() * 2.0), &none, &tangent).force;
        assert!((across - Vector3::z() * 12.0).norm() < 1e-14);
        let inertia = edge.force(&none, &Vector3::x(), &tangent).force;
        assert!((inertia - (Vector3::x() - tangent * 0.6) * 2.0).norm() < 1e-14);
    }
}
