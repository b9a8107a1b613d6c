//! Tests of rods that are handed to grippers, led and released.

use super::rod::{HandOver, RodSupply, loaded};
use super::simulated_rod::SimulatedRod;
use crate::test_cells::short_rods;
use nalgebra::Translation3;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3};
use rodlab_lab::experiment::DeploymentTables;
use rodlab_robot::Pose;
use toml::toml;

fn given(arm: usize, hand: &Pose, now: f64) -> HandOver {
    HandOver {
        arm,
        supply: 0,
        hand: *hand,
        table: table(),
        now,
    }
}

fn table() -> Pose {
    Pose::translation(0.3, -0.1, 0.05)
}

/// Pose in which a hand takes a rod; `heading` is the direction of the rod on the table.
fn hand(supply: &RodSupply, heading: f64) -> Pose {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading);
    table() * Pose::from_parts(Translation3::new(0.1, 0.2, 0.0), turn) * supply.end
}

/// Rods, the pose of a hand that takes one in the direction `heading` at the time `now`, s,
/// and the taken rod.
fn hanging(heading: f64, now: f64) -> (RodSupply, Pose, SimulatedRod) {
    let supply = short_rods();
    let hand = hand(&supply, heading);
    let rod = supply.handed(&given(0, &hand, now)).unwrap();
    (supply, hand, rod)
}

/// Advances a rod to a time, s, with the hand of each arm.
fn lead(rod: &mut SimulatedRod, time: f64, hand: impl Fn(usize) -> Pose) {
    while !rod.advance_in(&hand, time).unwrap() {}
}

fn raised(height: f64) -> Translation3<f64> {
    Translation3::new(0.0, 0.0, height)
}

#[test]
fn a_rod_that_is_handed_over_hangs_where_it_was_until_it_is_moved() {
    let (supply, hand, mut rod) = hanging(0.7, 3.0);
    let first = rod.nodes();
    assert!((first[first.len() - 1] - hand.translation.vector).norm() < 1e-6);
    let free = table() * nalgebra::Point3::new(0.1, 0.2, supply.rod().radius);
    assert!((first[0] - free.coords).norm() < 1e-9);
    for step in 1..=60 {
        lead(&mut rod, 3.0 + 5e-3 * f64::from(step), |_| hand);
    }
    let nodes = rod.nodes();
    let moved = nodes.iter().zip(&first).map(|(a, b)| (a - b).norm());
    assert!(moved.fold(0.0, f64::max) < 0.02 * supply.rod().gravito_bending_length);
}

#[test]
fn a_free_end_lies_at_its_given_place() {
    let supply = short_rods();
    let hand = hand(&supply, 0.0);
    let supply = supply.with_free_end([0.395, 0.104]);
    let rod = supply.handed(&given(0, &hand, 0.0)).unwrap();
    let expected = Vector3::new(0.395, 0.104, 0.05 + supply.rod().radius);
    assert!((rod.nodes()[0] - expected).norm() < 1e-9);
    // The free end is too far from the hand.
    let far = supply
        .with_free_end([0.1, 0.1])
        .handed(&given(0, &hand, 0.0));
    assert!(far.is_err());
}

#[test]
fn a_held_rod_waits_for_still_hands_and_moves_on_with_them() {
    let (_, hand, mut rod) = hanging(0.7, 0.0);
    let last = |rod: &SimulatedRod| rod.nodes()[rod.nodes().len() - 1];
    // The hand sways by less than it counts as a motion.
    let sways = |time: f64| raised(4e-7 * (20.0 * time).sin()) * hand;
    for step in 1..=800 {
        let time = 5e-3 * f64::from(step);
        lead(&mut rod, time, |_| sways(time));
    }
    let rests = rod.nodes();
    lead(&mut rod, 20.0, |_| sways(20.0));
    assert!(rod.nodes() == rests);
    // A motion begins at the time of the last call, and moves the end with the hand.
    let first = last(&rod);
    for step in 1..=100 {
        let time = 5e-3 * f64::from(step);
        lead(&mut rod, 20.0 + time, |_| raised(1e-2 * time) * hand);
        let risen = last(&rod).z - first.z;
        assert!((risen - 1e-2 * time).abs() < 1e-6, "{time} {risen}");
    }
    rod.release().unwrap();
    lead(&mut rod, 20.55, |_| hand);
    assert!(last(&rod).z < first.z);
}

#[test]
fn a_rod_that_is_let_go_falls_on_the_table() {
    let (supply, hand, mut rod) = hanging(0.0, 0.0);
    rod.release().unwrap();
    for step in 1..=300 {
        lead(&mut rod, 5e-3 * f64::from(step), |_| hand);
    }
    let top = rod.nodes().iter().map(|node| node.z).fold(0.0, f64::max);
    assert!(top - 0.05 < 0.3 * supply.rod().length, "{top}");
    assert!(!rod.is_held());
}

#[test]
fn a_rod_that_is_held_still_falls_when_it_is_let_go() {
    let (_, hand, mut rod) = hanging(0.0, 0.0);
    rod.release().unwrap();
    // No time has passed, so that nothing has moved.
    assert!(rod.advance(&hand, 0.0).unwrap());
    let height = |rod: &SimulatedRod| rod.nodes().last().map_or(0.0, |node| node.z);
    let first = height(&rod);
    lead(&mut rod, 0.05, |_| hand);
    assert!(height(&rod) < first - 5e-3);
}

#[test]
fn pegs_stand_where_the_frame_of_their_pattern_lies() {
    let scenario = toml! {
        experiment = "deployment"
        [deployment]
        pattern = { kind = "line", length = 0.2 }
        rod = { gravito_bending_length = 0.03, radius = 0.002, length = 0.3, edges = 30 }
        clips = { at = [0.1], width = 0.008, radius = 0.004, height = 0.006 }
        [contact]
        friction = 0.2
        [time]
        step = 0.005
        end = 10.0
    };
    let loaded = loaded("clips", scenario).unwrap();
    let tables: Option<&DeploymentTables> = loaded.scenario.experiment.tables();
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.5);
    let frame = table() * Pose::from_parts(Translation3::new(0.02, 0.03, 0.0), turn);
    let supply = RodSupply::of(&tables.unwrap().deployment, 0.2, frame).unwrap();
    for (index, ([foot, top], radius)) in supply.pegs().into_iter().enumerate() {
        let side = if index == 0 { 1.0 } else { -1.0 };
        let along = frame.inverse() * nalgebra::Point3::from(foot);
        let expected = Vector3::new(0.1, side * 0.008, 0.0);
        assert!((along.coords - expected).norm() < 1e-9, "{along}");
        assert!((top - foot - Vector3::z() * 0.002).norm() < 1e-12);
        assert_eq!(radius, 0.004);
    }
    // The free end lies at the start of the pattern, or at another given place. Pegs are not
    // among the visible rods.
    let begins = (frame * nalgebra::Point3::origin()).coords.xy();
    let free_end = nalgebra::Vector2::from(supply.free_end.unwrap());
    assert!((begins - free_end).norm() < 1e-9);
    let supply = supply.with_free_end([0.4, 0.1]);
    let rod = supply.handed(&given(0, &hand(&supply, 0.0), 0.0)).unwrap();
    assert_eq!(rod.nodes().len(), 31);
}

#[test]
fn two_hands_on_one_rod_each_move_their_own_node() {
    let (_, first, mut rod) = hanging(0.7, 0.0);
    lead(&mut rod, 5e-3, |_| first);
    let free = rod.nodes()[0];
    // Slightly beside the free end, and turned.
    let second = Pose::from_parts(
        Translation3::from(free + Vector3::new(4e-3, -3e-3, 2e-3)),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.4),
    );
    let node = rod.within_reach(&second).unwrap();
    assert_eq!(node, 0);
    let mut hands = [first, second];
    rod.take(1, node, &second, 5e-3).unwrap();
    assert_eq!(rod.holders().collect::<Vec<_>>(), [0, 1]);
    for step in 2..=240 {
        let part = f64::from(step) / 240.0;
        hands[0] = raised(-0.02 * part) * first;
        hands[1] = Translation3::new(0.0, 0.01 * part, 0.03 * part) * second;
        lead(&mut rod, 5e-3 * f64::from(step), |arm| hands[arm]);
    }
    let nodes = rod.nodes();
    let end = nodes[nodes.len() - 1];
    assert!((end - hands[0].translation.vector).norm() < 1e-6, "{end}");
    let led = nodes[0] - free;
    assert!((led - Vector3::new(0.0, 0.01, 0.03)).norm() < 1e-6, "{led}");
    // The table stops the lowered hand at the height of the lying rod. A gripper that opens
    // releases only its own end.
    for step in 241..=340 {
        let down = f64::from(step - 240) / 100.0;
        hands[1] = Translation3::new(0.0, 0.01, 0.03 - 0.05 * down) * second;
        lead(&mut rod, 5e-3 * f64::from(step), |arm| hands[arm]);
    }
    let height = rod.nodes()[0].z - free.z;
    assert!(height.abs() < 1e-6, "{height}");
    rod.release_by(1).unwrap();
    assert_eq!(rod.holders().collect::<Vec<_>>(), [0]);
    hands[0] = raised(-0.03) * first;
    lead(&mut rod, 2.0, |arm| hands[arm]);
    let end = rod.nodes()[nodes.len() - 1];
    assert!((end - hands[0].translation.vector).norm() < 1e-6, "{end}");
}

#[test]
fn a_hand_beyond_reach_takes_nothing() {
    let (_, hand, mut rod) = hanging(0.0, 0.0);
    let free = rod.nodes()[0];
    let at = |x: f64, y: f64, z: f64| Pose::from(free + Vector3::new(x, y, z));
    assert_eq!(rod.within_reach(&at(0.0, 0.014, 0.0)), Some(0));
    assert_eq!(rod.within_reach(&at(0.0, 0.016, 0.0)), None);
    assert_eq!(rod.within_reach(&at(0.0, 0.0, 0.016)), None);
    // Another gripper already holds the end.
    assert_eq!(rod.within_reach(&hand), None);
    rod.take(1, 0, &at(0.0, 0.0, 0.0), 0.0).unwrap();
    assert_eq!(rod.within_reach(&at(0.0, 0.0, 0.0)), None);
}

#[test]
fn a_second_rod_is_handed_beside_one_that_lies() {
    let (supply, first, mut rod) = hanging(0.7, 0.0);
    let free = rod.nodes()[0];
    // The rod is laid down straight, with the hand on a quarter of a circle about the free
    // end.
    let (sine, cosine) = libm::sincos(0.7);
    let ahead = Vector3::new(cosine, sine, 0.0);
    let across = nalgebra::UnitVector3::new_normalize(Vector3::z().cross(&ahead));
    let from = first.translation.vector - free;
    let turned = |angle: f64| {
        let turn = UnitQuaternion::from_axis_angle(&across, angle);
        let place = free + 0.99 * (turn * from);
        Pose::from_parts(place.into(), turn * first.rotation)
    };
    let low = free.z - table().translation.z;
    let last = libm::acos(low / from.norm()) - libm::atan2(from.dot(&ahead), from.z);
    for step in 1..=500 {
        let part = (f64::from(step - 100) / 400.0).clamp(0.0, 1.0);
        lead(&mut rod, 5e-3 * f64::from(step), |_| turned(part * last));
    }
    rod.release().unwrap();
    for step in 501..=700 {
        lead(&mut rod, 5e-3 * f64::from(step), |_| first);
    }
    let lay = rod.nodes();
    let second = Pose::translation(0.0, 0.2, 0.0) * hand(&supply, -0.4);
    let both = supply.handed_beside(&rod, &[&supply], &given(1, &second, 3.5));
    let mut both = both.unwrap();
    let seen = both.seen();
    assert_eq!(seen.len(), 2);
    let moved = |seen: &[(Vec<Vector3>, f64)]| {
        let moved = seen[0].0.iter().zip(&lay).map(|(a, b)| (a - b).norm());
        moved.fold(0.0, f64::max)
    };
    assert!(moved(&seen) < 1e-9);
    let end = seen[1].0[30];
    assert!((end - second.translation.vector).norm() < 1e-6, "{end}");
    // The first rod stays, and the second follows its hand.
    let lifted = raised(0.05) * second;
    for step in 1..=240 {
        let part = (f64::from(step) / 100.0).min(1.0);
        lead(&mut both, 3.5 + 5e-3 * f64::from(step), |_| {
            raised(0.05 * part) * second
        });
    }
    let seen = both.seen();
    assert!(moved(&seen) < 1e-4, "{}", moved(&seen));
    let end = seen[1].0[30];
    assert!((end - lifted.translation.vector).norm() < 1e-6, "{end}");
}

#[test]
fn a_hand_that_cannot_hold_a_hanging_rod_gets_the_reason() {
    let supply = short_rods();
    let far = raised(0.3) * hand(&supply, 0.0);
    let tipped = hand(&supply, 0.0) * Pose::rotation(Vector3::z() * std::f64::consts::FRAC_PI_2);
    for (hand, expected) in [(far, "above the table"), (tipped, "not level")] {
        let refused = supply.handed(&given(0, &hand, 0.0));
        let words = refused.err().expect("it cannot hold a rod");
        assert!(words.contains(expected), "{words}");
    }
}
