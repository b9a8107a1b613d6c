//! A row of `samples.csv`.

use rodlab_planning::plan::fold::Fold;
use serde::{Deserialize, Serialize};

/// Whether a fold was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// It was.
    Found,
    /// There is no gentle fold.
    OutOfReach,
}

/// A row of `samples.csv`: lengths in L_gb, forces in EI/L_gb².
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Sample {
    /// x̄.
    pub x: f64,
    /// z̄.
    pub z: f64,
    /// Whether there is a fold.
    pub outcome: Outcome,
    /// λ.
    pub lambda: Option<f64>,
    /// α, rad.
    pub alpha: Option<f64>,
    /// l̄_s.
    pub suspended_length: Option<f64>,
    /// arctan(H/|V|), rad.
    pub force_inclination: Option<f64>,
    /// H.
    pub horizontal_force: Option<f64>,
    /// V.
    pub vertical_force: Option<f64>,
    /// Whether the fold is in the penalty region.
    pub penalty: Option<bool>,
}

impl Sample {
    /// The row of the fold at a position, if there is one. Suspended lengths below `least` belong
    /// to the penalty region.
    pub fn new([x, z]: [f64; 2], fold: Option<&Fold>, least: f64) -> Self {
        Self {
            x,
            z,
            outcome: match fold {
                Some(_) => Outcome::Found,
                None => Outcome::OutOfReach,
            },
            lambda: fold.map(Fold::force_ratio),
            alpha: fold.map(|fold| fold.angle),
            suspended_length: fold.map(|fold| fold.suspended_length),
            force_inclination: fold.map(Fold::force_inclination),
            horizontal_force: fold.map(|fold| fold.forces.horizontal),
            vertical_force: fold.map(|fold| fold.forces.vertical),
            penalty: fold.map(|fold| fold.suspended_length < least),
        }
    }
}
