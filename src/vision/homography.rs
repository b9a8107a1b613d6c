//! Homographies of a plane, and focal lengths and poses of the plane in closed form from them
//! (Zhang, IEEE TPAMI 22:1330, 2000).

use super::Point;
use super::camera::Lens;
use super::checkerboard::Checkerboard;
use nalgebra::{Isometry3, Matrix3, Rotation3, SMatrix, Translation3, UnitQuaternion};

/// Homography from the board to pixels, by the direct linear transformation with normalised coordinates.
pub(super) fn homography(board: &Checkerboard, corners: &[Point]) -> Option<Matrix3<f64>> {
    let plane: Vec<Point> = (0..board.corners())
        .map(|index| board.corner(index))
        .collect();
    let (from, scaled_plane) = normalised(&plane)?;
    let (to, scaled_corners) = normalised(corners)?;
    let mut matrix = SMatrix::<f64, 9, 9>::zeros();
    for (p, q) in scaled_plane.iter().zip(&scaled_corners) {
        let rows = [
            [p.x, p.y, 1.0, 0.0, 0.0, 0.0, -q.x * p.x, -q.x * p.y, -q.x],
            [0.0, 0.0, 0.0, p.x, p.y, 1.0, -q.y * p.x, -q.y * p.y, -q.y],
        ];
        for row in rows {
            let row = nalgebra::SVector::<f64, 9>::from(row);
            matrix += row * row.transpose();
        }
    }
    let eigen = matrix.symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    let h = eigen.eigenvectors.column(least);
    let scaled = Matrix3::new(h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8]);
    let homography = to.try_inverse()? * scaled * from;
    (homography.determinant().abs() > 1e-12).then_some(homography)
}

/// Moves and scales points to mean 0 and mean distance √2; also returns the transformation.
fn normalised(points: &[Point]) -> Option<(Matrix3<f64>, Vec<Point>)> {
    let middle = points.iter().sum::<Point>() / points.len() as f64;
    let spread: f64 = points.iter().map(|point| (point - middle).norm()).sum();
    let spread = spread / points.len() as f64;
    if !(spread > 0.0) {
        return None;
    }
    let scale = std::f64::consts::SQRT_2 / spread;
    let matrix = Matrix3::new_scaling(scale).append_translation(&(middle * -scale));
    let moved = points
        .iter()
        .map(|point| (point - middle) * scale)
        .collect();
    Some((matrix, moved))
}

/// Focal lengths for a principal point in the middle of the picture. Two columns of a homography
/// are images of orthogonal directions of equal length; these conditions are linear in 1/fx² and
/// 1/fy².
pub(super) fn first_lens(homographies: &[Matrix3<f64>], width: u32, height: u32) -> Option<Lens> {
    let centre = [
        0.5 * (f64::from(width) - 1.0),
        0.5 * (f64::from(height) - 1.0),
    ];
    let mut normal = nalgebra::Matrix2::zeros();
    let mut right = nalgebra::Vector2::zeros();
    for homography in homographies {
        let shift = Matrix3::new_translation(&-Point::from(centre));
        let h = shift * homography;
        let h = h / h.norm();
        let (a, b) = (h.column(0), h.column(1));
        let equations = [
            ([a[0] * b[0], a[1] * b[1]], -a[2] * b[2]),
            (
                [a[0] * a[0] - b[0] * b[0], a[1] * a[1] - b[1] * b[1]],
                b[2] * b[2] - a[2] * a[2],
            ),
        ];
        for (row, value) in equations {
            let row = nalgebra::Vector2::from(row);
            normal += row * row.transpose();
            right += row * value;
        }
    }
    let [x, y]: [f64; 2] = (normal.try_inverse()? * right).into();
    let plausible = |square: f64| {
        let focal = (1.0 / square).sqrt();
        let size = f64::from(width.max(height));
        (focal > 0.1 * size && focal < 100.0 * size).then_some(focal)
    };
    Some(Lens {
        focal: [plausible(x)?, plausible(y)?],
        centre,
        distortion: [0.0; 5],
    })
}

/// Pose of the plane of a homography, for a lens without distortion.
pub(super) fn first_pose(homography: &Matrix3<f64>, lens: &Lens) -> Option<Isometry3<f64>> {
    let camera =
        Matrix3::new_nonuniform_scaling(&lens.focal.into()).append_translation(&lens.centre.into());
    let columns = camera.try_inverse()? * homography;
    let scale = 2.0 / (columns.column(0).norm() + columns.column(1).norm());
    // The plane is in front of the camera.
    let scale = if columns[(2, 2)] < 0.0 { -scale } else { scale };
    let (x, y) = (columns.column(0) * scale, columns.column(1) * scale);
    let rotation = Rotation3::from_matrix(&Matrix3::from_columns(&[x, y, x.cross(&y)]));
    let translation = columns.column(2) * scale;
    let finite = translation.iter().all(|value| value.is_finite());
    finite.then(|| {
        Isometry3::from_parts(
            Translation3::from(translation),
            UnitQuaternion::from_rotation_matrix(&rotation),
        )
    })
}
