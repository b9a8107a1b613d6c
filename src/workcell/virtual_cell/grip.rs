//! A gripper that holds a rod with a clamp at the hand. Several grippers may hold one rod.

use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::Motion;
use rodlab_robot::{Pose, between, distance_and_angle};

/// Largest horizontal and vertical distance of the hand from a lying rod that it can grip, m: the
/// opening of the fingers.
const REACH: f64 = 0.015;
/// Number of nodes on each side of a held node that no other gripper can take, since the first
/// gripper is in the way.
const BESIDE: usize = 2;
/// Distance of a hand from its place, m, and rotation, rad, up to which it is still.
const STILL: [f64; 2] = [1e-6, 1e-5];

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
    /// Pose near which the hand has been still.
    still: Pose,
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
            still: first,
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
        let next = self.led(hand, until);
        let motion = self.motion([(now, &self.last), (until, &next)]);
        self.last = next;
        motion
    }

    /// Whether `hand` leads the rod away from where the hand has been still, at a time of the
    /// simulation, s. If so, the hand is still at its new place from then on.
    pub fn moves(&mut self, hand: &Pose, time: f64) -> bool {
        let next = self.led(hand, time);
        let (distance, angle) = distance_and_angle(&self.still, &next);
        let moves = distance > STILL[0] || angle > STILL[1];
        if moves {
            self.still = next;
        }
        moves
    }

    /// Pose to which `hand` leads the rod at a time of the simulation, s: part of the way while
    /// the rod is handed over, and never into the table.
    fn led(&self, hand: &Pose, time: f64) -> Pose {
        let part = if time < self.handed_by {
            time / self.handed_by
        } else {
            1.0
        };
        let part = part * part * (3.0 - 2.0 * part);
        let mut next = between(&self.first, hand, part);
        let height = &mut next.translation.vector.z;
        *height = height.max(self.lowest);
        next
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

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Translation3, UnitQuaternion};

    fn at(place: [f64; 3], turn: Vector3) -> Pose {
        let rotation = UnitQuaternion::from_scaled_axis(turn);
        Pose::from_parts(Translation3::from(Vector3::from(place)), rotation)
    }

    #[test]
    fn a_grip_moves_with_its_hand_down_to_the_table() {
        let first = at([0.1, 0.2, 0.3], Vector3::new(0.4, -0.3, 0.9));
        let mut grip = Grip::new(0, 3, 1, first).stopped_at(0.02);
        for (height, lowest) in [(0.25, 0.25), (-0.1, 0.02)] {
            let hand = at([0.3, 0.1, height], Vector3::new(-0.2, 0.7, 0.1));
            let motion = grip.lead(&hand, [1.0, 1.5]);
            let (time, way) = motion.translation[1];
            assert_eq!(time, 1.5);
            assert!((way - Vector3::new(0.2, -0.1, lowest - 0.3)).norm() < 1e-15);
            // The rod turns with the second hand.
            let turned = motion.orientation[1].1 * first.rotation;
            assert!(turned.angle_to(&hand.rotation) < 1e-7);
            assert_eq!(motion.pivot, Some(first.translation.vector));
        }
    }

    #[test]
    fn a_rod_that_is_handed_over_is_half_way_in_half_of_the_time() {
        let first = at([0.0, 0.0, 0.5], Vector3::zeros());
        let hand = at([0.0, 0.4, 0.7], Vector3::x() * 0.6);
        let mut grip = Grip::new(0, 3, 1, first).handed_by(2.0);
        for (time, part) in [(0.5, 0.15625), (1.0, 0.5), (2.0, 1.0), (3.0, 1.0)] {
            let motion = grip.lead(&hand, [0.0, time]);
            let way = motion.translation[1].1;
            assert!((way - part * Vector3::new(0.0, 0.4, 0.2)).norm() < 1e-12);
            assert!((motion.orientation[1].1.angle() - part * 0.6).abs() < 1e-12);
        }
    }

    #[test]
    fn a_hand_reaches_the_nearest_free_node_between_its_fingers() {
        let nodes: Vec<Vector3> = (0..11)
            .map(|k| Vector3::new(0.01 * f64::from(k), 0.0, 0.1))
            .collect();
        let reached = |x: f64, y: f64, z: f64, grips: &[Grip]| {
            within_reach(&Vector3::new(x, y, z), &nodes, grips)
        };
        assert_eq!(reached(0.052, 0.0, 0.1, &[]), Some(5));
        // Between fingers that open by 15 mm to each side.
        assert_eq!(reached(0.05, 0.014, 0.1, &[]), Some(5));
        assert_eq!(reached(0.05, -0.016, 0.1, &[]), None);
        assert_eq!(reached(0.05, 0.0, 0.114, &[]), Some(5));
        assert_eq!(reached(0.05, 0.0, 0.084, &[]), None);
        // Another gripper holds the fourth node and takes up two to each side.
        let other = || Grip::new(1, 4, 2, Pose::identity());
        assert_eq!(reached(0.052, 0.0, 0.1, &[other()]), None);
        assert_eq!(reached(0.058, 0.0, 0.1, &[other()]), Some(7));
    }
}
