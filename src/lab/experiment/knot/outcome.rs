//! Outcome of a knot that was pulled tight.

use rodlab_files::results::{CaseOutcome, Ending, NamedValues};
use serde::{Deserialize, Serialize};

/// Outcomes of a knot; the last columns of `summary.csv`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KnotOutcome {
    /// Whether an inversion was to be detected: in overhand knots of unknotting number 2 and more,
    /// and in all runs that pull until inversion.
    pub may_invert: bool,
    /// l̄_k at which the traction fell as the knot inverted; empty if it did not.
    pub inversion_by_force: Option<f64>,
    /// l̄_k at which the loop touched the braid; empty if it never did.
    pub inversion_by_height: Option<f64>,
    /// Difference of the two values over their mean.
    pub inversion_difference: Option<f64>,
    /// Largest kinetic over elastic energy at the output times while the ends moved, before the inversion.
    pub kinetic_over_elastic: Option<f64>,
    /// Upper bound of this ratio for a quasi-static pull: `knot.kinetic_bound`.
    pub kinetic_bound: Option<f64>,
    /// Gain of energy and losses to friction and drag, over the work of the ends in the same time.
    pub energy_balance: Option<f64>,
    /// Reason why the run ended early; empty if it did not.
    pub knot_ending: Option<KnotEnding>,
    /// l̄_k at the last output.
    pub length_normalized: Option<f64>,
    /// Mean traction of the ends at the last output, N.
    pub traction_n: Option<f64>,
}

/// Regular reason why a run with a knot ended early.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum KnotEnding {
    /// The knot inverted, and was followed for a while.
    Inverted,
    /// The knot is locked: the rod stretches instead of slipping through it.
    Locked,
}

impl KnotOutcome {
    /// The outcome of a case; `None` without a knot.
    pub fn of(case: &CaseOutcome) -> Option<Self> {
        let observed = &case.observed;
        observed.get("may_invert")?;
        let flag = observed.get("may_invert") == Some(&true.into());
        let ending = observed.get("knot_ending").and_then(|value| value.text());
        Some(Self {
            may_invert: flag,
            inversion_by_force: observed.number("inversion_by_force"),
            inversion_by_height: observed.number("inversion_by_height"),
            inversion_difference: observed.number("inversion_difference"),
            kinetic_over_elastic: observed.number("kinetic_over_elastic"),
            kinetic_bound: observed.number("kinetic_bound"),
            energy_balance: observed.number("energy_balance"),
            knot_ending: ending.and_then(KnotEnding::from_word),
            length_normalized: observed.number("length_normalized"),
            traction_n: observed.number("traction_n"),
        })
    }

    /// The columns of the summary.
    pub fn values(&self) -> NamedValues {
        NamedValues::from([
            ("may_invert", self.may_invert.into()),
            ("inversion_by_force", self.inversion_by_force.into()),
            ("inversion_by_height", self.inversion_by_height.into()),
            ("inversion_difference", self.inversion_difference.into()),
            ("kinetic_over_elastic", self.kinetic_over_elastic.into()),
            ("kinetic_bound", self.kinetic_bound.into()),
            ("energy_balance", self.energy_balance.into()),
            ("knot_ending", self.knot_ending.map(KnotEnding::word).into()),
            ("length_normalized", self.length_normalized.into()),
            ("traction_n", self.traction_n.into()),
        ])
    }

    /// Returns a warning if the knot was pulled too fast to be quasi-static.
    pub fn remark(&self) -> Option<String> {
        let (ratio, bound) = (self.kinetic_over_elastic?, self.kinetic_bound?);
        (ratio > bound).then(|| {
            format!(
                "not quasi-static: the kinetic energy reached {ratio:.1e} of the elastic energy, beyond knot.kinetic_bound = {bound:e}; a smaller knot.pull_speed, or \"auto\", keeps it below"
            )
        })
    }

    /// Main results for the user: names and texts, a line each.
    pub fn highlights(&self) -> Vec<(String, String)> {
        let mut lines = Vec::new();
        let mut line = |name: &str, text: String| lines.push((name.to_owned(), text));
        if let (Some(length), Some(traction)) = (self.length_normalized, self.traction_n) {
            let pulled = format!("l̄_k = {length:.2}, traction {traction:.4} N");
            line("pulled to", pulled);
        }
        if self.may_invert {
            let point = |at: Option<f64>| at.map_or("none".to_owned(), |l| format!("l̄_k = {l:.2}"));
            line("inversion, by force", point(self.inversion_by_force));
            line("inversion, by height", point(self.inversion_by_height));
        }
        lines
    }
}

impl KnotEnding {
    const ALL: [Self; 2] = [Self::Inverted, Self::Locked];

    /// The word in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Inverted => "inverted",
            Self::Locked => "locked",
        }
    }

    /// The ending with this word in tables.
    fn from_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|ending| ending.word() == word)
    }

    /// A sentence for the user.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Inverted => "the knot inverted",
            Self::Locked => "the knot is locked: the rod stretches instead of slipping through it",
        }
    }
}

impl From<KnotEnding> for Ending {
    fn from(ending: KnotEnding) -> Self {
        Self {
            word: ending.word().to_owned(),
            sentence: ending.in_words().to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outcomes_are_read_back_by_their_columns() {
        let outcome = KnotOutcome {
            may_invert: true,
            inversion_by_force: Some(74.0),
            inversion_by_height: Some(73.5),
            inversion_difference: Some(0.25),
            kinetic_over_elastic: Some(1e-3),
            kinetic_bound: Some(2e-3),
            energy_balance: Some(0.5),
            knot_ending: Some(KnotEnding::Locked),
            length_normalized: Some(70.0),
            traction_n: Some(0.125),
        };
        for outcome in [outcome, KnotOutcome::default()] {
            let case = CaseOutcome {
                observed: outcome.values(),
                ..CaseOutcome::default()
            };
            assert_eq!(KnotOutcome::of(&case), Some(outcome));
        }
        assert_eq!(KnotOutcome::of(&CaseOutcome::default()), None);
    }

    /// In manifests of version 0.1 the observation is called `knot`.
    #[test]
    fn outcomes_of_earlier_manifests_are_read() {
        let json = r#"{"simulated_time":1.0,"steps":1,"newton_iterations":1,"retries":0,"fluid_iterations":0,
            "steps_with_contact":0,"newton_iterations_with_contact":0,"first_contact":null,"minimum_distance":null,
            "minimum_distance_ratio":null,"elastic_energy":null,"gravitational_energy":null,"critical_parameter":null,
            "knot":{"may_invert":false,"inversion_by_force":null,"kinetic_bound":1e-3,"knot_ending":"locked"}}"#;
        let case: CaseOutcome = serde_json::from_str(json).unwrap();
        let knot = KnotOutcome::of(&case).unwrap();
        assert_eq!(knot.kinetic_bound, Some(1e-3));
        assert_eq!(knot.knot_ending, Some(KnotEnding::Locked));
        let none: CaseOutcome = serde_json::from_str(
            &json.replace(&json[json.find("{\"may").unwrap()..json.len() - 1], "null"),
        )
        .unwrap();
        assert_eq!(KnotOutcome::of(&none), None);
    }
}
