//! All forces on all rods in one place: what dynamics and statics solve.
//!
//! [`System`] owns the models (elasticity, loads, contact) and scratch; it evaluates the residual
//!
//! ```text
//! R(q) = M/h ((q − qₙ)/h − vₙ) + ∇E(q) + C (q − qₙ)/h − F_dead(t) − F_moment(q, t) − F_contact(q) − F_fluid
//! F_fluid = F₀ − D ((q − qₙ)/h − vₙ)
//! ```
//!
//! (thesis Eq. 1.8) and its Jacobian, with the drag F₀ at the start of the step and its local resistance
//! D; without a [`Stage`] the terms with h fall away and equilibrium remains.

mod build;
mod clamps;
mod complementarity;
mod loads;
mod newton_matrix;

pub use build::Assembly;
pub use clamps::Drive;
pub use complementarity::NoContactForces;
use newton_matrix::NewtonMatrix;

use super::contact::{ContactPlane, ContactSurface, ImplicitContact};
use super::rod::{
    ElasticEnergy, GhostEdge, ReferenceFrames, RodGeometry, STRIDE, topology::position,
};
use super::scene::Scene;
use super::{Matrix3, Vector3};
use crate::linalg::{Inertia, SingularMatrix};

/// What an implicit stage of a time step knows.
#[derive(Clone, Debug)]
pub struct Stage {
    /// Size h of the implicit stage, s.
    pub step: f64,
    /// Unknowns at its start.
    pub start: Vec<f64>,
    /// Velocities at its start.
    pub velocity: Vec<f64>,
    /// Drag at the start, N per node; empty without fluid.
    pub drag: Vec<Vector3>,
    /// Local resistance D, N s/m per node; empty without fluid.
    pub resistance: Vec<Matrix3>,
    /// Positions at the start, m per node.
    pub positions: Vec<Vector3>,
}

/// Why Newton's method gave up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Divergence {
    /// Iterations spent.
    pub iterations: usize,
    /// Largest residual, N; NaN where the matrix was singular or a number not finite.
    pub residual: f64,
    /// Its unknown.
    pub unknown: usize,
}

/// Models, state of the frames, and scratch of one scene.
pub struct System {
    /// Rods, masses, held unknowns, clamps and loads.
    pub assembly: Assembly,
    /// Contact, where the scene has it.
    pub contact: Option<ImplicitContact>,
    /// Frames from which the present step transports.
    pub reference: ReferenceFrames,
    /// Ghost edges at the present time.
    pub ghosts: Vec<GhostEdge>,
    /// Frames and strains of the last evaluation.
    pub geometry: RodGeometry,
    /// Time of the present evaluation, s.
    pub time: f64,
    /// Residual of the last evaluation, N and N m; at held unknowns minus the reaction.
    pub residual: Vec<f64>,
    corrected_residual: Vec<f64>,
    dead_forces: Vec<f64>,
    /// Forces (N) and moments (N m) of another solver on the unknowns.
    pub external_forces: Vec<f64>,
    positions: Vec<Vector3>,
    nodal_forces: Vec<Vector3>,
    displacements: Vec<Vector3>,
    /// Scratch of the complementarity model: a correction of the unknowns, and one response of them per row.
    correction: Vec<f64>,
    responses: Vec<f64>,
    has_planes: bool,
    matrix: NewtonMatrix,
}

/// The terms of the residual, for the message that says which one diverged.
pub const TERMS: [&str; 4] = ["inertia and drag", "elastic", "external load", "contact"];

impl System {
    /// Sets up a scene at time zero.
    ///
    /// # Errors
    /// A sentence that names what is impossible, overlapping rods among it.
    pub fn new(scene: &Scene) -> Result<Self, String> {
        let assembly = Assembly::new(scene)?;
        let contact = contact_of(scene, &assembly)?;
        let friction = scene.contact.map_or(0.0, |parameters| parameters.friction);
        let rods_rub = friction > 0.0;
        let planes_rub = contact.is_some()
            && scene
                .planes
                .iter()
                .any(|plane| plane.friction.unwrap_or(friction) > 0.0);
        let mut system = Self {
            geometry: RodGeometry::new(&assembly.rods),
            reference: assembly.reference.clone(),
            ghosts: assembly.ghosts.clone(),
            time: 0.0,
            residual: vec![0.0; assembly.unknowns.len()],
            corrected_residual: vec![0.0; assembly.unknowns.len()],
            dead_forces: vec![0.0; assembly.unknowns.len()],
            external_forces: vec![0.0; assembly.unknowns.len()],
            positions: vec![Vector3::zeros(); assembly.rods.nodes],
            has_planes: !scene.planes.is_empty(),
            nodal_forces: vec![Vector3::zeros(); assembly.rods.nodes],
            displacements: vec![Vector3::zeros(); assembly.rods.nodes],
            correction: Vec::new(),
            responses: Vec::new(),
            matrix: NewtonMatrix::new(&assembly, rods_rub, planes_rub),
            contact,
            assembly,
        };
        let mut unknowns = system.assembly.unknowns.clone();
        system.drive(0.0, &mut unknowns);
        system.update_geometry(&unknowns);
        Ok(system)
    }

    /// Moves the clamps to `time`: writes prescribed unknowns and ghost edges, and the dead loads.
    pub fn drive(&mut self, time: f64, unknowns: &mut [f64]) {
        self.time = time;
        for drive in &self.assembly.drives {
            drive.apply(time, unknowns, &mut self.ghosts);
        }
        for drive in &self.assembly.drives {
            drive.turn_edges(time, &self.reference, unknowns);
        }
        self.assembly.loads.dead_forces(time, &mut self.dead_forces);
        for (dead, external) in self.dead_forces.iter_mut().zip(&self.external_forces) {
            *dead += external;
        }
    }

    /// Computes frames and strains at `unknowns`.
    pub fn update_geometry(&mut self, unknowns: &[f64]) {
        self.geometry
            .update(&self.assembly.rods, unknowns, &self.reference, &self.ghosts);
    }

    /// Makes the frames of the last evaluation the source of the next step.
    pub fn commit_frames(&mut self) {
        self.geometry.commit(&mut self.reference);
    }

    /// Keeps frames and contact forces of the last evaluation as those of an accepted step.
    pub fn accept(&mut self) {
        self.commit_frames();
        if let Some(contact) = &mut self.contact {
            contact.settle_multipliers();
        }
    }

    /// Elastic energy of the last evaluation.
    pub fn elastic_energy(&self) -> ElasticEnergy {
        self.assembly.rods.energy(&self.geometry)
    }

    /// Evaluates the residual at `unknowns`.
    pub fn evaluate(&mut self, unknowns: &[f64], stage: Option<&Stage>) {
        self.update_geometry(unknowns);
        self.residual.fill(0.0);
        self.assembly
            .rods
            .add_gradient(&self.geometry, &mut self.residual);
        self.add_simple_terms(unknowns, stage);
        if let Some(contact) = &mut self.contact {
            copy_positions(unknowns, &mut self.positions);
            let (previous, step) = start_of(stage, &self.positions);
            contact.evaluate_forces(&self.positions, previous, step);
            subtract_contact_forces(contact, &mut self.residual);
        }
    }

    /// Evaluates residual and Jacobian at `unknowns`.
    pub fn linearize(&mut self, unknowns: &[f64], stage: Option<&Stage>) {
        self.update_geometry(unknowns);
        self.residual.fill(0.0);
        self.matrix.clear();
        self.matrix
            .add_elastic(&self.assembly.rods, &self.geometry, &mut self.residual);
        self.add_simple_terms(unknowns, stage);
        if let Some(stage) = stage {
            self.matrix.add_inertia(&self.assembly, stage);
        }
        self.matrix
            .add_moments(&self.assembly, self.time, &self.reference, &self.geometry);
        if let Some(contact) = &mut self.contact {
            copy_positions(unknowns, &mut self.positions);
            let (previous, step) = start_of(stage, &self.positions);
            contact.evaluate(&self.positions, previous, step);
            subtract_contact_forces(contact, &mut self.residual);
            self.matrix.add_contact(contact);
        }
        self.matrix.hold(&self.assembly.held);
    }

    /// Adds inertia, damping, drag, dead forces and moments to the residual.
    fn add_simple_terms(&mut self, unknowns: &[f64], stage: Option<&Stage>) {
        for (entry, force) in self.residual.iter_mut().zip(&self.dead_forces) {
            *entry -= force;
        }
        for moment in &self.assembly.loads.moments {
            let (force, spin) = moment.force(self.time, &self.geometry.edges[moment.start]);
            for axis in 0..3 {
                self.residual[STRIDE * moment.end + axis] -= force[axis];
                self.residual[STRIDE * moment.start + axis] += force[axis];
            }
            self.residual[STRIDE * moment.start + 3] -= spin;
        }
        let Some(stage) = stage else { return };
        add_inertia(&self.assembly, stage, unknowns, &mut self.residual);
    }

    /// Adds `shift` times the unit matrix (in N/m and N m) to the Jacobian of the last linearisation.
    pub fn shift(&mut self, shift: f64, spin_shift: f64) {
        self.matrix.shift(shift, spin_shift, &self.assembly.held);
    }

    /// Factors the Jacobian; tells its inertia where it is symmetric.
    ///
    /// # Errors
    /// The unknown at which the matrix is singular.
    pub fn factor(&mut self) -> Result<Option<Inertia>, SingularMatrix> {
        self.matrix.factor()
    }

    /// Writes the Newton direction −J⁻¹R, zero at held unknowns, with the contact forces of the linearised
    /// laws that the Jacobian belongs to.
    ///
    /// # Errors
    /// A system that is singular to working precision.
    pub fn direction(&mut self, direction: &mut [f64]) -> Result<(), SingularMatrix> {
        self.correct_residual(ImplicitContact::linear_corrections);
        for k in 0..direction.len() {
            let held = self.assembly.held[k];
            direction[k] = if held {
                0.0
            } else {
                -self.corrected_residual[k]
            };
        }
        self.matrix.solve(direction)
    }

    /// Writes the residual with other contact forces.
    fn correct_residual(&mut self, of: fn(&ImplicitContact) -> &[[f64; 12]]) {
        self.corrected_residual.copy_from_slice(&self.residual);
        let Some(contact) = &self.contact else { return };
        for (pair, correction) in contact.contacts().iter().zip(of(contact)) {
            for (corner, &node) in pair.nodes.iter().enumerate() {
                for axis in 0..3 {
                    self.corrected_residual[STRIDE * node + axis] -= correction[3 * corner + axis];
                }
            }
        }
    }

    /// Sum of squares of the residual with the contact forces of the linearised laws, N².
    pub fn squared_linear_residual(&mut self) -> f64 {
        self.correct_residual(ImplicitContact::linear_corrections);
        self.square(&self.corrected_residual)
    }

    /// Sum of squares of the residual with the contact forces of the multipliers, N².
    pub fn squared_multiplier_residual(&mut self) -> f64 {
        self.correct_residual(ImplicitContact::multiplier_corrections);
        self.square(&self.corrected_residual)
    }

    /// Lets Newton's method carry contact forces along, those of the last step at first.
    pub fn begin_iterations(&mut self) {
        if let Some(contact) = &mut self.contact {
            contact.begin_iterations();
        }
    }

    /// Goes on without carried contact forces.
    pub fn abandon_multipliers(&mut self) {
        if let Some(contact) = &mut self.contact {
            contact.abandon_multipliers();
        }
    }

    /// Whether Newton's method carries contact forces along.
    pub fn uses_multipliers(&self) -> bool {
        self.contact
            .as_ref()
            .is_some_and(ImplicitContact::uses_multipliers)
    }

    /// Whether the candidates of contact changed; to be called at the start of a step.
    pub fn update_candidates(&mut self, unknowns: &[f64]) {
        if let Some(contact) = &mut self.contact {
            copy_positions(unknowns, &mut self.positions);
            if contact.update_candidates(&self.positions) {
                self.matrix.forget_pattern();
            }
        }
    }

    /// Whether no contact can be missing at `unknowns` for want of candidates.
    pub fn candidates_are_complete(&mut self, unknowns: &[f64]) -> bool {
        let Some(contact) = &self.contact else {
            return true;
        };
        copy_positions(unknowns, &mut self.positions);
        contact.candidates_are_complete(&self.positions)
    }

    /// Largest part of the straight way between two sets of unknowns along which no contact is crossed; 1
    /// where the contact model allows penetration.
    pub fn largest_step(&mut self, from: &[f64], to: &[f64]) -> f64 {
        let Some(contact) = &mut self.contact else {
            return 1.0;
        };
        copy_positions(from, &mut self.positions);
        for (node, displacement) in self.displacements.iter_mut().enumerate() {
            *displacement = position(to, node) - self.positions[node];
        }
        let step = contact.largest_step(&self.positions, &self.displacements);
        if step.candidates_changed {
            self.matrix.forget_pattern();
        }
        step.part
    }

    /// Forgets the factorisation pattern, as after a restart from a checkpoint.
    pub fn forget_pattern(&mut self) {
        self.matrix.forget_pattern();
    }

    /// Adapts the contact stiffness to the forces without contact at `unknowns` (thesis Eqs. 2.18, 2.19).
    pub fn adapt_contact_stiffness(&mut self, unknowns: &[f64], stage: &Stage) {
        let Some(mut contact) = self.contact.take() else {
            return;
        };
        let may_touch = !contact.candidates().is_empty() || self.has_planes;
        if may_touch && !contact.parameters().is_complementarity() {
            self.evaluate(unknowns, Some(stage));
            for node in 0..self.nodal_forces.len() {
                let held = self.assembly.held[STRIDE * node];
                self.nodal_forces[node] = if held {
                    Vector3::zeros()
                } else {
                    position(&self.residual, node)
                };
            }
            copy_positions(unknowns, &mut self.positions);
            contact.adapt_stiffness(&self.positions, &self.nodal_forces);
        }
        self.contact = Some(contact);
    }

    /// Largest residual of a free unknown in N (moments divided by the shortest edge), and its unknown.
    pub fn worst_residual(&self) -> (f64, usize) {
        let mut worst = (0.0, 0);
        let per_length = 1.0 / self.assembly.shortest_edge;
        for (k, (&value, &held)) in self.residual.iter().zip(&self.assembly.held).enumerate() {
            if held {
                continue;
            }
            let size = if k % STRIDE == 3 {
                value.abs() * per_length
            } else {
                value.abs()
            };
            if size > worst.0 || size.is_nan() {
                worst = (size, k);
            }
        }
        worst
    }

    /// Sum of squares of the residual of the free unknowns, moments divided by the shortest edge, N².
    pub fn squared_residual(&self) -> f64 {
        self.square(&self.residual)
    }

    fn square(&self, residual: &[f64]) -> f64 {
        let weights = [1.0, 1.0, 1.0, 1.0 / self.assembly.shortest_edge];
        let mut sums = [0.0; STRIDE];
        let held = self.assembly.held.chunks_exact(STRIDE);
        for (values, held) in residual.chunks_exact(STRIDE).zip(held) {
            for k in 0..STRIDE {
                let value = if held[k] { 0.0 } else { weights[k] * values[k] };
                sums[k] += value * value;
            }
        }
        sums.iter().sum()
    }

    /// Name of the term that is largest at one unknown.
    pub fn largest_term(
        &mut self,
        unknowns: &[f64],
        stage: Option<&Stage>,
        unknown: usize,
    ) -> &'static str {
        let total = self.residual[unknown];
        let mut elastic = vec![0.0; self.residual.len()];
        self.update_geometry(unknowns);
        self.assembly
            .rods
            .add_gradient(&self.geometry, &mut elastic);
        let mut inertia = vec![0.0; self.residual.len()];
        if let Some(stage) = stage {
            add_inertia(&self.assembly, stage, unknowns, &mut inertia);
        }
        let load = -self.dead_forces[unknown];
        let known = [inertia[unknown], elastic[unknown], load];
        let contact = total - known.iter().sum::<f64>();
        let sizes = [known[0], known[1], known[2], contact];
        let largest = (0..4).max_by(|&a, &b| sizes[a].abs().total_cmp(&sizes[b].abs()));
        TERMS[largest.unwrap_or(0)]
    }

    /// Tolerance for the residual: `relative` times the largest of EI/L², the loads and the contact forces
    /// of the last step, but no less than what rounding of the positions leaves, N.
    pub fn force_tolerance(&self, relative: f64, unknowns: &[f64]) -> f64 {
        let largest_load = self
            .dead_forces
            .iter()
            .fold(0.0_f64, |largest, f| largest.max(f.abs()));
        let largest_contact = self
            .contact
            .as_ref()
            .map_or(0.0, ImplicitContact::largest_normal_force);
        let scale = self
            .assembly
            .force_scale
            .max(largest_load)
            .max(largest_contact);
        let positions = unknowns.iter().enumerate().filter(|(k, _)| k % STRIDE != 3);
        let farthest = positions.fold(0.0_f64, |farthest, (_, x)| farthest.max(x.abs()));
        (relative * scale).max(8.0 * self.assembly.rounding_stiffness * farthest)
    }

    /// The Jacobian of the last linearisation as a dense matrix over all unknowns, held ones with unit
    /// diagonals; for tests and small eigenproblems.
    pub fn dense_matrix(&self) -> nalgebra::DMatrix<f64> {
        self.matrix.to_dense()
    }
}

fn contact_of(scene: &Scene, assembly: &Assembly) -> Result<Option<ImplicitContact>, String> {
    let Some(parameters) = scene.contact else {
        return Ok(None);
    };
    let mut surface = ContactSurface::new();
    for (range, rod) in assembly.rods.rods.iter().zip(&scene.rods) {
        surface.add_rod(
            range.first_node,
            &rod.centreline,
            rod.closed,
            rod.radius,
            rod.held,
        );
    }
    let planes = scene.planes.iter().map(|plane| ContactPlane {
        point: plane.point,
        normal: plane.normal,
        friction: plane.friction.unwrap_or(parameters.friction),
    });
    let stiffness_per_force = parameters.stiffness_per_force(surface.largest_moving_radius());
    let least_stiffness = stiffness_per_force * assembly.force_scale;
    let mut contact = ImplicitContact::new(parameters, surface, planes.collect(), least_stiffness);
    let mut positions = vec![Vector3::zeros(); assembly.rods.nodes];
    copy_positions(&assembly.unknowns, &mut positions);
    if let Some(overlap) = contact.initial_overlaps(&positions).first() {
        return Err(describe_overlap(overlap, &contact, assembly));
    }
    contact.update_candidates(&positions);
    Ok(Some(contact))
}

/// A sentence that names two bodies that are too close.
pub fn describe_overlap(
    overlap: &super::contact::Proximity,
    contact: &ImplicitContact,
    assembly: &Assembly,
) -> String {
    use super::contact::ContactPair;
    let edge_name = |edge: usize| {
        let edge = contact.surface().edges()[edge];
        let (rod, node) = assembly.locate(edge.nodes[0]);
        format!("edge {node} of rod `{}`", assembly.names[rod])
    };
    let (first, second) = match overlap.pair {
        ContactPair::Edges([a, b]) => (edge_name(a), edge_name(b)),
        ContactPair::NodeAndPlane { node, plane } => {
            let (rod, along) = assembly.locate(node);
            (
                format!("node {along} of rod `{}`", assembly.names[rod]),
                format!("plane {plane}"),
            )
        }
    };
    let (meet, least) = if contact.parameters().is_barrier() {
        ("touch or interpenetrate", "more than")
    } else {
        ("interpenetrate", "at least")
    };
    format!(
        "{first} and {second} {meet}: distance {:.6e} m, allowed is {least} {:.6e} m",
        overlap.distance, overlap.threshold
    )
}

/// Copies the positions out of the unknowns.
pub fn copy_positions(unknowns: &[f64], positions: &mut [Vector3]) {
    for (node, x) in positions.iter_mut().enumerate() {
        *x = position(unknowns, node);
    }
}

fn start_of<'a>(stage: Option<&'a Stage>, now: &'a [Vector3]) -> (&'a [Vector3], f64) {
    match stage {
        Some(stage) => (&stage.positions, stage.step),
        None => (now, f64::INFINITY),
    }
}

/// Adds M/h ((q − qₙ)/h − vₙ) + C (q − qₙ)/h − F₀ + D ((q − qₙ)/h − vₙ).
fn add_inertia(assembly: &Assembly, stage: &Stage, unknowns: &[f64], residual: &mut [f64]) {
    let per_step = 1.0 / stage.step;
    for k in 0..residual.len() {
        let change = (unknowns[k] - stage.start[k]) * per_step - stage.velocity[k];
        residual[k] += assembly.masses[k] * per_step * change;
    }
    for (k, coefficient) in assembly.loads.damping.iter().enumerate() {
        residual[k] += coefficient * (unknowns[k] - stage.start[k]) * per_step;
    }
    for (node, (drag, resistance)) in stage.drag.iter().zip(&stage.resistance).enumerate() {
        let change = (position(unknowns, node) - stage.positions[node]) * per_step
            - position(&stage.velocity, node);
        let force = drag - resistance * change;
        for axis in 0..3 {
            residual[STRIDE * node + axis] -= force[axis];
        }
    }
}

fn subtract_contact_forces(contact: &ImplicitContact, residual: &mut [f64]) {
    for pair in contact.contacts() {
        for (corner, &node) in pair.nodes.iter().enumerate() {
            for axis in 0..3 {
                residual[STRIDE * node + axis] -= pair.force[3 * corner + axis];
            }
        }
    }
    for touch in contact.plane_contacts() {
        for axis in 0..3 {
            residual[STRIDE * touch.node + axis] -= touch.force[axis];
        }
    }
}

#[cfg(test)]
mod tests;
