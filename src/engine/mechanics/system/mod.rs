//! All forces on all rods: the equations that dynamics and statics solve.
//!
//! [`System`] has a list of forces (`terms`), each of which implements one interface (`term`); it evaluates the residual
//!
//! ```text
//! R(q) = M/hₐ ((q − qₙ)/h − vₙ) + ∇E(q) + C (q − qₙ)/h − F_dead(t) − F_moment(q, t) − F_contact(q) − F_fluid
//! F_fluid = F₀ − D ((q − qₙ)/h − v₀)
//! ```
//!
//! (thesis Eq. 1.8) and its Jacobian, with the drag F₀ of a motion with the velocities v₀ and its
//! local resistance D. Without a [`Stage`] the terms with h vanish, which gives the equations of
//! equilibrium. The natural strains in E may be functions of time (`actuation`), and dashpots act
//! in parallel to its springs in viscous rods (`damping`). Springs between nodes, between frames
//! and about hinges are part of E (`springs`). Dependent positions are eliminated (`joints`).

mod actuation;
mod attached;
mod balance;
mod bearings;
mod breaking;
mod build;
mod centreline;
mod clamps;
mod complementarity;
mod constraint_matrix;
mod contact;
mod contact_prediction;
mod contact_response;
mod contact_start;
mod contact_stiffness;
mod copies;
mod cross_flow;
mod curve_elements;
mod damping;
mod demand;
mod eccentric;
mod elasticity;
mod events;
mod factor;
mod follower;
mod free_bodies;
mod grasp;
mod immersion;
mod inertia;
mod joined_bodies;
mod joined_rods;
mod joined_start;
mod joints;
mod jumps;
mod linear;
mod linear_drag;
mod loads;
mod local_drag;
mod mass;
mod newton_matrix;
mod node_element;
mod node_forces;
mod obstacles;
mod plastic_layers;
mod plasticity;
mod residual;
mod resultants;
mod rigid_contact;
mod rod_scale;
mod roots;
mod shared_mass;
mod sheaths;
mod small_motions;
mod spin;
mod springs;
mod stage;
mod start;
mod strain;
mod tendons;
mod term;
mod terms;
mod touching;
mod turned_elements;
mod turning;
mod virtual_work;
mod whole_matrix;
mod work;

use balance::Tolerances;
pub(crate) use balance::{Imbalance, keep_larger};
pub use breaking::Break;
use breaking::Breaking;
pub(crate) use build::Assembly;
pub(crate) use clamps::Drive;
use contact_response::Found;
pub(crate) use contact_start::StiffnessCourse;
pub(crate) use copies::{Allowance, Copies, Member, set_lanes};
pub(crate) use demand::Demand;
pub(crate) use events::Event;
pub use free_bodies::BodyMotion;
pub use grasp::{Grasp, Interventions};
use joints::Border;
pub(crate) use joints::TurningFrame;
pub use joints::{check_joints, joint_unknowns};
pub(crate) use jumps::Velocities;
use newton_matrix::NewtonMatrix;
pub use obstacles::obstacle_poses;
pub use resultants::Resultants;
pub(crate) use rigid_contact::ForceSearch;
pub use sheaths::check_sheaths;
pub(crate) use small_motions::MOST_UNKNOWNS;
pub use stage::Stage;
pub(crate) use stage::{angles_of, copy_positions};
pub(crate) use strain::{SectionScales, Strain};
use term::Configuration;
use terms::Terms;
pub(crate) use touching::{name_overlap, surface_of_rods};
pub(crate) use turned_elements::moments;
pub(crate) use turning::Turn;
pub(crate) use virtual_work::{OfStrains, StrainLaws};
pub(crate) use whole_matrix::WholeMatrix;

use super::SceneError;
use super::rod::{ElasticEnergy, GhostEdge, ReferenceFrames, RodGeometry};
use super::scene::{Motion, Scene};
use std::sync::atomic::{AtomicU64, Ordering};

/// Systems so far.
static SYSTEMS: AtomicU64 = AtomicU64::new(0);

/// Reason why Newton's method did not converge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Divergence {
    /// Iterations spent.
    pub iterations: usize,
    /// Largest residual, N; NaN if the matrix was singular or a value not finite.
    pub residual: f64,
    /// Its unknown.
    pub unknown: usize,
}

/// The terms of a scene, the state of its frames, and the Newton matrix.
pub struct System {
    /// Rods, masses, held unknowns and clamps.
    pub assembly: Assembly,
    /// The forces.
    pub(crate) terms: Terms,
    /// Joints and springs that may break.
    breaking: Breaking,
    /// Reference frames of the present step for parallel transport.
    pub reference: ReferenceFrames,
    /// Ghost edges at the present time.
    pub ghosts: Vec<GhostEdge>,
    /// Frames and strains of the last evaluation.
    pub geometry: RodGeometry,
    /// Time of the present evaluation, s.
    pub time: f64,
    /// Time of the reference frames, s.
    committed_time: f64,
    /// Residual of the last evaluation, N and N m; at held unknowns the reactions.
    pub residual: Vec<f64>,
    corrected_residual: Vec<f64>,
    /// Corners of schedules, in the order of time.
    events: Vec<Event>,
    /// Whether any node was grasped or released.
    switched: bool,
    /// Unique identifier among all systems of the program.
    number: u64,
    matrix: NewtonMatrix,
    /// Border of the matrix for sliding nodes.
    border: Border,
    /// Convergence tolerance of the residual.
    tolerances: Tolerances,
    /// Responses of the last prediction of contact forces; scratch.
    responses: Found,
}

impl System {
    /// Sets up a scene at time zero.
    ///
    /// # Errors
    /// [`SceneError`] for an invalid scene, for example with overlapping rods.
    pub fn new(scene: &Scene) -> Result<Self, SceneError> {
        let mut assembly = Assembly::new(scene)?;
        let is_rigid = (scene.contact).is_some_and(|contact| contact.is_complementarity());
        let demands = [
            scene.start.as_ref().map(|_| Demand::Start),
            is_rigid.then_some(Demand::RigidContact),
        ];
        for demand in demands.into_iter().flatten() {
            assembly.joints.admit(demand)?;
        }
        if let Some(start) = &scene.start {
            assembly.begin_at(start)?;
        }
        let terms = Terms::new(scene, &mut assembly)?;
        let has_potential = terms.all().iter().all(|term| term.has_potential());
        let lists_nodes = terms.contact.lists_nodes;
        let elements = terms.elements(&assembly);
        let mut system = Self {
            geometry: RodGeometry::new(&assembly.rods),
            reference: assembly.reference.clone(),
            ghosts: assembly.ghosts.clone(),
            time: 0.0,
            committed_time: 0.0,
            residual: vec![0.0; assembly.unknowns.len()],
            corrected_residual: vec![0.0; assembly.unknowns.len()],
            events: Vec::new(),
            switched: false,
            number: SYSTEMS.fetch_add(1, Ordering::Relaxed),
            matrix: NewtonMatrix::new(&assembly, &elements, has_potential, lists_nodes),
            border: Border::default(),
            tolerances: Tolerances::new(&assembly),
            responses: Found::default(),
            breaking: Breaking::new(scene, &assembly),
            terms,
            assembly,
        };
        for demand in demands.into_iter().flatten() {
            system.admit(demand)?;
        }
        system.list_events();
        let mut unknowns = system.assembly.unknowns.clone();
        system.drive(0.0, &mut unknowns);
        system.update_geometry(&unknowns);
        Ok(system)
    }

    /// Checks whether the scene meets a demand.
    ///
    /// # Errors
    /// The reason of the term that does not support it.
    pub(crate) fn admit(&self, demand: Demand) -> Result<(), SceneError> {
        self.assembly.joints.admit(demand)?;
        self.terms.admit(demand)
    }

    /// Gives a clamp another motion.
    pub(crate) fn move_clamp(&mut self, clamp: usize, motion: Motion) {
        self.assembly.drives[clamp].follow(motion);
        self.list_events();
    }

    /// Multiplies a load of the scene, counted from 0, by a factor in addition to its schedule; `None` if the load does not exist.
    pub(crate) fn set_load_factor(&mut self, load: usize, factor: f64) -> Option<()> {
        self.terms.loads.factors().get(load)?;
        for term in self.terms.all_mut() {
            term.scale_load(load, factor);
        }
        Some(())
    }

    /// Applies the prescribed motion and the dead loads at `time`: sets prescribed unknowns and
    /// ghost edges.
    pub fn drive(&mut self, time: f64, unknowns: &mut [f64]) {
        self.time = time;
        let committed = self.committed_time;
        for drive in &self.assembly.drives {
            drive.apply(time, committed, unknowns, &mut self.ghosts);
        }
        for drive in &mut self.assembly.drives {
            drive.turn_edges(time, committed, &self.reference, unknowns);
        }
        self.hold_in_sheaths(time, unknowns);
        self.assembly.turn_held_frames(time);
        self.assembly.joints.complete(unknowns);
        for term in self.terms.all_mut() {
            term.drive(time, &mut self.assembly.rods, &mut self.geometry);
        }
    }

    /// Computes frames and strains at `unknowns`.
    pub(crate) fn update_geometry(&mut self, unknowns: &[f64]) {
        self.assembly.joints.place(unknowns);
        (self.assembly.joints).turn_ghosts(unknowns, &mut self.ghosts);
        self.geometry
            .update(&self.assembly.rods, unknowns, &self.reference, &self.ghosts);
        self.yield_rods();
        let parts = self.parts(unknowns, None);
        for term in parts.terms.all_mut() {
            term.update(&parts.at);
        }
    }

    /// Makes the frames of the last evaluation the reference frames of the next step.
    pub(crate) fn commit_frames(&mut self) {
        self.geometry.commit(&mut self.reference);
        self.committed_time = self.time;
        for term in self.terms.all_mut() {
            term.commit();
        }
        self.assembly.drives.iter_mut().for_each(Drive::commit);
        self.assembly.joints.commit();
        self.ghosts.iter_mut().for_each(|ghost| ghost.spin = 0.0);
    }

    /// Restores the frames that were committed at `time` with `unknowns`.
    pub(crate) fn resume(&mut self, time: f64, unknowns: &[f64], reference: &ReferenceFrames) {
        self.begin_step(None);
        self.reference.clone_from(reference);
        self.committed_time = time;
        for term in self.terms.all_mut() {
            term.resume(time);
        }
        for drive in &mut self.assembly.drives {
            drive.resume(unknowns);
        }
        self.resume_sheaths(unknowns);
        self.assembly.joints.rotate(unknowns);
        self.assembly.joints.commit();
    }

    /// Stores the data of the last evaluation as those of an accepted step.
    pub(crate) fn accept(&mut self) {
        for term in self.terms.all_mut() {
            term.accept(&self.assembly, &self.geometry);
        }
        self.commit_frames();
    }

    /// Elastic energy of the last evaluation, including springs, relaxing parts and joints that
    /// yield.
    pub fn elastic_energy(&self) -> ElasticEnergy {
        let terms = self.terms.all().into_iter();
        let mut energy = terms.fold(ElasticEnergy::default(), |sum, term| {
            sum + term.energy(&self.assembly, &self.geometry)
        });
        energy.stretching += self.slides().iter().map(joints::Slide::energy).sum::<f64>();
        energy
    }

    /// Potential of the last evaluation, at `unknowns`, J: elastic and contact energy minus the
    /// work of the dead forces. Moments of fixed direction have no potential.
    pub(crate) fn potential(&self, unknowns: &[f64]) -> f64 {
        self.potential_and_size(unknowns)[0]
    }

    /// Sum of the magnitudes that [`Self::potential`] adds up, J: the rounding error of the
    /// potential is a few units in the last place of this sum.
    pub(crate) fn potential_size(&self, unknowns: &[f64]) -> f64 {
        self.potential_and_size(unknowns)[1]
    }

    fn potential_and_size(&self, unknowns: &[f64]) -> [f64; 2] {
        let elastic = self.elastic_energy().total();
        let terms = self.terms.all().into_iter().rev();
        terms.fold([elastic, elastic.abs()], |[sum, size], term| {
            let [own, own_size] = term.potential(unknowns);
            [sum + own, size + own_size]
        })
    }

    /// Evaluates the residual at `unknowns`.
    pub fn evaluate(&mut self, unknowns: &[f64], stage: Option<&Stage>) {
        self.begin_evaluation(unknowns, stage);
        self.residual.fill(0.0);
        let parts = self.parts(unknowns, stage);
        for term in parts.terms.all_mut() {
            term.evaluate(&parts.at, parts.residual);
        }
        self.gather_at_joints(unknowns);
    }

    /// Evaluates residual and Jacobian at `unknowns`.
    pub fn linearize(&mut self, unknowns: &[f64], stage: Option<&Stage>) {
        self.linearize_all(unknowns, stage);
        self.matrix.hold(&self.assembly.held);
    }

    /// Like [`Self::linearize`], with the arguments of the last [`Self::evaluate`]: its frames and
    /// contact forces are used again.
    pub(crate) fn linearize_evaluated(&mut self, unknowns: &[f64], stage: Option<&Stage>) {
        self.add_linearised_terms(unknowns, stage);
        self.matrix.hold(&self.assembly.held);
    }

    /// Evaluates residual and Jacobian, and returns the Jacobian with the rows of held unknowns.
    pub(crate) fn linearize_whole(
        &mut self,
        unknowns: &[f64],
        stage: Option<&Stage>,
    ) -> WholeMatrix {
        self.linearize_all(unknowns, stage);
        let whole = self.matrix.whole();
        self.matrix.hold(&self.assembly.held);
        whole
    }

    /// Evaluates residual and transposed Jacobian: [`Self::solve`] then solves Jᵀ x = b, with the
    /// same held unknowns.
    pub(crate) fn linearize_transposed(
        &mut self,
        unknowns: &[f64],
        stage: Option<&Stage>,
    ) -> WholeMatrix {
        self.linearize_all(unknowns, stage);
        self.matrix.transpose();
        let whole = self.matrix.whole();
        self.matrix.hold(&self.assembly.held);
        whole
    }

    fn linearize_all(&mut self, unknowns: &[f64], stage: Option<&Stage>) {
        self.begin_evaluation(unknowns, stage);
        self.add_linearised_terms(unknowns, stage);
    }

    fn add_linearised_terms(&mut self, unknowns: &[f64], stage: Option<&Stage>) {
        self.residual.fill(0.0);
        self.matrix.clear();
        let parts = self.parts(unknowns, stage);
        for (number, term) in parts.terms.all_mut().into_iter().enumerate() {
            let mut entries = parts.matrix.entries_of(number);
            term.linearize(&parts.at, parts.residual, &mut entries);
        }
        self.gather_at_joints(unknowns);
        self.matrix.turn_frames(&self.assembly, unknowns, stage);
    }

    fn begin_evaluation(&mut self, unknowns: &[f64], stage: Option<&Stage>) {
        if stage.is_none() {
            self.undamp();
        }
        self.update_geometry(unknowns);
    }

    /// Configuration at which forces are evaluated.
    fn at<'a>(&'a self, unknowns: &'a [f64], stage: Option<&'a Stage>) -> Configuration<'a> {
        Configuration {
            assembly: &self.assembly,
            geometry: &self.geometry,
            reference: &self.reference,
            time: self.time,
            unknowns,
            stage,
        }
    }

    /// The configuration at `unknowns`, with the terms and the data that they add to.
    fn parts<'a>(&'a mut self, unknowns: &'a [f64], stage: Option<&'a Stage>) -> Parts<'a> {
        Parts {
            at: Configuration {
                assembly: &self.assembly,
                geometry: &self.geometry,
                reference: &self.reference,
                time: self.time,
                unknowns,
                stage,
            },
            terms: &mut self.terms,
            residual: &mut self.residual,
            matrix: &mut self.matrix,
        }
    }

    /// Discards the factorisation pattern, as after a restart from a checkpoint.
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

/// Data that an evaluation reads and writes.
struct Parts<'a> {
    at: Configuration<'a>,
    terms: &'a mut Terms,
    residual: &'a mut [f64],
    matrix: &'a mut NewtonMatrix,
}

#[cfg(test)]
mod tests;
