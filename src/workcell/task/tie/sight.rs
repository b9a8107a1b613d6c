//! Rods in a picture of the camera, the order of strands at their crossings, and their knot.

use crate::cell::sums;
use crate::task::look::Seen;
use image::RgbImage;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::piecewise_linear;
use rodlab_lab::experiment::knot_on_table;
use rodlab_planning::knot::KnotInvariants;
use rodlab_vision::{Passage, Point, Strand, StrandCrossing, VisionError, find_crossings};
use serde::Serialize;

/// Least confidence in the order of strands at a crossing. Below it both orders are tried.
/// Pictures of the virtual cell give confidences of 0.2 to 0.9.
const SURE: f64 = 0.1;
/// Largest number of uncertain crossings, since both orders of each are tried.
const MOST_UNSURE: usize = 8;
/// Height of a strand that passes over a crossing, relative to the length of the rod; its value is
/// arbitrary.
const HEIGHT: f64 = 0.01;

/// A place along an observed rod.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize)]
pub struct SeenPlace {
    /// Number of the rod, from 1.
    pub rod: usize,
    /// Length along it, m.
    pub at_m: f64,
}

/// An observed crossing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SeenCrossing {
    /// The two places that cross: the rod with the lower number first; on one rod, the place
    /// nearer to its start first.
    pub places: [SeenPlace; 2],
    /// Position in the frame of the pattern, m.
    pub position_m: [f64; 2],
    /// Whether the strand of the second place is on top.
    pub over: bool,
    /// Confidence in the order of the strands: 0 for a guess.
    pub confidence: f64,
}

/// Observed rods.
pub struct SeenKnot {
    /// Curves of the rods in the frame of the pattern, m.
    pub curves: Vec<Vec<Point>>,
    /// Crossings of the rods.
    pub crossings: Vec<SeenCrossing>,
}

impl SeenKnot {
    /// Finds the rods in a picture that begin at `starts`, m; fewer if the picture has fewer
    /// strands.
    ///
    /// # Errors
    /// A pixel shows no point of the table.
    pub fn of(picture: &RgbImage, seen: &Seen, starts: &[Point]) -> Result<Self, VisionError> {
        let strands = seen.in_picture(starts)?.into_iter();
        let strands = strands.map(|(points, width)| Strand {
            widths: vec![width; points.len()],
            points,
            closed: false,
        });
        let strands: Vec<Strand> = strands.collect();
        let curves = strands.iter().map(|strand| {
            let places = strand.points.iter().map(|pixel| seen.place(*pixel));
            places.collect::<Result<Vec<Point>, _>>()
        });
        let curves = curves.collect::<Result<Vec<_>, _>>()?;
        let lengths: Vec<Vec<f64>> = curves.iter().map(|curve| lengths(curve)).collect();
        let found = find_crossings(picture, &strands).into_iter();
        let crossings = found.map(|crossing| in_metres(&crossing, &lengths, seen));
        let mut crossings = crossings.collect::<Result<Vec<_>, _>>()?;
        crossings.sort_by(|one, other| {
            let [one, other] = [one, other].map(|crossing| crossing.places[1]);
            one.rod
                .cmp(&other.rod)
                .then(one.at_m.total_cmp(&other.at_m))
        });
        Ok(Self { curves, crossings })
    }

    /// The length of each rod, m.
    pub fn lengths(&self) -> Vec<f64> {
        let lengths = self.curves.iter().map(|curve| lengths(curve));
        lengths
            .map(|lengths| lengths.last().copied().unwrap_or(0.0))
            .collect()
    }

    /// The knot of the rods: `Ok(None)` if it depends on how the ends are joined.
    ///
    /// # Errors
    /// A message: the picture does not show the knot.
    pub fn knot(&self) -> Result<Option<KnotInvariants>, String> {
        let numbered = self.crossings.iter().enumerate();
        let unsure: Vec<usize> = numbered
            .filter(|(_, crossing)| crossing.confidence < SURE)
            .map(|(index, _)| index)
            .collect();
        if unsure.len() > MOST_UNSURE {
            return Err(format!(
                "the picture does not show which strand is on top at {} crossings",
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
                "the picture does not show which strand is on top at {}",
                self.places_of(&unsure)
            )),
        }
    }

    fn places_of(&self, crossings: &[usize]) -> String {
        let places = crossings.iter().map(|index| {
            let [x, y] = self.crossings[*index].position_m;
            format!("{x:.3},{y:.3}")
        });
        places.collect::<Vec<_>>().join(" and ")
    }

    /// The knot if the second place of each crossing is on top where `over` is true, and below
    /// otherwise.
    fn knot_with(&self, over: &[bool]) -> Option<KnotInvariants> {
        let high = HEIGHT * self.lengths().iter().sum::<f64>();
        let placed = self.curves.iter().enumerate().map(|(index, curve)| {
            let crossings = self.crossings.iter().zip(over);
            let heights = crossings.flat_map(|(crossing, over)| {
                let height = if *over { high } else { -high };
                let [first, second] = crossing.places;
                [(first, -height), (second, height)]
            });
            let of_rod = heights.filter(|(place, _)| place.rod == index + 1);
            let mut heights: Vec<(f64, f64)> =
                of_rod.map(|(place, height)| (place.at_m, height)).collect();
            heights.sort_by(|one, other| one.0.total_cmp(&other.0));
            let nodes = curve.iter().zip(lengths(curve)).map(|(point, s)| {
                let height = piecewise_linear(&heights, s).unwrap_or(0.0);
                Vector3::new(point.x, point.y, height)
            });
            nodes.collect::<Vec<_>>()
        });
        let placed: Vec<Vec<Vector3>> = placed.collect();
        knot_on_table(&placed.iter().map(Vec::as_slice).collect::<Vec<_>>())
    }
}

fn in_metres(
    crossing: &StrandCrossing,
    lengths: &[Vec<f64>],
    seen: &Seen,
) -> Result<SeenCrossing, VisionError> {
    let place = |passage: &Passage| {
        let lengths = &lengths[passage.strand];
        let index = (passage.at as usize).min(lengths.len().saturating_sub(2));
        let step = lengths[index + 1] - lengths[index];
        SeenPlace {
            rod: passage.strand + 1,
            at_m: lengths[index] + (passage.at - index as f64) * step,
        }
    };
    let [over, under] = [&crossing.over, &crossing.under].map(place);
    let is_over = over > under;
    Ok(SeenCrossing {
        places: if is_over {
            [under, over]
        } else {
            [over, under]
        },
        position_m: seen.place(crossing.position)?.into(),
        over: is_over,
        confidence: crossing.confidence,
    })
}

/// Cumulative lengths along a curve, m.
fn lengths(curve: &[Point]) -> Vec<f64> {
    let pairs = curve.windows(2);
    sums(pairs.map(|pair| (pair[1] - pair[0]).norm()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rod along the trefoil of the repository, with the given order and confidence at each
    /// crossing.
    fn trefoil(passes: [(bool, f64); 3]) -> SeenKnot {
        use rodlab_planning::plan::pattern::{PatternSource, chosen_stroke, crossings, read_svg};
        let svg = include_str!("../../../../scenarios/patterns/trefoil.svg");
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
                places: [crossing.first, crossing.second].map(|at_m| SeenPlace { rod: 1, at_m }),
                position_m: crossing.position.into(),
                over: true,
                confidence: 1.0,
            })
            .collect();
        seen.sort_by(|one, other| one.places[1].at_m.total_cmp(&other.places[1].at_m));
        for (crossing, (over, confidence)) in seen.iter_mut().zip(passes) {
            (crossing.over, crossing.confidence) = (over, confidence);
        }
        SeenKnot {
            curves: vec![sampled.iter().map(|point| point.position).collect()],
            crossings: seen,
        }
    }

    #[test]
    fn a_knot_is_identified_from_visible_crossings() {
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
        // The middle crossing is uncertain; with its other order the curve is unknotted.
        let words = seen(alternating, [1.0, 0.01, 1.0]).unwrap_err();
        assert!(words.contains("does not show"), "{words}");
        // The order at two crossings does not matter here, whatever the order at the first one is.
        let mut loose = trefoil([(true, 0.0), (true, 1.0), (true, 1.0)]);
        loose.crossings.truncate(1);
        assert_eq!(loose.knot(), invariants(1, 0));
    }
}
