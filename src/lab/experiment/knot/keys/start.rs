//! Resolves the initial placement of the rods of a knot: tied from numbers, or along a curve.

use super::resolved::{KnotKind, KnotStart};
use super::typed;
use crate::scenario::keys::{POSITIVE, Request, Section};

/// Largest unknotting number for which a shape is available.
const LARGEST_UNKNOTTING_NUMBER: usize = 6;
/// Distance of the ends over the length below which a curve counts as closed.
const CLOSED: f64 = 1e-6;
/// Largest relative error of a typed `end_to_end`.
const SAME_DISTANCE: f64 = 1e-6;
/// A curve that already has its length, up to round-off, is not scaled, so that resolved scenarios
/// read back to themselves.
const SAME_LENGTH: f64 = 1e-12;

/// Placement and length of the rods of a knot.
pub struct PlacedKnot {
    /// Placement; `None` after a faulty kind of knot, which is reported.
    pub start: Option<KnotStart>,
    /// Length of each rod, m.
    pub length: f64,
    /// Distance of the ends, m.
    pub end_to_end: f64,
}

/// Resolves the start of a knot.
pub fn knot_start(request: &Request<'_>, section: &Section<'_>, typed: &typed::Knot) -> PlacedKnot {
    if typed.curve.is_some() || typed.points.is_some() {
        return along_curve(request, section, typed);
    }
    let kind = kind(
        section,
        typed,
        typed.kind.unwrap_or(typed::KnotKind::Overhand),
    );
    PlacedKnot {
        start: kind.map(KnotStart::Tied),
        length: section.required("length", &typed.length, POSITIVE),
        end_to_end: section.required("end_to_end", &typed.end_to_end, POSITIVE),
    }
}

/// The kind of knot called `name`.
fn kind(section: &Section<'_>, typed: &typed::Knot, name: typed::KnotKind) -> Option<KnotKind> {
    let key = "unknotting_number";
    if typed.unknotting_number.is_some() && name != typed::KnotKind::Overhand {
        section.fault(
            key,
            "it distinguishes only overhand knots; leave the key out",
        );
    }
    Some(match name {
        typed::KnotKind::Overhand => KnotKind::Overhand {
            unknotting_number: section.count(
                key,
                typed.unknotting_number,
                1..=LARGEST_UNKNOTTING_NUMBER,
            )?,
        },
        typed::KnotKind::FigureEight => KnotKind::FigureEight,
        typed::KnotKind::Reef => KnotKind::Reef,
        typed::KnotKind::Granny => KnotKind::Granny,
        typed::KnotKind::Surgeon => KnotKind::Surgeon,
        typed::KnotKind::Fisherman => KnotKind::Fisherman,
    })
}

fn along_curve(request: &Request<'_>, section: &Section<'_>, typed: &typed::Knot) -> PlacedKnot {
    use typed::KnotKind::{FigureEight, Overhand};
    let kind = match typed.kind {
        None if typed.unknotting_number.is_some() => kind(section, typed, Overhand).map(Some),
        None => Some(None),
        Some(name @ (Overhand | FigureEight)) => kind(section, typed, name).map(Some),
        Some(_) => {
            let message = "a curve is one rod, and this knot has two; allowed with a curve: \"overhand\", \"figure-eight\"";
            section.fault("kind", message);
            None
        }
    };
    let mut points = request.corners(section, "curve", &typed.curve, &typed.points);
    let placed = length(&points);
    let length = typed.length(section).unwrap_or(placed);
    let scale = length / placed;
    if (scale - 1.0).abs() > SAME_LENGTH {
        let components = points.iter_mut().flatten();
        components.for_each(|component| *component *= scale);
    }
    let end_to_end = match points[..] {
        [first, .., last] => distance(&first, &last),
        _ => f64::NAN,
    };
    if end_to_end < CLOSED * length {
        let key = if typed.curve.is_some() {
            "curve"
        } else {
            "points"
        };
        section.fault_with_help(
            key,
            "the curve is closed: it has no ends to pull",
            Some(
                "cut it open, or let it float: experiment = \"scene\", a rod with closed = true"
                    .to_owned(),
            ),
        );
    }
    if let Some(asked) = typed.end_to_end(section)
        && (asked - end_to_end).abs() > SAME_DISTANCE * end_to_end
    {
        section.fault(
            "end_to_end",
            format!("the ends of the curve are {end_to_end:?} m apart; leave the key out"),
        );
    }
    PlacedKnot {
        start: kind.map(|kind| KnotStart::Curve { kind, points }),
        length,
        end_to_end,
    }
}

fn distance(one: &[f64; 3], other: &[f64; 3]) -> f64 {
    let squares = one.iter().zip(other).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f64>().sqrt()
}

fn length(points: &[[f64; 3]]) -> f64 {
    points
        .windows(2)
        .map(|pair| distance(&pair[0], &pair[1]))
        .sum()
}

#[cfg(test)]
mod tests {
    use crate::experiment::knot::{Knot, KnotKind, KnotStart, KnotTables};
    use crate::scenario::Scenario;
    use crate::test_support::{assert_reads_back, loaded};

    fn read(experiment: &str, knot: &str) -> Result<Scenario, String> {
        let text = format!(
            "experiment = \"{experiment}\"\n\
             [knot]\n{knot}\n\
             [material]\nyoungs_modulus = 1e6\npoissons_ratio = 0.5\ndensity = 1000\n\
             [rod]\nradius = 1e-3\nnodes = 101\n\
             [contact]\n[time]\nend = 3.0\n"
        );
        loaded("knot", &text).map(|loaded| loaded.scenario)
    }

    fn knot(text: &str) -> Knot {
        let scenario = read("knot-tightening", text).unwrap();
        let tables: &KnotTables = scenario.experiment.tables().unwrap();
        tables.knot.clone()
    }

    fn fault(text: &str) -> String {
        read("knot-tightening", text).unwrap_err()
    }

    const ANGLE: &str = "points = [[0, 0, 0], [0.3, 0, 0], [0.3, 0.4, 0]]\n";

    #[test]
    fn a_curve_has_its_own_length_or_is_scaled() {
        let own = knot(ANGLE);
        assert!((own.length - 0.7).abs() < 1e-15);
        assert!((own.end_to_end - 0.5).abs() < 1e-15);
        let scaled = knot(&format!("{ANGLE}length = 1.4"));
        assert_eq!(scaled.length, 1.4);
        assert!((scaled.end_to_end - 1.0).abs() < 1e-15);
        let KnotStart::Curve { kind: None, points } = scaled.start else {
            panic!("{:?}", scaled.start);
        };
        assert!((points[2][1] - 0.8).abs() < 1e-15);
    }

    #[test]
    fn curves_and_knots_read_back_to_themselves() {
        for text in [
            ANGLE.to_owned(),
            format!("{ANGLE}length = 0.9173\nunknotting_number = 2"),
            format!("{ANGLE}kind = \"figure-eight\""),
            "kind = \"granny\"\nlength = 0.6\nend_to_end = 0.3".to_owned(),
        ] {
            let scenario = read("knot-tightening", &text).unwrap();
            assert_reads_back("knot", &scenario);
        }
    }

    #[test]
    fn a_knot_is_an_overhand_knot_unless_it_has_another_name() {
        let start = knot("unknotting_number = 2\nlength = 1.0\nend_to_end = 0.3").start;
        let cinquefoil = KnotKind::Overhand {
            unknotting_number: 2,
        };
        assert_eq!(start, KnotStart::Tied(cinquefoil));
        let start = knot("kind = \"figure-eight\"\nlength = 1.0\nend_to_end = 0.3").start;
        assert_eq!(start, KnotStart::Tied(KnotKind::FigureEight));
    }

    #[test]
    fn faults_of_knots_name_what_is_allowed() {
        let size = "length = 1.0\nend_to_end = 0.3";
        insta::assert_snapshot!(fault(&format!("kind = \"reef\"\nunknotting_number = 1\n{size}")), @"knot.toml:4:21: `knot.unknotting_number`: it distinguishes only overhand knots; leave the key out");
        insta::assert_snapshot!(fault(&format!("kind = \"overhand\"\nunknotting_number = 7\n{size}")), @"knot.toml:4:21: `knot.unknotting_number`: 7 is out of range; allowed: 1 to 6");
        insta::assert_snapshot!(fault(&format!("kind = \"overhand\"\n{size}")), @"knot.toml:2:1: `knot`: missing key `unknotting_number` (a whole number, 1 to 6)");
        insta::assert_snapshot!(fault(&format!("kind = \"bowline\"\n{size}")), @r#"knot.toml:3:8: `knot.kind`: "bowline" is not a valid value; allowed: overhand, figure-eight, reef, granny, surgeon, fisherman"#);
        insta::assert_snapshot!(fault(&format!("{ANGLE}kind = \"reef\"")), @r#"knot.toml:4:8: `knot.kind`: a curve is one rod, and this knot has two; allowed with a curve: "overhand", "figure-eight""#);
        insta::assert_snapshot!(fault(&format!("{ANGLE}end_to_end = 0.3")), @"knot.toml:4:14: `knot.end_to_end`: the ends of the curve are 0.5 m apart; leave the key out");
        insta::assert_snapshot!(fault(&format!("{ANGLE}pull_speed = 0.2\nsettling_time = 1")), @"knot.toml:15:7: `time.end`: the ends would be pulled 1.3000 m apart, beyond the length of the rod; allowed: less than 1.5000 s");
        insta::assert_snapshot!(fault(&format!("{ANGLE}curve = \"nowhere.csv\"")), @"knot.toml:3:10: `knot.points`: give `curve` or `points`, not both");
        insta::assert_snapshot!(fault("curve = \"nowhere.csv\""), @"knot.toml:3:9: `knot.curve`: nowhere.csv cannot be read: No such file or directory (os error 2)");
        insta::assert_snapshot!(fault("points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0]]"), @r#"knot.toml:3:10: `knot.points`: the curve is closed: it has no ends to pull (cut it open, or let it float: experiment = "scene", a rod with closed = true)"#);
        insta::assert_snapshot!(fault("points = [[0, 0, 0], [1, 0, 0]]"), @"knot.toml:2:1: `knot.end_to_end`: 1.0 m is out of range; allowed: less than the length of the rod, 1.0 m");
        insta::assert_snapshot!(fault("kind = \"figure-eight\"\nlength = 1.0"), @"knot.toml:2:1: `knot`: missing key `end_to_end` (a length, greater than 0)");
        insta::assert_snapshot!(read("knot-inversion", &format!("kind = \"granny\"\n{size}")).unwrap_err(), @r#"knot.toml:3:8: `knot.kind`: other knots do not invert; allowed: "overhand""#);
    }
}
