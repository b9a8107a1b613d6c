//! Poses of rigid bodies.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3, Vector6};

/// A rigid-body transformation: the pose of a frame in another frame, m.
pub type Pose = Isometry3<f64>;

/// The pose of a position, m, and a quaternion w, x, y, z of any length; `None` if its length is
/// zero.
pub fn pose(position: [f64; 3], quaternion: [f64; 4]) -> Option<Pose> {
    let [w, x, y, z] = quaternion;
    let rotation = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-9)?;
    position
        .iter()
        .all(|x| x.is_finite())
        .then(|| Pose::from_parts(Translation3::from(position), rotation))
}

/// The pose of a position, m, and of roll, pitch and yaw, rad: turns about the fixed axes x, y and z in this order,
/// as in URDF.
pub fn pose_of_angles(position: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Pose {
    Pose::from_parts(
        Translation3::from(position),
        UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    )
}

/// The twist that moves one pose to another in unit time: displacement, m, and rotation vector,
/// rad, both in the frame in which the poses are given. The rotation is the shorter one.
pub fn difference(from: &Pose, to: &Pose) -> Vector6<f64> {
    let shift = to.translation.vector - from.translation.vector;
    let turn = (to.rotation * from.rotation.inverse()).scaled_axis();
    Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
}

/// Distance, m, and angle, rad, between two poses.
pub fn distance_and_angle(a: &Pose, b: &Pose) -> (f64, f64) {
    let twist = difference(a, b);
    let part = |k| Vector3::new(twist[k], twist[k + 1], twist[k + 2]).norm();
    (part(0), part(3))
}

/// Interpolates between two poses at `part` in `0..=1`, along a straight line with a constant
/// angular velocity.
pub fn between(from: &Pose, to: &Pose, part: f64) -> Pose {
    let shift = from.translation.vector.lerp(&to.translation.vector, part);
    let turn = (from.rotation.inverse() * to.rotation).scaled_axis() * part;
    Pose::from_parts(
        Translation3::from(shift),
        from.rotation * UnitQuaternion::from_scaled_axis(turn),
    )
}

/// Position, m, and quaternion w, x, y, z with w ≥ 0.
pub fn parts(pose: &Pose) -> ([f64; 3], [f64; 4]) {
    let position = pose.translation.vector.into();
    let q = pose.rotation.quaternion();
    let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
    (position, [q.w, q.i, q.j, q.k].map(|part| sign * part))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn roll_pitch_and_yaw_turn_about_fixed_axes() {
        let turned = pose_of_angles([0.0; 3], [FRAC_PI_2, 0.0, FRAC_PI_2]);
        // Roll first: y goes to z, which yaw leaves unchanged.
        assert!((turned * Vector3::y() - Vector3::z()).norm() < 1e-15);
        assert!((turned * Vector3::x() - Vector3::y()).norm() < 1e-15);
    }

    #[test]
    fn interpolation_between_two_poses_ends_at_the_second() {
        let from = pose_of_angles([0.1, 0.2, 0.3], [0.4, -0.5, 3.0]);
        let to = pose_of_angles([-0.1, 0.5, 0.0], [1.0, 0.2, -3.0]);
        let (distance, angle) = distance_and_angle(&between(&from, &to, 1.0), &to);
        assert!(distance < 1e-15 && angle < 1e-14);
        let whole = distance_and_angle(&from, &to).1;
        let half = distance_and_angle(&from, &between(&from, &to, 0.5)).1;
        assert!((half - whole / 2.0).abs() < 1e-14);
    }

    #[test]
    fn a_quaternion_without_length_is_none() {
        assert!(pose([0.0; 3], [0.0; 4]).is_none());
        assert!(pose([f64::NAN, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]).is_none());
        let (_, quaternion) = parts(&pose([0.0; 3], [-2.0, 0.0, 0.0, 0.0]).unwrap());
        assert_eq!(quaternion[0], 1.0);
    }
}
