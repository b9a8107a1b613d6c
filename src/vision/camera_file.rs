//! Cameras in TOML files.

use super::VisionError;
use super::camera::{Camera, Lens};
use super::input::read_text;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use std::fmt::Write;
use std::path::Path;
use toml::{Table, Value};

impl Camera {
    /// Reads the table `[camera]` of a TOML file; other tables are ignored.
    ///
    /// # Errors
    /// The file cannot be read, is not TOML, or its table `[camera]` lacks a key or holds an
    /// impossible value.
    pub fn read(path: &Path) -> Result<Self, VisionError> {
        let text = read_text(path)?;
        let document: Table = text.parse().map_err(|error| VisionError::Malformed {
            path: path.into(),
            reason: format!("not a TOML file: {error}"),
        })?;
        let camera = document.get("camera").and_then(Value::as_table);
        let reader = CameraReader {
            path,
            table: camera.ok_or_else(|| VisionError::Camera {
                path: path.into(),
                key: "camera".into(),
                reason: "there is no table [camera]; `rodlab calibrate camera` writes it".into(),
            })?,
        };
        reader.camera()
    }

    /// Returns the camera as a TOML table `[camera]`.
    pub fn to_toml(&self) -> String {
        let list = |values: &[f64]| {
            let texts: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
            format!("[{}]", texts.join(", "))
        };
        let mut text = String::from("[camera]\n");
        let Lens {
            focal,
            centre,
            distortion,
        } = self.lens;
        let quaternion = self.pose.rotation;
        let _ = write!(
            text,
            "width = {}\nheight = {}\n\
             # pixels; the centre of the first pixel is (0, 0)\n\
             fx = {:?}\nfy = {:?}\ncx = {:?}\ncy = {:?}\n\
             # k1, k2, p1, p2, k3\ndistortion = {}\n\
             # of the camera in the world, metres; w, x, y, z: its z axis is the view, its y axis points down\n\
             position = {}\nquaternion = {}\n\
             # height z of the plane on which points are located, metres\ntable_height = {:?}\n",
            self.width,
            self.height,
            focal[0],
            focal[1],
            centre[0],
            centre[1],
            list(&distortion),
            list(self.pose.translation.vector.as_slice()),
            list(&[quaternion.w, quaternion.i, quaternion.j, quaternion.k]),
            self.table_height
        );
        text
    }
}

const KEYS: [&str; 11] = [
    "width",
    "height",
    "fx",
    "fy",
    "cx",
    "cy",
    "distortion",
    "position",
    "quaternion",
    "table_height",
    "source",
];

struct CameraReader<'a> {
    path: &'a Path,
    table: &'a Table,
}

impl CameraReader<'_> {
    fn fault(&self, key: &str, reason: impl Into<String>) -> VisionError {
        VisionError::Camera {
            path: self.path.into(),
            key: format!("camera.{key}"),
            reason: reason.into(),
        }
    }

    fn number_of(value: &Value) -> Option<f64> {
        let number = value
            .as_float()
            .or_else(|| value.as_integer().map(|n| n as f64));
        number.filter(|number| number.is_finite())
    }

    fn get(&self, key: &str) -> Result<&Value, VisionError> {
        self.table.get(key).ok_or_else(|| {
            self.fault(
                key,
                "the key is missing; `rodlab calibrate camera` writes it",
            )
        })
    }

    fn number(&self, key: &str) -> Result<f64, VisionError> {
        Self::number_of(self.get(key)?).ok_or_else(|| self.fault(key, "expected a finite number"))
    }

    fn size(&self, key: &str) -> Result<u32, VisionError> {
        let size = self.get(key)?.as_integer();
        let size = size.and_then(|size| u32::try_from(size).ok());
        size.filter(|size| (1..=super::LONGEST_SIDE).contains(size))
            .ok_or_else(|| {
                let most = super::LONGEST_SIDE;
                self.fault(
                    key,
                    format!("expected a whole number of pixels, 1 to {most}"),
                )
            })
    }

    fn list<const N: usize>(&self, key: &str) -> Result<[f64; N], VisionError> {
        let values = self.get(key)?.as_array();
        let numbers: Option<Vec<f64>> =
            values.and_then(|values| values.iter().map(Self::number_of).collect());
        numbers
            .and_then(|numbers| numbers.try_into().ok())
            .ok_or_else(|| self.fault(key, format!("expected a list of {N} finite numbers")))
    }

    fn camera(&self) -> Result<Camera, VisionError> {
        if let Some(key) = self.table.keys().find(|key| !KEYS.contains(&key.as_str())) {
            return Err(self.fault(key, format!("unknown key; allowed: {}", KEYS.join(", "))));
        }
        let focal = [self.number("fx")?, self.number("fy")?];
        for (key, focal) in ["fx", "fy"].into_iter().zip(focal) {
            if focal <= 0.0 {
                return Err(self.fault(key, "a focal length must be positive"));
            }
        }
        let optional = |key: &str| self.table.contains_key(key);
        let distortion = if optional("distortion") {
            self.list("distortion")?
        } else {
            [0.0; 5]
        };
        let [w, x, y, z] = self.list("quaternion")?;
        let norm = (w * w + x * x + y * y + z * z).sqrt();
        if !((norm - 1.0).abs() < 1e-3) {
            return Err(self.fault(
                "quaternion",
                format!("[w, x, y, z] has norm {norm:.4}, expected 1"),
            ));
        }
        let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        let position: [f64; 3] = self.list("position")?;
        let camera = Camera {
            width: self.size("width")?,
            height: self.size("height")?,
            lens: Lens {
                focal,
                centre: [self.number("cx")?, self.number("cy")?],
                distortion,
            },
            pose: Isometry3::from_parts(Translation3::from(Vector3::from(position)), rotation),
            table_height: if optional("table_height") {
                self.number("table_height")?
            } else {
                0.0
            },
        };
        Ok(camera)
    }
}

#[cfg(test)]
mod tests {
    use super::super::camera::tests::slanted_camera;
    use super::*;
    use std::fs;

    #[test]
    fn a_file_reads_back_as_it_was_written() {
        let folder = std::env::temp_dir().join(format!("camera-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        let path = folder.join("cell.toml");
        let camera = slanted_camera();
        let text = format!("name = \"cell\"\n{}\n[arm]\nx = 1\n", camera.to_toml());
        fs::write(&path, &text).expect("a file");
        let read = Camera::read(&path).expect("a camera");
        assert_eq!(read.lens, camera.lens);
        assert!((read.pose.translation.vector - camera.pose.translation.vector).norm() < 1e-15);
        assert!(read.pose.rotation.angle_to(&camera.pose.rotation) < 1e-12);
        let faults = [
            ("fx = 910.0", "fx = -1", "camera.fx"),
            ("fx = 910.0", "focal = 3", "camera.focal"),
            ("fx = 910.0", "", "camera.fx"),
            ("width = 1280", "width = 0", "camera.width"),
            ("[camera]", "[other]", "camera: there is no table"),
            ("position = [", "position = [1, ", "camera.position"),
            ("quaternion = [", "quaternion = [3, ", "camera.quaternion"),
        ];
        for (old, new, expected) in faults {
            fs::write(&path, text.replacen(old, new, 1)).expect("a file");
            let error = Camera::read(&path).expect_err("a fault").to_string();
            assert!(error.contains(expected), "{error}");
        }
        fs::remove_dir_all(&folder).expect("the folder goes");
    }
}
