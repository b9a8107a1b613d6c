//! Knot tightening (thesis 2.5) and inversion (thesis 3): a knot whose ends are pulled apart at constant speed.
//!
//! **Geometry.** A knot tied from numbers lies around the x axis, with its ends along it. A curve
//! keeps its position. The rods are naturally straight and start without twist.
//!
//! **Drive.** First the knot settles: the ends rest, and a drag that damps the loop critically
//! brings the strands into contact; it fades before the ends move. Then all ends move outwards
//! along the axis. Clamped ends keep their frames, so that they do not rotate relative to each
//! other.

use super::tied_knot::{TiedKnot, outward, tie};
use super::{Knot, KnotEnds, KnotTables};
use crate::experiment::prepare::round_rod;
use crate::scenario::Issue;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{Clamp, Load, LoadKind, Motion, Scene};
use std::f64::consts::TAU;

/// Fraction of the settling time after which the drag begins to fade.
const FULL_DRAG: f64 = 0.7;
/// Initial drag over the drag that settles the loop, and the fraction of the settling time in
/// which it falls to the latter. The strands are initially apart and should meet slowly; otherwise
/// those with high friction do not settle.
const FIRST_DRAG: f64 = 100.0;
const SLOWED: f64 = 0.3;
/// Damping rate of the settling drag over the frequency √(EI/ρA)/R² of the loop; 2 is critical.
const SETTLING_DRAG: f64 = 4.0;

/// Adds the knotted rods, the clamps that hold and move their ends, and their drag.
///
/// # Errors
/// As [`tie`].
pub fn add(scene: &mut Scene, tables: &KnotTables, end: f64) -> Result<(), Issue> {
    let KnotTables {
        material,
        rod,
        knot,
    } = tables;
    let TiedKnot { rods, is_built } = tie(rod, knot)?;
    let slices: Vec<&[Vector3]> = rods.iter().map(Vec::as_slice).collect();
    let outward = outward(&slices);
    let is_pair = rods.len() > 1;
    for (nodes, outward) in rods.into_iter().zip(outward) {
        let index = scene.rods.len();
        let name = if is_pair {
            format!("knot_{}", index + 1)
        } else {
            "knot".to_owned()
        };
        for (node, direction) in [(0, outward[0]), (nodes.len() - 1, outward[1])] {
            scene.clamps.push(Clamp {
                rod: index,
                node,
                holds_position: true,
                holds_frame: knot.ends == KnotEnds::Clamped,
                motion: pulled(knot, direction, end),
            });
        }
        let mut description = round_rod(&name, nodes, material, rod);
        if is_built {
            description.end_tangents = [Some(-outward[0]), Some(outward[1])];
            description.first_director = Some(Vector3::y());
        }
        add_drag(
            scene,
            index,
            description.mass_per_length,
            description.stiffness.bending[0],
            knot,
        );
        scene.rods.push(description);
    }
    Ok(())
}

/// Motion of an end: outwards, after the knot has settled, until the end of the simulated time.
fn pulled(knot: &Knot, outward: Vector3, end: f64) -> Motion {
    let until = end.max(knot.settling_time + 1.0);
    let distance = knot.pull_speed * (until - knot.settling_time);
    Motion {
        translation: vec![
            (knot.settling_time, Vector3::zeros()),
            (until, outward * distance),
        ],
        ..Motion::default()
    }
}

/// Adds the drag that settles a rod, and that while the ends move.
fn add_drag(
    scene: &mut Scene,
    rod: usize,
    mass_per_length: f64,
    bending_stiffness: f64,
    knot: &Knot,
) {
    let loop_radius = (knot.length - knot.end_to_end) / TAU;
    let frequency = (bending_stiffness / mass_per_length).sqrt() / loop_radius.powi(2);
    let settling = SETTLING_DRAG * mass_per_length * frequency;
    for (translation, schedule) in [
        (
            settling,
            vec![
                (0.0, FIRST_DRAG),
                (SLOWED * knot.settling_time, 1.0),
                (FULL_DRAG * knot.settling_time, 1.0),
                (knot.settling_time, 0.0),
            ],
        ),
        (knot.damping, Vec::new()),
    ] {
        scene.loads.push(Load {
            kind: LoadKind::Drag {
                rod: Some(rod),
                translation,
                rotation: 0.0,
            },
            schedule,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::knot::{
        KnotEnding, KnotMonitor, KnotOutcome, KnotRow, read_knot_series,
    };
    use crate::experiment::{from_text, prepare};
    use crate::run::{RunOptions, run};
    use crate::test_support::advance_to;
    use rodlab_engine::mechanics::dynamics::Simulation;
    use std::path::Path;

    fn prepared(overrides: &[&str]) -> Result<crate::run::PreparedRun, String> {
        let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
        let text = include_str!("../../../../scenarios/trefoil.toml");
        let loaded = from_text("trefoil", text, Path::new(""), &overrides);
        let scenario = loaded.map_err(|error| error.to_string())?.scenario;
        prepare(&scenario).map_err(|error| error.to_string())
    }

    #[test]
    fn ends_move_apart_along_the_axis_after_settling() {
        let run = prepared(&[]).unwrap();
        let corners: Vec<_> = run
            .scene
            .clamps
            .iter()
            .map(|clamp| &clamp.motion.translation)
            .collect();
        for (corners, sign) in corners.into_iter().zip([-1.0, 1.0]) {
            assert_eq!(corners[0], (2.0, Vector3::zeros()));
            assert_eq!(corners[1].0, 52.0);
            let expected = Vector3::x() * sign * 6e-3 * 50.0;
            assert!((corners[1].1 - expected).norm() < 1e-15);
        }
    }

    #[test]
    fn both_ends_are_pulled_alike_and_the_knot_stays() {
        let settings = [
            "knot.settling_time=0.0",
            "material.density=10.0",
            "time.end=1.0",
        ];
        let run = prepared(&settings).unwrap();
        let mut simulation = Simulation::new(&run.scene, &run.integration).unwrap();
        advance_to(&mut simulation, 0.25);
        let observer = run.observer::<KnotMonitor>().unwrap().observer;
        let row = observer.measure(&simulation);
        assert!(observer.recognises(&row));
        assert!(row.traction_start_n > 0.0);
        assert!((row.traction_end_n / row.traction_start_n - 1.0).abs() < 0.05);
        assert!((row.end_to_end_m - 0.283).abs() < 1e-12);
        // In a loose trefoil, 2πR is less than the shortening, by the length in the braid.
        let radius = row.loop_radius_m.unwrap();
        assert!((0.09..0.13).contains(&radius), "{radius}");
    }

    /// A short trefoil that is pulled by 16 mm, with a bound on its kinetic energy.
    fn pulled_slowly(kinetic_bound: f64) -> (KnotOutcome, Vec<KnotRow>) {
        let settings = |end: f64| {
            let given = [
                "knot.length=0.3",
                "rod.nodes=101",
                "knot.end_to_end=0.12",
                "knot.pull_speed=\"auto\"",
                "contact.distance_tolerance=1e-4",
                "output.interval=0.05",
            ];
            let computed = [
                format!("knot.kinetic_bound={kinetic_bound}"),
                format!("time.end={end:?}"),
            ];
            given.map(str::to_owned).into_iter().chain(computed)
        };
        let scenario = |end: f64| {
            let text = include_str!("../../../../scenarios/trefoil.toml");
            let overrides: Vec<String> = settings(end).collect();
            let loaded = from_text("trefoil", text, Path::new(""), &overrides);
            loaded.unwrap().scenario
        };
        let started = scenario(3.0);
        let KnotTables { knot, .. } = started.experiment.tables().unwrap();
        let prepared = prepare(&scenario(knot.settling_time + 8e-3 / knot.pull_speed)).unwrap();
        let directory = tempfile::tempdir().unwrap();
        let finished = run(&prepared, &RunOptions::new(directory.path())).unwrap();
        let rows = read_knot_series(directory.path()).unwrap().into_iter();
        (
            KnotOutcome::of(&finished.case).unwrap(),
            rows.map(|(_, row)| row).collect(),
        )
    }

    /// Work of the ends while they were pulled from one distance (m) to another, J.
    fn work(rows: &[KnotRow], from: f64, to: f64) -> f64 {
        let done = |distance: f64| {
            let after = rows.partition_point(|row| row.end_to_end_m < distance);
            let (a, b) = (&rows[after - 1], &rows[after]);
            let part = (distance - a.end_to_end_m) / (b.end_to_end_m - a.end_to_end_m);
            a.work_of_ends_j + part * (b.work_of_ends_j - a.work_of_ends_j)
        };
        done(to) - done(from)
    }

    #[test]
    fn a_quasi_static_pull_has_the_same_traction_at_half_the_speed() {
        // The kinetic energy grows with the square of the speed.
        let [(whole, fast), (half, slow)] = [1e-3, 2.5e-4].map(pulled_slowly);
        for (outcome, bound) in [(whole, 1e-3), (half, 2.5e-4)] {
            assert!(outcome.kinetic_over_elastic.unwrap() < bound);
            assert_eq!(outcome.remark(), None);
            let balance = outcome.energy_balance.unwrap();
            assert!((balance - 1.0).abs() < 2e-3, "{balance}");
        }
        for millimetres in [123.0, 127.0, 131.0] {
            let (from, to) = (1e-3 * millimetres, 1e-3 * (millimetres + 4.0));
            let ratio = work(&fast, from, to) / work(&slow, from, to);
            assert!((ratio - 1.0).abs() < 0.01, "{millimetres}: {ratio}");
        }
    }

    /// Runs the knot of a changed scenario file and returns the outcome of the knot.
    fn outcome(overrides: &[&str]) -> KnotOutcome {
        let text = include_str!("../../../../scenarios/inversion_n3.toml");
        let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
        let loaded = from_text("inversion_n3", text, Path::new(""), &overrides).unwrap();
        let prepared = prepare(&loaded.scenario).unwrap();
        let directory = tempfile::tempdir().unwrap();
        let options = RunOptions::new(directory.path());
        KnotOutcome::of(&run(&prepared, &options).unwrap().case).unwrap()
    }

    #[test]
    fn a_cinquefoil_inverts_and_both_measures_locate_the_inversion() {
        let knot = outcome(&[
            "knot.unknotting_number=2",
            "knot.length=0.4",
            "rod.nodes=126",
            "knot.end_to_end=0.22",
            "knot.pull_speed=\"6 mm/s\"",
            "knot.settling_time=0.5",
            "contact.distance_tolerance=\"40 µm\"",
            "time.end=10.0",
            // The knot inverts within one interval, between two outputs.
            "output.interval=1.0",
        ]);
        assert_eq!(knot.knot_ending, Some(KnotEnding::Inverted));
        assert!((knot.inversion_by_force.unwrap() - 74.0).abs() < 2.0);
        assert!(knot.inversion_difference.unwrap() < 0.02);
        assert!(knot.kinetic_over_elastic.unwrap() < 0.01);
    }

    #[test]
    fn a_trefoil_does_not_invert_and_is_pulled_until_it_locks() {
        let knot = outcome(&[
            "knot.unknotting_number=1",
            "knot.length=0.3",
            "rod.nodes=101",
            "knot.end_to_end=0.2",
            "knot.pull_speed=\"10 mm/s\"",
            "knot.settling_time=0.5",
            "time.end=5.4",
        ]);
        assert_eq!(knot.knot_ending, Some(KnotEnding::Locked));
        assert_eq!(knot.inversion_by_force, None);
        assert_eq!(knot.inversion_by_height, None);
    }

    #[test]
    fn impossible_knots_are_refused_with_the_reason() {
        for (override_, reason) in [
            ("knot.unknotting_number=0", "1 to 6"),
            ("knot.unknotting_number=7", "1 to 6"),
            ("knot.end_to_end=1.5", "less than the length of the rod"),
            ("knot.end_to_end=0.05", "wide"),
            ("time.end=100.0", "beyond the length of the rod"),
            ("contact.model=\"none\"", "a knot needs contact"),
        ] {
            let error = prepared(&[override_]).unwrap_err();
            assert!(error.contains(reason), "{override_}: {error}");
        }
    }
}
