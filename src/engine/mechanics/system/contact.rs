//! Contact as a term: a [`ContactSystem`] and the data that it needs from the system.

use super::System;
use super::build::Assembly;
use super::demand::Demand;
use super::events::Event;
use super::newton_matrix::Entries;
use super::obstacles::MovingObstacle;
use super::stage::{Stage, copy_positions};
use super::term::{Configuration, Kind, Term};
use super::touching::contact_of;
use super::turned_elements::moments;
use crate::mechanics::contact::{
    ContactMemory, ContactModel, ContactSystem, FrictionAt, Geometry, MismatchedMemory,
};
use crate::mechanics::rod::topology::{add_to_node, position};
use crate::mechanics::rod::{ElasticRods, RodGeometry, STRIDE};
use crate::mechanics::scene::Scene;
use crate::mechanics::{SceneError, Vector3};

/// Rigid contact is limited to implicit Euler: the midpoint rule would extrapolate through
/// contacts, and in statics there is no free motion that contact could prevent.
const ONLY_EULER: SceneError = SceneError::Unsuitable(
    "contact by complementarity needs time steps with time.scheme = \"implicit-euler\"",
);

const ON_CENTRELINES: SceneError = SceneError::Unsuitable(
    "contact by complementarity has friction on the centrelines: friction at the surfaces needs the model `imc` or `ipc`",
);

const ONLY_POLYLINES: SceneError = SceneError::Unsuitable(
    "contact by complementarity and friction at the surfaces need contact.geometry = \"polyline\"",
);

const ONLY_CENTRELINES: SceneError = SceneError::Unsuitable(
    "friction that depends on the direction of rods needs the model `imc` or `ipc`, friction on the centrelines, and contact.geometry = \"polyline\"",
);

const ONLY_USUAL: SceneError = SceneError::Unsuitable(
    "friction that depends on the direction of rods needs rods without `friction` of their own",
);

const NO_TUBES_OR_BALLS: SceneError = SceneError::Unsuitable(
    "contact.geometry = \"smooth\" supports neither hollow tubes nor balls: they need \"polyline\"",
);

/// At the rim of a tube the energies of pieces of a rod and of the joints between them cancel, for
/// which they must have the same radius; and so do their frictions.
const ROUND_TUBES: SceneError =
    SceneError::Unsuitable("hollow tubes need rods with the same radius and friction everywhere");

const NO_BODIES: SceneError = SceneError::Unsuitable(
    "free bodies need contact.geometry = \"polyline\", friction on centrelines that does not depend on the direction, and obstacles without hollow tubes",
);

const NO_ENERGY: SceneError =
    SceneError::Unsuitable("an equilibrium with friction is not a minimum of an energy");

const NO_PATH: SceneError = SceneError::Unsuitable(
    "a path of equilibria supports neither friction nor contact by complementarity: their forces depend on the history of the motion",
);

/// Contact with its obstacles, and scratch.
pub(crate) struct Contact {
    /// The contact model, if the scene has one.
    pub model: Option<ContactSystem>,
    /// Whether its forces were evaluated at the present configuration, and its Jacobians were not.
    is_evaluated: bool,
    /// Messages on contact that is ignored where rods are rooted in other bodies, one sentence
    /// each.
    pub roots: Vec<String>,
    /// Whether there is friction of rods with each other or with obstacles, and with planes.
    rubs: [bool; 2],
    /// Whether nodes have their own elements: with friction on planes or obstacles, and with rigid
    /// contact.
    pub lists_nodes: bool,
    /// Whether there are planes.
    pub has_planes: bool,
    moving_obstacles: Vec<MovingObstacle>,
    /// Positions at the start of the step, m.
    pub step_start: Vec<Vector3>,
    /// Contact energy at the start of the step, J, if it was requested.
    pub stored_at_start: f64,
    /// Scratch: positions, m.
    pub positions: Vec<Vector3>,
    /// Scratch: displacements, m.
    pub displacements: Vec<Vector3>,
    /// Scratch: forces without contact, N.
    pub forces: Vec<Vector3>,
    /// Scratch: displacement of each node under a unit force within a step by inertia alone, m/N.
    pub mobilities: Vec<f64>,
    /// Scratch of the complementarity model: a correction of the unknowns.
    pub correction: Vec<f64>,
}

impl Contact {
    /// Whether there is friction: the forces of an equilibrium then depend on its history.
    pub(crate) fn rubs(&self) -> bool {
        self.rubs.contains(&true)
    }

    /// Whether contact forces are computed by complementarity.
    pub(crate) fn is_rigid(&self) -> bool {
        let model = self.model.as_ref();
        model.is_some_and(|contact| contact.parameters().is_complementarity())
    }

    /// Moves the obstacles to their poses at `time`, s.
    pub(crate) fn place_obstacles(&mut self, time: f64) {
        if let Some(contact) = &mut self.model {
            for moving in &self.moving_obstacles {
                contact.place_obstacle(moving.obstacle, moving.pose(time));
            }
        }
    }
}

/// Forces of the last evaluation on the nodes of rods, N.
pub(crate) fn visit_forces(contact: &ContactSystem, mut visit: impl FnMut(usize, [f64; 3])) {
    for pair in contact.contacts() {
        let (forces, _) = pair.force.as_chunks();
        for (point, force) in pair.nodes.into_iter().zip(forces) {
            if contact.is_of_rod(point) {
                contact.spread(point, *force, &mut visit);
            }
        }
    }
    for touch in contact.plane_contacts() {
        contact.spread(touch.node, touch.force, &mut visit);
    }
}

/// Passes the changes of the angles of all edges since the start of a stage to contact, if
/// friction acts at surfaces, and the rotations of free bodies.
fn set_angles(contact: &mut ContactSystem, at: &Configuration) {
    if let Some(stage) = at.stage {
        contact.set_body_turns(at.assembly.joints.turns_since(&stage.start));
        let now = at.unknowns.iter().skip(3).step_by(STRIDE);
        contact.set_angles(now.zip(&stage.angles).map(|(now, start)| now - start));
    }
}

impl Term for Contact {
    fn new(scene: &Scene, assembly: &mut Assembly) -> Result<Self, SceneError> {
        if let Some(parameters) = scene.contact.filter(|own| own.geometry == Geometry::Smooth) {
            if parameters.is_complementarity() || parameters.friction_at == FrictionAt::Surface {
                return Err(ONLY_POLYLINES);
            }
            if scene.obstacles.iter().any(|own| own.body.hollow)
                || scene.bodies.iter().any(|body| body.ball.is_some())
            {
                return Err(NO_TUBES_OR_BALLS);
            }
        }
        let own_frictions = scene.own_frictions();
        if scene
            .planes
            .iter()
            .any(|plane| plane.directed_friction.is_some())
            && let Some(parameters) = &scene.contact
        {
            if parameters.is_complementarity()
                || parameters.friction_at == FrictionAt::Surface
                || parameters.geometry == Geometry::Smooth
            {
                return Err(ONLY_CENTRELINES);
            }
            if !own_frictions.is_empty() {
                return Err(ONLY_USUAL);
            }
        }
        let varies = scene.rods.iter().any(|rod| {
            let frictions = rod.frictions();
            rod.least_radius() < rod.radius || frictions.iter().any(|own| *own != frictions[0])
        });
        if scene.contact.is_some() && varies && scene.obstacles.iter().any(|one| one.body.hollow) {
            return Err(ROUND_TUBES);
        }
        if let Some(parameters) = &scene.contact
            && !scene.free_bodies.is_empty()
            && (parameters.friction_at == FrictionAt::Surface
                || parameters.geometry == Geometry::Smooth
                || scene
                    .planes
                    .iter()
                    .any(|own| own.directed_friction.is_some())
                || scene.obstacles.iter().any(|own| own.body.hollow))
        {
            return Err(NO_BODIES);
        }
        let (model, roots) = match contact_of(scene, assembly)? {
            Some(of_scene) => (Some(of_scene.contact), of_scene.roots),
            None => (None, Vec::new()),
        };
        let friction = scene.contact.map_or(0.0, |parameters| parameters.friction);
        let rubs = |coefficient: f64| model.is_some() && coefficient > 0.0;
        let of_bodies = own_frictions.into_iter().any(rubs);
        let may_rub = |own: Option<f64>| of_bodies || rubs(own.unwrap_or(friction));
        let on_obstacles = scene.obstacles.iter().any(|one| may_rub(one.friction));
        let on_planes = scene.planes.iter().any(|one| may_rub(one.own_friction()));
        let nodes = assembly.rods.nodes;
        let mut contact = Self {
            model,
            is_evaluated: false,
            roots,
            rubs: [friction > 0.0 || of_bodies || on_obstacles, on_planes],
            lists_nodes: on_planes || on_obstacles || !scene.free_bodies.is_empty(),
            has_planes: !scene.planes.is_empty(),
            moving_obstacles: MovingObstacle::of(&scene.obstacles),
            step_start: vec![Vector3::zeros(); nodes],
            stored_at_start: 0.0,
            positions: vec![Vector3::zeros(); nodes],
            displacements: vec![Vector3::zeros(); nodes],
            forces: vec![Vector3::zeros(); nodes],
            mobilities: Vec::new(),
            correction: Vec::new(),
        };
        contact.lists_nodes |= contact.is_rigid();
        Ok(contact)
    }

    fn kind(&self) -> Kind {
        Kind::Contact
    }

    fn has_copies(&self) -> bool {
        self.model.is_none()
    }

    fn drive(&mut self, time: f64, _: &mut ElasticRods, _: &mut RodGeometry) {
        self.place_obstacles(time);
    }

    fn potential(&self, _: &[f64]) -> [f64; 2] {
        let energy = self.model.as_ref().map_or(0.0, ContactSystem::energy);
        [energy, energy.abs()]
    }

    fn has_potential(&self) -> bool {
        !self.rubs()
    }

    fn add_forces(&self, at: &Configuration, residual: &mut [f64]) {
        if let Some(contact) = &self.model {
            visit_forces(contact, |node, force| {
                for axis in 0..3 {
                    residual[STRIDE * node + axis] -= force[axis];
                }
            });
        }
        for (unknown, moment) in self.model.iter().flat_map(moments) {
            residual[unknown] -= moment;
        }
        for one in self.model.iter().flat_map(ContactSystem::all_spun) {
            for (body, moment) in one.bodies.iter().zip(&one.moments) {
                let mut frames = at.assembly.joints.free_frames();
                if let Some((_, frame, _)) = body.and_then(|body| frames.nth(body)) {
                    add_to_node(residual, frame.first_unknown / STRIDE, &-moment);
                }
            }
        }
    }

    fn update(&mut self, _: &Configuration) {
        self.is_evaluated = false;
    }

    fn evaluate(&mut self, at: &Configuration, residual: &mut [f64]) {
        if let Some(contact) = &mut self.model {
            copy_positions(at.unknowns, &mut self.positions);
            set_angles(contact, at);
            let (previous, step) = start_of(at.stage, &self.positions);
            contact.evaluate_forces(&self.positions, previous, step);
            self.is_evaluated = true;
        }
        self.add_forces(at, residual);
    }

    fn linearize(&mut self, at: &Configuration, residual: &mut [f64], entries: &mut Entries) {
        if let Some(contact) = &mut self.model {
            copy_positions(at.unknowns, &mut self.positions);
            set_angles(contact, at);
            let (previous, step) = start_of(at.stage, &self.positions);
            if self.is_evaluated {
                contact.evaluate_jacobians(&self.positions, previous, step);
                self.is_evaluated = false;
            } else {
                contact.evaluate(&self.positions, previous, step);
            }
        }
        self.add_forces(at, residual);
        if let Some(contact) = &mut self.model {
            let matrix = entries.matrix();
            matrix.turn_bodies(at.assembly, at.unknowns);
            if contact.couple_contacts() {
                matrix.expect_other_candidates();
            }
            matrix.add_contact(contact);
        }
    }

    fn add_sizes(&self, _: &Configuration, sizes: &mut [f64]) {
        if let Some(contact) = &self.model {
            visit_forces(contact, |node, force| {
                for axis in 0..3 {
                    sizes[STRIDE * node + axis] += force[axis].abs();
                }
            });
        }
        for (unknown, moment) in self.model.iter().flat_map(moments) {
            sizes[unknown] += moment.abs();
        }
    }

    fn accept(&mut self, _: &Assembly, _: &RodGeometry) {
        if let Some(contact) = &mut self.model {
            contact.commit_multipliers();
        }
    }

    /// The next step starts with the present poses of the obstacles.
    fn commit(&mut self) {
        if let Some(contact) = &mut self.model {
            contact.commit_obstacles();
        }
    }

    fn resume(&mut self, time: f64) {
        self.place_obstacles(time);
        self.commit();
    }

    fn list_events(&self, events: &mut Vec<Event>) {
        for obstacle in &self.moving_obstacles {
            obstacle.list_events(events);
        }
    }

    fn refuses(&self, demand: Demand) -> Option<SceneError> {
        let turns = (self.model.as_ref())
            .is_some_and(|contact| contact.parameters().friction_at == FrictionAt::Surface);
        match demand {
            Demand::RigidContact if turns => Some(ON_CENTRELINES),
            Demand::ImplicitMidpoint | Demand::BackwardDifferences if self.is_rigid() => {
                Some(ONLY_EULER)
            }
            Demand::Equilibrium | Demand::NearbyEquilibrium if self.is_rigid() => Some(ONLY_EULER),
            Demand::NearbyEquilibrium if self.rubs() => Some(NO_ENERGY),
            Demand::Path if self.is_rigid() || self.rubs() => Some(NO_PATH),
            _ => None,
        }
    }
}

impl System {
    /// The contact model, if the scene has one.
    pub fn contact(&self) -> Option<&ContactSystem> {
        self.terms.contact.model.as_ref()
    }

    /// Restores candidates, stiffness and forces from a checkpoint, without multipliers for
    /// Newton's method.
    ///
    /// # Errors
    /// If the checkpoint belongs to another scene.
    pub(crate) fn restore_contact(
        &mut self,
        memory: Option<&ContactMemory>,
    ) -> Result<(), MismatchedMemory> {
        if let (Some(contact), Some(memory)) = (&mut self.terms.contact.model, memory) {
            contact.restore(memory)?;
            contact.abandon_multipliers();
            self.matrix.expect_other_candidates();
        }
        Ok(())
    }

    /// Stores the positions at the start of a step, and the contact energy there if the scheme
    /// `extrapolates`. Candidates must be those of the start.
    pub(crate) fn note_start(&mut self, unknowns: &[f64], extrapolates: bool) {
        let contact = &mut self.terms.contact;
        if let Some(model) = &mut contact.model {
            copy_positions(unknowns, &mut contact.step_start);
            model.begin_at(&contact.step_start);
            contact.stored_at_start = if extrapolates {
                model.energy_at(&contact.step_start)
            } else {
                0.0
            };
        }
    }

    /// Makes contact forces unknowns of Newton's method, starting with those of the last step.
    pub(crate) fn begin_iterations(&mut self, stage: &Stage) {
        let Contact {
            model: Some(contact),
            mobilities,
            ..
        } = &mut self.terms.contact
        else {
            return;
        };
        let (masses, held) = (&self.assembly.masses, &self.assembly.held);
        let square = stage.step * stage.acceleration_step;
        mobilities.clear();
        mobilities.extend((0..self.assembly.rods.nodes).map(|node| {
            let unknown = STRIDE * node;
            if held[unknown] {
                0.0
            } else {
                square / masses[unknown]
            }
        }));
        for (vertex, mass) in self.assembly.masses_at_vertices() {
            mobilities[vertex] = square / mass;
        }
        contact.begin_iterations(mobilities);
        contact.set_angle_mobilities((0..self.assembly.rods.nodes).map(|edge| {
            let angle = STRIDE * edge + 3;
            if held[angle] || masses[angle] == 0.0 {
                0.0
            } else {
                square / masses[angle]
            }
        }));
    }

    /// Sets the size of the stage over the time in which obstacles move in it.
    pub(crate) fn set_obstacle_pace(&mut self, pace: f64) {
        if let Some(contact) = &mut self.terms.contact.model {
            contact.set_obstacle_pace(pace);
        }
    }

    /// Records whether the last correction was small compared with the radii.
    pub(crate) fn set_moved_slightly(&mut self, slightly: bool) {
        if let Some(contact) = &mut self.terms.contact.model {
            contact.set_moved_slightly(slightly);
        }
    }

    /// Continues without contact forces as unknowns.
    pub(crate) fn abandon_multipliers(&mut self) {
        if let Some(contact) = &mut self.terms.contact.model {
            contact.abandon_multipliers();
        }
    }

    /// Whether contact forces are unknowns of Newton's method.
    pub(crate) fn uses_multipliers(&self) -> bool {
        self.contact().is_some_and(ContactSystem::uses_multipliers)
    }

    /// Updates the candidates, and the matrix if they changed; call this at the start of a step.
    pub fn update_candidates(&mut self, unknowns: &[f64]) {
        let contact = &mut self.terms.contact;
        if let Some(model) = &mut contact.model {
            copy_positions(unknowns, &mut contact.positions);
            if model.update_candidates(&contact.positions) {
                self.matrix.expect_other_candidates();
            }
        }
    }

    /// Whether contact has friction and is modelled by a penalty, so that any step is possible.
    pub(crate) fn has_friction(&self) -> bool {
        self.contact().is_some_and(|contact| {
            let parameters = contact.parameters();
            parameters.friction > 0.0 && parameters.model == ContactModel::ImplicitContact
        })
    }

    /// Whether the candidates contain every contact at `unknowns`.
    pub(crate) fn candidates_are_complete(&mut self, unknowns: &[f64]) -> bool {
        let contact = &mut self.terms.contact;
        contact.model.as_ref().is_none_or(|model| {
            copy_positions(unknowns, &mut contact.positions);
            model.candidates_are_complete(&contact.positions)
        })
    }

    /// Largest part of the straight path between two sets of unknowns along which no contact is crossed; 1
    /// where the contact model allows penetration.
    pub(crate) fn largest_step(&mut self, from: &[f64], to: &[f64]) -> f64 {
        let contact = &mut self.terms.contact;
        let Some(model) = &mut contact.model else {
            return 1.0;
        };
        copy_positions(from, &mut contact.positions);
        for (node, displacement) in contact.displacements.iter_mut().enumerate() {
            *displacement = position(to, node) - contact.positions[node];
        }
        let step = model.largest_step(&contact.positions, &contact.displacements);
        if step.candidates_changed {
            self.matrix.expect_other_candidates();
        }
        step.fraction
    }

    /// Farthest that a node may move at once so that surfaces do not pass through each other
    /// undetected, m; infinite without contact, and if [`Self::largest_step`] guarantees it.
    pub(crate) fn largest_safe_move(&self) -> f64 {
        let is_soft =
            |contact: &ContactSystem| contact.parameters().model == ContactModel::ImplicitContact;
        if !self.contact().is_some_and(is_soft) {
            return f64::INFINITY;
        }
        (self.assembly.radii.iter().copied()).fold(f64::INFINITY, f64::min)
    }
}

/// Positions at the start of a stage, m, and its size, s.
fn start_of<'a>(stage: Option<&'a Stage>, now: &'a [Vector3]) -> (&'a [Vector3], f64) {
    match stage {
        Some(stage) => (&stage.positions, stage.step),
        None => (now, f64::INFINITY),
    }
}
