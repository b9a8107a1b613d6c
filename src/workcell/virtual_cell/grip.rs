//! A gripper that holds a rod: the clamp that its hand leads. Several may hold one rod.

use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::Motion;
use rodlab_robot::{Pose, between};

/// Largest distance of the hand from a lying rod, seen from above, and above or below it, m: the opening of the fingers.
const REACH: f64 = 0.015;
/// Number of nodes beside a held one that no other gripper can take: a gripper is there already.
const BESIDE: usize = 2;

/// Grip of a gripper on a rod. Poses are in the frame of the simulation.
pub(super) struct Grip {
    /// The arm that holds it.
    pub holder: usize,
    /// The node that is held.
    pub node: usize,
    /// The clamp that leads it.
    pub clamp: usize,
    /// The hand when it took hold: from there on the rod moves with it.
    first: Pose,
    /// The hand when it was led last.
    last: Pose,
    /// Until when what is handed over comes into the fingers, s of the simulation.
    handed_by: f64,
    /// Lowest height of the hand, m: there the table stops it.
    lowest: f64,
    /// Centre of rotation of the clamp: the hand, or its own middle.
    pivot: Option<Vector3>,
}

impl Grip {
    /// The grip of an arm, whose hand is at `first`, on a node that a clamp leads.
    pub fn new(holder: usize, node: usize, clamp: usize, first: Pose) -> Self {
        Self {
            holder,
            node,
            clamp,
            first,
            last: first,
            handed_by: 0.0,
            lowest: f64::NEG_INFINITY,
            pivot: Some(first.translation.vector),
        }
    }

    /// The same, where a rod comes into the fingers by a time of the simulation, s.
    pub fn handed_by(self, handed_by: f64) -> Self {
        Self { handed_by, ..self }
    }

    /// The same, with a table that stops the hand at a height, m.
    pub fn stopped_at(self, lowest: f64) -> Self {
        Self { lowest, ..self }
    }

    /// The same, with a clamp that turns about its own middle.
    pub fn about_its_middle(self) -> Self {
        Self {
            pivot: None,
            ..self
        }
    }

    /// The motion of the clamp from `now` until a later time of the simulation, s, at which the hand is somewhere else.
    pub fn lead(&mut self, hand: &Pose, [now, until]: [f64; 2]) -> Motion {
        let part = if until < self.handed_by {
            until / self.handed_by
        } else {
            1.0
        };
        let part = part * part * (3.0 - 2.0 * part);
        let mut next = between(&self.first, hand, part);
        let height = &mut next.translation.vector.z;
        *height = height.max(self.lowest);
        let motion = self.motion([(now, &self.last), (until, &next)]);
        self.last = next;
        motion
    }

    fn motion(&self, knots: [(f64, &Pose); 2]) -> Motion {
        let way = |pose: &Pose| pose.translation.vector - self.first.translation.vector;
        let turn = |pose: &Pose| pose.rotation * self.first.rotation.inverse();
        Motion {
            translation: knots.map(|(time, pose)| (time, way(pose))).into(),
            orientation: knots.map(|(time, pose)| (time, turn(pose))).into(),
            pivot: self.pivot,
            ..Motion::default()
        }
    }
}

/// The node that a hand reaches, the nearest seen from above, if there is a free one.
pub(super) fn within_reach(hand: &Vector3, nodes: &[Vector3], grips: &[Grip]) -> Option<usize> {
    let away = |node: &usize| (nodes[*node] - hand).xy().norm();
    let is_free = |node: &usize| grips.iter().all(|grip| grip.node.abs_diff(*node) > BESIDE);
    let is_reached = |node: &usize| away(node) <= REACH && (nodes[*node].z - hand.z).abs() <= REACH;
    let reached = (0..nodes.len()).filter(|node| is_free(node) && is_reached(node));
    reached.min_by(|one, other| away(one).total_cmp(&away(other)))
}
