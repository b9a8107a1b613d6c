//! How a pattern comes to its crossings again.

use crate::plan::deployment::DeployedRod;
use crate::plan::pattern::{Pattern, Point, crossings};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Distance of points of the pattern between which crossings are looked for, m.
const SPACING: f64 = 1e-3;
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

/// A crossing of a pattern with itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Arc length at which the pattern comes there first, m.
    pub first: f64,
    /// Arc length at which it comes there again, m.
    pub second: f64,
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

/// The crossings of a pattern in the order in which it comes to them again, with the words that say how.
///
/// # Errors
/// The knot cannot be tied so.
pub fn passages(
    curve: &Pattern,
    rod: &DeployedRod,
    words: &[Pass],
) -> Result<Vec<Passage>, TyingError> {
    let mut found = crossings(&curve.sampled(SPACING));
    found.sort_by(|one, other| one.second.total_cmp(&other.second));
    if found.len() != words.len() {
        return Err(TyingError::Words {
            crossings: found.len(),
            words: words.len(),
        });
    }
    if curve.length() <= rod.length {
        return Err(TyingError::NoPath {
            pattern_m: curve.length(),
            rod_m: rod.length,
        });
    }
    let laid = laid_length(rod);
    let least = BEFORE_CROSSING * rod.gravito_bending_length;
    let mut passages = Vec::with_capacity(found.len());
    for (index, (crossing, &pass)) in found.iter().zip(words).enumerate() {
        let number = index + 1;
        if crossing.first > laid {
            return Err(TyingError::NothingThere {
                number,
                first_m: crossing.first,
                rod_m: rod.length,
            });
        }
        let is_led = crossing.second >= rod.length + least;
        let is_laid = crossing.second <= laid && pass == Pass::Over;
        if !(is_led || is_laid) {
            return Err(TyingError::LaidOver {
                number,
                second_m: crossing.second,
                rod_m: rod.length,
                least_m: least,
            });
        }
        passages.push(Passage {
            first: crossing.first,
            second: crossing.second,
            place: crossing.position,
            pass,
        });
    }
    Ok(passages)
}
