//! Files of rods that are laid on a table.

use crate::scenario::dimension::{Density, Length};
use crate::scenario::{Issue, Issues, KeyPath, Quantity, ScenarioError, TypedFile};
use rodlab_planning::plan::deployment::DeployedRod;
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// A rod by its file.
#[derive(Clone, Debug)]
pub struct RodFile {
    /// Name of the rod for readers.
    pub title: String,
    /// The rod.
    pub rod: DeployedRod,
    /// Mass per volume, kg/m³. The shape depends on the gravito-bending length, not on the
    /// density.
    pub density: f64,
    /// Number of edges of the simulated rod; `None` for the default.
    pub edges: Option<u32>,
    /// Coefficients of friction with tables, by name.
    pub friction: BTreeMap<String, f64>,
}

/// Default density, kg/m³.
const DENSITY: f64 = 1000.0;

#[derive(Serialize)]
struct Written<'a> {
    title: &'a str,
    deployment: WrittenDeployment<'a>,
}

#[derive(Serialize)]
struct WrittenDeployment<'a> {
    rod: WrittenRod<'a>,
}

#[derive(Serialize)]
struct WrittenRod<'a> {
    gravito_bending_length: f64,
    radius: f64,
    length: f64,
    density: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    edges: Option<u32>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    friction: &'a BTreeMap<String, f64>,
}

#[derive(Debug, Deserialize)]
struct Typed {
    #[serde(rename = "extends")]
    _extends: Option<IgnoredAny>,
    title: Option<String>,
    deployment: TypedDeployment,
}

#[derive(Debug, Deserialize)]
struct TypedDeployment {
    rod: TypedRod,
}

#[derive(Debug, Deserialize)]
struct TypedRod {
    gravito_bending_length: Quantity<Length>,
    radius: Quantity<Length>,
    length: Quantity<Length>,
    density: Option<Quantity<Density>>,
    edges: Option<u32>,
    #[serde(default)]
    friction: BTreeMap<String, f64>,
}

impl RodFile {
    /// The text of the file.
    pub fn text(&self) -> String {
        let written = Written {
            title: &self.title,
            deployment: WrittenDeployment {
                rod: WrittenRod {
                    gravito_bending_length: self.rod.gravito_bending_length,
                    radius: self.rod.radius,
                    length: self.rod.length,
                    density: self.density,
                    edges: self.edges,
                    friction: &self.friction,
                },
            },
        };
        toml::to_string(&written).expect("numbers and names are TOML values")
    }

    /// Reads a rod's file.
    ///
    /// # Errors
    /// All its faults, with file, line and key.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let file: TypedFile<Typed> = TypedFile::read(path)?;
        let typed = &file.typed.deployment.rod;
        let root = KeyPath::from("deployment.rod");
        let mut issues = Issues::default();
        let mut positive = |key: &str, value: Result<f64, String>, unit: &str| {
            let value = value.and_then(|value| match value > 0.0 && value.is_finite() {
                true => Ok(value),
                false => Err(format!("{value} {unit} must be above 0")),
            });
            value.unwrap_or_else(|message| {
                issues.push(Issue::new(root.key(key), message));
                1.0
            })
        };
        let unit = typed.gravito_bending_length.si();
        let rod = DeployedRod {
            gravito_bending_length: positive("gravito_bending_length", unit, "m"),
            radius: positive("radius", typed.radius.si(), "m"),
            length: positive("length", typed.length.si(), "m"),
        };
        let density = typed.density.as_ref().map_or(Ok(DENSITY), Quantity::si);
        let density = positive("density", density, "kg/m³");
        for (name, friction) in &typed.friction {
            if !(*friction >= 0.0 && friction.is_finite()) {
                let key = root.key("friction").key(name);
                issues.push(Issue::new(key, format!("{friction} must be 0 or more")));
            }
        }
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let found = Self {
            title: (file.typed.title.clone()).unwrap_or_else(|| stem.into_owned()),
            rod,
            density,
            edges: typed.edges,
            friction: typed.friction.clone(),
        };
        issues.or_ok(found).map_err(|issues| file.locate(issues))
    }
}
