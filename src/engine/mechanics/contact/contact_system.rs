//! All contacts of a scene: candidates, forces, Jacobians, stiffness.

use super::active_law::ActiveLaw;
use super::body_turns::{BodyTurns, SpunContact};
use super::broad_phase::BroadPhase;
use super::candidates::Candidates;
use super::contacts::{
    ActiveContact, Bodies, CandidatePair, ContactConstraint, EdgeJacobian, ForceCorrections,
    PlaneContact, PlaneJacobian, Proximity,
};
use super::curve_points::CurvePoints;
use super::evaluated::EvaluatedPair;
use super::iterate::Iterate;
use super::multipliers::Multipliers;
use super::parameters::ContactParameters;
use super::placed_obstacles::PlacedObstacles;
use super::plane::ContactPlane;
use super::slots::Slots;
use super::surface::ContactSurface;
use super::surface_turns::{SurfaceTurns, TurnedContact};
use super::tractions::Tractions;
use crate::mechanics::Vector3;
use crate::mechanics::rotation::Pose;
use std::sync::Arc;

/// Implicit contact with Coulomb friction (thesis 2.2–2.3) of all rods and planes of a scene, by the
/// potential of the implicit contact model or by the barrier of incremental potential contact.
///
/// In a time step: [`update_candidates`](Self::update_candidates); then
/// [`evaluate`](Self::evaluate) in each Newton iteration, and
/// [`evaluate_forces`](Self::evaluate_forces) in each trial of the line search. `largest_step`
/// limits how far the line search may go along a straight path. After the step:
/// `candidates_are_complete`, `excessive_penetration` and `passage`.
///
/// The distance of two edges has kinks where several pairs of points are equally near: at the
/// joints of a rod, and on parallel edges, whose closest points the implicit contact model
/// smooths. Newton's method may need its line search there. Every model guarantees at the end of a
/// step that no surfaces overlap beyond the bound, and that no bodies have passed through each
/// other.
#[derive(Clone, Debug)]
pub struct ContactSystem {
    pub(super) parameters: ContactParameters,
    pub(super) surface: ContactSurface,
    /// Smooth curves of the rods; without them the contact points of rods are their nodes.
    pub(super) curves: Option<Arc<CurvePoints>>,
    /// Contact points of all rods.
    node_count: usize,
    pub(super) planes: Vec<ContactPlane>,
    /// Nodes of the rod before and after each node; the node itself at a free end. Empty unless
    /// the friction of a plane depends on the direction of rods.
    pub(super) chords: Vec<[usize; 2]>,
    pub(super) obstacles: PlacedObstacles,
    pub(super) candidates: Candidates,
    /// Positions at the start of the step, m; empty before the first.
    pub(super) start: Vec<Vector3>,
    pub(super) multipliers: Multipliers,
    pub(super) carried_tractions: Tractions,
    pub(super) stiffness: f64,
    pub(super) least_stiffness: f64,
    /// Least contact stiffness of each node; empty if it is the same for all.
    pub(super) least_of_nodes: Vec<f64>,
    pub(super) iterate: Iterate,
    /// Displacement of every node since the candidates were built, m; scratch.
    pub(super) motion: Vec<f64>,
    pub(super) broad_phase: BroadPhase,
    /// Pairs of edges whose paths come near each other; scratch.
    pub(super) swept_pairs: Vec<CandidatePair>,
    /// Positions along a step that is searched for collisions, m; scratch.
    pub(super) scratch_positions: Vec<Vector3>,
    pub(super) contacts: Vec<ActiveContact>,
    /// Friction per normal force of the edge contacts.
    pub(super) tractions: Vec<Vector3>,
    pub(super) jacobians: Vec<EdgeJacobian>,
    /// Differences between the forces of the linear laws and the present forces, N.
    pub(super) linear_corrections: Vec<[f64; 12]>,
    pub(super) plane_contacts: Vec<PlaneContact>,
    /// Friction per normal force of the plane contacts.
    pub(super) plane_tractions: Vec<Vector3>,
    pub(super) plane_jacobians: Vec<PlaneJacobian>,
    pub(super) plane_linear_corrections: Vec<[f64; 3]>,
    /// Rotation of the surfaces of rods, if friction acts at them.
    pub(super) surface_turns: Option<SurfaceTurns>,
    /// Contacts that turn edges; those of pairs come first.
    pub(super) turned: Vec<TurnedContact>,
    /// Rotation of free bodies.
    pub(super) body_turns: BodyTurns,
    /// Contacts of free bodies with friction, parallel to those of pairs and of planes; empty
    /// without free bodies.
    pub(super) spun: Vec<Option<SpunContact>>,
    pub(super) plane_spun: Vec<Option<SpunContact>>,
    /// Contacts of the complementarity model.
    pub(super) constraints: Vec<ContactConstraint>,
    /// Active laws that replace the constraints while derivatives are computed.
    pub(super) active_laws: Vec<ActiveLaw>,
    pub(super) energy: f64,
    /// Work of the friction in a step because round obstacles turn about their centrelines, J.
    pub(super) turning_work: f64,
    /// Size of the stage, over the time in which obstacles move from its start to its end.
    pub(super) obstacle_pace: f64,
    pub(super) contact_count: usize,
    /// Whether the position of each node of the rods is prescribed.
    pub(super) prescribed: Vec<bool>,
    /// The pairs in contact at the last evaluation of forces alone, in the order of the candidates.
    pub(super) evaluated: Vec<EvaluatedPair>,
    /// Prescribed points that touched at the last evaluation.
    pub(super) without_force: Vec<Proximity>,
}

impl ContactSystem {
    /// `least_stiffness` is the initial contact stiffness k, and the least value that
    /// `Self::adapt_stiffness` chooses; a suitable value is that for the force scale EI/L².
    pub fn new(
        parameters: ContactParameters,
        surface: ContactSurface,
        planes: Vec<ContactPlane>,
        least_stiffness: f64,
    ) -> Self {
        let candidates = Candidates::new(&surface, parameters.reach());
        let is_directed = planes.iter().any(|plane| plane.directed_friction.is_some());
        Self {
            chords: if is_directed {
                surface.chords()
            } else {
                Vec::new()
            },
            curves: None,
            node_count: surface.node_count(),
            obstacles: PlacedObstacles::new(&surface),
            surface_turns: SurfaceTurns::of(&surface, &parameters),
            turned: Vec::new(),
            body_turns: BodyTurns::of(&surface),
            spun: Vec::new(),
            plane_spun: Vec::new(),
            parameters,
            surface,
            planes,
            candidates,
            start: Vec::new(),
            multipliers: Multipliers::default(),
            carried_tractions: Tractions::default(),
            tractions: Vec::new(),
            stiffness: least_stiffness,
            least_stiffness,
            least_of_nodes: Vec::new(),
            iterate: Iterate::default(),
            motion: Vec::new(),
            broad_phase: BroadPhase::default(),
            swept_pairs: Vec::new(),
            scratch_positions: Vec::new(),
            contacts: Vec::new(),
            jacobians: Vec::new(),
            linear_corrections: Vec::new(),
            plane_contacts: Vec::new(),
            plane_tractions: Vec::new(),
            plane_jacobians: Vec::new(),
            plane_linear_corrections: Vec::new(),
            constraints: Vec::new(),
            active_laws: Vec::new(),
            energy: 0.0,
            turning_work: 0.0,
            obstacle_pace: 1.0,
            contact_count: 0,
            prescribed: Vec::new(),
            evaluated: Vec::new(),
            without_force: Vec::new(),
        }
    }

    /// The surfaces.
    pub(crate) fn surface(&self) -> &ContactSurface {
        &self.surface
    }

    /// The rigid planes.
    pub(crate) fn planes(&self) -> &[ContactPlane] {
        &self.planes
    }

    /// The parameters.
    pub(crate) fn parameters(&self) -> &ContactParameters {
        &self.parameters
    }

    /// Sets the margin of the candidates, m (two radii of the thickest moving rod otherwise), and discards them.
    ///
    /// A larger margin means fewer rebuilds; a smaller margin means fewer candidates and so fewer
    /// entries in the Newton system. Call this before the first update, and again before a
    /// restart.
    #[cfg(test)]
    pub(crate) fn set_candidate_margin(&mut self, margin: f64) {
        self.candidates.set_margin(margin);
    }

    /// Rebuilds the candidates if some node has moved more than a quarter of the margin since they
    /// were last built; returns whether the set changed. Call this at the start of a step.
    pub fn update_candidates(&mut self, positions: &[Vector3]) -> bool {
        let positions = self.placed(positions);
        if self.obstacles.moved || self.candidates.are_worn(&positions) {
            self.renew_candidates(&positions)
        } else {
            false
        }
    }

    /// Moves an obstacle to its pose at the end of a step; this invalidates the candidates.
    pub(crate) fn place_obstacle(&mut self, obstacle: usize, pose: Pose) {
        self.obstacles.place(&self.surface, obstacle, pose);
    }

    /// Takes the present positions of the obstacles as the start of the next step.
    pub(crate) fn commit_obstacles(&mut self) {
        self.obstacles.commit();
    }

    /// Displacement of a vertex of an obstacle in the step, m; vertices are numbered after the
    /// nodes of the rods.
    pub(crate) fn vertex_motion(&self, vertex: usize) -> Vector3 {
        let now = self.obstacles.points(&[]).vertices[vertex - self.node_count];
        now - self.obstacles.points_at_start(&[]).vertices[vertex - self.node_count]
    }

    /// Whether an index belongs to a node of a rod, not to a vertex of an obstacle.
    pub(crate) fn is_of_rod(&self, node: usize) -> bool {
        node < self.node_count
    }

    /// Builds the candidates for `positions` during the iterations of a step; returns whether the
    /// set changed.
    pub(super) fn renew_candidates(&mut self, positions: &[Vector3]) -> bool {
        let changed = self
            .candidates
            .rebuild(&self.surface, &self.obstacles, positions);
        self.obstacles.moved = false;
        if changed {
            self.carry_multipliers_over();
        }
        changed
    }

    fn carry_multipliers_over(&mut self) {
        let (old, new) = (self.candidates.earlier_pairs(), self.candidates.pairs());
        self.multipliers.carry_over(old, new);
        self.carried_tractions.carry_over(old, new);
        self.renumber_contacts();
    }

    /// Reorders the contacts of the last evaluation by the new candidates. The Jacobians are
    /// removed, since the Newton system has their old pattern.
    fn renumber_contacts(&mut self) {
        let (old, new) = (self.candidates.earlier_pairs(), self.candidates.pairs());
        let numbers: Vec<Option<usize>> = self
            .contacts
            .iter()
            .map(|contact| new.binary_search(&old[contact.candidate]).ok())
            .collect();
        let mut known = numbers.iter();
        self.tractions
            .retain(|_| known.next().is_some_and(Option::is_some));
        let mut known = numbers.iter();
        self.spun
            .retain(|_| known.next().is_some_and(Option::is_some));
        let spun = self.spun.iter_mut().flatten();
        spun.for_each(|one| one.jacobian = None);
        let mut known = numbers.iter();
        self.contacts
            .retain_mut(|contact| match known.next().copied().flatten() {
                Some(number) => {
                    contact.candidate = number;
                    true
                }
                None => false,
            });
        self.constraints.retain_mut(|constraint| {
            let Bodies::Edges(candidate) = &mut constraint.bodies else {
                return true;
            };
            let number = new.binary_search(&old[*candidate]);
            number.is_ok_and(|number| {
                *candidate = number;
                true
            })
        });
        self.jacobians.clear();
        self.linear_corrections.clear();
        super::surface_turns::renumber(&mut self.turned, old, new);
    }

    /// Rebuilds the candidates for these positions unconditionally; without positions the set is
    /// empty.
    pub(super) fn rebuild_candidates(&mut self, positions: &[Vector3]) {
        self.candidates
            .rebuild(&self.surface, &self.obstacles, positions);
    }

    /// Positions for which the candidates were built, m; empty before the first build.
    pub(super) fn candidate_positions(&self) -> &[Vector3] {
        self.candidates.positions()
    }

    /// Pairs of edges that may touch, sorted by edges.
    pub fn candidates(&self) -> &[CandidatePair] {
        self.candidates.pairs()
    }

    /// Whether the candidates contain every contact at these positions: no node has moved more
    /// than half the margin since they were built. Check this when a step has converged; if it is
    /// false, update the candidates and continue iterating if the set changed.
    pub(crate) fn candidates_are_complete(&self, positions: &[Vector3]) -> bool {
        !self.obstacles.moved && self.candidates.are_complete(&self.placed(positions))
    }

    /// Starts the Newton iterations of a step. Until [`Self::commit_multipliers`] or
    /// [`Self::abandon_multipliers`], normal forces and tractions are unknowns of the iteration
    /// that begin with their values of the last step, and the Jacobians are those of the force law
    /// linearised at them. `mobilities` are the displacements of each node under a unit force
    /// within the step by inertia alone, m/N; zero for held nodes.
    pub(crate) fn begin_iterations(&mut self, mobilities: &[f64]) {
        if self.parameters.is_complementarity() {
            // Each step begins with the data that a checkpoint contains.
            self.constraints.clear();
            return;
        }
        if let Some(turns) = &mut self.surface_turns {
            turns.begin();
        }
        self.body_turns.begin();
        match &self.curves {
            Some(curves) => self.iterate.begin(&curves.mobilities(mobilities)),
            None => self.iterate.begin(mobilities),
        }
        self.multipliers.begin(self.slots());
        self.carried_tractions.begin(self.slots());
    }

    /// Restarts the iterations of a step from the forces of the last one, without the record of sudden changes.
    pub(crate) fn begin_forces_anew(&mut self) {
        self.iterate.forget_changes();
        self.multipliers.begin(self.slots());
        self.carried_tractions.begin(self.slots());
    }

    /// Whether the contact forces at the prediction differ much from those of the last step, and
    /// predicting all of them is worth its cost for this number of rods. Call this after the first
    /// linearisation of a step.
    pub(crate) fn is_surprised(&self, rods: usize) -> bool {
        self.iterate.is_surprised(rods)
    }

    /// Whether the Jacobians are linearised at the multipliers.
    pub(crate) fn uses_multipliers(&self) -> bool {
        self.multipliers.in_use()
    }

    /// Sets whether the last correction was small compared with the radii; otherwise Jacobians
    /// omit the rotation of contacts.
    pub(crate) fn set_moved_slightly(&mut self, slightly: bool) {
        self.iterate.moved_slightly = slightly;
    }

    /// Continues with Jacobians at the present gaps.
    pub(crate) fn abandon_multipliers(&mut self) {
        self.multipliers.abandon();
    }

    /// Commits the normal forces of the last evaluation as those of an accepted step.
    pub(crate) fn commit_multipliers(&mut self) {
        let slots = self.slots();
        let reach = self.parameters.reach();
        // Contacts that opened stay listed if their multipliers carried a force.
        let pairs = self
            .contacts
            .iter()
            .filter(|c| c.distance - c.threshold < reach);
        let planes = self
            .plane_contacts
            .iter()
            .filter(|c| c.distance - c.threshold < reach);
        // A slot holds the magnitude of a force; the force of a counter-pair is negative.
        let of_pairs = pairs.clone().map(|c| (c.candidate, c.normal_force.abs()));
        let of_planes = planes
            .clone()
            .map(|c| (slots.over_plane(c.plane, c.node), c.normal_force));
        self.multipliers.commit(slots, of_pairs.chain(of_planes));
        let pairs = self.contacts.iter().zip(&self.tractions);
        let pairs = pairs.filter(|(c, _)| c.distance - c.threshold < reach);
        let planes = self.plane_contacts.iter().zip(&self.plane_tractions);
        let planes = planes.filter(|(c, _)| c.distance - c.threshold < reach);
        let of_pairs = pairs.map(|(c, traction)| (c.candidate, *traction));
        let of_planes = planes.map(|(c, traction)| (slots.over_plane(c.plane, c.node), *traction));
        self.carried_tractions
            .commit(slots, of_pairs.chain(of_planes));
    }

    /// Slots for the data that contacts keep between steps.
    pub(super) fn slots(&self) -> Slots {
        Slots {
            candidates: self.candidates.pairs().len(),
            nodes: self.node_count,
            planes: self.planes.len(),
        }
    }

    pub(super) fn multipliers(&self) -> &Multipliers {
        &self.multipliers
    }

    pub(super) fn carried_tractions(&self) -> &Tractions {
        &self.carried_tractions
    }

    pub(super) fn restore_multipliers(&mut self, forces: &[f64], tractions: Vec<Option<Vector3>>) {
        self.multipliers.restore(forces);
        self.carried_tractions.restore(tractions);
    }

    /// Contact energy of the last evaluation, J.
    pub fn energy(&self) -> f64 {
        self.energy
    }

    /// Work of the friction of the last evaluation in a step because round obstacles turn about
    /// their centrelines, J, in addition to the work of the forces on their vertices.
    pub(crate) fn turning_work(&self) -> f64 {
        self.turning_work
    }

    /// Sets the size of the stage over the time in which obstacles move from its start to its end.
    /// Stages of backward differences are shorter than steps, and nodes move in them from a virtual
    /// start, but obstacles from where they were: their velocity is that of the whole step.
    pub(crate) fn set_obstacle_pace(&mut self, pace: f64) {
        self.obstacle_pace = pace;
    }

    /// h θ of the obstacle of a pair, m rad: its rotation in the step times the distance of its
    /// surface from its centreline or core; zero for pairs without one.
    ///
    /// The rim of a tube stands for its centreline, so that a tube that spins does not drag what
    /// touches its rim.
    pub(super) fn swing_of_obstacle(&self, pair: &CandidatePair) -> Vector3 {
        let obstacle = self.surface.obstacle_of(pair.edges[1]);
        let swing = |obstacle| self.obstacles.turn(obstacle) * self.surface.core(pair);
        obstacle.map_or_else(Vector3::zeros, swing)
    }

    /// Active edge–edge contacts of the last evaluation, in the order of the candidates.
    pub fn contacts(&self) -> &[ActiveContact] {
        &self.contacts
    }

    /// Normal forces of the candidates in the last accepted step, N; may be shorter than their list.
    pub(crate) fn normal_forces(&self) -> &[f64] {
        self.multipliers.committed()
    }

    /// Largest normal force of a contact in the last accepted step, N; zero without contacts.
    pub(crate) fn largest_normal_force(&self) -> f64 {
        self.multipliers
            .committed()
            .iter()
            .copied()
            .fold(0.0, f64::max)
    }

    /// Largest slope of the friction of any contact with respect to its slip speed in the last
    /// accepted step, N s/m; zero if friction is not smoothed.
    pub(crate) fn steepest_friction(&self) -> f64 {
        let coefficient = self.largest_friction();
        self.parameters.friction_slope(coefficient) * self.largest_normal_force()
    }

    /// Force Jacobians, one per element of [`Self::contacts`]; symmetric without friction.
    pub(crate) fn jacobians(&self) -> &[EdgeJacobian] {
        &self.jacobians
    }

    /// Differences between the forces of the linearised laws at the present gaps and those of
    /// [`Self::contacts`] and [`Self::plane_contacts`], N: the right-hand side for the Jacobians.
    /// Zero without multipliers.
    pub(crate) fn linear_corrections(&self) -> ForceCorrections<'_> {
        ForceCorrections {
            edges: &self.linear_corrections,
            planes: &self.plane_linear_corrections,
        }
    }

    /// Active plane contacts of the last evaluation, sorted by plane and node.
    pub(crate) fn plane_contacts(&self) -> &[PlaneContact] {
        &self.plane_contacts
    }

    /// Force Jacobians, one per element of [`Self::plane_contacts`].
    pub(crate) fn plane_jacobians(&self) -> &[PlaneJacobian] {
        &self.plane_jacobians
    }

    /// Contacts of the last evaluation, including planes, within the distance tolerance δ (Eq.
    /// 2.17).
    pub(crate) fn contact_count(&self) -> usize {
        self.contact_count
    }
}
