//! All forces on all rods in one place: what dynamics and statics solve.
//!
//! [`System`] owns the models (elasticity, loads, contact) and scratch; it evaluates the residual
//!
//! ```text
//! R(q) = M/hₐ ((q − qₙ)/h − vₙ) + ∇E(q) + C (q − qₙ)/h − F_dead(t) − F_moment(q, t) − F_contact(q) − F_fluid
//! F_fluid = F₀ − D ((q − qₙ)/h − v₀)
//! ```
//!
//! (thesis Eq. 1.8) and its Jacobian, with the drag F₀ of a motion with the velocities v₀ and its local
//! resistance D; without a [`Stage`] the terms with h fall away and equilibrium remains. The natural strains in E may be
//! functions of time (`actuation`), and dashpots lie beside its springs where rods are viscous (`damping`). Springs between
//! nodes, between frames and about hinges are part of E (`springs`). Positions that others determine are eliminated (`joints`).

mod actuation;
mod balance;
mod breaking;
mod build;
mod centreline;
mod clamps;
mod complementarity;
mod contact_prediction;
mod contact_response;
mod contact_stiffness;
mod damping;
mod eccentric;
mod events;
mod factor;
mod follower;
mod grasp;
mod immersion;
mod joined_rods;
mod joints;
mod linear;
mod loads;
mod mass;
mod newton_matrix;
mod obstacles;
mod residual;
mod resultants;
mod rigid_contact;
mod roots;
mod shared_mass;
mod small_motions;
mod springs;
mod start;
mod strain;
mod touching;
mod turning;
mod work;

use actuation::Actuators;
pub(crate) use balance::Imbalance;
use balance::RodTolerance;
pub use breaking::Break;
use breaking::Breaking;
pub(crate) use build::Assembly;
pub(crate) use clamps::Drive;
use damping::Damping;
pub(crate) use events::Event;
pub use grasp::{Grasp, Interventions};
use joints::Border;
pub use joints::{check_joints, joint_unknowns};
use loads::Loads;
use newton_matrix::NewtonMatrix;
use obstacles::MovingObstacle;
pub use obstacles::obstacle_poses;
pub use resultants::Resultants;
pub(crate) use rigid_contact::ForceSearch;
pub(crate) use small_motions::MOST_UNKNOWNS;
use springs::Springs;
pub(crate) use strain::{SectionScale, Strain};
use touching::contact_of;
pub(crate) use touching::name_overlap;
pub(crate) use turning::Turn;

use super::contact::{ContactModel, ContactSystem};
use super::rod::{
    ElasticEnergy, GhostEdge, ReferenceFrames, RodGeometry, STRIDE, topology::position,
};
use super::scene::{Motion, Scene};
use super::{Matrix3, SceneError, Vector3};

/// What an implicit stage of a time step knows.
#[derive(Clone, Debug)]
pub struct Stage {
    /// Size h of the implicit stage, s: velocities are (q − qₙ)/h.
    pub step: f64,
    /// Size hₐ of the same for velocities, s: accelerations are (v − vₙ)/hₐ. It is h but for backward differences.
    pub acceleration_step: f64,
    /// Unknowns at its start.
    pub start: Vec<f64>,
    /// Velocities at its start.
    pub velocity: Vec<f64>,
    /// Drag F₀ of a motion near that of the stage, N per node, and with spheres in the fluid per place; empty without fluid.
    pub drag: Vec<Vector3>,
    /// Velocities v₀ of that motion, m/s for the same places.
    pub drag_velocity: Vec<Vector3>,
    /// Local resistance D, N s/m for the same places.
    pub resistance: Vec<Matrix3>,
    /// Positions at the start, m per node.
    pub positions: Vec<Vector3>,
}

/// Why Newton's method gave up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Divergence {
    /// Iterations spent.
    pub iterations: usize,
    /// Largest residual, N; NaN where the matrix was singular or a number not finite.
    pub residual: f64,
    /// Its unknown.
    pub unknown: usize,
}

const NO_RIGID_CONTACT: SceneError = SceneError::Unsuitable(
    "contact by complementarity knows no joints: choose the model `imc` or `ipc`",
);

const NO_START: SceneError = SceneError::Unsuitable(
    "a scene with rigid joints, hinges, sliding nodes or bodies with inertia cannot start from the end of another run, which does not tell how they are turned or where they slide",
);

/// Models, state of the frames, and scratch of one scene.
pub struct System {
    /// Rods, masses, held unknowns and clamps.
    pub assembly: Assembly,
    /// External loads.
    pub loads: Loads,
    /// Natural strains as functions of time.
    actuators: Actuators,
    /// Dashpots of the material.
    pub damping: Damping,
    /// Springs between nodes, between frames and about hinges.
    springs: Springs,
    /// What breaks of joints and springs.
    breaking: Breaking,
    /// Contact, where the scene has it.
    pub contact: Option<ContactSystem>,
    /// What contact passes over where rods are set in other bodies, in words.
    roots: Vec<String>,
    /// Frames from which the present step transports.
    pub reference: ReferenceFrames,
    /// Ghost edges at the present time.
    pub ghosts: Vec<GhostEdge>,
    /// Frames and strains of the last evaluation.
    pub geometry: RodGeometry,
    /// Time of the present evaluation, s.
    pub time: f64,
    /// Time of the frames of reference, s.
    committed_time: f64,
    /// Residual of the last evaluation, N and N m; at held unknowns what holds them.
    pub residual: Vec<f64>,
    corrected_residual: Vec<f64>,
    /// Scratch: which nodes are in contact.
    in_contact: Vec<bool>,
    dead_forces: Vec<f64>,
    /// Forces (N) and moments (N m) of another solver on the unknowns.
    pub external_forces: Vec<f64>,
    positions: Vec<Vector3>,
    /// Positions where the step starts, m, and the energy that contacts hold there, J, where it was asked for.
    step_start: Vec<Vector3>,
    stored_by_contact: f64,
    nodal_forces: Vec<Vector3>,
    displacements: Vec<Vector3>,
    /// Scratch: how far a unit force moves each node within a step by inertia, m/N.
    mobilities: Vec<f64>,
    /// Scratch of the complementarity model: a correction of the unknowns.
    correction: Vec<f64>,
    has_planes: bool,
    moving_obstacles: Vec<MovingObstacle>,
    /// Corners of schedules, in the order of time.
    events: Vec<Event>,
    /// Whether a node was ever grasped or released.
    switched: bool,
    matrix: NewtonMatrix,
    /// What sliding nodes add to it.
    border: Border,
    /// What residual counts as none, rod by rod, and the multiple of the acting forces that it is.
    tolerances: Vec<RodTolerance>,
    relative_tolerance: f64,
}

impl System {
    /// Sets up a scene at time zero.
    ///
    /// # Errors
    /// [`SceneError`] names what is impossible, overlapping rods among it.
    pub fn new(scene: &Scene) -> Result<Self, SceneError> {
        let mut assembly = Assembly::new(scene)?;
        if let Some(start) = &scene.start {
            let joints = &assembly.joints;
            if !joints.frames.is_empty() || !joints.slides.is_empty() {
                return Err(NO_START);
            }
            assembly.begin_at(start)?;
        }
        if let Some(contact) = scene.contact
            && contact.is_complementarity()
            && !assembly.joints.is_empty()
        {
            return Err(NO_RIGID_CONTACT);
        }
        let springs = Springs::new(scene, &assembly)?;
        springs.round(&mut assembly);
        let mut loads = Loads::new(&scene.loads, &assembly)?;
        loads.resist_spin(scene, &assembly);
        let actuators = Actuators::new(&scene.actuations, &assembly)?;
        let (contact, roots) = match contact_of(scene, &assembly)? {
            Some(of_scene) => (Some(of_scene.contact), of_scene.roots),
            None => (None, Vec::new()),
        };
        let friction = scene.contact.map_or(0.0, |parameters| parameters.friction);
        let friction_on_obstacles = contact.is_some()
            && scene
                .obstacles
                .iter()
                .any(|obstacle| obstacle.friction.unwrap_or(friction) > 0.0);
        let friction_of_pairs = friction > 0.0 || friction_on_obstacles;
        let friction_on_planes = contact.is_some()
            && scene
                .planes
                .iter()
                .any(|plane| plane.friction.unwrap_or(friction) > 0.0);
        let is_rigid = contact
            .as_ref()
            .is_some_and(|contact| contact.parameters().is_complementarity());
        let mut system = Self {
            geometry: RodGeometry::new(&assembly.rods),
            reference: assembly.reference.clone(),
            ghosts: assembly.ghosts.clone(),
            time: 0.0,
            committed_time: 0.0,
            residual: vec![0.0; assembly.unknowns.len()],
            corrected_residual: vec![0.0; assembly.unknowns.len()],
            in_contact: vec![false; assembly.rods.nodes],
            dead_forces: vec![0.0; assembly.unknowns.len()],
            external_forces: vec![0.0; assembly.unknowns.len()],
            positions: vec![Vector3::zeros(); assembly.rods.nodes],
            step_start: vec![Vector3::zeros(); assembly.rods.nodes],
            stored_by_contact: 0.0,
            has_planes: !scene.planes.is_empty(),
            moving_obstacles: MovingObstacle::of(&scene.obstacles),
            events: Vec::new(),
            switched: false,
            nodal_forces: vec![Vector3::zeros(); assembly.rods.nodes],
            displacements: vec![Vector3::zeros(); assembly.rods.nodes],
            mobilities: Vec::new(),
            correction: Vec::new(),
            matrix: NewtonMatrix::new(
                &assembly,
                &loads,
                &springs,
                friction_of_pairs,
                friction_on_planes,
                friction_on_planes || friction_on_obstacles || is_rigid,
            ),
            border: Border::default(),
            tolerances: vec![RodTolerance::default(); assembly.rods.rods.len()],
            relative_tolerance: 0.0,
            contact,
            roots,
            actuators,
            damping: Damping::new(scene),
            springs,
            breaking: Breaking::new(scene, &assembly),
            assembly,
            loads,
        };
        system.list_events();
        let mut unknowns = system.assembly.unknowns.clone();
        system.drive(0.0, &mut unknowns);
        system.update_geometry(&unknowns);
        Ok(system)
    }

    /// Gives a clamp another motion.
    pub(crate) fn move_clamp(&mut self, clamp: usize, motion: Motion) {
        self.assembly.drives[clamp].follow(motion);
        self.list_events();
    }

    /// Moves the clamps to `time`: writes prescribed unknowns and ghost edges, and the dead loads.
    pub fn drive(&mut self, time: f64, unknowns: &mut [f64]) {
        self.time = time;
        self.actuate(time);
        let committed = self.committed_time;
        for drive in &self.assembly.drives {
            drive.apply(time, committed, unknowns, &mut self.ghosts);
        }
        for drive in &mut self.assembly.drives {
            drive.turn_edges(time, committed, &self.reference, unknowns);
        }
        self.assembly.turn_held_frames(time);
        self.assembly.joints.complete(unknowns);
        self.place_obstacles(time);
        self.loads.dead_forces(time, &mut self.dead_forces);
        self.loads.update_damping(time);
        for (dead, external) in self.dead_forces.iter_mut().zip(&self.external_forces) {
            *dead += external;
        }
    }

    /// Computes frames and strains at `unknowns`.
    pub(crate) fn update_geometry(&mut self, unknowns: &[f64]) {
        self.springs.stretch(unknowns);
        self.assembly.joints.place(unknowns);
        (self.assembly.joints).turn_ghosts(unknowns, &mut self.ghosts);
        (self.springs).turn(&self.assembly.joints, &self.assembly.drives, self.time);
        self.geometry
            .update(&self.assembly.rods, unknowns, &self.reference, &self.ghosts);
    }

    /// Makes the frames of the last evaluation the source of the next step.
    pub(crate) fn commit_frames(&mut self) {
        self.geometry.commit(&mut self.reference);
        self.committed_time = self.time;
        self.commit_obstacles();
        self.assembly.drives.iter_mut().for_each(Drive::commit);
        self.assembly.joints.commit();
        self.ghosts.iter_mut().for_each(|ghost| ghost.spin = 0.0);
    }

    /// Goes on from frames that were committed at `time` with `unknowns`.
    pub(crate) fn resume(&mut self, time: f64, unknowns: &[f64], reference: &ReferenceFrames) {
        self.begin_step(None);
        self.reference.clone_from(reference);
        self.committed_time = time;
        self.place_obstacles(time);
        self.commit_obstacles();
        for drive in &mut self.assembly.drives {
            drive.resume(unknowns);
        }
        self.assembly.joints.rotate(unknowns);
        self.assembly.joints.commit();
    }

    /// Keeps frames and contact forces of the last evaluation as those of an accepted step.
    pub(crate) fn accept(&mut self) {
        self.keep_damping();
        self.commit_frames();
        if let Some(contact) = &mut self.contact {
            contact.commit_multipliers();
        }
    }

    /// Elastic energy of the last evaluation, that of springs and of what relaxes included.
    pub fn elastic_energy(&self) -> ElasticEnergy {
        let rods = self.assembly.rods.energy(&self.geometry);
        rods + self.springs.energy() + self.relaxing_energy(None)
    }

    /// Potential of the last evaluation, at `unknowns`, J: elastic and contact energy less the work of the dead
    /// forces. Moments of fixed direction have none.
    pub(crate) fn potential(&self, unknowns: &[f64]) -> f64 {
        let elastic = self.elastic_energy();
        let contact = self.contact.as_ref().map_or(0.0, ContactSystem::energy);
        let work: f64 = (self.dead_forces.iter().zip(unknowns))
            .map(|(force, unknown)| force * unknown)
            .sum();
        elastic.total() + contact - work
    }

    /// Sum of the magnitudes that [`Self::potential`] adds up, J: rounding leaves some last digits of it.
    pub(crate) fn potential_size(&self, unknowns: &[f64]) -> f64 {
        let elastic = self.elastic_energy();
        let contact = self.contact.as_ref().map_or(0.0, ContactSystem::energy);
        let work: f64 = (self.dead_forces.iter().zip(unknowns))
            .map(|(force, unknown)| (force * unknown).abs())
            .sum();
        elastic.total().abs() + contact.abs() + work
    }

    /// Evaluates the residual at `unknowns`.
    pub fn evaluate(&mut self, unknowns: &[f64], stage: Option<&Stage>) {
        if stage.is_none() {
            self.undamp();
        }
        self.update_geometry(unknowns);
        self.residual.fill(0.0);
        self.assembly
            .rods
            .add_gradient(&self.geometry, &mut self.residual);
        (self.springs).add_gradient(&self.assembly.joints, &mut self.residual);
        self.add_simple_terms(unknowns, stage);
        if let Some(contact) = &mut self.contact {
            copy_positions(unknowns, &mut self.positions);
            let (previous, step) = start_of(stage, &self.positions);
            contact.evaluate_forces(&self.positions, previous, step);
            subtract_contact_forces(contact, &mut self.residual);
        }
        self.gather_at_joints(unknowns);
    }

    /// Evaluates residual and Jacobian at `unknowns`.
    pub fn linearize(&mut self, unknowns: &[f64], stage: Option<&Stage>) {
        if stage.is_none() {
            self.undamp();
        }
        self.update_geometry(unknowns);
        self.residual.fill(0.0);
        self.matrix.clear();
        self.matrix
            .add_elastic(&self.assembly.rods, &self.geometry, &mut self.residual);
        (self.springs).add_gradient(&self.assembly.joints, &mut self.residual);
        (self.matrix).add_springs(&self.springs, &self.assembly.joints, unknowns);
        self.add_simple_terms(unknowns, stage);
        if let Some(stage) = stage {
            self.matrix.add_inertia(&self.assembly, &self.loads, stage);
        }
        self.matrix
            .add_edge_loads(&self.loads, self.time, &self.reference, &self.geometry);
        if let Some(contact) = &mut self.contact {
            copy_positions(unknowns, &mut self.positions);
            let (previous, step) = start_of(stage, &self.positions);
            contact.evaluate(&self.positions, previous, step);
            subtract_contact_forces(contact, &mut self.residual);
            if contact.couple_contacts() {
                self.matrix.expect_other_candidates();
            }
            self.matrix.add_contact(contact);
        }
        self.gather_at_joints(unknowns);
        self.matrix.turn_frames(&self.assembly, unknowns, stage);
        self.matrix.hold(&self.assembly.held);
    }

    /// Adds inertia, damping, drag, and loads to the residual.
    fn add_simple_terms(&mut self, unknowns: &[f64], stage: Option<&Stage>) {
        for (entry, force) in self.residual.iter_mut().zip(&self.dead_forces) {
            *entry -= force;
        }
        for moment in &self.loads.moments {
            let (force, spin) = moment.force(self.time, &self.geometry.edges[moment.start]);
            for axis in 0..3 {
                self.residual[STRIDE * moment.end + axis] -= force[axis];
                self.residual[STRIDE * moment.start + axis] += force[axis];
            }
            self.residual[STRIDE * moment.start + 3] -= spin;
        }
        for follower in &self.loads.followers {
            let force = follower.force(self.time, &self.geometry.edges[follower.start]);
            for (node, share) in [follower.start, follower.end]
                .into_iter()
                .zip(follower.shares)
            {
                for axis in 0..3 {
                    self.residual[STRIDE * node + axis] -= share * force[axis];
                }
            }
        }
        let Some(stage) = stage else { return };
        add_inertia(
            &self.assembly,
            &self.loads,
            stage,
            unknowns,
            &mut self.residual,
        );
    }

    /// Notes where a step starts, and the energy that contacts hold there if the scheme `extrapolates`. Candidates must be
    /// those of the start.
    pub(crate) fn note_start(&mut self, unknowns: &[f64], extrapolates: bool) {
        let Some(contact) = &self.contact else {
            return;
        };
        copy_positions(unknowns, &mut self.step_start);
        self.stored_by_contact = if extrapolates {
            contact.energy_at(&self.step_start)
        } else {
            0.0
        };
    }

    /// Lets Newton's method carry contact forces along, those of the last step at first.
    pub(crate) fn begin_iterations(&mut self, stage: &Stage) {
        let Some(contact) = &mut self.contact else {
            return;
        };
        let (masses, held) = (&self.assembly.masses, &self.assembly.held);
        let square = stage.step * stage.acceleration_step;
        self.mobilities.clear();
        self.mobilities
            .extend((0..self.positions.len()).map(|node| {
                let unknown = STRIDE * node;
                if held[unknown] {
                    0.0
                } else {
                    square / masses[unknown]
                }
            }));
        contact.begin_iterations(&self.mobilities);
    }

    /// Says whether the last correction was small against the radii.
    pub(crate) fn set_moved_slightly(&mut self, slightly: bool) {
        if let Some(contact) = &mut self.contact {
            contact.set_moved_slightly(slightly);
        }
    }

    /// Goes on without carried contact forces.
    pub(crate) fn abandon_multipliers(&mut self) {
        if let Some(contact) = &mut self.contact {
            contact.abandon_multipliers();
        }
    }

    /// Whether Newton's method carries contact forces along.
    pub(crate) fn uses_multipliers(&self) -> bool {
        self.contact
            .as_ref()
            .is_some_and(ContactSystem::uses_multipliers)
    }

    /// Whether the candidates of contact changed; to be called at the start of a step.
    pub fn update_candidates(&mut self, unknowns: &[f64]) {
        if let Some(contact) = &mut self.contact {
            copy_positions(unknowns, &mut self.positions);
            if contact.update_candidates(&self.positions) {
                self.matrix.expect_other_candidates();
            }
        }
    }

    /// Whether contact is frictional and by a penalty, which any step may overcome.
    pub(crate) fn has_friction(&self) -> bool {
        self.contact.as_ref().is_some_and(|contact| {
            let parameters = contact.parameters();
            parameters.friction > 0.0 && parameters.model == ContactModel::ImplicitContact
        })
    }

    /// Whether no contact can be missing at `unknowns` for want of candidates.
    pub(crate) fn candidates_are_complete(&mut self, unknowns: &[f64]) -> bool {
        let Some(contact) = &self.contact else {
            return true;
        };
        copy_positions(unknowns, &mut self.positions);
        contact.candidates_are_complete(&self.positions)
    }

    /// Largest part of the straight path between two sets of unknowns along which no contact is crossed; 1
    /// where the contact model allows penetration.
    pub(crate) fn largest_step(&mut self, from: &[f64], to: &[f64]) -> f64 {
        let Some(contact) = &mut self.contact else {
            return 1.0;
        };
        copy_positions(from, &mut self.positions);
        for (node, displacement) in self.displacements.iter_mut().enumerate() {
            *displacement = position(to, node) - self.positions[node];
        }
        let step = contact.largest_step(&self.positions, &self.displacements);
        if step.candidates_changed {
            self.matrix.expect_other_candidates();
        }
        step.fraction
    }

    /// Farthest that a node may move at once so that surfaces do not pass through each other unnoticed, m; infinite
    /// where nothing touches, and where [`Self::largest_step`] watches over it.
    pub(crate) fn largest_safe_move(&self) -> f64 {
        let Some(contact) = &self.contact else {
            return f64::INFINITY;
        };
        if contact.parameters().model != ContactModel::ImplicitContact {
            return f64::INFINITY;
        }
        self.assembly
            .radii
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min)
    }

    /// Forgets the factorisation pattern, as after a restart from a checkpoint.
    pub(crate) fn forget_pattern(&mut self) {
        self.matrix.forget_pattern();
    }

    /// The Jacobian of the last linearisation as a dense matrix over all unknowns, held ones with unit
    /// diagonals; for tests and small eigenproblems.
    pub fn dense_matrix(&self) -> nalgebra::DMatrix<f64> {
        let mut dense = self.matrix.to_dense();
        (self.assembly.joints).reduce_jacobian(&mut dense, &self.assembly.held);
        dense
    }
}

/// Copies the positions out of the unknowns.
pub(crate) fn copy_positions(unknowns: &[f64], positions: &mut [Vector3]) {
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

/// Adds M/hₐ ((q − qₙ)/h − vₙ) + C (q − qₙ)/h − F₀ + D ((q − qₙ)/h − v₀).
fn add_inertia(
    assembly: &Assembly,
    loads: &Loads,
    stage: &Stage,
    unknowns: &[f64],
    residual: &mut [f64],
) {
    let per_step = 1.0 / stage.step;
    let per_acceleration_step = 1.0 / stage.acceleration_step;
    for k in 0..residual.len() {
        let change = (unknowns[k] - stage.start[k]) * per_step - stage.velocity[k];
        residual[k] += assembly.masses[k] * per_acceleration_step * change;
    }
    assembly.add_shared_inertia(stage, unknowns, residual);
    assembly.add_eccentric_inertia(stage, unknowns, residual);
    for (k, coefficient) in loads.damping.iter().enumerate() {
        residual[k] += coefficient * (unknowns[k] - stage.start[k]) * per_step;
    }
    for (node, (drag, resistance)) in stage.drag.iter().zip(&stage.resistance).enumerate() {
        let change = (position(unknowns, node) - position(&stage.start, node)) * per_step
            - stage.drag_velocity[node];
        let force = drag - resistance * change;
        for axis in 0..3 {
            residual[STRIDE * node + axis] -= force[axis];
        }
    }
}

fn subtract_contact_forces(contact: &ContactSystem, residual: &mut [f64]) {
    for pair in contact.contacts() {
        for (corner, &node) in pair.nodes.iter().enumerate() {
            if !contact.is_of_rod(node) {
                continue;
            }
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
