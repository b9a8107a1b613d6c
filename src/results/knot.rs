//! What a knot that was pulled tight came to.

use serde::{Deserialize, Serialize};

/// Outcomes of a knot; the last columns of `summary.csv`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KnotOutcome {
    /// Whether an inversion was looked for: in overhand knots of unknotting number 2 and more, and in all that are pulled
    /// for it.
    #[serde(default)]
    pub may_invert: bool,
    /// l̄_k at which the traction fell as the knot inverted; empty where it did not.
    pub inversion_by_force: Option<f64>,
    /// l̄_k at which the loop had come to lie on the braid; empty where it did not.
    pub inversion_by_height: Option<f64>,
    /// Difference of the two over their mean.
    pub inversion_difference: Option<f64>,
    /// Largest kinetic over elastic energy at the output times while the ends moved, before the inversion.
    pub kinetic_over_elastic: Option<f64>,
    /// What it should not exceed for a quasi-static pull: `knot.kinetic_bound`.
    pub kinetic_bound: Option<f64>,
    /// Gain of energy and losses to friction and drag over the work of the ends, meanwhile.
    pub energy_balance: Option<f64>,
    /// Why the run ended before its time; empty where it did not.
    pub knot_ending: Option<KnotEnding>,
    /// l̄_k at the last output.
    #[serde(default)]
    pub length_normalized: Option<f64>,
    /// Mean traction of the ends at the last output, N.
    #[serde(default)]
    pub traction_n: Option<f64>,
}

/// Why a run with a knot ended before its time, as it should.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum KnotEnding {
    /// The knot inverted, and was followed for a while.
    Inverted,
    /// The knot is locked: the rod stretches instead of slipping through it.
    Locked,
}

impl KnotOutcome {
    /// Says so where the knot was pulled too fast to be quasi-static.
    pub fn remark(&self) -> Option<String> {
        let (ratio, bound) = (self.kinetic_over_elastic?, self.kinetic_bound?);
        (ratio > bound).then(|| {
            format!(
                "not quasi-static: the kinetic energy reached {ratio:.1e} of the elastic energy, beyond knot.kinetic_bound = {bound:e}; a smaller knot.pull_speed, or \"auto\", keeps it below"
            )
        })
    }
}

impl KnotEnding {
    /// A sentence for people.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Inverted => "the knot inverted",
            Self::Locked => "the knot is locked: the rod stretches instead of slipping through it",
        }
    }
}
