//! Patterns compared with formulas and with the reference.

use super::*;
use std::f64::consts::{PI, TAU};

#[test]
fn a_circle_has_its_curvature_everywhere() {
    let circle = Pattern::new(Box::new(Circle { radius: -0.1 }), 0.0).unwrap();
    assert!((circle.length() - 0.1 * TAU).abs() < 1e-12);
    for point in circle.sampled(0.01) {
        assert!((point.curvature + 10.0).abs() < 1e-10);
        assert!(point.curvature_bend.abs() < 1e-4);
        let expected = Point::new(
            0.1 * (point.s / 0.1).sin(),
            -0.1 * (1.0 - (point.s / 0.1).cos()),
        );
        assert!((point.position - expected).norm() < 1e-12);
    }
}

#[test]
fn derivatives_of_the_curvature_are_those_over_arc_length() {
    let sine = Sine {
        amplitude: 0.04,
        wavelength: 0.25,
        waves: 2.0,
    };
    let pattern = Pattern::new(Box::new(sine), 0.0)
        .unwrap()
        .with_lead_in(0.07);
    let step = 1e-4;
    for index in 1..60 {
        let s = pattern.length() * f64::from(index) / 60.0;
        let [before, here, after] = [s - step, s, s + step].map(|s| pattern.at(s));
        let slope = (after.curvature - before.curvature) / (2.0 * step);
        assert!(
            (here.curvature_slope - slope).abs() < 0.05 + 1e-3 * slope.abs(),
            "{s}"
        );
        let bend = (after.curvature_slope - before.curvature_slope) / (2.0 * step);
        assert!(
            (here.curvature_bend - bend).abs() < 5.0 + 5e-3 * bend.abs(),
            "{s}: {bend}"
        );
        let turn = (after.angle - before.angle) / (2.0 * step);
        assert!(
            (here.curvature - turn).abs() < 1e-3 + 1e-4 * turn.abs(),
            "{s}"
        );
        let speed = (after.position - before.position).norm() / (2.0 * step);
        assert!((speed - 1.0).abs() < 1e-5, "{s}: {speed}");
    }
}

#[test]
fn a_lead_in_starts_straight_and_joins_smoothly() {
    let circle = Pattern::new(Box::new(Circle { radius: 0.1 }), 0.0).unwrap();
    let pattern = circle.with_lead_in(0.12);
    assert!((pattern.length() - 0.1 * TAU - 0.12).abs() < 1e-12);
    let start = pattern.at(0.0);
    assert_eq!((start.curvature, start.curvature_bend), (0.0, 0.0));
    let [before, after] = [0.12 - 1e-9, 0.12 + 1e-9].map(|s| pattern.at(s));
    assert!((before.position - after.position).norm() < 1e-8);
    assert!((before.angle - after.angle).abs() < 1e-7);
    assert!((before.curvature - after.curvature).abs() < 1e-6);
    assert!((before.curvature_bend - after.curvature_bend).abs() < 1e-2);
}

#[test]
fn a_lead_in_to_a_circle_turns_by_half_of_its_length_over_the_radius() {
    // 10x³ − 15x⁴ + 6x⁵ has the mean ½, and grows all the way to 1.
    let circle = Pattern::new(Box::new(Circle { radius: 0.1 }), 0.0).unwrap();
    let bend = LeadBend::of(&circle.at(0.0), 0.12);
    assert!((bend.turn / 0.6 - 1.0).abs() < 0.01, "{bend:?}");
    assert!((bend.sharpest - 10.0).abs() < 1e-9, "{bend:?}");
}

#[test]
fn a_straight_lead_in_continues_as_a_bent_one() {
    let circle = || Pattern::new(Box::new(Circle { radius: 0.1 }), 0.0).unwrap();
    let bent = circle().with_lead_in(0.12);
    let pattern = circle().with_straight_lead_in(0.05, 0.12);
    assert!((pattern.lead_in() - 0.17).abs() < 1e-15);
    let first = bent.at(0.0);
    let way = first.position - pattern.at(0.0).position;
    assert!((way - 0.05 * Point::new(first.angle.cos(), first.angle.sin())).norm() < 1e-15);
    for s in [0.0, 0.03, 0.12, 0.4] {
        let (here, there) = (bent.at(s), pattern.at(s + 0.05));
        assert!((here.position - there.position).norm() < 1e-12, "{s}");
        assert!((here.curvature - there.curvature).abs() < 1e-9, "{s}");
    }
    // Without a bend the lead-in ends at the start of the pattern.
    let line = Pattern::new(Box::new(Line { length: 0.3 }), 0.0).unwrap();
    let start = line.with_straight_lead_in(0.1, 0.0).at(0.02).position;
    assert!((start - Point::new(-0.08, 0.0)).norm() < 1e-15);
}

/// At the start of the lead-out and along it, by differences.
#[test]
fn a_lead_out_continues_smoothly_and_ends_straight() {
    let sine = Sine {
        amplitude: 0.04,
        wavelength: 0.25,
        waves: 1.8,
    };
    let pattern = Pattern::new(Box::new(sine), 0.0).unwrap();
    let length = pattern.length();
    let pattern = pattern.with_lead_out(0.1, 0.16);
    assert!((pattern.length() - length - 0.16).abs() < 1e-12);
    let [before, after] = [length - 1e-9, length + 1e-9].map(|s| pattern.at(s));
    assert!((before.position - after.position).norm() < 1e-8);
    let turn = after.angle - before.angle;
    assert!((turn - TAU * (turn / TAU).round()).abs() < 1e-6);
    assert!((before.curvature - after.curvature).abs() < 1e-5);
    assert!((before.curvature_slope - after.curvature_slope).abs() < 1e-3);
    let step = 1e-5;
    for part in 1..32 {
        let s = length + 0.16 * f64::from(part) / 32.0;
        let [before, here, after] = [s - step, s, s + step].map(|s| pattern.at(s));
        let tangent = (after.position - before.position) / (2.0 * step);
        assert!((tangent - Point::new(here.angle.cos(), here.angle.sin())).norm() < 1e-6);
        let turn = (after.angle - before.angle) / (2.0 * step);
        assert!((here.curvature - turn).abs() < 1e-4, "{s}");
        let slope = (after.curvature - before.curvature) / (2.0 * step);
        assert!((here.curvature_slope - slope).abs() < 1e-2, "{s}");
    }
    for s in [0.1, 0.13, 0.16] {
        assert!(pattern.at(length + s).curvature.abs() < 1e-12);
    }
}

#[test]
fn a_smoothed_circle_stays_within_the_deviation_and_keeps_its_curvature() {
    let points: Vec<Point> = (0..=180)
        .map(|index| f64::from(index) / 180.0 * 1.5 * PI)
        .map(|angle| 0.1 * Point::new(angle.cos(), angle.sin()))
        .collect();
    let pattern = Pattern::along(&points, 1e-4).unwrap();
    assert!(pattern.deviation <= 1e-4 && pattern.deviation > 1e-6);
    for point in pattern.sampled(0.005) {
        assert!((point.position.norm() - 0.1).abs() < 1.01e-4);
        if point.s > 0.05 && point.s < pattern.length() - 0.05 {
            assert!((point.curvature - 10.0).abs() < 0.1, "{point:?}");
        }
    }
}

#[test]
fn noise_is_smoothed_away() {
    let mut random = 1u32;
    let mut noise = || {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        2e-4 * (f64::from(random >> 8) / f64::from(1 << 24) - 0.5)
    };
    let points: Vec<Point> = (0..=400)
        .map(|index| f64::from(index) / 400.0 * PI)
        .map(|angle| 0.1 * Point::new(angle.cos(), angle.sin()) + Point::new(noise(), noise()))
        .collect();
    let pattern = Pattern::along(&points, 2.5e-4).unwrap();
    for point in pattern.sampled(0.005) {
        if point.s > 0.05 && point.s < pattern.length() - 0.05 {
            assert!((point.curvature - 10.0).abs() < 1.0, "{point:?}");
        }
    }
}

#[test]
fn sharp_corners_are_rounded_within_the_deviation() {
    let corner = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1]].map(Point::from);
    let pattern = Pattern::along(&corner, 5e-4).unwrap();
    assert!(pattern.deviation <= 5e-4);
    let sharpest = pattern
        .sampled(0.0005)
        .iter()
        .fold(0.0, |most: f64, point| most.max(point.curvature));
    // A fillet with the deviation d from a right corner has a radius of up to about 2.4 d.
    assert!(sharpest > 100.0 && sharpest < 2000.0, "{sharpest}");
}

#[test]
fn curves_of_zero_length_are_rejected() {
    let at = |points: &[[f64; 2]]| {
        let points: Vec<Point> = points.iter().map(|point| Point::from(*point)).collect();
        Pattern::along(&points, 1e-4).err()
    };
    assert!(at(&[[0.0, 0.0], [0.0, 0.0]]).is_some());
    assert!(at(&[]).is_some());
    assert!(at(&[[0.0, 0.0], [f64::NAN, 0.0]]).is_some());
    assert!(Pattern::new(Box::new(Line { length: 0.0 }), 0.0).is_err());
}

#[test]
fn an_eight_crosses_itself_once() {
    let points: Vec<Point> = (-10..=195)
        .map(|index| f64::from(index) / 205.0 * TAU)
        .map(|t| Point::new(0.1 * t.sin(), 0.05 * (2.0 * t).sin()))
        .collect();
    let pattern = Pattern::along(&points, 1e-4).unwrap();
    let found = crossings(&pattern.sampled(0.003));
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].position.norm() < 1e-3);
    assert!(
        crossings(
            &Pattern::new(Box::new(Line { length: 1.0 }), 0.0)
                .unwrap()
                .sampled(0.01)
        )
        .is_empty()
    );
}

/// A circle with a number of turns, through the given points, with or without a lead-in.
fn turned(radius: f64, turns: f64, lead_in: f64, step: f64) -> Vec<PatternPoint> {
    let points: Vec<Point> = (0..=400)
        .map(|index| turns * TAU * f64::from(index) / 400.0)
        .map(|t| Point::new(radius * t.sin(), radius * (1.0 - t.cos())))
        .collect();
    let pattern = Pattern::along(&points, 1e-5).unwrap();
    pattern.with_lead_in(lead_in).sampled(step)
}

#[test]
fn a_circle_that_closes_touches_itself_and_does_not_cross() {
    for radius in [0.08, -0.08, 0.03, 0.3] {
        for lead_in in [0.0, 0.02, 0.0917, 0.25] {
            for step in [0.001, 0.003, 0.0077] {
                let circle = Pattern::new(Box::new(Circle { radius }), 0.0).unwrap();
                let points = circle.with_lead_in(lead_in).sampled(step);
                let found = crossings(&points);
                assert!(
                    found.is_empty(),
                    "{radius} {lead_in} {step}: {} crossings",
                    found.len()
                );
            }
        }
    }
    // A curve that retraces its start for a quarter of a turn has no crossing either.
    for step in [0.001, 0.003] {
        let found = crossings(&turned(0.08, 1.25, 0.0, step));
        assert!(found.is_empty(), "{found:?}");
    }
}

#[test]
fn curves_that_cross_at_a_small_angle_cross_once() {
    // Two circles of 10 cm about centres 1 mm apart cross twice, at 0.6°.
    let circle = |shift: f64| {
        let circle = Pattern::new(Box::new(Circle { radius: 0.1 }), 0.0).unwrap();
        let mut points = circle.sampled(0.003);
        for point in &mut points {
            // Their starts are away from the crossings.
            point.position = Point::new(point.position.y + shift, -point.position.x);
        }
        points
    };
    let found = crossings_of_two(&circle(0.0), &circle(1e-3));
    assert_eq!(found.len(), 2, "{found:?}");
    let touching = crossings_of_two(&circle(0.0), &circle(0.2));
    assert!(touching.is_empty(), "{touching:?}");
}

#[test]
fn a_pattern_whose_end_meets_its_start_at_a_corner_does_not_cross_itself() {
    let corners = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1], [0.0, 0.0]];
    let points: Vec<Point> = corners.iter().map(|corner| Point::from(*corner)).collect();
    let square = Pattern::along(&points, 1e-3).unwrap();
    assert!(crossings(&square.sampled(0.002)).is_empty());
    // An end that extends beyond the line does cross it.
    let mut points = points;
    points[4] = Point::new(0.0, -0.02);
    let beyond = Pattern::along(&points, 1e-3).unwrap().with_lead_in(0.05);
    assert_eq!(crossings(&beyond.sampled(0.002)).len(), 1);
}

#[test]
fn patterns_of_the_reference_are_smooth_and_near() {
    let Some(text) = crate::reference::text("patterns/patterns_raw.csv") else {
        return;
    };
    for name in ["line", "circle", "sine", "U", "C", "L", "A"] {
        let points: Vec<Point> = text
            .lines()
            .map(|line| line.split(',').collect::<Vec<_>>())
            .filter(|row| row[0] == name)
            .map(|row| Point::new(row[2].parse().unwrap(), row[3].parse().unwrap()))
            .collect();
        assert!(points.len() > 100, "{name}");
        let pattern = Pattern::along(&points, 5e-4).unwrap();
        let length: f64 = points
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).norm())
            .sum();
        assert!((pattern.length() / length - 1.0).abs() < 0.01, "{name}");
        let sharpest = pattern
            .sampled(0.002)
            .iter()
            .fold(0.0, |most: f64, p| most.max(p.curvature.abs()));
        assert!(sharpest < 60.0, "{name}: {sharpest}");
    }
}
