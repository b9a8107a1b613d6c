//! A gripper that holds a rod with a clamp at the hand. Several grippers may hold one rod.

use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::Motion;
use rodlab_robot::{Pose, between};

/// Largest horizontal and vertical distance of the hand from a lying rod that it can grip, m: the
/// opening of the fingers.
const REACH: f64 = 0.015;
/// Number of nodes on each side of a held node that no other gripper can take, since the first
/// gripper is in the way.
const BESIDE: usize = 2;

/// Grip of a gripper on a rod. Poses are in the frame of the simulation.
pub(super) struct Grip {
    /// The arm that holds the rod.
    pub holder: usize,
    /// The held node.
    pub node: usize,
    /// The clamp that moves the node.
    pub clamp: usize,
    /// Pose of the hand when it took hold; from then on the rod moves with the hand.
    first: Pose,
    /// Pose of the hand at the last call.
    last: Pose,
    /// Time of the simulation, s, at which the hand-over of a rod into the fingers ends.
    handed_by: f64,
    /// Lowest height of the hand, m, at which the table stops it.
    lowest: f64,
    /// Centre of rotation of the clamp: the hand, or (`None`) the middle of the clamp.
    pivot: Option<Vector3>,
}

impl Grip {
    /// Creates the grip of an arm on a node that a clamp moves; `first` is the pose of the hand.
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

    /// The grip with a hand-over that ends at a time of the simulation, s.
    pub fn handed_by(self, handed_by: f64) -> Self {
        Self { handed_by, ..self }
    }

    /// The grip with a table that stops the hand at a height, m.
    pub fn stopped_at(self, lowest: f64) -> Self {
        Self { lowest, ..self }
    }

    /// The grip with a clamp that turns about its own middle.
    pub fn about_its_middle(self) -> Self {
        Self {
            pivot: None,
            ..self
        }
    }

    /// Motion of the clamp between two times of the simulation, s, from the last pose of the hand
    /// to `hand`.
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

/// The free node within reach of a hand that is nearest to it in plan view, if there is one.
pub(super) fn within_reach(hand: &Vector3, nodes: &[Vector3], grips: &[Grip]) -> Option<usize> {
    let away = |node: &usize| (nodes[*node] - hand).xy().norm();
    let is_free = |node: &usize| grips.iter().all(|grip| grip.node.abs_diff(*node) > BESIDE);
    let is_reached = |node: &usize| away(node) <= REACH && (nodes[*node].z - hand.z).abs() <= REACH;
    let reached = (0..nodes.len()).filter(|node| is_free(node) && is_reached(node));
    reached.min_by(|one, other| away(one).total_cmp(&away(other)))
}
