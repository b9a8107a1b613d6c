//! Files of helical rods with markers.

use super::prelude::*;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use rodlab_lab::scenario::dimension::{Curvature, Length};
use rodlab_lab::scenario::{Issue, Issues, KeyPath, Quantity, TypedFile};
use rodlab_vision::helix_points;
use serde::Deserialize;

/// Largest number of markers of a rod.
const MOST_MARKERS: usize = 1000;

/// A helix in the world, with its markers.
#[derive(Debug)]
pub struct HelixFile {
    curvature: f64,
    torsion: f64,
    pose: Isometry3<f64>,
    /// Arc lengths of the markers, m.
    pub markers: Vec<f64>,
}

#[derive(Debug, Deserialize)]
struct Typed {
    helix: TypedHelix,
}

#[derive(Debug, Deserialize)]
struct TypedHelix {
    curvature: Quantity<Curvature>,
    torsion: Quantity<Curvature>,
    markers: Vec<Quantity<Length>>,
    position: [Quantity<Length>; 3],
    quaternion: [f64; 4],
}

impl HelixFile {
    /// Reads the table `[helix]` of a file.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let file: TypedFile<Typed> = TypedFile::read(path)?;
        let typed = &file.typed.helix;
        let root = KeyPath::from("helix");
        let mut issues = Issues::default();
        let mut number = |key: &str, value: Result<f64, String>| match value {
            Ok(value) if value.is_finite() => value,
            Ok(value) => {
                issues.push(Issue::new(root.key(key), format!("{value} is not finite")));
                0.0
            }
            Err(message) => {
                issues.push(Issue::new(root.key(key), message));
                0.0
            }
        };
        let curvature = number("curvature", typed.curvature.si());
        let torsion = number("torsion", typed.torsion.si());
        let markers = typed.markers.iter().map(|at| number("markers", at.si()));
        let markers: Vec<f64> = markers.collect();
        let position = typed
            .position
            .each_ref()
            .map(|x| number("position", x.si()));
        if markers.is_empty() || markers.len() > MOST_MARKERS {
            issues.push(Issue::new(
                root.key("markers"),
                format!("expected arc lengths of 1 to {MOST_MARKERS} markers"),
            ));
        }
        let [w, x, y, z] = typed.quaternion;
        let quaternion = Quaternion::new(w, x, y, z);
        if !((quaternion.norm() - 1.0).abs() < 1e-3) {
            let norm = quaternion.norm();
            issues.push(Issue::new(
                root.key("quaternion"),
                format!("[w, x, y, z] has norm {norm:.4}, expected 1"),
            ));
        }
        let found = Self {
            curvature,
            torsion,
            pose: Isometry3::from_parts(
                Translation3::from(Vector3::from(position)),
                UnitQuaternion::from_quaternion(quaternion),
            ),
            markers,
        };
        Ok(issues.or_ok(found).map_err(|issues| file.locate(issues))?)
    }

    /// Positions of the markers in the world, while the rod is that helix.
    pub fn places(&self) -> Vec<Vector3<f64>> {
        helix_points(self.curvature, self.torsion, &self.markers, &self.pose)
    }
}
