//! A clamp that follows a gripper.

use crate::scenario::Pose;
use rodlab_engine::mechanics::scene::Motion;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3};

/// The motion of a part that a gripper holds from its first pose on, as one rigid body with the
/// gripper: x(t) = p(t) + R(t) R(0)⁻¹ (x(0) − p(0)), with the position p and the orientation R of
/// the gripper. At least one pose is needed.
pub fn gripper_motion(poses: &[Pose]) -> Motion {
    let start = Vector3::from(poses[0].1);
    let turned_back = orientation(poses[0].2).inverse();
    Motion {
        translation: poses
            .iter()
            .map(|&(time, position, _)| (time, Vector3::from(position) - start))
            .collect(),
        orientation: poses
            .iter()
            .map(|&(time, _, quaternion)| (time, orientation(quaternion) * turned_back))
            .collect(),
        pivot: Some(start),
        ..Motion::default()
    }
}

fn orientation([w, x, y, z]: [f64; 4]) -> UnitQuaternion {
    UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, y, z))
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::test_support::{advance_to, simulation};

    /// A beam whose end a gripper holds at an offset. The gripper moves and rotates about z, from
    /// one orientation to another.
    fn follow(from: [f64; 4], to: [f64; 4]) {
        let text = format!(
            "experiment = \"scene\"\n\
            [material]\nyoungs_modulus = 1e6\npoissons_ratio = 0.5\ndensity = 1000.0\n\
            [[rods]]\nname = \"beam\"\nradius = 0.005\nedges = 10\n\
            shape = {{ kind = \"straight\", start = [0, 0, 0], end = [1, 0, 0] }}\n\
            [[clamps]]\nrod = \"beam\"\nat = \"start\"\n\
            poses = [[0, [0, 0.1, 0], {from:?}], [1, [0.2, 0.1, 0], {to:?}]]\n\
            [time]\nstep = 0.01\nend = 1.0\n"
        );
        let mut simulation = simulation("beam", &text).unwrap();
        for (until, angle) in [
            (0.5, std::f64::consts::FRAC_PI_4),
            (1.0, std::f64::consts::FRAC_PI_2),
        ] {
            advance_to(&mut simulation, until);
            // The node is 0.1 m from the gripper, which rotates about z.
            let gripper = Vector3::new(0.2 * until, 0.1, 0.0);
            let expected = gripper + 0.1 * Vector3::new(angle.sin(), -angle.cos(), 0.0);
            let found = simulation.positions()[0];
            assert!((found - expected).norm() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn a_node_moves_with_its_gripper_as_one_rigid_body() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        follow([1.0, 0.0, 0.0, 0.0], [half, 0.0, 0.0, half]);
        // The gripper starts rotated by a quarter turn about x; the rotation about z follows.
        follow([half, half, 0.0, 0.0], [0.5; 4]);
    }
}
