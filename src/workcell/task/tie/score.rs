//! Compares the observed knot with the knot of the patterns.

use super::sight::{SeenCrossing, SeenKnot};
use rodlab_planning::knot::KnotInvariants;
use rodlab_vision::SeenLength;
use serde::Serialize;

/// Invariants of an unknotted curve.
const NO_KNOT: KnotInvariants = KnotInvariants {
    determinant: 1,
    signature: 0,
};

/// Outcome of a knot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TieScore {
    /// Whether the knot of the patterns is tied; `null` if the picture does not show it. If the
    /// patterns have no knot, it is `false`.
    pub tied: Option<bool>,
    /// Reason why the picture does not show whether the knot is tied.
    pub undecided: Option<String>,
    /// The knot of the patterns; `null` if it depends on how the ends are joined.
    pub drawn: Option<KnotInvariants>,
    /// The observed knot; `null` if it depends on how the ends are joined, or if the picture does
    /// not show it.
    pub seen: Option<KnotInvariants>,
    /// Observed length of each rod, m.
    pub seen_lengths_m: Vec<f64>,
    /// Observed crossings of the rods.
    pub crossings: Vec<SeenCrossing>,
}

impl TieScore {
    /// Computes the score from rods that are completely visible and the knot of their patterns.
    pub fn of(rods: &SeenKnot, drawn: Option<KnotInvariants>) -> Self {
        let (seen, undecided) = match rods.knot() {
            Ok(knot) => (knot, None),
            Err(words) => (None, Some(words)),
        };
        let is_as_drawn = seen.is_some() && seen == drawn;
        Self {
            tied: undecided
                .is_none()
                .then_some(is_as_drawn && drawn != Some(NO_KNOT)),
            undecided,
            drawn,
            seen,
            seen_lengths_m: rods.lengths(),
            crossings: rods.crossings.clone(),
        }
    }

    /// Returns as text whether the knot is tied.
    pub fn in_words(&self) -> String {
        match (self.tied, &self.undecided) {
            (Some(true), _) => "tied as drawn".into(),
            (Some(false), _) if self.drawn == Some(NO_KNOT) => "none was drawn".into(),
            (Some(false), _) => "not tied".into(),
            (None, reason) => format!(
                "undecided: {}",
                reason.as_deref().unwrap_or("the picture does not show it")
            ),
        }
    }
}

/// Message that rods with given lengths, m, are not completely visible; `None` if they are.
pub fn not_seen_whole(rods: &SeenKnot, lengths: &[f64]) -> Option<String> {
    if rods.curves.len() < lengths.len() {
        return Some(format!(
            "of {} rods the picture shows {}",
            lengths.len(),
            rods.curves.len()
        ));
    }
    let pairs = rods.curves.iter().zip(lengths);
    let mut seen = pairs.map(|(curve, length)| SeenLength::of(curve, *length));
    seen.find(|length| !length.is_whole())
        .map(|length| length.to_string())
}

/// Returns a knot as text.
pub fn knot_in_words(knot: Option<KnotInvariants>) -> String {
    match knot {
        Some(NO_KNOT) => "none: determinant 1, signature 0".into(),
        Some(knot) => format!(
            "determinant {}, signature {}",
            knot.determinant, knot.signature
        ),
        None => "depends on how the ends are joined, or is not seen".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_vision::Point;

    fn straight(length: f64) -> SeenKnot {
        SeenKnot {
            curves: vec![
                (0..=10)
                    .map(|k| Point::new(0.1 * length * f64::from(k), 0.0))
                    .collect(),
            ],
            crossings: Vec::new(),
        }
    }

    #[test]
    fn without_a_knot_nothing_is_tied() {
        let trefoil = Some(KnotInvariants {
            determinant: 3,
            signature: -2,
        });
        let score = TieScore::of(&straight(0.99), trefoil);
        assert_eq!((score.tied, score.seen), (Some(false), Some(NO_KNOT)));
        let score = TieScore::of(&straight(1.0), Some(NO_KNOT));
        assert_eq!(score.tied, Some(false));
        assert_eq!(score.in_words(), "none was drawn");
    }

    #[test]
    fn a_part_of_a_rod_or_one_of_two_is_not_seen_whole() {
        assert_eq!(not_seen_whole(&straight(0.99), &[1.0]), None);
        let words = not_seen_whole(&straight(0.95), &[1.0]).unwrap();
        assert!(words.contains("950.0 mm"), "{words}");
        let words = not_seen_whole(&straight(1.0), &[1.0, 1.0]).unwrap();
        assert!(words.contains("of 2 rods"), "{words}");
    }
}
