//! Files of sheets that are folded.

use super::failure::Failure;
use crate::plan::fold::FoldedSheet;
use crate::scenario::dimension::{Density, Dimension, Length, Pressure};
use crate::scenario::{Issue, Issues, KeyPath, Quantity, TypedFile};
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::path::Path;

/// Gravity of the stiffness that is given by E, h and ρ, m/s².
const GRAVITY: f64 = 9.81;
/// Least suspended length of paper, in L_gb (thesis sec. 4.6.5).
const LEAST_SUSPENDED: f64 = 0.958;

/// A sheet by its file.
pub struct PaperFile {
    /// Its name for people.
    pub title: String,
    /// L_gb, m.
    pub gravito_bending_length: f64,
    /// Its sides, m.
    pub length: f64,
    /// The side that stays as it is.
    pub width: f64,
    /// Least suspended length while it is bent, in L_gb.
    pub least_suspended: f64,
    /// Static friction on the table.
    pub friction: Option<f64>,
}

#[derive(Debug, Deserialize)]
struct Typed {
    #[serde(rename = "extends")]
    _extends: Option<IgnoredAny>,
    title: Option<String>,
    folding: TypedFolding,
}

#[derive(Debug, Deserialize)]
struct TypedFolding {
    paper: TypedPaper,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TypedPaper {
    length: Quantity<Length>,
    width: Quantity<Length>,
    gravito_bending_length: Option<Quantity<Length>>,
    youngs_modulus: Option<Quantity<Pressure>>,
    thickness: Option<Quantity<Length>>,
    density: Option<Quantity<Density>>,
    least_suspended_length: Option<f64>,
    friction: Option<f64>,
}

impl PaperFile {
    /// Reads a sheet's file.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let file: TypedFile<Typed> = TypedFile::read(path)?;
        let typed = &file.typed.folding.paper;
        let mut issues = Issues::default();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let mut found = Self {
            title: (file.typed.title.clone()).unwrap_or_else(|| stem.into_owned()),
            gravito_bending_length: 1.0,
            length: positive("length", &typed.length, &mut issues),
            width: positive("width", &typed.width, &mut issues),
            least_suspended: typed.least_suspended_length.unwrap_or(LEAST_SUSPENDED),
            friction: typed.friction,
        };
        found.gravito_bending_length = gravito_bending_length(typed, &mut issues);
        if !(found.least_suspended > 0.0 && found.least_suspended.is_finite()) {
            let fault = format!("{} must be above 0, in L_gb", found.least_suspended);
            issues.push(Issue::new(key("least_suspended_length"), fault));
        }
        if let Some(friction) = typed.friction
            && !(friction >= 0.0 && friction.is_finite())
        {
            issues.push(Issue::new(
                key("friction"),
                format!("{friction} must be 0 or more"),
            ));
        }
        Ok(issues.or_ok(found).map_err(|issues| file.locate(issues))?)
    }

    /// The sheet, folded in the direction of its length, or along its diagonal.
    pub fn sheet(&self, along_diagonal: bool) -> FoldedSheet {
        FoldedSheet {
            gravito_bending_length: self.gravito_bending_length,
            length: if along_diagonal {
                libm::hypot(self.length, self.width)
            } else {
                self.length
            },
            least_suspended: self.least_suspended,
        }
    }

    /// Whether both sides are the same.
    pub fn is_square(&self) -> bool {
        (self.length - self.width).abs() <= 1e-6 * self.length
    }
}

fn key(name: &str) -> KeyPath {
    KeyPath::from("folding.paper").key(name)
}

/// L_gb as it is given, or of E, h and ρ.
fn gravito_bending_length(typed: &TypedPaper, issues: &mut Issues) -> f64 {
    let material = (&typed.youngs_modulus, &typed.thickness, &typed.density);
    match (&typed.gravito_bending_length, material) {
        (Some(length), (None, None, None)) => positive("gravito_bending_length", length, issues),
        (None, (Some(modulus), Some(thickness), Some(density))) => {
            FoldedSheet::gravito_bending_length_of(
                positive("youngs_modulus", modulus, issues),
                positive("thickness", thickness, issues),
                positive("density", density, issues),
                GRAVITY,
            )
        }
        _ => {
            let needed = "either `gravito_bending_length` or all of `youngs_modulus`, `thickness` and `density` must be given";
            issues.push(Issue::new(KeyPath::from("folding.paper"), needed));
            1.0
        }
    }
}

fn positive<D: Dimension>(name: &str, quantity: &Quantity<D>, issues: &mut Issues) -> f64 {
    let fault = match quantity.si() {
        Ok(value) if value > 0.0 && value.is_finite() => return value,
        Ok(value) => format!("{value} must be above 0"),
        Err(message) => message,
    };
    issues.push(Issue::new(key(name), fault));
    1.0
}
