//! Which knot a rod on the table is tied into, and which its pattern.
//!
//! Both ends are raised straight up and joined far above the table, and, once more, lowered and joined far below it. Where
//! both closed curves have the same determinant, it does not matter how the ends are joined: that is the knot. Where they
//! differ an end lies within the loops of the rod, and it is no knot that holds.

use crate::knot::determinant_of_closed;
use crate::mechanics::Vector3;
use crate::plan::pattern::{Pattern, PatternPoint};
use crate::plan::tying::{Pass, Passage};

/// How far above and below the table ends are joined, in lengths of the curve.
const FAR: f64 = 3.0;
/// Points of a pattern.
const POINTS: usize = 1000;

/// The determinant of a rod on the table, joined above as well as below; `None` where they differ.
pub fn determinant_on_table(nodes: &[Vector3]) -> Option<u64> {
    let length: f64 = nodes
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).norm())
        .sum();
    let [above, below] = [FAR, -FAR].map(|far| {
        let raised = |node: &Vector3| node + far * length * Vector3::z();
        let mut closed = vec![raised(nodes.first()?)];
        closed.extend(nodes);
        closed.push(raised(nodes.last()?));
        determinant_of_closed(&closed)
    });
    above.filter(|_| above == below)
}

/// The same of a pattern by its passages.
pub fn determinant_of_pattern(curve: &Pattern, passages: &[Passage]) -> Option<u64> {
    let points = curve.sampled(curve.length() / POINTS as f64);
    // Heights at passages, first and second, in the order of arc length.
    let mut heights: Vec<(f64, f64)> = passages
        .iter()
        .flat_map(|passage| {
            let second = match passage.pass {
                Pass::Over => 1.0,
                Pass::Under => -1.0,
            };
            [(passage.first, -second), (passage.second, second)]
        })
        .collect();
    heights.sort_by(|one, other| one.0.total_cmp(&other.0));
    let height = |s: f64| {
        let scale = 0.01 * curve.length();
        crate::mechanics::scene::piecewise_linear(&heights, s).unwrap_or(0.0) * scale
    };
    let placed =
        |point: &PatternPoint| Vector3::new(point.position.x, point.position.y, height(point.s));
    determinant_on_table(&points.iter().map(placed).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::deployment::DeployedRod;
    use crate::plan::pattern::{PatternSource, chosen_stroke, read_svg};
    use crate::plan::tying::passages;

    fn trefoil() -> Pattern {
        let svg = include_str!("../../../scenarios/patterns/trefoil.svg");
        let points = chosen_stroke(read_svg(svg).unwrap(), None).unwrap();
        let source = PatternSource::Drawn {
            points,
            deviation: 2.5e-4,
        };
        source.pattern().unwrap()
    }

    #[test]
    fn alternating_crossings_are_a_trefoil_and_others_are_none() {
        use Pass::{Over, Under};
        let curve = trefoil();
        let rod = DeployedRod {
            gravito_bending_length: 0.0286,
            radius: 0.0032,
            length: 0.84,
        };
        for (words, determinant) in [
            ([Over, Under, Over], 3),
            ([Over, Over, Over], 1),
            ([Over, Under, Under], 1),
        ] {
            let passages = passages(&curve, &rod, &words).unwrap();
            assert_eq!(determinant_of_pattern(&curve, &passages), Some(determinant));
        }
    }

    #[test]
    fn an_end_within_a_loop_is_no_knot() {
        // An overhand loop whose end lies over its middle: a trefoil or not, as the end is raised or lowered.
        let curve = trefoil();
        let rod = DeployedRod {
            gravito_bending_length: 0.0286,
            radius: 0.0032,
            length: 0.84,
        };
        use Pass::{Over, Under};
        let passages = passages(&curve, &rod, &[Over, Under, Over]).unwrap();
        // It ends after it went under, before it goes over.
        let between = 0.5 * (passages[1].second + passages[2].second);
        let open = curve.shortened(between);
        assert_eq!(determinant_of_pattern(&open, &passages[..2]), None);
    }
}
