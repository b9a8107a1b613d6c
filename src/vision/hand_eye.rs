//! Hand–eye calibration: the mount of a camera from pairs of poses.
//!
//! A camera on a hand takes pictures of a fixed target. The pose of the target in the base, Gᵢ X
//! Tᵢ, is then the same for all i, with the pose Gᵢ of the hand in the base, the pose X of the
//! camera in the hand and the pose Tᵢ of the target in the camera. Two poses give A X = X B with A
//! = Gⱼ⁻¹ Gᵢ and B = Tⱼ Tᵢ⁻¹; their rotation vectors satisfy a = R b, which gives the rotation R
//! of X by least squares, and then its translation (Park and Martin, IEEE Trans. Robotics and
//! Automation 10:717, 1994).

use super::VisionError;
use super::hand_eye_consensus::{agreeing, deviations};
use super::hand_eye_mount::mount;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use serde::Serialize;

/// Mount of a camera, and its errors over the pairs of poses.
#[derive(Clone, Debug, PartialEq)]
pub struct HandEye {
    /// Pose of the camera in the hand (or in the base, for a fixed camera and a target on the
    /// hand).
    pub camera: Isometry3<f64>,
    /// Pose of the target in the base (or in the hand).
    pub target: Isometry3<f64>,
    /// Root mean square distance of the target's positions from their mean, metres.
    pub position_rms: f64,
    /// Root mean square angle of the target's orientations from their mean, radians.
    pub rotation_rms: f64,
    /// Standard deviations of the camera's position, metres, and of its rotation, radians, from a
    /// jackknife over the pairs; `None` for fewer than five pairs.
    pub deviations: Option<([f64; 3], f64)>,
    /// Pairs that do not agree with the others. They are excluded from all numbers above.
    pub rejected: Vec<RejectedPair>,
}

/// A pair of poses that does not agree with the others.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RejectedPair {
    /// Number of the pair, from 1.
    pub pair: usize,
    /// Deviation of the target position from that of the other pairs, metres.
    pub position_error_m: f64,
    /// Deviation of the target orientation from that of the other pairs, degrees.
    pub rotation_error_degrees: f64,
}

/// Finds the pose of the camera in the hand from poses of the hand in the base and poses of a
/// fixed target in the camera.
///
/// For a fixed camera and a target on the hand, pass the inverse poses of the hand.
///
/// # Errors
/// There are fewer than three pairs, the hand turned about one axis only, or most pairs disagree.
pub fn hand_eye(
    hands: &[Isometry3<f64>],
    targets: &[Isometry3<f64>],
) -> Result<HandEye, VisionError> {
    let undetermined = |reason: String| VisionError::Undetermined {
        problem: "the mount of the camera",
        reason,
    };
    let count = hands.len();
    if count != targets.len() {
        return Err(undetermined(format!(
            "{count} poses of the hand cannot be paired with {} of the target",
            targets.len()
        )));
    }
    if count < 3 {
        return Err(undetermined(format!(
            "{count} pairs of poses; at least three are needed; turn the hand about two axes"
        )));
    }
    let used = agreeing(hands, targets)?;
    let chosen = |poses: &[Isometry3<f64>]| -> Vec<Isometry3<f64>> {
        used.iter().map(|index| poses[*index]).collect()
    };
    let (kept_hands, kept_targets) = (chosen(hands), chosen(targets));
    let camera = mount(&kept_hands, &kept_targets)?;
    let spread = Spread::of(&camera, &kept_hands, &kept_targets);
    let left_out = (0..count).filter(|index| !used.contains(index));
    let rejected = left_out.map(|index| {
        let seen = hands[index] * camera * targets[index];
        let away = seen.translation.vector - spread.target.translation.vector;
        let turn = spread.target.rotation.angle_to(&seen.rotation);
        RejectedPair {
            pair: index + 1,
            position_error_m: away.norm(),
            rotation_error_degrees: turn.to_degrees(),
        }
    });
    Ok(HandEye {
        camera,
        target: spread.target,
        position_rms: spread.position_rms,
        rotation_rms: spread.rotation_rms,
        deviations: deviations(&kept_hands, &kept_targets),
        rejected: rejected.collect(),
    })
}

/// Pose of the target for a given mount, and the deviations of the pairs from it.
struct Spread {
    target: Isometry3<f64>,
    position_rms: f64,
    rotation_rms: f64,
}

impl Spread {
    fn of(camera: &Isometry3<f64>, hands: &[Isometry3<f64>], targets: &[Isometry3<f64>]) -> Self {
        let seen: Vec<Isometry3<f64>> = hands
            .iter()
            .zip(targets)
            .map(|(hand, target)| hand * camera * target)
            .collect();
        let count = seen.len() as f64;
        let position = seen
            .iter()
            .map(|pose| pose.translation.vector)
            .sum::<Vector3<f64>>()
            / count;
        // The mean rotation, near the first one.
        let first = seen[0].rotation;
        let turns = seen
            .iter()
            .map(|pose| (first.inverse() * pose.rotation).scaled_axis());
        let rotation = first * UnitQuaternion::new(turns.sum::<Vector3<f64>>() / count);
        let mean_square = |square: f64| (square / count).sqrt();
        let distances = seen
            .iter()
            .map(|pose| (pose.translation.vector - position).norm_squared());
        let angles = seen
            .iter()
            .map(|pose| rotation.angle_to(&pose.rotation).powi(2));
        Self {
            target: Isometry3::from_parts(Translation3::from(position), rotation),
            position_rms: mean_square(distances.sum()),
            rotation_rms: mean_square(angles.sum()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(turn: [f64; 3], shift: [f64; 3]) -> Isometry3<f64> {
        Isometry3::new(Vector3::from(shift), Vector3::from(turn))
    }

    /// Pose of the camera in the hand, and of the target in the base.
    fn mount_and_target() -> [Isometry3<f64>; 2] {
        [
            pose([0.1, -0.2, 1.5], [0.03, -0.01, 0.08]),
            pose([0.0, 0.1, 0.4], [0.5, 0.1, 0.02]),
        ]
    }

    /// The target as the camera sees it from a hand.
    fn seen(hand: &Isometry3<f64>) -> Isometry3<f64> {
        let [mount, target] = mount_and_target();
        (hand * mount).inverse() * target
    }

    fn hands() -> Vec<Isometry3<f64>> {
        (0..8)
            .map(|index| {
                let t = f64::from(index);
                pose(
                    [0.4 * (1.3 * t).sin(), 0.4 * (2.1 * t).cos(), 0.5 * t.sin()],
                    [0.1 * t.cos(), 0.1 * (0.7 * t).sin(), 0.3 + 0.02 * t],
                )
            })
            .collect()
    }

    #[test]
    fn exact_pairs_give_the_exact_mount() {
        let [mount, target] = mount_and_target();
        let hands = hands();
        let targets: Vec<Isometry3<f64>> = hands.iter().map(seen).collect();
        let found = hand_eye(&hands, &targets).expect("a mount");
        assert!((found.camera.translation.vector - mount.translation.vector).norm() < 1e-10);
        assert!(found.camera.rotation.angle_to(&mount.rotation) < 1e-7);
        assert!((found.target.translation.vector - target.translation.vector).norm() < 1e-9);
        assert!(found.position_rms < 1e-9 && found.rotation_rms < 1e-7);
    }

    /// Every pose of the hand twice, with errors of the target that cancel: the mount is exact, and what is left is the errors.
    #[test]
    fn residuals_are_the_errors_of_the_pairs() {
        let [mount, target] = mount_and_target();
        let (shift, turn) = (1e-3, 2e-3);
        let once = hands();
        let twice: Vec<Isometry3<f64>> = once.iter().chain(&once).copied().collect();
        let targets = |shift: f64, turn: f64| -> Vec<Isometry3<f64>> {
            let pairs = twice.iter().enumerate().map(|(index, hand)| {
                let sign = if index < once.len() { 1.0 } else { -1.0 };
                let moved = Vector3::new(0.6, 0.0, -0.8) * (sign * shift);
                let turned = UnitQuaternion::new(Vector3::new(0.0, 0.6, 0.8) * (sign * turn));
                let off = Isometry3::from_parts(
                    Translation3::from(target.translation.vector + moved),
                    turned * target.rotation,
                );
                (hand * mount).inverse() * off
            });
            pairs.collect()
        };
        let moved = hand_eye(&twice, &targets(shift, 0.0)).expect("a mount");
        assert!((moved.camera.translation.vector - mount.translation.vector).norm() < 1e-9);
        assert!((moved.position_rms / shift - 1.0).abs() < 1e-6);
        assert!(moved.rotation_rms < 1e-7);
        let turned = hand_eye(&twice, &targets(0.0, turn)).expect("a mount");
        assert!((turned.rotation_rms / turn - 1.0).abs() < 1e-2);
        // A pair that is far off is rejected with its own errors.
        let mut bad = targets(0.0, 0.0);
        bad[4] = (twice[4] * mount).inverse()
            * Isometry3::from_parts(
                Translation3::from(target.translation.vector + Vector3::y() * 0.03),
                UnitQuaternion::new(Vector3::x() * 0.2) * target.rotation,
            );
        let found = hand_eye(&twice, &bad).expect("a mount");
        let [rejected] = found.rejected[..] else {
            panic!("{found:?}");
        };
        assert_eq!(rejected.pair, 5);
        assert!((rejected.position_error_m - 0.03).abs() < 1e-9);
        assert!((rejected.rotation_error_degrees - 0.2_f64.to_degrees()).abs() < 1e-6);
    }

    #[test]
    fn residuals_measure_the_errors_of_the_pairs() {
        let [mount, _] = mount_and_target();
        let hands = hands();
        let mut targets: Vec<Isometry3<f64>> = hands.iter().map(seen).collect();
        for (index, target) in targets.iter_mut().enumerate() {
            target.translation.vector.x += 1e-3 * f64::from([1, -1][index % 2]);
        }
        let found = hand_eye(&hands, &targets).expect("a mount");
        let off = (found.camera.translation.vector - mount.translation.vector).norm();
        assert!(off < 2e-3, "{off}");
        assert!(found.position_rms > 1e-4 && found.position_rms < 2e-3);
    }

    /// Fifteen pairs with a reproducible noise of about 0.3 mm and 0.05°.
    fn noisy() -> (Vec<Isometry3<f64>>, Vec<Isometry3<f64>>) {
        let hands: Vec<Isometry3<f64>> = (0..15)
            .map(|index| {
                let t = 1.7 * f64::from(index);
                pose(
                    [0.5 * (1.3 * t).sin(), 0.5 * (2.1 * t).cos(), 0.6 * t.sin()],
                    [
                        0.1 * t.cos(),
                        0.1 * (0.7 * t).sin(),
                        0.3 + 0.02 * (0.9 * t).cos(),
                    ],
                )
            })
            .collect();
        let targets = hands.iter().enumerate().map(|(index, hand)| {
            let t = 12.9 * index as f64;
            let noise = |k: f64| (k * t + k).sin();
            let shake = pose(
                [noise(3.1), noise(5.3), noise(7.7)].map(|part| 1e-3 * part),
                [noise(2.3), noise(4.9), noise(6.1)].map(|part| 3e-4 * part),
            );
            seen(hand) * shake
        });
        let targets = targets.collect();
        (hands, targets)
    }

    #[test]
    fn bad_pairs_are_rejected_and_named_and_error_bars_hold() {
        let [mount, _] = mount_and_target();
        let (hands, targets) = noisy();
        let off =
            |found: &HandEye| (found.camera.translation.vector - mount.translation.vector).norm();
        let clean = hand_eye(&hands, &targets).expect("a mount");
        assert_eq!(clean.rejected, []);
        let (deviations, turn) = clean.deviations.expect("error bars");
        let deviation = deviations.iter().map(|one| one * one).sum::<f64>().sqrt();
        assert!(
            off(&clean) < 3.0 * deviation && deviation < 1e-3,
            "{clean:?}"
        );
        assert!(
            clean.camera.rotation.angle_to(&mount.rotation) < 3.0 * turn,
            "{clean:?}"
        );
        // One pose of the hand belongs to another picture, or one target was moved by 4 cm.
        for spoil in [0, 1, 2] {
            let (mut hands, mut targets) = (hands.clone(), targets.clone());
            match spoil {
                0 => targets[6].translation.vector.x += 0.04,
                1 => hands[6] = hands[7],
                _ => {
                    targets[6].translation.vector.x += 0.04;
                    hands[2] = hands[11];
                }
            }
            let found = hand_eye(&hands, &targets).expect("a mount");
            let expected: &[usize] = if spoil == 2 { &[3, 7] } else { &[7] };
            let named: Vec<usize> = found.rejected.iter().map(|one| one.pair).collect();
            assert_eq!(named, expected, "{found:?}");
            assert!(off(&found) < 1e-3, "{spoil}: {}", off(&found));
        }
    }

    #[test]
    fn pairs_that_do_not_belong_together_are_refused() {
        let (hands, mut targets) = noisy();
        targets.rotate_left(1);
        for (index, target) in targets.iter_mut().enumerate() {
            target.translation.vector.y += 0.05 * (index as f64 * 2.3).sin();
        }
        let error = hand_eye(&hands, &targets).expect_err("no mount");
        assert!(error.to_string().contains("agree"), "{error}");
    }

    #[test]
    fn turns_about_one_axis_are_refused() {
        let hands: Vec<Isometry3<f64>> = (0..5)
            .map(|index| pose([0.0, 0.0, 0.3 * f64::from(index)], [0.1, 0.0, 0.0]))
            .collect();
        let targets: Vec<Isometry3<f64>> = hands.iter().map(Isometry3::inverse).collect();
        let error = hand_eye(&hands, &targets)
            .expect_err("one axis")
            .to_string();
        assert!(error.contains("one axis"), "{error}");
        assert!(hand_eye(&hands[..2], &targets[..2]).is_err());
        assert!(hand_eye(&hands, &targets[..2]).is_err());
    }
}
