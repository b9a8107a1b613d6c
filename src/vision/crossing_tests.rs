//! Regression tests for paths through crossings.

use super::render::{RenderOptions, render};
use super::trace_tests::{camera, distance, imaged, scene};
use super::*;
use image::{Rgb, RgbImage};

const RED: [u8; 3] = [200, 60, 70];
const GREEN: [u8; 3] = [70, 170, 90];

/// Strokes 7 pixels wide on black, each on top of the previous ones.
fn picture(strokes: &[([[f64; 2]; 2], [u8; 3])]) -> RgbImage {
    RgbImage::from_fn(200, 120, |u, v| {
        let pixel = Point::new(f64::from(u), f64::from(v));
        let all = strokes.iter().rev();
        let on_top = all
            .into_iter()
            .find(|(ends, _)| mask::tests::distance(*ends, pixel) < 3.5);
        Rgb(on_top.map_or([8; 3], |(_, colour)| *colour))
    })
}

#[test]
fn strands_of_one_hue_that_cross_under_another_continue_straight() {
    for beside in [0.0, 4.0, 7.0] {
        let picture = picture(&[
            ([[40.0, 20.0], [160.0, 100.0]], RED),
            ([[40.0, 100.0], [160.0, 20.0]], RED),
            ([[100.0 + beside, 8.0], [100.0 + beside, 112.0]], GREEN),
        ]);
        let found = trace(&picture, &TraceOptions::default()).expect("strands");
        assert_eq!(found.strands.len(), 3, "{beside}");
        for strand in &found.strands {
            let (first, last) = (strand.points[0], strand.points[strand.points.len() - 1]);
            let tangent = (last - first).normalize();
            let off = |point: &Point| tangent.perp(&(point - first)).abs();
            let worst = strand.points.iter().map(off).fold(0.0, f64::max);
            assert!(worst < 1.5, "{beside}: {worst}");
        }
    }
}

#[test]
fn an_end_that_sticks_out_beyond_another_strand_is_followed_to_its_tip() {
    for out in [2.0, 4.0, 6.0] {
        let tip = 60.0 - 3.5 - out;
        let picture = picture(&[
            ([[20.0, 60.0], [180.0, 60.0]], RED),
            ([[100.0, 110.0], [100.0, tip + 3.5]], RED),
        ]);
        let found = trace(&picture, &TraceOptions::default()).expect("strands");
        assert_eq!(
            (found.strands.len(), found.crossings.len()),
            (2, 1),
            "{out}"
        );
        let all = found.strands.iter().flat_map(|strand| &strand.points);
        let highest = all.map(|point| point.y).fold(f64::INFINITY, f64::min);
        assert!((highest - tip).abs() < 2.0, "{out}: {highest}");
    }
}

#[test]
fn an_end_that_stops_on_another_strand_is_not_followed_beyond_it() {
    let picture = picture(&[
        ([[20.0, 60.0], [180.0, 60.0]], RED),
        ([[100.0, 110.0], [100.0, 60.0]], RED),
    ]);
    let found = trace(&picture, &TraceOptions::default()).expect("strands");
    assert_eq!((found.strands.len(), found.crossings.len()), (2, 0));
}

/// A regression test: the end of a strand that emerges from under another one was too narrow to be
/// measured, and was extended straight by 26 pixels.
#[test]
fn an_end_that_cannot_be_measured_stays_on_the_mask() {
    let view = camera(0.0, 0.0);
    for (number, rods) in [(5031, 3), (5092, 3)] {
        let rods = scene(number, rods);
        let ground = |_| [12.0, 12.0, 14.0];
        let picture = render(&view, &rods, ground, &RenderOptions::default());
        let found = trace(&picture, &TraceOptions::default()).expect("strands");
        let lines: Vec<Vec<Point>> = rods.iter().map(|rod| imaged(&view, rod)).collect();
        let away = |point: &Point| {
            let distances = lines.iter().map(|line| distance(line, *point).0);
            distances.fold(f64::INFINITY, f64::min)
        };
        let points = found.strands.iter().flat_map(|strand| &strand.points);
        let worst = points.map(away).fold(0.0, f64::max);
        assert!(worst < 7.0, "{number}: {worst}");
    }
}
