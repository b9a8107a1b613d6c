//! The photographs of `scenarios/photographs`. They are rendered, so that they are free to use and
//! reproducible.
//!
//! `RODLAB_WRITE_PHOTOGRAPHS=scenarios/photographs cargo test --lib vision::photograph` redraws
//! them.

use super::camera::tests::looking_at;
use super::render::{RenderOptions, render};
use super::smoothing::resample;
use super::trace_tests::{camera as above_table, scene};
use super::*;
use image::RgbImage;
use image::codecs::jpeg::JpegEncoder;
use nalgebra::{UnitQuaternion, Vector3};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::{Path, PathBuf};

/// Side of the cells of the ink lookup, metres.
const CELL: f64 = 4e-3;

/// A sheet of paper under a desk lamp, with one letter drawn by hand with a slight tremor.
struct Drawing {
    /// Points of the line and half its width there, grouped by cells.
    ink: HashMap<(i32, i32), Vec<(Point, f64)>>,
}

impl Drawing {
    fn new(line: &[Point]) -> Self {
        let mut ink: HashMap<(i32, i32), Vec<(Point, f64)>> = HashMap::new();
        let (points, _) = resample(line, 0.2e-3, false);
        for (index, point) in points.iter().enumerate() {
            let s = 0.2e-3 * index as f64;
            let half_width = 1.2e-3 + 0.12e-3 * (s / 0.031).sin();
            let cell = Self::cell(*point);
            ink.entry(cell).or_default().push((*point, half_width));
        }
        Self { ink }
    }

    fn cell(point: Point) -> (i32, i32) {
        (
            (point.x / CELL).floor() as i32,
            (point.y / CELL).floor() as i32,
        )
    }

    /// Darkness of a place: 1 in the line, 0 on the paper.
    fn darkness(&self, place: Point) -> f64 {
        let (column, row) = Self::cell(place);
        let mut most = 0.0f64;
        for y in row - 1..=row + 1 {
            for x in column - 1..=column + 1 {
                for (point, half_width) in self.ink.get(&(x, y)).into_iter().flatten() {
                    let inside = half_width - (place - point).norm();
                    most = most.max((inside / 0.2e-3 + 0.5).clamp(0.0, 1.0));
                }
            }
        }
        most
    }

    fn colour(&self, place: Point) -> [f64; 3] {
        // The light is brighter towards the upper left.
        let light = 1.0 + 0.35 * (place.y - place.x);
        let ink = 0.82 * self.darkness(place);
        [214.0, 209.0, 197.0].map(|paper| paper * light * (1.0 - ink) + 30.0 * ink)
    }
}

/// An S of two arcs, 0.22 m high, with hand tremor.
fn letter() -> Vec<Point> {
    const RADIUS: f64 = 0.055;
    let wobble = |s: f64| {
        let waves = [
            (0.06, 0.5e-3, 0.3),
            (0.037, 0.4e-3, 1.1),
            (0.012, 0.12e-3, 2.0),
        ];
        let heights =
            waves.map(|(length, height, phase)| height * (TAU * s / length + phase).sin());
        heights.iter().sum::<f64>()
    };
    let half = 1.25 * PI;
    (0..=1000)
        .map(|index| {
            let angle = 2.0 * half * f64::from(index) / 1000.0 - half;
            let s = RADIUS * (angle + half);
            // The upper arc is drawn first, to the left and down; the lower one is its point
            // reflection about the middle.
            let side = if angle < 0.0 { 1.0 } else { -1.0 };
            let radius = RADIUS + wobble(s);
            let turn = angle.abs() - PI / 2.0;
            Point::new(-radius * turn.cos(), RADIUS + radius * turn.sin()) * side
        })
        .collect()
}

/// A camera above the sheet, as if held by hand.
fn above_sheet() -> Camera {
    let slant = UnitQuaternion::from_euler_angles(0.22, -0.1, 0.08);
    let distortion = [0.06, -0.11, 0.0004, -0.0003, 0.0];
    let lens = ([905.0, 903.0], [402.0, 297.0], distortion);
    looking_at(Vector3::zeros(), 0.5, slant, [800, 600], lens)
}

fn letter_photograph() -> RgbImage {
    let drawing = Drawing::new(&letter());
    let options = RenderOptions {
        noise: 2.5,
        seed: 57,
        ..RenderOptions::default()
    };
    render(&above_sheet(), &[], |place| drawing.colour(place), &options)
}

fn rods_photograph() -> RgbImage {
    let (view, rods) = (above_table(0.7, 0.25), scene(SCENE, 3));
    let options = RenderOptions::default();
    render(&view, &rods, |_| [22.0, 24.0, 28.0], &options)
}

/// Index of the scene of random rods.
const SCENE: u64 = 2;

fn folder() -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("scenarios/photographs")
}

#[test]
fn photographs_are_what_the_renderer_draws() {
    let drawn = [
        ("letter.jpg", letter_photograph()),
        ("rods.jpg", rods_photograph()),
    ];
    if let Ok(folder) = std::env::var("RODLAB_WRITE_PHOTOGRAPHS") {
        let folder = Path::new(&folder);
        fs::create_dir_all(folder).expect("a folder");
        for (name, picture) in &drawn {
            let mut bytes = Vec::new();
            JpegEncoder::new_with_quality(&mut bytes, 88)
                .encode_image(picture)
                .expect("a JPEG");
            fs::write(folder.join(name), bytes).expect("a file");
        }
        fs::write(folder.join("camera.toml"), above_sheet().to_toml()).expect("a file");
        return;
    }
    for (name, picture) in drawn {
        let kept = read_picture(&folder().join(name)).expect("a photograph");
        assert_eq!(kept.dimensions(), picture.dimensions(), "{name}");
        let difference: u64 = kept
            .as_raw()
            .iter()
            .zip(picture.as_raw())
            .map(|(a, b)| u64::from(a.abs_diff(*b)))
            .sum();
        let mean = difference as f64 / kept.as_raw().len() as f64;
        assert!(mean < 2.5, "{name} differs by {mean} on average");
    }
    let camera = Camera::read(&folder().join("camera.toml")).expect("a camera");
    assert_eq!(camera.lens, above_sheet().lens);
}

#[test]
fn the_letter_comes_back_from_its_photograph() {
    let picture = read_picture(&folder().join("letter.jpg")).expect("a photograph");
    let camera = Camera::read(&folder().join("camera.toml")).expect("a camera");
    let options = TraceOptions {
        colour: ColourRule::parse("pen").expect("a rule"),
        ..TraceOptions::default()
    };
    let found = trace(&picture, &options).expect("a line");
    assert_eq!(found.strands.len(), 1);
    let curve =
        pattern(&found.strands[0], Metric::Camera(&camera), 0.002, 0.001).expect("a pattern");
    let error = score(&curve, &letter(), 100, false).expect("a score");
    assert!(error.by_nearest_point.largest_m < 0.5e-3, "{error:?}");
}
