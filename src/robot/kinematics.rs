//! Forward kinematics and the Jacobian.
//!
//! The pose of the hand is the product of the poses of the links, each in the frame of the one
//! before. The column of the geometric Jacobian for a joint with axis a through the point p is (a
//! × (h − p), a) if the joint is revolute and (a, 0) if it is prismatic, with the position h of
//! the hand (Siciliano et al., Robotics, 2009, Eq. 3.30), all in the base frame.

use super::chain::{Chain, JointKind, MOST_JOINTS, Motion};
use super::pose::Pose;
use nalgebra::{DMatrix, Matrix6, Vector3, Vector6};

/// The columns of a Jacobian, one per joint: linear velocity, m/s, and angular velocity, rad/s, of
/// the hand per unit velocity of the joint.
#[derive(Clone, Debug)]
pub struct Jacobian {
    columns: [Vector6<f64>; MOST_JOINTS],
    joints: usize,
}

impl Jacobian {
    /// The columns, one per joint.
    pub fn columns(&self) -> &[Vector6<f64>] {
        &self.columns[..self.joints]
    }

    /// J Jᵀ.
    pub fn squared(&self) -> Matrix6<f64> {
        let mut squared = Matrix6::zeros();
        for column in self.columns() {
            squared.ger(1.0, column, column, 1.0);
        }
        squared
    }

    /// Yoshikawa's manipulability √det(J Jᵀ), zero at a singularity; with fewer than six joints √det(Jᵀ J).
    pub fn manipulability(&self) -> f64 {
        self.singular_values().iter().product()
    }

    /// Smallest singular value of the Jacobian, lengths in metres and angles in radians: zero at a singularity.
    pub fn smallest_singular_value(&self) -> f64 {
        self.singular_values()
            .into_iter()
            .fold(f64::INFINITY, f64::min)
    }

    fn singular_values(&self) -> Vec<f64> {
        let matrix = DMatrix::from_columns(
            &self
                .columns()
                .iter()
                .map(|column| nalgebra::DVector::from_column_slice(column.as_slice()))
                .collect::<Vec<_>>(),
        );
        matrix.singular_values().iter().copied().collect()
    }
}

impl Chain {
    /// Pose of the hand in the base frame.
    ///
    /// # Panics
    /// If there are fewer positions than joints. All methods that take positions panic then.
    pub fn hand(&self, positions: &[f64]) -> Pose {
        let last = self
            .segments
            .iter()
            .fold(Pose::identity(), |pose, segment| {
                pose * segment.pose(positions)
            });
        last * self.tool
    }

    /// Poses of the links in the base frame, in the order of the segments.
    pub fn links(&self, positions: &[f64]) -> Vec<Pose> {
        let mut pose = Pose::identity();
        self.segments
            .iter()
            .map(|segment| {
                pose *= segment.pose(positions);
                pose
            })
            .collect()
    }

    /// Pose of the hand and the Jacobian, both in the base frame.
    pub fn hand_and_jacobian(&self, positions: &[f64]) -> (Pose, Jacobian) {
        // First collect axis, point and factor of each moving segment; the position of the hand
        // follows at the end.
        let mut jacobian = Jacobian {
            columns: [Vector6::zeros(); MOST_JOINTS],
            joints: self.joints.len(),
        };
        let mut moments = [Vector3::zeros(); MOST_JOINTS];
        let mut pose = Pose::identity();
        for segment in &self.segments {
            let before = pose;
            pose *= segment.pose(positions);
            if let Motion::Driven {
                kind,
                axis,
                joint,
                ratio,
                ..
            } = segment.motion
            {
                let direction = before.rotation * (segment.origin.rotation * axis.scale(ratio));
                match kind {
                    // With a × (h − p) = a × h − a × p, the position h of the hand can be inserted
                    // later.
                    JointKind::Revolute => {
                        let point =
                            before * nalgebra::Point3::from(segment.origin.translation.vector);
                        moments[joint] += direction.cross(&point.coords);
                        let mut angular = jacobian.columns[joint].fixed_rows_mut::<3>(3);
                        angular += direction;
                    }
                    JointKind::Prismatic => {
                        let mut linear = jacobian.columns[joint].fixed_rows_mut::<3>(0);
                        linear += direction;
                    }
                }
            }
        }
        let hand = pose * self.tool;
        for (column, moment) in jacobian.columns.iter_mut().zip(moments) {
            let angular: Vector3<f64> = column.fixed_rows::<3>(3).into_owned();
            let mut linear = column.fixed_rows_mut::<3>(0);
            linear += angular.cross(&hand.translation.vector) - moment;
        }
        (hand, jacobian)
    }

    /// Smallest distance of a joint from an end of its range, rad or m; infinite if no joint has
    /// an end.
    pub fn distance_to_limits(&self, positions: &[f64]) -> f64 {
        self.joints
            .iter()
            .zip(positions)
            .map(|(joint, q)| (q - joint.limits.lower).min(joint.limits.upper - q))
            .fold(f64::INFINITY, f64::min)
    }
}
