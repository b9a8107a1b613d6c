//! Knot type of rods on the table, and of their patterns.
//!
//! The ends of a rod are extended straight up and joined far above the table; for a second closed
//! curve they are extended down and joined far below it. With two rods the end of each is joined
//! to the start of the other, so that the closed curve follows both rods forwards. The two joining
//! paths have different heights. If both closed curves have the same determinant and signature, the
//! knot does not depend on how ends are joined. If they differ, an end lies within the loops of a
//! rod, and the knot does not hold.
//!
//! A reef knot has two bights. Each comes from one side and returns to it through the other bight.
//! B enters from the right below the upper strand of A's bight and returns below the lower strand,
//! or passes above both. Two paths close the curve: one above the knot from A's end on the left to
//! B's start on the right, and one below it from B's end to A's start. They cross nothing. Six
//! crossings remain, three of the upper strands and three of the lower strands, each group
//! alternating over and under: two trefoils in a row on one closed curve. A mirror along the axis
//! of the knot maps the upper crossings onto the lower ones and keeps over and under. One trefoil
//! is therefore the mirror image of the other: 3₁ # m(3₁), with determinant 3·3 and signature
//! 2 − 2. In a granny knot B enters above and returns below. Both trefoils are then the same, and
//! the signature is ±4. Without a knot the determinant is 1.

use rodlab_engine::mechanics::{Vector3, scene::piecewise_linear};
use rodlab_planning::knot::KnotInvariants;
use rodlab_planning::plan::pattern::{Pattern, PatternPoint};
use rodlab_planning::plan::tying::{Pass, Passage};

/// Distance from the table at which ends are joined, in lengths of the curves, and the ratio of
/// this distance for the second path to that for the first.
const FAR: f64 = 3.0;
const FARTHER: f64 = 1.5;
/// Points of a pattern.
const POINTS: usize = 1000;

/// The knot of one or two rods on the table, if joining above and below gives the same knot;
/// `None` otherwise.
pub fn knot_on_table(rods: &[&[Vector3]]) -> Option<KnotInvariants> {
    let edges = rods.iter().flat_map(|rod| rod.windows(2));
    let length: f64 = edges.map(|edge| (edge[1] - edge[0]).norm()).sum();
    let [above, below] = [FAR, -FAR].map(|far| {
        let raised = |node: &Vector3, far: f64| node + far * length * Vector3::z();
        let mut closed = Vec::new();
        for (number, rod) in rods.iter().enumerate() {
            // The path to the start of the first rod is the farther one.
            let [to_start, from_end] = match (number, rods.len()) {
                (0, 2) => [FARTHER * far, far],
                (1, 2) => [far, FARTHER * far],
                _ => [far, far],
            };
            closed.push(raised(rod.first()?, to_start));
            closed.extend(rod.iter().copied());
            closed.push(raised(rod.last()?, from_end));
        }
        KnotInvariants::of_closed(&closed)
    });
    above.filter(|_| above == below)
}

/// The knot of patterns, given their passages.
pub fn knot_of_patterns<'a>(
    curves: impl IntoIterator<Item = &'a Pattern>,
    passages: &[Passage],
) -> Option<KnotInvariants> {
    let placed = curves.into_iter().enumerate().map(|(number, curve)| {
        // Heights at passages, in the order of arc length.
        let mut heights: Vec<(f64, f64)> = passages
            .iter()
            .flat_map(|passage| {
                let second = match passage.pass {
                    Pass::Over => 1.0,
                    Pass::Under => -1.0,
                };
                [(passage.first, -second), (passage.second, second)]
            })
            .filter(|(place, _)| place.rod == number)
            .map(|(place, height)| (place.s, height))
            .collect();
        heights.sort_by(|one, other| one.0.total_cmp(&other.0));
        let scale = 0.01 * curve.length();
        let height = |s: f64| piecewise_linear(&heights, s).unwrap_or(0.0) * scale;
        let points = curve.sampled(curve.length() / POINTS as f64).into_iter();
        let place =
            |point: PatternPoint| Vector3::new(point.position.x, point.position.y, height(point.s));
        points.map(place).collect()
    });
    let placed: Vec<Vec<Vector3>> = placed.collect();
    knot_on_table(&placed.iter().map(Vec::as_slice).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use Pass::{Over, Under};
    use rodlab_planning::knot::{KnotSize, TwoThrows};
    use rodlab_planning::plan::deployment::DeployedRod;
    use rodlab_planning::plan::pattern::{PatternSource, chosen_stroke, read_svg};
    use rodlab_planning::plan::tying::{TiedRod, passages};

    const ROD: DeployedRod = DeployedRod {
        gravito_bending_length: 0.0286,
        radius: 0.0032,
        length: 0.84,
    };

    fn trefoil() -> Pattern {
        let svg = include_str!("../../../../scenarios/patterns/trefoil.svg");
        let points = chosen_stroke(read_svg(svg).unwrap(), None).unwrap();
        let source = PatternSource::Drawn {
            points,
            deviation: 2.5e-4,
        };
        source.pattern().unwrap()
    }

    fn tied(curve: &Pattern, words: &[Pass]) -> Vec<Passage> {
        passages(&[TiedRod { rod: &ROD, curve }], words).unwrap()
    }

    #[test]
    fn alternating_crossings_are_a_trefoil_and_others_are_none() {
        let curve = trefoil();
        for (words, determinant, signature) in [
            ([Over, Under, Over], 3, 2),
            ([Over, Over, Over], 1, 0),
            ([Over, Under, Under], 1, 0),
        ] {
            let passages = tied(&curve, &words);
            let found = knot_of_patterns(&[trefoil()], &passages).unwrap();
            assert_eq!(
                (found.determinant, found.signature.abs()),
                (determinant, signature)
            );
        }
    }

    #[test]
    fn an_end_within_a_loop_is_not_a_knot() {
        // An overhand loop with its end over its middle. It is a trefoil if the end is raised, but
        // not if it is lowered, or vice versa.
        let curve = trefoil();
        let passages = tied(&curve, &[Over, Under, Over]);
        // The curve ends after it went under, and before it goes over.
        let between = 0.5 * (passages[1].second.s + passages[2].second.s);
        let open = curve.shortened(between);
        assert_eq!(knot_of_patterns(&[open], &passages[..2]), None);
    }

    /// The two rods of a knot with two throws, laid flat. The second one is reversed, since its
    /// end is joined to the start of the first.
    fn lying(throws: TwoThrows) -> [Vec<Vector3>; 2] {
        let size = KnotSize {
            length: 1.0,
            radius: 1.6e-3,
            end_to_end: 0.6,
        };
        let [first, mut second] = throws.nodes(&size, 401).unwrap();
        second.reverse();
        [first, second]
    }

    #[test]
    fn reef_granny_and_no_knot_are_distinguished() {
        for (throws, determinant, signature) in [(TwoThrows::REEF, 9, 0), (TwoThrows::GRANNY, 9, 4)]
        {
            let [first, second] = lying(throws);
            let found = knot_on_table(&[&first, &second]).unwrap();
            assert_eq!(
                (found.determinant, found.signature.abs()),
                (determinant, signature)
            );
        }
        // One rod lies over the other everywhere.
        let [first, second] = lying(TwoThrows::REEF);
        let flat = |rod: &[Vector3], height: f64| -> Vec<Vector3> {
            let at = |(index, node): (usize, &Vector3)| {
                Vector3::new(node.x, node.y, height + 1e-6 * index as f64)
            };
            rod.iter().enumerate().map(at).collect()
        };
        let found = knot_on_table(&[&flat(&first, 0.0), &flat(&second, 0.01)]).unwrap();
        assert_eq!((found.determinant, found.signature), (1, 0));
    }
}
