//! The mount of a camera by least squares over all pairs of poses.

use super::VisionError;
use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3,
};

/// Smallest rotation between two poses that is used, radians.
const LEAST_TURN: f64 = 0.05;

/// The mount by least squares over all pairs.
///
/// # Errors
/// The hand was rotated about one axis only.
pub fn mount(
    hands: &[Isometry3<f64>],
    targets: &[Isometry3<f64>],
) -> Result<Isometry3<f64>, VisionError> {
    let undetermined = |reason: String| VisionError::Undetermined {
        problem: "the mount of the camera",
        reason,
    };
    let count = hands.len();
    let mut pairs = Vec::new();
    for i in 0..count {
        for j in 0..i {
            let a = hands[j].inverse() * hands[i];
            let b = targets[j] * targets[i].inverse();
            pairs.push((a, b));
        }
    }
    // Least squares of a = R b over all pairs: R is the rotation nearest to Σ a bᵀ.
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
            "the hand was turned about at most one axis; turn it about two axes by 20° or more"
                .into(),
        ));
    }
    let svd = correlation.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Err(undetermined("the rotations are not finite".into()));
    };
    let sign = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, (u * v_t).determinant().signum()));
    let rotation = Rotation3::from_matrix_unchecked(u * sign * v_t);
    // Translation t from (R_A − 1) t = R t_B − t_A.
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
    Ok(Isometry3::from_parts(
        Translation3::new(translation[0], translation[1], translation[2]),
        UnitQuaternion::from_rotation_matrix(&rotation),
    ))
}
