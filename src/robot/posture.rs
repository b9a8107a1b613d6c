//! A posture with its measures of quality, for people and programs.

use super::chain::Chain;
use super::pose::{Pose, distance_and_angle, parts};
use serde::Serialize;

/// A posture of a chain.
#[derive(Clone, Debug, Serialize)]
pub struct Posture {
    /// Joint positions, rad or m.
    pub joints: Vec<f64>,
    /// Position of the hand in the base frame, m.
    pub position: [f64; 3],
    /// Quaternion of the orientation: w, x, y, z.
    pub quaternion: [f64; 4],
    /// Distance, m, or angle, rad, to the requested pose, whichever is larger.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual: Option<f64>,
    /// √det(J Jᵀ), zero at a singularity.
    pub manipulability: f64,
    /// Smallest singular value of the Jacobian, zero at a singularity.
    pub distance_to_singularity: f64,
    /// Smallest distance of a joint from an end of its range, rad or m; `null` if no joint has an
    /// end.
    pub distance_to_limits: Option<f64>,
}

impl Posture {
    /// The posture at joint positions, with its distance from a requested pose.
    pub fn new(chain: &Chain, joints: &[f64], asked: Option<&Pose>) -> Self {
        let (hand, jacobian) = chain.hand_and_jacobian(joints);
        let (position, quaternion) = parts(&hand);
        let to_limits = chain.distance_to_limits(joints);
        Self {
            joints: joints.to_vec(),
            position,
            quaternion,
            residual: asked.map(|asked| {
                let (distance, angle) = distance_and_angle(&hand, asked);
                distance.max(angle)
            }),
            manipulability: jacobian.manipulability(),
            distance_to_singularity: jacobian.smallest_singular_value(),
            distance_to_limits: to_limits.is_finite().then_some(to_limits),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{chain, revolute};
    use nalgebra::{Translation3, UnitQuaternion, Vector3};

    /// A joint about z from -1 to 2 rad, whose hand is half a metre away.
    fn lever() -> Chain {
        let joint = revolute(Pose::identity(), (-1.0, 2.0));
        chain(vec![joint], Pose::translation(0.5, 0.0, 0.0))
    }

    #[test]
    fn measures_of_a_lever_are_those_of_its_only_joint() {
        let chain = lever();
        for (angle, to_limits) in [(1.6, 0.4), (-0.7, 0.3)] {
            let posture = Posture::new(&chain, &[angle], None);
            assert!((posture.distance_to_limits.unwrap() - to_limits).abs() < 1e-12);
            // The hand moves by 0.5 m and turns by 1 rad per rad.
            let column = libm::hypot(0.5, 1.0);
            assert!((posture.manipulability - column).abs() < 1e-12);
            assert!((posture.distance_to_singularity - column).abs() < 1e-12);
            assert_eq!(posture.residual, None);
        }
    }

    #[test]
    fn a_posture_is_as_far_from_a_pose_as_the_larger_of_distance_and_angle() {
        let chain = lever();
        let hand = chain.hand(&[0.3]);
        for (shift, turn, expected) in [(0.2, 0.1, 0.2), (0.05, 0.3, 0.3)] {
            let asked = Translation3::new(0.0, shift, 0.0)
                * hand
                * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), turn);
            let residual = Posture::new(&chain, &[0.3], Some(&asked)).residual;
            assert!((residual.unwrap() - expected).abs() < 1e-12, "{residual:?}");
        }
    }
}
