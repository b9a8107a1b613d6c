//! A sheet for folding, in metres.

use super::equilibrium::Fold;
use super::path::Sheet;
use super::pose::FoldPose;
use crate::plan::deployment::GripperPose;
use rodlab_engine::mechanics::Vector3;

/// Parameters of a sheet for folding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoldedSheet {
    /// L_gb = (E h²/(24 ρ g))^(1/3), m.
    pub gravito_bending_length: f64,
    /// Length in the direction of the fold, m.
    pub length: f64,
    /// Least suspended length of the bent sheet, in L_gb (thesis sec. 4.6.5).
    pub least_suspended: f64,
}

impl FoldedSheet {
    /// L_gb of a sheet with Young's modulus E (Pa), thickness h (m) and density ρ (kg/m³) in a
    /// gravity g (m/s²), m (thesis Eq. 4.4).
    pub fn gravito_bending_length_of(
        modulus: f64,
        thickness: f64,
        density: f64,
        gravity: f64,
    ) -> f64 {
        libm::cbrt(modulus * thickness * thickness / (24.0 * density * gravity))
    }

    /// The same in L_gb.
    pub fn dimensionless(&self) -> Sheet {
        Sheet {
            length: self.length / self.gravito_bending_length,
            least_suspended: self.least_suspended,
        }
    }

    /// Poses of the gripper for folds, in the plane y = 0. The edge starts at the origin; the
    /// sheet lies along x on the table z = 0. The gripper's x axis is the tangent of the sheet,
    /// towards the gripper; its z axis is the normal that points up on the flat sheet. `s` is the
    /// arc length of the gripper path, m.
    pub fn poses(&self, folds: &[Fold]) -> Vec<GripperPose> {
        let mut way = 0.0;
        let mut before = Vector3::zeros();
        let poses = folds.iter().map(|fold| {
            let [x, z] = fold
                .gripper
                .map(|value| value * self.gravito_bending_length);
            let position = Vector3::new(x, 0.0, z);
            way += (position - before).norm();
            before = position;
            GripperPose::new(way, position, FoldPose::of(fold).orientation())
        });
        poses.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{FoldAtlas, Forces};
    use super::*;

    #[test]
    fn the_gravito_bending_length_of_paper() {
        // 2.5 GPa, 0.1 mm, 800 kg/m³: 5.1 cm.
        let length = FoldedSheet::gravito_bending_length_of(2.5e9, 1e-4, 800.0, 9.81);
        assert!((length.powi(3) - 2.5e9 * 1e-8 / (24.0 * 800.0 * 9.81)).abs() < 1e-15);
    }

    #[test]
    fn the_gripper_holds_the_sheet_along_its_tangent() {
        let sheet = FoldedSheet {
            gravito_bending_length: 0.05,
            length: 0.3,
            least_suspended: 0.958,
        };
        let fold = FoldAtlas::new().solve([3.4, 1.7]).unwrap();
        let pose = &sheet.poses(&[fold])[0];
        assert!((pose.position - Vector3::new(0.17, 0.0, 0.085)).norm() < 1e-9);
        let shape = fold.shape(10_000);
        let [last, end] = [shape[9_999], shape[10_000]];
        let tangent = Vector3::new(end[0] - last[0], 0.0, end[1] - last[1]).normalize();
        let axis = pose.rotation * Vector3::x();
        assert!((axis - tangent).norm() < 1e-6, "{axis} {tangent}");
        let flat = Fold {
            angle: 0.0,
            forces: Forces::default(),
            ..fold
        };
        let normal = sheet.poses(&[flat])[0].rotation * Vector3::z();
        assert!((normal - Vector3::z()).norm() < 1e-12);
    }
}
