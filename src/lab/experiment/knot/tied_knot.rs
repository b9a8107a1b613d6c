//! The rods of a knot as specified by a scenario: tied from numbers, or laid along a curve.

use super::{Knot, KnotKind, KnotStart};
use crate::experiment::prepare::curve::sample;
use crate::scenario::{BuilderRod, Issue, KeyPath, Shape};
use rodlab_engine::mechanics::Vector3;
use rodlab_planning::knot::{
    FIGURE_EIGHT_DETERMINANT, FISHERMAN_DETERMINANT, KnotSize, Overhand, TwoThrows, determinant,
    determinant_of_pair, figure_eight_nodes, fisherman_nodes, overhand_nodes,
};

/// The rods of a knot before they settle.
#[derive(Clone, Debug)]
pub struct TiedKnot {
    /// Nodes of each rod, m.
    pub rods: Vec<Vec<Vector3>>,
    /// Whether the rods are tied from numbers, with their ends along the x axis.
    pub is_built: bool,
}

/// Lays the rods of a knot.
///
/// # Errors
/// The knot does not fit between the ends, or a curve is not the required knot, or intersects
/// itself.
pub fn tie(rod: &BuilderRod, knot: &Knot) -> Result<TiedKnot, Issue> {
    match &knot.start {
        KnotStart::Tied(kind) => {
            let rods = from_numbers(*kind, rod, knot).map_err(|message| {
                Issue::new(KeyPath::from("knot").key("end_to_end"), message).with_help(
                    "change the length of the rod or the distance of its ends".to_owned(),
                )
            });
            Ok(TiedKnot {
                rods: rods?,
                is_built: true,
            })
        }
        KnotStart::Curve { kind, points } => {
            let shape = Shape::Points {
                points: points.clone(),
            };
            let nodes = sample(&shape, rod.nodes - 1, false).nodes;
            refuse_other_knots(&nodes, *kind)
                .map_err(|message| Issue::new(KeyPath::from("knot").key("curve"), message))?;
            Ok(TiedKnot {
                rods: vec![nodes],
                is_built: false,
            })
        }
    }
}

fn from_numbers(
    kind: KnotKind,
    rod: &BuilderRod,
    knot: &Knot,
) -> Result<Vec<Vec<Vector3>>, String> {
    let size = KnotSize {
        length: knot.length,
        radius: rod.radius,
        end_to_end: knot.end_to_end,
    };
    let two_throws = |throws: TwoThrows| throws.nodes(&size, rod.nodes).map(Vec::from);
    match kind {
        KnotKind::Overhand { unknotting_number } => {
            let overhand = Overhand {
                unknotting_number,
                length: knot.length,
                radius: rod.radius,
                end_to_end: knot.end_to_end,
            };
            overhand_nodes(&overhand, rod.nodes).map(|nodes| vec![nodes])
        }
        KnotKind::FigureEight => figure_eight_nodes(&size, rod.nodes).map(|nodes| vec![nodes]),
        KnotKind::Reef => two_throws(TwoThrows::REEF),
        KnotKind::Granny => two_throws(TwoThrows::GRANNY),
        KnotKind::Surgeon => two_throws(TwoThrows::SURGEON),
        KnotKind::Fisherman => fisherman_nodes(&size, rod.nodes).map(Vec::from),
    }
}

/// The determinant of a kind of knot.
pub fn determinant_of_kind(kind: KnotKind) -> u64 {
    match kind {
        KnotKind::Overhand { unknotting_number } => 2 * unknotting_number as u64 + 1,
        KnotKind::FigureEight => FIGURE_EIGHT_DETERMINANT,
        KnotKind::Reef => TwoThrows::REEF.determinant(),
        KnotKind::Granny => TwoThrows::GRANNY.determinant(),
        KnotKind::Surgeon => TwoThrows::SURGEON.determinant(),
        KnotKind::Fisherman => FISHERMAN_DETERMINANT,
    }
}

/// Rejects a curve that is not a knot of this kind, or whose knot cannot be identified.
fn refuse_other_knots(nodes: &[Vector3], kind: Option<KnotKind>) -> Result<(), String> {
    let Some(found) = determinant(nodes) else {
        return Err("the curve intersects itself".to_owned());
    };
    match kind.map(determinant_of_kind) {
        Some(expected) if expected != found => Err(format!(
            "the curve is another knot: its determinant is {found}, that of the knot asked for is {expected}"
        )),
        _ => Ok(()),
    }
}

/// Unit vector along which the ends of the rods are pulled: for a single rod from its start to its
/// end, for two rods x.
pub fn pull_axis(rods: &[&[Vector3]]) -> Vector3 {
    match rods {
        [rod] => (rod[rod.len() - 1] - rod[0]).normalize(),
        _ => Vector3::x(),
    }
}

/// Outward unit vectors along which the start and the end of each rod are pulled.
pub fn outward(rods: &[&[Vector3]]) -> Vec<[Vector3; 2]> {
    let axis = pull_axis(rods);
    let ends = rods.iter().map(|rod| [rod[0], rod[rod.len() - 1]]);
    let sum: Vector3 = ends.clone().flatten().sum();
    let middle = sum / (2 * rods.len()) as f64;
    let outward = |end: Vector3| axis * 1f64.copysign((end - middle).dot(&axis));
    ends.map(|ends| ends.map(outward)).collect()
}

/// Determinant of the knot of one or two rods; `None` if it cannot be identified.
pub fn determinant_of_rods(rods: &[&[Vector3]]) -> Option<u64> {
    match rods {
        [rod] => determinant(rod),
        &[first, second, ..] => determinant_of_pair([first, second], &pull_axis(rods)),
        [] => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::knot::{KnotMonitor, KnotRow};
    use crate::experiment::{from_text, prepare};
    use crate::run::PreparedRun;
    use crate::test_support::advance_to;
    use rodlab_engine::mechanics::dynamics::Simulation;
    use std::fmt::Write;
    use std::path::Path;

    fn line(from: [f64; 3], to: [f64; 3]) -> Vec<Vector3> {
        let (from, to) = (Vector3::from(from), Vector3::from(to));
        (0..=4)
            .map(|k| from.lerp(&to, f64::from(k) / 4.0))
            .collect()
    }

    #[test]
    fn the_ends_of_one_rod_are_pulled_along_the_line_through_both() {
        let rod = line([1.0, 1.0, 0.0], [1.0, 3.0, 0.0]);
        assert_eq!(outward(&[&rod]), [[-Vector3::y(), Vector3::y()]]);
    }

    #[test]
    fn the_ends_of_two_rods_are_pulled_to_the_side_where_they_are() {
        let there = line([-1.0, 0.0, 0.0], [1.0, -0.1, 0.0]);
        let back = line([1.0, 0.1, 0.0], [-1.0, 0.2, 0.0]);
        let [left, right] = [-Vector3::x(), Vector3::x()];
        assert_eq!(outward(&[&there, &back]), [[left, right], [right, left]]);
    }

    /// The figure-eight knot of the scenario file with changes; files are looked up in
    /// `directory`.
    fn prepared(directory: &Path, overrides: &[&str]) -> Result<PreparedRun, String> {
        let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
        let text = include_str!("../../../../scenarios/figure_eight.toml");
        let loaded = from_text("figure_eight", text, directory, &overrides);
        let loaded = loaded.map_err(|error| error.to_string())?;
        prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues).to_string())
    }

    /// The knot after it has settled and its ends have been pulled for half the settling time.
    fn pulled(run: &PreparedRun) -> KnotRow {
        let mut simulation = Simulation::new(&run.scene, &run.integration).unwrap();
        advance_to(&mut simulation, 0.3);
        let observer = run.observer::<KnotMonitor>().unwrap().observer;
        let row = observer.measure(&simulation);
        assert!(observer.recognises(&row), "{row:?}");
        row
    }

    const BRIEFLY: [&str; 3] = [
        "knot.settling_time=0.2",
        "material.density=100.0",
        "time.end=0.5",
    ];

    #[test]
    fn knots_of_all_kinds_settle_and_all_their_ends_are_pulled_alike() {
        for (kind, end_to_end, determinant) in [
            ("figure-eight", 0.3, 5),
            ("reef", 0.36, 9),
            ("granny", 0.36, 9),
            ("surgeon", 0.36, 15),
            ("fisherman", 0.34, 11),
        ] {
            let kind = format!("knot.kind=\"{kind}\"");
            let distance = format!("knot.end_to_end={end_to_end}");
            let settings = [&[kind.as_str(), distance.as_str()], &BRIEFLY[..]].concat();
            let row = pulled(&prepared(Path::new(""), &settings).unwrap());
            assert_eq!(row.knot_determinant, Some(determinant), "{kind}");
            assert!(
                (row.end_to_end_m - end_to_end - 1e-3).abs() < 1e-12,
                "{kind} {row:?}"
            );
            // Symmetries exchange the ends of the figure-eight, and the rods of the other knots.
            let alike = match (row.second_traction_start_n, row.second_traction_end_n) {
                (Some(start), Some(end)) => {
                    [[row.traction_start_n, start], [row.traction_end_n, end]]
                }
                _ => [[row.traction_start_n, row.traction_end_n]; 2],
            };
            for [one, other] in alike {
                assert!(one > 0.0 && (other / one - 1.0).abs() < 1e-6, "{row:?}");
            }
            let is_pair = row.second_traction_start_n.is_some();
            assert_eq!(is_pair, determinant != 5, "{kind}");
        }
    }

    /// The curve of a figure-eight knot. A function of the fraction along the curve changes its
    /// heights.
    fn curve(height: impl Fn(f64, f64) -> f64) -> Vec<Vector3> {
        let size = KnotSize {
            length: 0.8,
            radius: 1.6e-3,
            end_to_end: 0.4,
        };
        let mut nodes = figure_eight_nodes(&size, 301).unwrap();
        for (k, node) in nodes.iter_mut().enumerate() {
            node.z = height(node.z, k as f64 / 300.0);
        }
        nodes
    }

    /// A scenario whose rod starts along a curve.
    fn along(curve: &[Vector3], overrides: &[&str]) -> Result<PreparedRun, String> {
        let directory = tempfile::tempdir().unwrap();
        let mut text = "x,y,z\n".to_owned();
        for point in curve {
            writeln!(text, "{},{},{}", point.x, point.y, point.z).unwrap();
        }
        std::fs::write(directory.path().join("curve.csv"), text).unwrap();
        let file = include_str!("../../../../scenarios/three_twist.toml")
            .replace("three_twist.csv", "curve.csv")
            .replace("length = 0.8 ", "#");
        let overrides: Vec<String> = [&BRIEFLY, overrides]
            .concat()
            .iter()
            .map(|text| (*text).to_owned())
            .collect();
        let loaded = from_text("curve", &file, directory.path(), &overrides);
        let loaded = loaded.map_err(|error| error.to_string())?;
        prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues).to_string())
    }

    #[test]
    fn a_rod_along_a_curve_is_the_knot_that_the_curve_is() {
        let knotted = curve(|height, _| 1.5 * height);
        let row = pulled(&along(&knotted, &["knot.kind=\"figure-eight\""]).unwrap());
        assert_eq!(row.knot_determinant, Some(5));
        let rising = curve(|_, part| 0.1 * part);
        let row = pulled(&along(&rising, &[]).unwrap());
        assert_eq!(row.knot_determinant, Some(1));
    }

    #[test]
    fn curves_that_cannot_be_the_knot_are_refused_with_the_reason() {
        let refusal = |curve: &[Vector3], overrides: &[&str]| along(curve, overrides).unwrap_err();
        let knotted = curve(|height, _| height);
        let flat = curve(|_, _| 0.0);
        let low = curve(|height, _| 0.5 * height);
        insta::assert_snapshot!(refusal(&knotted, &["knot.unknotting_number=1"]), @"curve.toml:16:9: `knot.curve`: the curve is another knot: its determinant is 5, that of the knot asked for is 3");
        insta::assert_snapshot!(refusal(&flat, &[]), @"curve.toml:16:9: `knot.curve`: the curve intersects itself");
        insta::assert_snapshot!(refusal(&low, &[]), @"curve.toml:16:9: `knot.curve`: edge 62 of rod `knot` and edge 168 of rod `knot` interpenetrate: distance 2.991735e-3 m, allowed is at least 3.200000e-3 m");
    }
}
