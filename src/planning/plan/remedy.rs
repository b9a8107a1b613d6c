//! Remedies for a pattern that cannot be laid: another size, or a larger deviation from the
//! drawing.

use super::deployment::{DeployedRod, DeploymentError, Spare, checked_points, long_enough};
use super::grasp::{GraspError, GraspProblem};
use super::pattern::{Drawing, PatternError, PatternSource, Point, bounds};
use super::request::{DeploymentRequest, RequestError};
use std::fmt;

/// Largest proposed deviation, relative to the longer side of the drawing.
const LARGEST_DEVIATION: f64 = 0.1;
/// Fractions of the longest possible pattern that are tried as lengths of a scaled pattern.
const LENGTHS: [f64; 4] = [0.9, 0.75, 0.5, 0.25];
/// Number of bisections, on a logarithmic scale, between a deviation that fails and one that
/// works.
const HALVINGS: usize = 4;
/// Ratio of successive deviations in the search for these.
const STEP: f64 = 1.6;

/// Proposed values of the options.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remedy {
    /// Length of the longer side of the drawing, m; `None` to keep it.
    pub size: Option<f64>,
    /// Deviation from the drawing, m; `None` to keep it.
    pub deviation: Option<f64>,
}

impl Changes {
    /// Nothing may change.
    pub const NONE: Self = Self {
        size: false,
        deviation: false,
    };
}

impl Remedy {
    /// The drawing with these values; a formula stays as it is.
    ///
    /// # Errors
    /// The drawing has no extent that could be scaled.
    pub fn applied(self, source: PatternSource) -> Result<PatternSource, PatternError> {
        let PatternSource::Drawn { points, deviation } = source else {
            return Ok(source);
        };
        let whole = Drawing {
            size: self.size,
            reverse: false,
        };
        Ok(PatternSource::Drawn {
            points: whole.of(points)?,
            deviation: self.deviation.unwrap_or(deviation),
        })
    }
}

impl fmt::Display for Remedy {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let options = [("--size", self.size), ("--deviation", self.deviation)];
        let given = options
            .iter()
            .filter_map(|(name, length)| Some((name, (*length)?)));
        for (index, (name, length)) in given.enumerate() {
            let space = if index == 0 { "" } else { " " };
            write!(formatter, "{space}{name} \"{} mm\"", 1e3 * length)?;
        }
        Ok(())
    }
}

/// Which properties of a drawing may change without a question.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Changes {
    /// Its size.
    pub size: bool,
    /// The deviation of the smooth curve from it.
    pub deviation: bool,
}

impl DeploymentRequest<'_> {
    /// The smallest change of a drawing with which it can be planned, if it cannot be planned as it
    /// is and only the allowed properties change; the deviation by at most a tenth of its longer
    /// side.
    pub fn allowed_remedy(
        &self,
        source: &PatternSource,
        rod: &DeployedRod,
        allowed: Changes,
    ) -> Option<Remedy> {
        if allowed == Changes::NONE || self.check(source, rod).is_ok() {
            return None;
        }
        let remedy = self.remedy(source, rod, &Spare::HANGS)?;
        let is_allowed = (remedy.size.is_none() || allowed.size)
            && (remedy.deviation.is_none() || allowed.deviation);
        is_allowed.then_some(remedy)
    }

    /// The smallest change with which a drawing can be planned: only its deviation if that is
    /// enough, otherwise also its size. A complete plan verifies it. `None` if nothing is found,
    /// or if the pattern is a formula.
    pub fn remedy(
        &self,
        source: &PatternSource,
        rod: &DeployedRod,
        spare: &Spare<'_>,
    ) -> Option<Remedy> {
        let PatternSource::Drawn { points, deviation } = source else {
            return None;
        };
        let [length, side] = [source.drawn_length(), longer_side(points)];
        if !(length > 0.0 && side > 0.0) {
            return None;
        }
        let longest = rod.length - GraspProblem::LENGTHS[0] * rod.gravito_bending_length;
        let as_drawn = (length < longest).then_some(1.0);
        let scaled = LENGTHS.iter().map(|part| part * longest / length);
        let scales = as_drawn
            .into_iter()
            .chain(scaled)
            .filter(|scale| *scale > 0.0);
        let mut scales = scales.map(|scale| {
            let size = (scale != 1.0).then(|| rounded(scale * side, f64::floor));
            (size, size.unwrap_or(side))
        });
        scales.find_map(|(size, side)| {
            let whole = Drawing {
                size,
                reverse: false,
            };
            let points = whole.of(points.clone()).ok()?;
            let drawn = |deviation: f64| PatternSource::Drawn {
                points: points.clone(),
                deviation,
            };
            let most = deviation.max(LARGEST_DEVIATION * side);
            let least = self.least_deviation(*deviation, most, rod, &drawn)?;
            // The complete plan may need a larger deviation.
            let works = [1.0, STEP, STEP * STEP]
                .iter()
                .map(|factor| match least == *deviation {
                    true if *factor == 1.0 => *deviation,
                    _ => rounded(factor * least, f64::ceil),
                });
            let deviation = works
                .filter(|tried| *tried <= most)
                .filter(|tried| self.plan(&drawn(*tried), rod, spare).is_ok())
                .map(|tried| (tried != *deviation).then_some(tried))
                .next()?;
            Some(Remedy { size, deviation })
        })
    }

    /// The least deviation up to `most`, m, for which the rod is long enough and thin enough for a
    /// drawing.
    fn least_deviation(
        &self,
        given: f64,
        most: f64,
        rod: &DeployedRod,
        drawn: &dyn Fn(f64) -> PatternSource,
    ) -> Option<f64> {
        let can_be_laid = |deviation: f64| self.check(&drawn(deviation), rod).is_ok();
        if can_be_laid(given) {
            return Some(given);
        }
        let mut tried = (1..).map(|power| given * STEP.powi(power));
        let mut high = tried.find(|deviation| *deviation > most || can_be_laid(*deviation))?;
        if high > most {
            return None;
        }
        let mut low = high / STEP;
        for _ in 0..HALVINGS {
            let middle = (low * high).sqrt();
            match can_be_laid(middle) {
                true => high = middle,
                false => low = middle,
            }
        }
        Some(high)
    }

    /// Checks of a plan that need no poses.
    fn check(&self, source: &PatternSource, rod: &DeployedRod) -> Result<(), RequestError> {
        let pattern = self.pattern(source, rod)?;
        long_enough(rod, &pattern)?;
        let most = GraspProblem::LARGEST_CURVATURE / rod.gravito_bending_length;
        let points = checked_points(&pattern, self.step, rod)?;
        match points.iter().find(|point| point.curvature.abs() > most) {
            Some(point) => Err(DeploymentError::Grasp {
                s_m: point.s,
                error: GraspError::Curvature(point.curvature * rod.gravito_bending_length),
            }
            .into()),
            None => Ok(()),
        }
    }
}

/// The longer side of the bounding box of points, m.
fn longer_side(points: &[Point]) -> f64 {
    let [low, high] = bounds(points);
    (high - low).max()
}

/// Rounds a length to two digits in millimetres, m.
fn rounded(length: f64, to: fn(f64) -> f64) -> f64 {
    let digits = libm::floor(libm::log10(1e3 * length)) as i32 - 1;
    // Uses whole powers of ten, so that the number is printed with two digits.
    let millimetres = match digits >= 0 {
        true => to(1e3 * length / 10f64.powi(digits)) * 10f64.powi(digits),
        false => to(1e3 * length * 10f64.powi(-digits)) / 10f64.powi(-digits),
    };
    millimetres / 1e3
}

#[cfg(test)]
mod tests {
    use super::super::pattern::Line;
    use super::*;

    const ROD: DeployedRod = DeployedRod {
        gravito_bending_length: 0.02,
        radius: 1.6e-3,
        length: 0.9,
    };

    fn corner(size: f64) -> PatternSource {
        let points = [[0.0, 0.0], [size, 0.0], [size, size]].map(Point::from);
        PatternSource::Drawn {
            points: points.to_vec(),
            deviation: 2.5e-4,
        }
    }

    #[test]
    fn a_rod_that_cannot_be_held_is_refused_with_the_allowed_lengths() {
        let request = DeploymentRequest::default();
        for (relative, is_allowed) in [(250.0, false), (100.1, false), (99.9, true)] {
            let rod = DeployedRod {
                length: relative * ROD.gravito_bending_length,
                ..ROD
            };
            let line = PatternSource::Line(Line { length: 0.05 });
            let planned = request.plan(&line, &rod, &Spare::HANGS);
            let Err(error) = planned else {
                assert!(is_allowed, "{relative}");
                continue;
            };
            let error = error.to_string();
            assert!(
                !is_allowed && error.contains("allowed: 0.0020 m to 2.0000 m"),
                "{relative}: {error}"
            );
        }
    }

    #[test]
    fn only_allowed_properties_change_and_corners_only_a_little() {
        let request = DeploymentRequest::default();
        let changed =
            |size: f64, changes: Changes| request.allowed_remedy(&corner(size), &ROD, changes);
        let [deviation, both] = [false, true].map(|size| Changes {
            size,
            deviation: true,
        });
        assert_eq!(changed(0.1, Changes::NONE), None);
        let round = changed(0.1, deviation).unwrap();
        assert_eq!(round.size, None);
        assert!(
            round.deviation.unwrap() <= LARGEST_DEVIATION * 0.1,
            "{round}"
        );
        let round = round.applied(corner(0.1)).unwrap();
        assert!(request.plan(&round, &ROD, &Spare::HANGS).is_ok());
        // It can be laid now.
        assert_eq!(request.allowed_remedy(&round, &ROD, both), None);
        // Too long for the rod, and, when it is small enough, with a corner.
        assert_eq!(changed(10.0, deviation), None);
        let small = changed(10.0, both).unwrap();
        assert!(small.size.is_some_and(|size| size < 1.0), "{small}");
        let small = small.applied(corner(10.0)).unwrap();
        assert!(request.plan(&small, &ROD, &Spare::HANGS).is_ok());
        // The corner of a drawing of the size of the rod's radius would be rounded away.
        assert_eq!(changed(0.004, deviation), None);
    }

    #[test]
    fn proposed_values_work_and_smaller_ones_do_not() {
        let request = DeploymentRequest::default();
        let spare = Spare::HANGS;
        for (size, is_scaled) in [(0.1, false), (10.0, true), (0.002, true)] {
            let source = corner(size);
            let remedy = request.remedy(&source, &ROD, &spare).expect("a remedy");
            assert_eq!(remedy.size.is_some(), is_scaled, "{size}: {remedy}");
            let PatternSource::Drawn { points, deviation } = source else {
                unreachable!("drawn above");
            };
            let drawing = Drawing {
                size: remedy.size,
                reverse: false,
            };
            let points = drawing.of(points).unwrap();
            let changed = |deviation: f64| PatternSource::Drawn {
                points: points.clone(),
                deviation,
            };
            let deviation = remedy.deviation.unwrap_or(deviation);
            assert!(
                request.plan(&changed(deviation), &ROD, &spare).is_ok(),
                "{remedy}"
            );
            if !is_scaled {
                assert!(
                    request.check(&changed(0.8 * deviation), &ROD).is_err(),
                    "{remedy}"
                );
            }
        }
    }

    #[test]
    fn options_are_written_as_they_are_taken() {
        let remedy = Remedy {
            size: Some(rounded(0.123_456, f64::floor)),
            deviation: Some(rounded(0.000_512_3, f64::ceil)),
        };
        assert_eq!(
            remedy.to_string(),
            "--size \"120 mm\" --deviation \"0.52 mm\""
        );
    }
}
