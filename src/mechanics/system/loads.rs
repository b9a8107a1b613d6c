//! External loads: dead forces, moments on edges, linear drag.

use super::build::Assembly;
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::vertex::EdgeFrame;
use crate::mechanics::rod::{RodRange, STRIDE, holonomy_jacobian};
use crate::mechanics::scene::{Load, LoadKind, piecewise_linear};
use crate::mechanics::{LoadError, Matrix3, Vector3};

/// All external loads of a scene, resolved to unknowns.
#[derive(Clone, Debug, Default)]
pub struct Loads {
    dead: Vec<DeadLoad>,
    /// Moments on edges.
    pub moments: Vec<EdgeMoment>,
    /// Coefficient of the velocity of each unknown at the present time, N s/m or N m s; empty without drag.
    pub damping: Vec<f64>,
    drags: Vec<Drag>,
    /// Acceleration of gravity, with schedules, for the potential energy.
    gravity: Vec<(Vector3, Scale)>,
    /// What weighs on the tips of bodies whose centre of mass is off their node: unknown along x and mass, kg.
    weights_of_tips: Vec<(usize, f64)>,
    /// Factor of each load of the scene beside its schedule.
    factors: Vec<f64>,
}

/// The factor of a load as a function of time.
#[derive(Clone, Debug)]
struct Scale {
    /// Number of the load in the scene.
    load: usize,
    schedule: Vec<(f64, f64)>,
    factor: f64,
}

impl Scale {
    fn at(&self, time: f64) -> f64 {
        self.factor * piecewise_linear(&self.schedule, time).unwrap_or(1.0)
    }
}

/// Forces that do not depend on the configuration.
#[derive(Clone, Debug)]
struct DeadLoad {
    /// Entries (unknown, force).
    entries: Vec<(usize, f64)>,
    scale: Scale,
}

/// Linear drag: a coefficient for each unknown, N s/m or N m s.
#[derive(Clone, Debug)]
struct Drag {
    coefficients: Vec<f64>,
    scale: Scale,
}

/// A moment of fixed direction on an edge.
#[derive(Clone, Debug)]
pub struct EdgeMoment {
    /// Node at the start of the edge.
    pub start: usize,
    /// Node at its end.
    pub end: usize,
    moment: Vector3,
    scale: Scale,
}

impl Loads {
    /// Whether any of them is a force or a moment.
    pub fn are_forces(&self) -> bool {
        !self.dead.is_empty() || !self.moments.is_empty()
    }

    /// Resolves the loads of a scene to the unknowns of its rods.
    ///
    /// # Errors
    /// [`LoadError`] names a rod, node or edge that does not exist.
    pub fn new(descriptions: &[Load], assembly: &Assembly) -> Result<Self, LoadError> {
        let mut loads = Self {
            weights_of_tips: assembly.weights_of_tips(),
            ..Self::default()
        };
        let range = |rod: usize| -> Result<RodRange, LoadError> {
            let found = assembly.rods.rods.get(rod).copied();
            found.ok_or(LoadError::NoSuchRod(rod))
        };
        let along = |rod: Option<usize>, range: &RodRange| {
            rod.is_none_or(|r| assembly.rods.rods[r] == *range)
        };
        loads.factors = vec![1.0; descriptions.len()];
        for (number, load) in descriptions.iter().enumerate() {
            let mut entries = Vec::new();
            let scale = Scale {
                load: number,
                schedule: load.schedule.clone(),
                factor: 1.0,
            };
            match &load.kind {
                LoadKind::Gravity { acceleration } => {
                    loads.gravity.push((*acceleration, scale.clone()));
                    for node in (0..assembly.rods.nodes).filter(|&node| !assembly.obstacle[node]) {
                        for axis in 0..3 {
                            let unknown = STRIDE * node + axis;
                            entries.push((unknown, assembly.masses[unknown] * acceleration[axis]));
                        }
                    }
                    for &(unknown, mass) in &loads.weights_of_tips {
                        let weight = acceleration * mass;
                        entries.extend((0..3).map(|axis| (unknown + axis, weight[axis])));
                    }
                }
                LoadKind::Force { rod, node, force } => {
                    let range = range(*rod)?;
                    if *node >= range.nodes {
                        return Err(LoadError::NoSuchNode {
                            node: *node,
                            nodes: range.nodes,
                        });
                    }
                    for axis in 0..3 {
                        entries.push((STRIDE * (range.first_node + node) + axis, force[axis]));
                    }
                }
                LoadKind::Moment { rod, edge, moment } => {
                    let range = range(*rod)?;
                    if *edge >= range.edges() {
                        return Err(LoadError::NoSuchEdge {
                            edge: *edge,
                            edges: range.edges(),
                        });
                    }
                    let start = range.first_node + edge;
                    loads.moments.push(EdgeMoment {
                        start,
                        end: range.end_of(start),
                        moment: *moment,
                        scale: scale.clone(),
                    });
                }
                LoadKind::Distributed {
                    rod,
                    force_per_length,
                } => {
                    if let Some(rod) = rod {
                        range(*rod)?;
                    }
                    for edge in &assembly.rods.edges {
                        let (owner, _) = assembly.locate(edge.start);
                        if !along(*rod, &assembly.rods.rods[owner]) {
                            continue;
                        }
                        for node in [edge.start, edge.end] {
                            for axis in 0..3 {
                                let share = 0.5 * edge.natural_length * force_per_length[axis];
                                entries.push((STRIDE * node + axis, share));
                            }
                        }
                    }
                }
                LoadKind::Drag {
                    rod,
                    translation,
                    rotation,
                } => {
                    if let Some(rod) = rod {
                        range(*rod)?;
                    }
                    let mut coefficients = vec![0.0; STRIDE * assembly.rods.nodes];
                    for edge in &assembly.rods.edges {
                        let (owner, _) = assembly.locate(edge.start);
                        if !along(*rod, &assembly.rods.rods[owner]) {
                            continue;
                        }
                        for node in [edge.start, edge.end] {
                            for axis in 0..3 {
                                coefficients[STRIDE * node + axis] +=
                                    0.5 * edge.natural_length * translation;
                            }
                        }
                        coefficients[STRIDE * edge.start + 3] += edge.natural_length * rotation;
                    }
                    loads.damping.resize(coefficients.len(), 0.0);
                    loads.drags.push(Drag {
                        coefficients,
                        scale: scale.clone(),
                    });
                }
            }
            if !entries.is_empty() {
                loads.dead.push(DeadLoad { entries, scale });
            }
        }
        loads.update_damping(0.0);
        Ok(loads)
    }

    /// Times at which a load changes its rate, s.
    pub fn corners(&self) -> impl Iterator<Item = f64> {
        let dead = self.dead.iter().map(|load| &load.scale.schedule);
        let moments = self.moments.iter().map(|moment| &moment.scale.schedule);
        let drags = self.drags.iter().map(|drag| &drag.scale.schedule);
        let schedules = dead.chain(moments).chain(drags);
        schedules.flatten().map(|corner| corner.0)
    }

    /// Factor of each load of the scene beside its schedule.
    pub fn factors(&self) -> &[f64] {
        &self.factors
    }

    /// Sets the factor of a load of the scene, counted from 0, beside its schedule; `None` where there is no such load.
    pub fn set_factor(&mut self, load: usize, factor: f64) -> Option<()> {
        *self.factors.get_mut(load)? = factor;
        let scales = (self.dead.iter_mut().map(|load| &mut load.scale))
            .chain(self.moments.iter_mut().map(|moment| &mut moment.scale))
            .chain(self.drags.iter_mut().map(|drag| &mut drag.scale))
            .chain(self.gravity.iter_mut().map(|(_, scale)| scale));
        for scale in scales.filter(|scale| scale.load == load) {
            scale.factor = factor;
        }
        Some(())
    }

    /// Sets the coefficients of drag to those of `time`.
    pub fn update_damping(&mut self, time: f64) {
        self.damping.fill(0.0);
        for drag in &self.drags {
            let factor = drag.scale.at(time);
            for (sum, coefficient) in self.damping.iter_mut().zip(&drag.coefficients) {
                *sum += factor * coefficient;
            }
        }
    }

    /// Writes the dead forces at `time`.
    pub fn dead_forces(&self, time: f64, forces: &mut [f64]) {
        forces.fill(0.0);
        for load in &self.dead {
            let factor = load.scale.at(time);
            for &(unknown, force) in &load.entries {
                forces[unknown] += factor * force;
            }
        }
    }

    /// Potential energy of gravity of bodies, from their nodes to their centres of mass, −Σ m g·r, J.
    pub fn gravitational_energy_of_arms(&self, time: f64, unknowns: &[f64]) -> f64 {
        let mut energy = 0.0;
        for (acceleration, scale) in &self.gravity {
            let factor = scale.at(time);
            for &(unknown, mass) in &self.weights_of_tips {
                energy -= factor * mass * acceleration.dot(&position(unknowns, unknown / STRIDE));
            }
        }
        energy
    }

    /// Potential energy of gravity of nodes, −Σ m g·x, J.
    pub fn gravitational_energy(
        &self,
        time: f64,
        masses: &[f64],
        obstacle: &[bool],
        unknowns: &[f64],
    ) -> f64 {
        let mut energy = 0.0;
        for (acceleration, scale) in &self.gravity {
            let factor = scale.at(time);
            for node in (0..obstacle.len()).filter(|&node| !obstacle[node]) {
                for axis in 0..3 {
                    let unknown = STRIDE * node + axis;
                    energy -= factor * masses[unknown] * acceleration[axis] * unknowns[unknown];
                }
            }
        }
        energy
    }
}

impl EdgeMoment {
    /// Generalised forces of the moment m on (x_start, θ, x_end): the edge turns with angular velocity
    /// t×ṫ + (spin) t, so that its ends feel ∓(m×t)/l ∓ (m·t) c and its angle m·t, with the holonomy c of
    /// the transported frame ([`crate::mechanics::rod::vertex`]).
    pub fn force(&self, time: f64, frame: &EdgeFrame) -> (Vector3, f64) {
        let moment = self.moment * self.scale.at(time);
        let spin = moment.dot(&frame.tangent);
        (
            moment.cross(&frame.tangent) / frame.length + frame.holonomy * spin,
            spin,
        )
    }

    /// Derivatives over the edge vector of the force on the end node and of the spin moment; `source` is
    /// the tangent from which the frame is transported.
    pub fn jacobian(&self, time: f64, source: &Vector3, frame: &EdgeFrame) -> (Matrix3, Vector3) {
        let moment = self.moment * self.scale.at(time);
        let tangent = &frame.tangent;
        let projector = Matrix3::identity() - tangent * tangent.transpose();
        let inverse_length = 1.0 / frame.length;
        let spin = projector * moment * inverse_length;
        let turning =
            moment.cross_matrix() * projector - moment.cross(tangent) * tangent.transpose();
        let force = turning * (inverse_length * inverse_length)
            + frame.holonomy * spin.transpose()
            + holonomy_jacobian(source, frame) * moment.dot(tangent);
        (force, spin)
    }

    /// The unknowns x_start, θ, x_end.
    pub fn unknowns(&self) -> [usize; 12] {
        let mut element = [usize::MAX; 12];
        for axis in 0..3 {
            element[axis] = STRIDE * self.start + axis;
            element[4 + axis] = STRIDE * self.end + axis;
        }
        element[3] = STRIDE * self.start + 3;
        element
    }
}
