//! The rod between a chuck and a hand, read from its file.

use crate::scenario::dimension::{Density, Dimension, Dimensionless, Length, Pressure};
use crate::scenario::{Issue, Issues, KeyPath, Quantity, ScenarioError, TypedFile};
use rodlab_engine::mechanics::Vector3;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::path::Path;
use toml::{Table, toml};

/// Default number of edges of the simulated rod: at a distance ‖(κ, τ, ω)‖ of 12 the angle between
/// edges is 0.2 rad.
const EDGES: u32 = 60;
/// Minimum and maximum number of edges: fewer do not resolve a helix, more take too long.
const ALLOWED_EDGES: [u32; 2] = [8, 1000];
/// Default number of markers.
const MARKERS: u32 = 15;
/// Minimum and maximum number of markers: fewer do not distinguish a helix from other curves, more
/// overlap in a picture.
const ALLOWED_MARKERS: [u32; 2] = [3, 100];
/// Time step, s. The implicit Euler method damps faster vibrations, as do friction at the clamps
/// and the air.
const STEP: f64 = 5e-3;

/// A straight, round, uniform rod of an isotropic material, clamped at both ends, with markers along it.
#[derive(Clone, Debug, PartialEq)]
pub struct ClampedRod {
    /// Name of the rod for readers.
    pub title: String,
    /// Length between the clamps, m.
    pub length: f64,
    /// Radius, m.
    pub radius: f64,
    /// Young's modulus, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// Mass per volume, kg/m³.
    pub density: f64,
    /// Edges in simulation.
    pub edges: u32,
    /// Number of markers, evenly spread between the clamps.
    pub markers: u32,
}

#[derive(Debug, Deserialize)]
struct Typed {
    #[serde(rename = "extends")]
    _extends: Option<IgnoredAny>,
    title: Option<String>,
    material: TypedMaterial,
    rod: TypedRod,
}

#[derive(Debug, Deserialize)]
struct TypedMaterial {
    youngs_modulus: Quantity<Pressure>,
    poissons_ratio: Quantity<Dimensionless>,
    density: Quantity<Density>,
}

#[derive(Debug, Deserialize)]
struct TypedRod {
    radius: Quantity<Length>,
    length: Quantity<Length>,
    edges: Option<u32>,
    markers: Option<u32>,
}

impl ClampedRod {
    /// Reads a rod's file.
    ///
    /// # Errors
    /// All its faults, with file, line and key.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let file: TypedFile<Typed> = TypedFile::read(path)?;
        let Typed {
            title,
            material,
            rod,
            ..
        } = &file.typed;
        let mut issues = Issues::default();
        let mut reader = Reader {
            issues: &mut issues,
        };
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let found = Self {
            title: title.clone().unwrap_or_else(|| stem.into_owned()),
            length: reader.positive("rod.length", &rod.length),
            radius: reader.positive("rod.radius", &rod.radius),
            youngs_modulus: reader.positive("material.youngs_modulus", &material.youngs_modulus),
            poissons_ratio: reader.poissons_ratio(&material.poissons_ratio),
            density: reader.positive("material.density", &material.density),
            edges: reader.count("rod.edges", rod.edges.unwrap_or(EDGES), ALLOWED_EDGES),
            markers: reader.count(
                "rod.markers",
                rod.markers.unwrap_or(MARKERS),
                ALLOWED_MARKERS,
            ),
        };
        issues.or_ok(found).map_err(|issues| file.locate(issues))
    }

    /// Twisting over bending stiffness, c = GJ/EI = 1/(1 + ν).
    pub fn stiffness_ratio(&self) -> f64 {
        1.0 / (1.0 + self.poissons_ratio)
    }

    /// Gravito-bending length (E h²/(8ρg))^(1/3), m. Gravity bends rods that are much longer than
    /// this.
    pub fn gravito_bending_length(&self) -> f64 {
        let weight = 8.0 * self.density * GRAVITY;
        libm::cbrt(self.youngs_modulus * self.radius.powi(2) / weight)
    }

    /// Positions of the markers along the rod, over its length.
    pub fn marker_places(&self) -> Vec<f64> {
        let parts = f64::from(self.markers + 1);
        (1..=self.markers).map(|k| f64::from(k) / parts).collect()
    }

    /// The scenario of the rod, straight along x, with the clamps at both ends as first and second
    /// clamp. `up` is the unit vector against gravity.
    pub fn scenario(&self, up: &Vector3) -> Table {
        let Self {
            length,
            radius,
            youngs_modulus,
            poissons_ratio,
            density,
            edges,
            ..
        } = *self;
        let [x, y, z]: [f64; 3] = (-GRAVITY * up).into();
        toml! {
            experiment = "scene"
            title = (self.title.as_str())
            [material]
            youngs_modulus = youngs_modulus
            poissons_ratio = poissons_ratio
            density = density
            [[rods]]
            name = "rod"
            radius = radius
            edges = edges
            shape = { kind = "straight", start = [0, 0, 0], end = [length, 0, 0] }
            [[clamps]]
            rod = "rod"
            at = "start"
            [[clamps]]
            rod = "rod"
            at = "end"
            [[loads]]
            kind = "gravity"
            acceleration = [x, y, z]
            [contact]
            friction = FRICTION
            [time]
            scheme = "implicit-euler"
            step = STEP
            end = 1.0
        }
    }
}

/// Self-friction of the rod, which touches itself after it has left the helix: the value of
/// metals.
const FRICTION: f64 = 0.2;
/// Acceleration of free fall, m/s².
const GRAVITY: f64 = 9.81;

/// Reads quantities and records their faults.
struct Reader<'a> {
    issues: &'a mut Issues,
}

impl Reader<'_> {
    fn fault(&mut self, key: &str, message: String) {
        self.issues.push(Issue::new(KeyPath::from(key), message));
    }

    fn si<D: Dimension>(&mut self, key: &str, quantity: &Quantity<D>) -> f64 {
        quantity.si().unwrap_or_else(|message| {
            self.fault(key, message);
            1.0
        })
    }

    fn positive<D: Dimension>(&mut self, key: &str, quantity: &Quantity<D>) -> f64 {
        let value = self.si(key, quantity);
        if !(value > 0.0 && value.is_finite()) {
            self.fault(key, format!("{value} must be above 0"));
        }
        value
    }

    fn poissons_ratio(&mut self, quantity: &Quantity<Dimensionless>) -> f64 {
        let value = self.si("material.poissons_ratio", quantity);
        if !(value > -1.0 && value <= 0.5) {
            self.fault(
                "material.poissons_ratio",
                format!("{value} must be above -1 and at most 0.5"),
            );
        }
        value
    }

    fn count(&mut self, key: &str, value: u32, [least, most]: [u32; 2]) -> u32 {
        if !(least..=most).contains(&value) {
            self.fault(key, format!("{value}; allowed: {least} to {most}"));
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIRE: &str = "[material]\nyoungs_modulus = \"67.5 GPa\"\npoissons_ratio = 0.33\ndensity = 6450.0\n\
                        [rod]\nradius = \"0.79375 mm\"\nlength = \"50 cm\"\n";

    fn read(text: &str) -> Result<ClampedRod, ScenarioError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("wire.toml");
        std::fs::write(&path, text).unwrap();
        ClampedRod::read(&path)
    }

    /// Thesis section 6.4 states 1.3816, because it inserts the diameter for the radius h in its
    /// own formula.
    #[test]
    fn the_gravito_bending_length_of_the_wire_of_the_thesis() {
        let wire = read(WIRE).unwrap();
        assert!((wire.gravito_bending_length() / wire.length - 0.876).abs() < 1e-3);
        let thick = ClampedRod {
            radius: 2.0 * wire.radius,
            ..wire.clone()
        };
        assert!((thick.gravito_bending_length() / wire.length / 1.3816 - 1.0).abs() < 0.01);
        let places = wire.marker_places();
        assert_eq!((places.len(), places[7]), (15, 0.5));
    }

    #[test]
    fn faults_name_their_keys() {
        for (from, to, words) in [
            ("0.33", "0.6", "poissons_ratio"),
            ("\"50 cm\"", "\"0 cm\"", "length"),
            ("\"67.5 GPa\"", "\"67.5 m\"", "youngs_modulus"),
            ("length", "markers = 2\nlength", "allowed: 3 to 100"),
            ("length", "edges = 7\nlength", "allowed: 8 to 1000"),
        ] {
            let error = read(&WIRE.replace(from, to)).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
