//! How patterns come to their crossings again.

use crate::plan::deployment::DeployedRod;
use crate::plan::pattern::{Pattern, PatternPoint, Point, crossings, crossings_of_two};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Distance of points of the pattern between which crossings are looked for, m.
const SPACING: f64 = 1e-3;
/// Points of a pattern, at most: of a longer one they lie farther apart.
const MOST_POINTS: f64 = 4_000.0;
/// Length of the rod that is still held when the rest lies, in gravito-bending lengths l̄: its end is l̄⁴/48 above the rest then,
/// so that a gripper that trembles does not meet the table.
const HELD: f64 = 1.6;
/// Least way of the end before a crossing, in gravito-bending lengths.
const BEFORE_CROSSING: f64 = 1.0;

/// How a rod comes to a crossing for the second time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Pass {
    /// Over what lies there.
    Over,
    /// Under it.
    Under,
}

/// A rod that is laid along a pattern. Where the pattern is longer than the rod, its rest is the path of the rod's end.
#[derive(Clone, Copy)]
pub struct TiedRod<'a> {
    /// The rod.
    pub rod: &'a DeployedRod,
    /// The pattern.
    pub curve: &'a Pattern,
}

impl TiedRod<'_> {
    /// Whether its end is led on when it is laid.
    pub fn is_led(&self) -> bool {
        self.curve.length() > self.rod.length
    }
}

/// A place along the pattern of a rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Number of the rod, from 0, in the order in which they are laid.
    pub rod: usize,
    /// Arc length, m.
    pub s: f64,
}

/// A crossing of a pattern with itself or with another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Where a rod comes there first.
    pub first: Place,
    /// Where it comes there again, or another one does.
    pub second: Place,
    /// The place, m.
    pub place: Point,
    /// How it passes the second time.
    pub pass: Pass,
}

/// Why a knot cannot be tied along a pattern.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TyingError {
    /// Not as many words as crossings.
    #[error(
        "crossings that the pattern comes to again: {crossings}; passes given: {words}; say \"over\" or \"under\" for each, in the order \
         in which it comes there"
    )]
    Words {
        /// Crossings of the pattern.
        crossings: usize,
        /// Words.
        words: usize,
    },
    /// The same of two rods.
    #[error(
        "crossings that the rods come to again: {crossings}; passes given: {words}; say \"over\" or \"under\" for each, in the order in \
         which rods come there: first the second rod as it is laid, then its end as it is led, then that of the first"
    )]
    WordsOfTwo {
        /// Crossings of the patterns.
        crossings: usize,
        /// Words.
        words: usize,
    },
    /// Nothing is led.
    #[error(
        "neither pattern is longer than its rod: what goes on is the path along which the end of the rod is led, under a strand of the \
         other; without it the second rod lies on the first, and no knot arises"
    )]
    NothingIsLed,
    /// There is no path for the end.
    #[error(
        "the pattern is {pattern_m:.4} m long, and the rod {rod_m} m: the rest of the pattern is the path along which the end of the \
         rod is led, so that it must be longer than the rod"
    )]
    NoPath {
        /// Length of the pattern, m.
        pattern_m: f64,
        /// Length of the rod, m.
        rod_m: f64,
    },
    /// A laid rod cannot go under.
    #[error(
        "crossing {number} lies at {second_m:.4} m of the pattern, which the rod of {rod_m} m covers when it is laid: it goes over \
         there; to be led under, its end must stop {least_m:.4} m before"
    )]
    LaidOver {
        /// Number of the crossing, from 1.
        number: usize,
        /// Where the pattern comes to it again, m.
        second_m: f64,
        /// Length of the rod, m.
        rod_m: f64,
        /// Least way of the end before it, m.
        least_m: f64,
    },
    /// The path of the end crosses itself.
    #[error(
        "crossing {number} lies at {first_m:.4} m of the pattern when it comes there first, where no rod of {rod_m} m lies yet"
    )]
    NothingThere {
        /// Number of the crossing, from 1.
        number: usize,
        /// Where the pattern comes to it first, m.
        first_m: f64,
        /// Length of the rod, m.
        rod_m: f64,
    },
}

/// The length of pattern along which a rod is laid before its end is led on, m.
pub fn laid_length(rod: &DeployedRod) -> f64 {
    rod.length - HELD * rod.gravito_bending_length
}

/// When a rod comes to a place: rods are laid one after the other, and the last one's end is the first to be led.
fn stage(rods: &[TiedRod<'_>], place: &Place) -> (usize, f64) {
    if place.s <= rods[place.rod].rod.length {
        (place.rod, place.s)
    } else {
        (2 * rods.len() - place.rod, place.s)
    }
}

/// The crossings of patterns, in the order in which rods come to them again.
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

/// The crossings of the patterns of one or two rods in the order in which they are come to again, with the words that say how.
///
/// # Errors
/// The knot cannot be tied so.
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
