//! Contacts with friction at the surfaces: rotation of the surfaces, and the corresponding
//! Jacobians.

use super::contact_system::ContactSystem;
use super::contacts::{CandidatePair, ContactMotion};
use super::edge_contact::Sliding;
use super::levers::{EdgesAtNodes, Levers};
use super::multipliers::LinearLaw;
use super::nearest_points::NearestPoints;
use super::surface::ContactSurface;
use super::surface_turns::{TurnedBodies, TurnedContact};
use super::tractions::{LinearTraction, correction};
use super::turning::{Row, Turning};
use crate::mechanics::Vector3;

/// A contact that turns edges, before it is linearised.
pub(super) struct Turned<'a> {
    pub turning: &'a Turning,
    pub sliding: &'a Sliding,
    pub motion: &'a ContactMotion,
    /// Whether the derivatives include the rotation of normal, contact points and moments.
    pub turns: bool,
    /// Sign: −1 for a counter-pair.
    pub sign: f64,
    /// Normal force (N), and friction per normal force.
    pub force: (f64, Vector3),
}

/// The edges of rods at whose surfaces friction acts.
pub(crate) struct TurningEdges<'a> {
    edges: &'a EdgesAtNodes,
    surface: &'a ContactSurface,
}

impl TurningEdges<'_> {
    /// Levers of a pair.
    pub(crate) fn of_pair(&self, pair: &CandidatePair) -> Levers {
        self.edges.of_pair(self.surface, pair)
    }

    /// Levers of every edge and ball at an obstacle.
    pub(crate) fn at_obstacles(&self) -> impl Iterator<Item = Levers> {
        let edges = 0..self.surface.rod_edges().len();
        edges.map(|edge| self.edges.at_obstacle(self.surface, edge))
    }

    /// Levers of nodes over planes, with the indices of the nodes.
    pub(crate) fn over_planes(&self) -> impl Iterator<Item = (usize, Levers)> {
        let nodes = self.surface.nodes().iter();
        nodes.map(|one| (one.node, self.edges.of_node(one.node, one.radius)))
    }
}

impl ContactSystem {
    /// Rotation of the surfaces of a pair, if friction acts at them; positions are those now and
    /// at the start of the stage.
    pub(super) fn turning_of_pair(
        &self,
        pair: &CandidatePair,
        nearest: &NearestPoints,
        positions: [&[Vector3]; 2],
        time_step: f64,
    ) -> Option<Turning> {
        let turns = self.surface_turns.as_ref()?;
        let mut levers = turns.edges.of_pair(&self.surface, pair);
        if pair.is_of_piece() {
            let radius = self.surface.edges()[pair.edges[0]].radius;
            levers.share_at(pair.side, nearest.along_piece(), radius);
        }
        Some(turns.turning(levers, positions, time_step))
    }

    /// Rotation of a node over a plane, with a sphere of a given radius, m.
    pub(super) fn turning_over_plane(
        &self,
        node: usize,
        radius: f64,
        positions: [&[Vector3]; 2],
        time_step: f64,
    ) -> Option<Turning> {
        let turns = self.surface_turns.as_ref()?;
        let levers = turns.edges.of_node(node, radius);
        Some(turns.turning(levers, positions, time_step))
    }

    /// Slip of the surfaces under a unit friction due to the rotation of edges, m/N, and
    /// displacements of the unknowns of the contact since the last linearisation.
    pub(super) fn turned_since(&self, turning: &Turning, now: &[Vector3]) -> (f64, Row) {
        let Some(turns) = &self.surface_turns else {
            return (0.0, Row::zeros());
        };
        let moved = |node: usize| self.iterate.moved_by(node, &now[node]);
        (
            turns.mobility(&turning.levers),
            turns.displacement(&turning.levers, moved),
        )
    }

    /// Adds the moments of a contact that turns edges.
    pub(super) fn push_turned(
        &mut self,
        bodies: TurnedBodies,
        turning: &Turning,
        normal: &Vector3,
        friction: &Vector3,
    ) {
        self.turned.push(TurnedContact {
            bodies,
            levers: turning.levers,
            moments: turning.moments(normal, friction),
            jacobian: None,
            correction: Row::zeros(),
        });
    }

    /// Linearises the contact that was added last, in a slot, with the linear laws of that slot.
    pub(super) fn linearize_turned(
        &mut self,
        slot: usize,
        contact: &Turned,
        pressure: &LinearLaw,
        friction: &LinearTraction,
    ) {
        let (turning, motion, sign) = (contact.turning, contact.motion, contact.sign);
        let sliding = (contact.sliding, friction.slip);
        let found = turning.jacobian(motion, &pressure.tangent, sliding, contact.turns);
        if self.multipliers.in_use() {
            self.multipliers.keep(slot, pressure, &motion.gap_gradient);
            self.carried_tractions
                .keep_turning(slot, friction, &found.traction);
        }
        let with = |force: f64, traction: &Vector3| -> [f64; 14] {
            let row = turning.force(&motion.weights, &motion.normal, sign * force, traction);
            row.into()
        };
        let (force, traction) = contact.force;
        let corrected = correction(pressure, friction, with(force, &traction), with);
        if let Some(last) = self.turned.last_mut() {
            last.jacobian = Some(found.jacobian * sign);
            last.correction = corrected.into();
        }
    }

    /// The contacts of the last evaluation that turn edges. Those of pairs come first, in the
    /// order of [`Self::contacts`].
    pub(crate) fn turned(&self) -> &[TurnedContact] {
        &self.turned
    }

    /// The edges of rods at whose surfaces friction acts; `None` where it acts on centrelines.
    pub(crate) fn turning_edges(&self) -> Option<TurningEdges<'_>> {
        let turns = self.surface_turns.as_ref()?;
        Some(TurningEdges {
            edges: &turns.edges,
            surface: &self.surface,
        })
    }

    /// Angle by which an edge has turned since the stage began, rad; zero where friction acts on the centrelines.
    pub(crate) fn turn_of(&self, edge: usize) -> f64 {
        let turns = self.surface_turns.as_ref();
        turns.map_or(0.0, |turns| turns.turn_of(edge))
    }

    /// Sets the angles by which edges have turned since the stage began, rad, if friction acts at
    /// the surfaces.
    pub(crate) fn set_angles(&mut self, angles: impl Iterator<Item = f64>) {
        if let Some(turns) = &mut self.surface_turns {
            turns.set_angles(angles);
        }
    }

    /// Sets the rotation of each edge under a unit moment within the step by inertia alone, rad/(N
    /// m); zero for an edge that is held or has no inertia.
    pub(crate) fn set_angle_mobilities(&mut self, mobilities: impl Iterator<Item = f64>) {
        if let Some(turns) = &mut self.surface_turns {
            turns.set_mobilities(mobilities);
        }
    }
}

/// The relative velocity of surfaces for that of their centrelines, m/s.
pub(super) fn with_turning(
    velocity: Vector3,
    turning: Option<&Turning>,
    normal: &Vector3,
) -> Vector3 {
    match turning {
        Some(turning) => velocity + turning.velocity(normal),
        None => velocity,
    }
}
