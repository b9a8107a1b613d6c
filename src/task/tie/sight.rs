//! The rod as the camera sees it, with what lies over what: which knot that is.

use crate::experiment::knot_on_table;
use crate::knot::KnotInvariants;
use crate::mechanics::Vector3;
use crate::mechanics::scene::piecewise_linear;
use crate::task::look::Seen;
use crate::vision::{Point, Strand, StrandCrossing, VisionError, find_crossings};
use image::RgbImage;
use serde::Serialize;

/// How sure it must be which strand lies on top: below, both are tried. Pictures of the virtual cell tell it with 0.2 to 0.9.
const SURE: f64 = 0.1;
/// Most crossings of which it is not sure: both orders of each are tried.
const MOST_UNSURE: usize = 8;
/// Height of what passes over a crossing, over the length of the rod: any will do.
const HEIGHT: f64 = 0.01;

/// A crossing that was seen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SeenCrossing {
    /// Where along the rod it comes there first, and where again, m.
    pub at_m: [f64; 2],
    /// Where, in the frame of the pattern, m.
    pub place_m: [f64; 2],
    /// Whether it lies over what was there when it comes there again.
    pub over: bool,
    /// How sure that is: 0 for a guess.
    pub confidence: f64,
}

/// A rod that was seen.
pub struct SeenRod {
    /// The rod in the frame of the pattern, m.
    pub curve: Vec<Point>,
    /// Its crossings, in the order in which it comes to them again.
    pub crossings: Vec<SeenCrossing>,
}

impl SeenRod {
    /// The longest strand in a picture, from the end that is nearer to `start`, m.
    ///
    /// # Errors
    /// A pixel shows no point of the table.
    pub fn of(picture: &RgbImage, seen: &Seen, start: Point) -> Result<Self, VisionError> {
        let (pixels, width) = seen.longest_in_picture(start)?;
        let strand = Strand {
            widths: vec![width; pixels.len()],
            points: pixels,
            closed: false,
        };
        let strands = std::slice::from_ref(&strand);
        let found = find_crossings(picture, strands);
        let places = strand.points.iter().map(|pixel| seen.place(*pixel));
        let curve = places.collect::<Result<Vec<_>, _>>()?;
        let lengths = lengths(&curve);
        let mut crossings = Vec::with_capacity(found.len());
        for crossing in &found {
            crossings.push(in_metres(crossing, &lengths, seen)?);
        }
        crossings.sort_by(|one, other| one.at_m[1].total_cmp(&other.at_m[1]));
        Ok(Self { curve, crossings })
    }

    /// Its length, m.
    pub fn length(&self) -> f64 {
        lengths(&self.curve).last().copied().unwrap_or(0.0)
    }

    /// Its knot: `Ok(None)` where it depends on how the ends are joined.
    ///
    /// # Errors
    /// In words: the picture does not decide.
    pub fn knot(&self) -> Result<Option<KnotInvariants>, String> {
        let numbered = self.crossings.iter().enumerate();
        let unsure: Vec<usize> = numbered
            .filter(|(_, crossing)| crossing.confidence < SURE)
            .map(|(index, _)| index)
            .collect();
        if unsure.len() > MOST_UNSURE {
            return Err(format!(
                "of {} crossings the picture does not show what lies on top",
                unsure.len()
            ));
        }
        let ways = (0..1_usize << unsure.len()).map(|way| {
            let mut over: Vec<bool> = self.crossings.iter().map(|known| known.over).collect();
            for (bit, index) in unsure.iter().enumerate() {
                over[*index] ^= way >> bit & 1 == 1;
            }
            self.knot_with(&over)
        });
        let mut knots: Vec<Option<KnotInvariants>> = ways.collect();
        knots.dedup();
        match knots.as_slice() {
            [only] => Ok(*only),
            _ => Err(format!(
                "the picture does not show what lies on top at {}",
                self.places_of(&unsure)
            )),
        }
    }

    fn places_of(&self, crossings: &[usize]) -> String {
        let places = crossings.iter().map(|index| {
            let [x, y] = self.crossings[*index].place_m;
            format!("{x:.3},{y:.3}")
        });
        places.collect::<Vec<_>>().join(" and ")
    }

    /// The knot where it comes to each of its crossings over, or under, what was there.
    fn knot_with(&self, over: &[bool]) -> Option<KnotInvariants> {
        let lengths = lengths(&self.curve);
        let high = HEIGHT * self.length();
        let mut heights: Vec<(f64, f64)> = self
            .crossings
            .iter()
            .zip(over)
            .flat_map(|(crossing, over)| {
                let [first, second] = crossing.at_m;
                let height = if *over { high } else { -high };
                [(first, -height), (second, height)]
            })
            .collect();
        heights.sort_by(|one, other| one.0.total_cmp(&other.0));
        let nodes = self.curve.iter().zip(&lengths).map(|(point, s)| {
            let height = piecewise_linear(&heights, *s).unwrap_or(0.0);
            Vector3::new(point.x, point.y, height)
        });
        knot_on_table(&[&nodes.collect::<Vec<_>>()])
    }
}

fn in_metres(
    crossing: &StrandCrossing,
    lengths: &[f64],
    seen: &Seen,
) -> Result<SeenCrossing, VisionError> {
    let place = seen.place(crossing.position)?;
    let along = |at: f64| {
        let index = (at as usize).min(lengths.len() - 2);
        lengths[index] + (at - index as f64) * (lengths[index + 1] - lengths[index])
    };
    let [over, under] = [along(crossing.over.at), along(crossing.under.at)];
    Ok(SeenCrossing {
        at_m: [over.min(under), over.max(under)],
        place_m: place.into(),
        over: over > under,
        confidence: crossing.confidence,
    })
}

/// Lengths along a curve, m.
fn lengths(curve: &[Point]) -> Vec<f64> {
    let mut lengths = vec![0.0];
    for pair in curve.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + (pair[1] - pair[0]).norm());
    }
    lengths
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rod along the trefoil of the repository, which passes its crossings so.
    fn trefoil(passes: [(bool, f64); 3]) -> SeenRod {
        use crate::plan::pattern::{PatternSource, chosen_stroke, crossings, read_svg};
        let svg = include_str!("../../../scenarios/patterns/trefoil.svg");
        let points = chosen_stroke(read_svg(svg).unwrap(), None).unwrap();
        let source = PatternSource::Drawn {
            points,
            deviation: 2.5e-4,
        };
        let sampled = source.pattern().unwrap().sampled(2e-3);
        let found = crossings(&sampled);
        let mut seen: Vec<SeenCrossing> = found
            .iter()
            .map(|crossing| SeenCrossing {
                at_m: [crossing.first, crossing.second],
                place_m: crossing.position.into(),
                over: true,
                confidence: 1.0,
            })
            .collect();
        seen.sort_by(|one, other| one.at_m[1].total_cmp(&other.at_m[1]));
        for (crossing, (over, confidence)) in seen.iter_mut().zip(passes) {
            (crossing.over, crossing.confidence) = (over, confidence);
        }
        SeenRod {
            curve: sampled.iter().map(|point| point.position).collect(),
            crossings: seen,
        }
    }

    #[test]
    fn a_knot_is_known_by_its_crossings_where_they_are_seen() {
        let seen = |over: [bool; 3], confidence: [f64; 3]| {
            let passes = [0, 1, 2].map(|k| (over[k], confidence[k]));
            trefoil(passes).knot()
        };
        let invariants = |determinant: u64, signature: i64| {
            Ok(Some(KnotInvariants {
                determinant,
                signature,
            }))
        };
        let alternating = [true, false, true];
        assert_eq!(seen(alternating, [1.0; 3]), invariants(3, -2));
        assert_eq!(seen([true; 3], [1.0; 3]), invariants(1, 0));
        // With the other order at one crossing there is no knot.
        let words = seen(alternating, [1.0, 0.01, 1.0]).unwrap_err();
        assert!(words.contains("does not show"), "{words}");
        // All of it lies over or under: whatever the first crossing is.
        let mut loose = trefoil([(true, 0.0), (true, 1.0), (true, 1.0)]);
        loose.crossings.truncate(1);
        assert_eq!(loose.knot(), invariants(1, 0));
    }
}
