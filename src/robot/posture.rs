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
    /// Its quaternion w, x, y, z.
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
