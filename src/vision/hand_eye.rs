//! Where a camera is mounted: hand–eye calibration from pairs of poses.
//!
//! A camera on a hand sees a target that does not move: Gᵢ X Tᵢ is the same for all i, with the hand Gᵢ in the base,
//! the target Tᵢ in the camera and the camera X in the hand. Two poses give A X = X B with A = Gⱼ⁻¹ Gᵢ and
//! B = Tⱼ Tᵢ⁻¹; their rotation vectors obey a = R b, from which R follows by least squares, then the translation
//! (Park and Martin, IEEE Trans. Robotics and Automation 10:717, 1994).

use super::VisionError;
use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3,
};

/// A camera's mount and how well it explains the pairs of poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandEye {
    /// The camera in the hand (or in the base, for a camera that does not move and a target on the hand).
    pub camera: Isometry3<f64>,
    /// The target in the base (or in the hand).
    pub target: Isometry3<f64>,
    /// Root mean square distance of the target's positions from their mean, metres.
    pub position_rms: f64,
    /// Root mean square angle of the target's orientations from their mean, radians.
    pub rotation_rms: f64,
}

/// Smallest turn between two poses that tells something, radians.
const LEAST_TURN: f64 = 0.05;

/// Finds the camera in the hand from poses of the hand in the base and of a fixed target in the camera.
///
/// For a camera that does not move and a target on the hand, pass the inverse poses of the hand.
///
/// # Errors
/// There are fewer than three pairs, or the hand turned about one axis only.
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
            "{count} poses of the hand and {} of the target are no pairs",
            targets.len()
        )));
    }
    if count < 3 {
        return Err(undetermined(format!(
            "{count} pairs of poses, three are the least; turn the hand about two axes"
        )));
    }
    let mut pairs = Vec::new();
    for i in 0..count {
        for j in 0..i {
            let a = hands[j].inverse() * hands[i];
            let b = targets[j] * targets[i].inverse();
            pairs.push((a, b));
        }
    }
    // a = R b over all pairs: the rotation nearest to Σ a bᵀ.
    let mut correlation = Matrix3::zeros();
    let mut axes = Matrix3::zeros();
    for (a, b) in &pairs {
        let (a, b) = (a.rotation.scaled_axis(), b.rotation.scaled_axis());
        if a.norm() > LEAST_TURN {
            correlation += a * b.transpose();
            let axis = a.normalize();
            axes += axis * axis.transpose();
        }
    }
    let mut spread: Vec<f64> = axes.symmetric_eigenvalues().iter().copied().collect();
    spread.sort_by(f64::total_cmp);
    if !(spread[1] > 0.01 * spread[2].max(1e-12)) {
        return Err(undetermined(
            "the hand turned about one axis only, or not at all; turn it about two axes by 20° or more"
                .into(),
        ));
    }
    let svd = correlation.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Err(undetermined("the rotations are not finite".into()));
    };
    let sign = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, (u * v_t).determinant().signum()));
    let rotation = Rotation3::from_matrix_unchecked(u * sign * v_t);
    // (R_A − 1) t = R t_B − t_A.
    let mut matrix = DMatrix::zeros(3 * pairs.len(), 3);
    let mut right = DVector::zeros(3 * pairs.len());
    for (index, (a, b)) in pairs.iter().enumerate() {
        let turn = a.rotation.to_rotation_matrix().into_inner() - Matrix3::identity();
        matrix.view_mut((3 * index, 0), (3, 3)).copy_from(&turn);
        let value = rotation * b.translation.vector - a.translation.vector;
        right.rows_mut(3 * index, 3).copy_from(&value);
    }
    let translation = matrix
        .svd(true, true)
        .solve(&right, 1e-9)
        .map_err(|reason| undetermined(reason.into()))?;
    let camera = Isometry3::from_parts(
        Translation3::new(translation[0], translation[1], translation[2]),
        UnitQuaternion::from_rotation_matrix(&rotation),
    );
    Ok(with_residuals(camera, hands, targets))
}

fn with_residuals(
    camera: Isometry3<f64>,
    hands: &[Isometry3<f64>],
    targets: &[Isometry3<f64>],
) -> HandEye {
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
    HandEye {
        camera,
        target: Isometry3::from_parts(Translation3::from(position), rotation),
        position_rms: mean_square(distances.sum()),
        rotation_rms: mean_square(angles.sum()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(turn: [f64; 3], shift: [f64; 3]) -> Isometry3<f64> {
        Isometry3::new(Vector3::from(shift), Vector3::from(turn))
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
        let mount = pose([0.1, -0.2, 1.5], [0.03, -0.01, 0.08]);
        let target = pose([0.0, 0.1, 0.4], [0.5, 0.1, 0.02]);
        let hands = hands();
        let targets: Vec<Isometry3<f64>> = hands
            .iter()
            .map(|hand| (hand * mount).inverse() * target)
            .collect();
        let found = hand_eye(&hands, &targets).expect("a mount");
        assert!((found.camera.translation.vector - mount.translation.vector).norm() < 1e-10);
        assert!(found.camera.rotation.angle_to(&mount.rotation) < 1e-7);
        assert!((found.target.translation.vector - target.translation.vector).norm() < 1e-9);
        assert!(found.position_rms < 1e-9 && found.rotation_rms < 1e-7);
    }

    #[test]
    fn residuals_say_how_far_off_the_pairs_are() {
        let mount = pose([0.1, -0.2, 1.5], [0.03, -0.01, 0.08]);
        let target = pose([0.0, 0.1, 0.4], [0.5, 0.1, 0.02]);
        let hands = hands();
        let mut targets: Vec<Isometry3<f64>> = hands
            .iter()
            .map(|hand| (hand * mount).inverse() * target)
            .collect();
        for (index, target) in targets.iter_mut().enumerate() {
            target.translation.vector.x += 1e-3 * f64::from([1, -1][index % 2]);
        }
        let found = hand_eye(&hands, &targets).expect("a mount");
        let off = (found.camera.translation.vector - mount.translation.vector).norm();
        assert!(off < 2e-3, "{off}");
        assert!(found.position_rms > 1e-4 && found.position_rms < 2e-3);
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
