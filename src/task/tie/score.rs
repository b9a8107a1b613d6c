//! The knot that was seen, compared with the one that was drawn.

use super::sight::{SeenCrossing, SeenKnot};
use crate::knot::KnotInvariants;
use serde::Serialize;

/// Part of its length by which a rod may seem longer or shorter: otherwise something else was seen, or not all of it.
const LENGTH: f64 = 0.06;
/// What there is without a knot.
const NO_KNOT: KnotInvariants = KnotInvariants {
    determinant: 1,
    signature: 0,
};

/// What a knot came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TieScore {
    /// Whether the knot that was drawn is tied; `null` where the picture does not decide. Where none was drawn none is tied.
    pub tied: Option<bool>,
    /// Why the picture does not decide.
    pub undecided: Option<String>,
    /// The knot that was drawn; `null` where it depends on how ends are joined.
    pub drawn: Option<KnotInvariants>,
    /// The knot that was seen; `null` where it depends on how ends are joined, or is not decided.
    pub seen: Option<KnotInvariants>,
    /// Length of each rod as it was seen, m.
    pub seen_lengths_m: Vec<f64>,
    /// Their crossings.
    pub crossings: Vec<SeenCrossing>,
}

impl TieScore {
    /// The score of rods of some lengths, m, along whose patterns a knot was drawn.
    pub fn of(rods: &SeenKnot, lengths: &[f64], drawn: Option<KnotInvariants>) -> Self {
        let seen_lengths_m = rods.lengths();
        let (seen, undecided) = match not_seen(&seen_lengths_m, lengths) {
            Some(words) => (None, Some(words)),
            None => match rods.knot() {
                Ok(knot) => (knot, None),
                Err(words) => (None, Some(words)),
            },
        };
        let is_as_drawn = seen.is_some() && seen == drawn;
        Self {
            tied: undecided
                .is_none()
                .then_some(is_as_drawn && drawn != Some(NO_KNOT)),
            undecided,
            drawn,
            seen,
            seen_lengths_m,
            crossings: rods.crossings.clone(),
        }
    }

    /// Whether it is tied, in words.
    pub fn in_words(&self) -> String {
        match (self.tied, &self.undecided) {
            (Some(true), _) => "tied as drawn".into(),
            (Some(false), _) if self.drawn == Some(NO_KNOT) => "none was drawn".into(),
            (Some(false), _) => "not tied".into(),
            (None, reason) => format!(
                "undecided: {}",
                reason.as_deref().unwrap_or("the picture does not tell")
            ),
        }
    }
}

/// Which rod is not seen as a whole, in words.
fn not_seen(seen: &[f64], lengths: &[f64]) -> Option<String> {
    if seen.len() < lengths.len() {
        return Some(format!(
            "of {} rods the picture shows {}",
            lengths.len(),
            seen.len()
        ));
    }
    let mut pairs = seen.iter().zip(lengths);
    let other = pairs.find(|(seen, length)| !((*seen / *length - 1.0).abs() <= LENGTH));
    other.map(|(seen, length)| {
        format!(
            "a strand in the picture is {seen:.3} m long, and its rod {length:.3} m: it is not seen as a whole"
        )
    })
}

/// A knot in words.
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
    use crate::vision::Point;

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
    fn without_a_knot_nothing_is_tied_and_a_part_of_the_rod_does_not_decide() {
        let trefoil = Some(KnotInvariants {
            determinant: 3,
            signature: -2,
        });
        let score = TieScore::of(&straight(0.99), &[1.0], trefoil);
        assert_eq!((score.tied, score.seen), (Some(false), Some(NO_KNOT)));
        let score = TieScore::of(&straight(1.0), &[1.0], Some(NO_KNOT));
        assert_eq!(score.tied, Some(false));
        assert_eq!(score.in_words(), "none was drawn");
        let score = TieScore::of(&straight(0.8), &[1.0], trefoil);
        assert_eq!((score.tied, score.seen), (None, None));
        assert!(score.in_words().contains("not seen as a whole"));
        let score = TieScore::of(&straight(1.0), &[1.0, 1.0], trefoil);
        assert_eq!(score.tied, None);
    }
}
