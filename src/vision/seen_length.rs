//! Comparison of the length of a rod in a picture with its true length, to check that all of it is
//! visible.

use super::Point;
use super::score::polyline_length;
use serde::Serialize;
use std::fmt;

/// Greatest difference of the two lengths, as a fraction of the rod's length. A completely traced
/// rod is within 1 %, and a missing loop or end is longer than this tolerance.
const TOLERANCE: f64 = 0.03;

/// Length of a rod in a picture, and its true length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SeenLength {
    /// Length of the curve in the picture, m.
    pub seen_m: f64,
    /// Length of the rod, m.
    pub rod_m: f64,
    /// Smallest length that the picture should show, m. This is less than the length of the rod if
    /// the end of the rod is outside the picture, or fell onto the rod.
    pub least_m: f64,
}

impl SeenLength {
    /// The lengths of a curve that should be a whole rod with the given length, m.
    pub fn of(curve: &[Point], rod_m: f64) -> Self {
        Self {
            seen_m: polyline_length(curve),
            rod_m,
            least_m: rod_m,
        }
    }

    /// The lengths if the picture should show at least a given part of the rod, m.
    pub fn with_least(self, least_m: f64) -> Self {
        Self {
            least_m: least_m.min(self.rod_m),
            ..self
        }
    }

    /// Whether the curve has the required length, within 3 % of the rod's length.
    pub fn is_whole(&self) -> bool {
        let allowed = TOLERANCE * self.rod_m;
        self.seen_m >= self.least_m - allowed && self.seen_m <= self.rod_m + allowed
    }
}

impl fmt::Display for SeenLength {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let millimetres = |metres: f64| format!("{:.1} mm", 1e3 * metres);
        let [seen, rod, least] = [self.seen_m, self.rod_m, self.least_m].map(millimetres);
        write!(
            formatter,
            "the rod in the picture is {seen} long, but the rod is {rod} long"
        )?;
        if self.least_m < self.rod_m {
            write!(formatter, ", of which at least {least} should be seen")?;
        }
        write!(
            formatter,
            "; allowed: {:.0} % of its length",
            1e2 * TOLERANCE
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(length: f64) -> [Point; 2] {
        [Point::zeros(), Point::new(length, 0.0)]
    }

    #[test]
    fn a_rod_is_whole_within_three_percent_of_its_length() {
        for (seen, whole) in [
            (0.9, true),
            (0.874, true),
            (0.926, true),
            (0.872, false),
            (0.928, false),
            (0.45, false),
            (0.0, false),
            (f64::NAN, false),
        ] {
            let lengths = SeenLength::of(&line(seen), 0.9);
            assert_eq!(lengths.is_whole(), whole, "{lengths}");
        }
        let words = SeenLength::of(&line(0.45), 0.9).to_string();
        assert!(
            words.contains("450.0 mm") && words.contains("900.0 mm"),
            "{words}"
        );
    }

    #[test]
    fn an_end_that_cannot_be_seen_may_be_missing() {
        for (seen, whole) in [(0.88, true), (0.6, true), (0.572, false), (0.93, false)] {
            let lengths = SeenLength::of(&line(seen), 0.9).with_least(0.6);
            assert_eq!(lengths.is_whole(), whole, "{lengths}");
        }
        let words = SeenLength::of(&line(0.4), 0.9).with_least(0.6).to_string();
        assert!(words.contains("at least 600.0 mm"), "{words}");
    }
}
