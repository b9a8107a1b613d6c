//! Tracing of rendered rods, whose centrelines and crossings are known.

use super::camera::tests::looking_at;
use super::render::{RenderOptions, RenderedRod, render};
use super::*;
use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::TAU;

/// A camera 0.6 m above the table that looks down, with a slight roll and tilt.
pub(super) fn camera(roll: f64, slant: f64) -> Camera {
    let turned = UnitQuaternion::from_euler_angles(slant, 0.0, roll);
    let lens = ([620.0; 2], [319.5, 239.5], [0.05, -0.1, 0.0, 0.0, 0.0]);
    looking_at(Vector3::zeros(), 0.6, turned, [640, 480], lens)
}

/// Generator of deterministic numbers from 0 to 1.
pub(super) struct Dice(pub u64);

impl Dice {
    pub(super) fn roll(&mut self) -> f64 {
        self.number() as f64 / (1u64 << 31) as f64
    }

    /// The next integer, below 2³¹.
    pub(super) fn number(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        self.0 >> 33
    }
}

/// A rod of 0.65 m in the middle of the table. Its direction is a sum of a few harmonics, so that
/// its curvature stays below 1/(19 mm). Its height rises and falls, so that it passes over and
/// under itself.
fn wandering_rod(dice: &mut Dice, radius: f64, colour: [u8; 3], level: f64) -> RenderedRod {
    const LENGTH: f64 = 0.65;
    let turns = 2.4 * (dice.roll() - 0.5);
    let amplitudes = [2.2 * dice.roll(), 1.1 * dice.roll()];
    let phases = [TAU * dice.roll(), TAU * dice.roll(), TAU * dice.roll()];
    let start = TAU * dice.roll();
    let count = 1300;
    let step = LENGTH / f64::from(count - 1);
    let mut points: Vec<Vector3<f64>> = Vec::new();
    let (mut x, mut y) = (0.0, 0.0);
    for index in 0..count {
        let s = f64::from(index) / f64::from(count - 1);
        let heading = start
            + TAU * turns * s
            + amplitudes[0] * (TAU * s + phases[0]).sin()
            + amplitudes[1] * (2.0 * TAU * s + phases[1]).sin();
        x += step * heading.cos();
        y += step * heading.sin();
        // At most crossings, the heights differ by more than a diameter.
        let z = radius + level + 1.7 * radius * (1.0 + (TAU * 1.7 * s + phases[2]).sin());
        points.push(Vector3::new(x, y, z));
    }
    let middle = points.iter().sum::<Vector3<f64>>() / f64::from(count);
    for point in &mut points {
        point.x -= middle.x;
        point.y -= middle.y;
    }
    RenderedRod {
        points,
        radius,
        colour,
    }
}

/// Rods of different colours on top of each other; `number` is that of the scene.
pub(super) fn scene(number: u64, count: usize) -> Vec<RenderedRod> {
    const COLOURS: [[u8; 3]; 3] = [[205, 70, 90], [90, 170, 120], [190, 200, 90]];
    let mut dice = Dice(number * 7919 + 17 + count as u64);
    for _ in 0..8 {
        dice.roll();
    }
    (0..count)
        .map(|rod| wandering_rod(&mut dice, 0.0035, COLOURS[rod], 0.0105 * rod as f64))
        .collect()
}

/// The true image of a centreline.
pub(super) fn imaged(camera: &Camera, rod: &RenderedRod) -> Vec<Point> {
    let points = rod.points.iter().filter_map(|point| camera.project(*point));
    points.collect()
}

/// Distance of a point from a polyline, and the parameter of the nearest place.
pub(super) fn distance(line: &[Point], point: Point) -> (f64, f64) {
    let mut best = (f64::INFINITY, 0.0);
    for (index, pair) in line.windows(2).enumerate() {
        let along = pair[1] - pair[0];
        let t = ((point - pair[0]).dot(&along) / along.norm_squared().max(1e-18)).clamp(0.0, 1.0);
        let away = (pair[0] + along * t - point).norm();
        if away < best.0 {
            best = (away, index as f64 + t);
        }
    }
    best
}

/// Passages of true centrelines near a point: all places within a few pixels that are far apart
/// along the rod.
fn passages(camera: &Camera, rods: &[RenderedRod], point: Point) -> Vec<(usize, usize, f64)> {
    let mut found: Vec<(usize, usize, f64)> = Vec::new();
    for (number, rod) in rods.iter().enumerate() {
        let line = imaged(camera, rod);
        let mut last: Option<(usize, f64)> = None;
        for (index, place) in line.iter().enumerate() {
            let away = (place - point).norm();
            if away > 5.0 {
                continue;
            }
            match last {
                Some((before, nearest)) if index - before < 20 => {
                    if away < nearest {
                        let end = found.len() - 1;
                        found[end] = (number, index, rod.points[index].z);
                        last = Some((index, away));
                    } else {
                        last = Some((index, nearest));
                    }
                }
                _ => {
                    found.push((number, index, rod.points[index].z));
                    last = Some((index, away));
                }
            }
        }
    }
    found
}

#[derive(Default)]
struct Totals {
    points: usize,
    error: f64,
    worst: f64,
    crossings: usize,
    right: usize,
    right_count: usize,
    pictures: usize,
}

/// Traces rendered scenes and compares centrelines and the order of crossings with the truth.
fn trial(scenes: u64, rods_each: usize, options: &RenderOptions, camera: &Camera) -> Totals {
    let mut totals = Totals::default();
    for number in 0..scenes {
        let rods = scene(number, rods_each);
        let picture = render(camera, &rods, |_| [12.0, 12.0, 14.0], options);
        let trace = trace(&picture, &TraceOptions::default()).expect("strands");
        totals.pictures += 1;
        totals.right_count += usize::from(trace.strands.len() == rods.len());
        let lines: Vec<Vec<Point>> = rods.iter().map(|rod| imaged(camera, rod)).collect();
        for strand in &trace.strands {
            for point in &strand.points {
                let nearest = lines.iter().map(|line| distance(line, *point).0);
                let error = nearest.fold(f64::INFINITY, f64::min);
                totals.points += 1;
                totals.error += error;
                totals.worst = totals.worst.max(error);
            }
        }
        for crossing in &trace.crossings {
            let passages = passages(camera, &rods, crossing.position);
            // The heights give the true order. Crossings of three strands, and strands too close
            // in height, are not counted.
            let [a, b] = passages[..] else {
                continue;
            };
            if (a.2 - b.2).abs() < 0.004 {
                continue;
            }
            let (top, below) = if a.2 > b.2 { (a, b) } else { (b, a) };
            let over = &trace.strands[crossing.over.strand];
            let direction = over.tangent((crossing.over.at as usize).min(over.points.len() - 1));
            let along = |passage: (usize, usize, f64)| {
                let line = &lines[passage.0];
                let next = (passage.1 + 1).min(line.len() - 1);
                let before = passage.1.saturating_sub(1);
                (line[next] - line[before])
                    .normalize()
                    .dot(&direction)
                    .abs()
            };
            totals.crossings += 1;
            totals.right += usize::from(along(top) > along(below));
        }
    }
    totals
}

#[test]
fn rendered_centrelines_are_found_to_a_fraction_of_a_pixel() {
    let views = [camera(0.0, 0.0), camera(0.7, 0.25), camera(-0.4, -0.3)];
    let lights = [
        RenderOptions::default(),
        RenderOptions {
            noise: 8.0,
            blur: 2,
            ..RenderOptions::default()
        },
        RenderOptions {
            light: Vector3::new(-0.8, 0.5, 0.9),
            ambient: 0.35,
            noise: 4.0,
            ..RenderOptions::default()
        },
    ];
    let mut all = Totals::default();
    for (index, (view, light)) in views.iter().zip(&lights).enumerate() {
        for rods in 1..=3 {
            let found = trial(4, rods, light, view);
            println!(
                "view {index}, {rods} rods: mean {:.3} px, worst {:.2} px, order {}/{}, count {}/{}",
                found.error / found.points as f64,
                found.worst,
                found.right,
                found.crossings,
                found.right_count,
                found.pictures
            );
            all.points += found.points;
            all.error += found.error;
            all.crossings += found.crossings;
            all.right += found.right;
            all.pictures += found.pictures;
            all.right_count += found.right_count;
        }
    }
    let Totals {
        crossings,
        right,
        pictures,
        right_count: whole,
        ..
    } = all;
    let mean = all.error / all.points as f64;
    assert!(mean < 0.5, "mean error {mean} pixels");
    assert!(crossings > 40, "{crossings} crossings");
    // Rods that run side by side or end on each other may be traced in two pieces.
    assert!(
        whole * 10 >= 9 * pictures,
        "all rods in {whole} of {pictures} pictures"
    );
    assert!(
        right * 100 >= 98 * crossings,
        "{right} of {crossings} in order"
    );
}
