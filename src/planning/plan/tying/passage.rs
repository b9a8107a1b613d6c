//! Second passes of patterns through their crossings.

use crate::plan::deployment::DeployedRod;
use crate::plan::pattern::{Pattern, PatternPoint, Point, crossings, crossings_of_two};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Distance of points of the pattern in the search for crossings, m.
const SPACING: f64 = 1e-3;
/// Maximum number of points of a pattern; those of longer patterns are farther apart.
const MOST_POINTS: f64 = 4_000.0;
/// Length of the rod that is still held when the rest is laid, in gravito-bending lengths l̄. The
/// end of the rod is then l̄⁴/48 above the rest, so that the jitter of the gripper does not press
/// it into the table.
const HELD: f64 = 1.6;
/// Smallest distance of the end before a crossing, in gravito-bending lengths.
const BEFORE_CROSSING: f64 = 1.0;

/// Second pass of a rod through a crossing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Pass {
    /// Over the first strand.
    Over,
    /// Under it.
    Under,
}

/// A rod that is laid along a pattern. If the pattern is longer than the rod, its rest is the path
/// of the rod's end.
#[derive(Clone, Copy)]
pub struct TiedRod<'a> {
    /// The rod.
    pub rod: &'a DeployedRod,
    /// The pattern.
    pub curve: &'a Pattern,
}

impl TiedRod<'_> {
    /// Whether its end is moved on after laying.
    pub fn is_led(&self) -> bool {
        self.curve.length() > self.rod.length
    }
}

/// A position along the pattern of a rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Number of the rod in the order of laying, from 0.
    pub rod: usize,
    /// Arc length, m.
    pub s: f64,
}

/// A crossing of a pattern with itself or with another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Position of the first pass.
    pub first: Place,
    /// Position of the second pass, by the same rod or another.
    pub second: Place,
    /// Position of the crossing, m.
    pub place: Point,
    /// Over or under, at the second pass.
    pub pass: Pass,
}

/// Reason why a knot cannot be tied along a pattern.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TyingError {
    /// The number of passes differs from that of the crossings.
    #[error(
        "crossings of the pattern: {crossings}; passes given: {words}; give \"over\" or \"under\" \
         for each crossing, in the order of the second passes"
    )]
    Words {
        /// Crossings of the pattern.
        crossings: usize,
        /// Given passes.
        words: usize,
    },
    /// The same of two rods.
    #[error(
        "crossings of the rods: {crossings}; passes given: {words}; give \"over\" or \"under\" for \
         each crossing, in the order of the second passes: first the second rod as it is laid, \
         then its end, then the end of the first rod"
    )]
    WordsOfTwo {
        /// Number of crossings of the patterns.
        crossings: usize,
        /// Given passes.
        words: usize,
    },
    /// No end is moved.
    #[error(
        "neither pattern is longer than its rod, so no end is led under the other rod and no knot is tied; extend a \
         pattern beyond the length of its rod"
    )]
    NothingIsLed,
    /// There is no path for the end.
    #[error(
        "the pattern is {pattern_m:.4} m long, and the rod {rod_m} m: the pattern must be longer \
         than the rod, because its rest is the path of the end of the rod"
    )]
    NoPath {
        /// Length of the pattern, m.
        pattern_m: f64,
        /// Length of the rod, m.
        rod_m: f64,
    },
    /// A rod being laid cannot pass under.
    #[error(
        "crossing {number} is at {second_m:.4} m of the pattern, which the rod of {rod_m} m covers \
         when it is laid, so the rod passes over there; to pass under, the rod must end \
         {least_m:.4} m before the crossing"
    )]
    LaidOver {
        /// Number of the crossing, from 1.
        number: usize,
        /// Position of the second pass, m.
        second_m: f64,
        /// Length of the rod, m.
        rod_m: f64,
        /// Smallest allowed distance of the end before the crossing, m.
        least_m: f64,
    },
    /// The path of the end crosses itself.
    #[error(
        "crossing {number} is first passed at {first_m:.4} m of the pattern, beyond the end of the laid rod of {rod_m} m"
    )]
    NothingThere {
        /// Number of the crossing, from 1.
        number: usize,
        /// Position of the first pass, m.
        first_m: f64,
        /// Length of the rod, m.
        rod_m: f64,
    },
}

/// The length of pattern along which a rod is laid before its end is moved on, m.
pub fn laid_length(rod: &DeployedRod) -> f64 {
    rod.length - HELD * rod.gravito_bending_length
}

/// Order of passes: rods are laid one after the other, and the end of the last rod is moved first.
fn stage(rods: &[TiedRod<'_>], place: &Place) -> (usize, f64) {
    if place.s <= rods[place.rod].rod.length {
        (place.rod, place.s)
    } else {
        (2 * rods.len() - place.rod, place.s)
    }
}

/// The crossings of patterns, in the order of their second passes.
fn found(rods: &[TiedRod<'_>]) -> Vec<(Place, Place, Point)> {
    let sampled: Vec<Vec<PatternPoint>> = rods
        .iter()
        .map(|tied| {
            let spacing = SPACING.max(tied.curve.length() / MOST_POINTS);
            tied.curve.sampled(spacing)
        })
        .collect();
    let mut found = Vec::new();
    for (rod, points) in sampled.iter().enumerate() {
        let place = |s: f64| Place { rod, s };
        let own = crossings(points).into_iter();
        found.extend(own.map(|own| (place(own.first), place(own.second), own.position)));
        for (earlier, others) in sampled[..rod].iter().enumerate() {
            let between = crossings_of_two(others, points).into_iter();
            found.extend(between.map(|crossing| {
                let of_earlier = Place {
                    rod: earlier,
                    s: crossing.first,
                };
                (of_earlier, place(crossing.second), crossing.position)
            }));
        }
    }
    for (first, second, _) in &mut found {
        if stage(rods, first) > stage(rods, second) {
            std::mem::swap(first, second);
        }
    }
    let key = |found: &(Place, Place, Point)| stage(rods, &found.1);
    found.sort_by(|one, other| {
        let ((one, s), (other, other_s)) = (key(one), key(other));
        one.cmp(&other).then(s.total_cmp(&other_s))
    });
    found
}

/// The crossings of the patterns of one or two rods in the order of their second passes, with the
/// given passes.
///
/// # Errors
/// The knot cannot be tied in this way.
pub fn passages(rods: &[TiedRod<'_>], words: &[Pass]) -> Result<Vec<Passage>, TyingError> {
    let found = found(rods);
    if found.len() != words.len() {
        let (crossings, words) = (found.len(), words.len());
        return Err(if rods.len() == 1 {
            TyingError::Words { crossings, words }
        } else {
            TyingError::WordsOfTwo { crossings, words }
        });
    }
    if !rods.iter().any(TiedRod::is_led) {
        return Err(match rods {
            [only] => TyingError::NoPath {
                pattern_m: only.curve.length(),
                rod_m: only.rod.length,
            },
            _ => TyingError::NothingIsLed,
        });
    }
    let mut passages = Vec::with_capacity(found.len());
    for (index, ((first, second, place), &pass)) in found.into_iter().zip(words).enumerate() {
        let number = index + 1;
        if first.s > laid_length(rods[first.rod].rod) {
            return Err(TyingError::NothingThere {
                number,
                first_m: first.s,
                rod_m: rods[first.rod].rod.length,
            });
        }
        let rod = rods[second.rod].rod;
        let least = BEFORE_CROSSING * rod.gravito_bending_length;
        let is_led = second.s >= rod.length + least;
        let is_laid = second.s <= laid_length(rod) && pass == Pass::Over;
        if !(is_led || is_laid) {
            return Err(TyingError::LaidOver {
                number,
                second_m: second.s,
                rod_m: rod.length,
                least_m: least,
            });
        }
        passages.push(Passage {
            first,
            second,
            place,
            pass,
        });
    }
    Ok(passages)
}
