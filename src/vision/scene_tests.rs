//! The rendered scenes with known centrelines, if the shared data is present.

use super::trace_tests::distance;
use super::*;
use serde::Deserialize;
use std::fs;
use std::path::{Path, PathBuf};

/// Distance within which a centreline covers a point of a rod, pixels.
const COVERS: f64 = 6.0;
/// Part of a rod that its strand must cover.
const COVERED: f64 = 0.95;
/// Largest distance between the ends of a strand and those of its rod, pixels.
const ENDS: f64 = 20.0;
/// The scenes: thirteen kinds, two of each.
const KINDS: [&str; 13] = [
    "clutter",
    "cropped",
    "crossings",
    "glare",
    "gripper",
    "lowlight",
    "plain",
    "samecolour",
    "shadows",
    "thin",
    "touch",
    "white",
    "wood",
];

#[derive(Deserialize)]
struct Truth {
    rods: Vec<Vec<[f64; 2]>>,
}

/// A picture, and the parts of its rods inside of it.
struct Scene {
    name: String,
    picture: image::RgbImage,
    rods: Vec<Vec<Point>>,
}

/// Pictures next to the checkout.
fn folder() -> Option<PathBuf> {
    let folder =
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("../shared/vision/scenes");
    if !folder.is_dir() {
        eprintln!("skipped: {} is not there", folder.display());
    }
    folder.is_dir().then_some(folder)
}

fn scene(folder: &Path, name: String) -> Scene {
    let picture = read_picture(&folder.join(format!("{name}.jpg"))).expect("a picture");
    let text = fs::read_to_string(folder.join(format!("{name}.json"))).expect("a truth");
    // A list of lists of numbers is also a value of TOML.
    let truth: Truth = toml::from_str(&format!("rods = {text}")).expect("lines");
    let (width, height) = (f64::from(picture.width()), f64::from(picture.height()));
    let is_inside = |point: &Point| {
        (-0.5..=width - 0.5).contains(&point.x) && (-0.5..=height - 0.5).contains(&point.y)
    };
    let inside = |rod: Vec<[f64; 2]>| {
        let points = rod.into_iter().map(Point::from);
        points.filter(is_inside).collect()
    };
    Scene {
        rods: truth.rods.into_iter().map(inside).collect(),
        name,
        picture,
    }
}

/// Whether a strand covers a rod from end to end.
fn is_whole(strand: &Strand, rod: &[Point]) -> bool {
    let covered = rod
        .iter()
        .filter(|point| distance(&strand.points, **point).0 <= COVERS);
    let ends = |line: &[Point]| [line[0], line[line.len() - 1]];
    let ([a, b], [c, d]) = (ends(&strand.points), ends(rod));
    let straight = (a - c).norm().max((b - d).norm());
    let crossed = (a - d).norm().max((b - c).norm());
    covered.count() as f64 >= COVERED * rod.len() as f64 && straight.min(crossed) <= ENDS
}

/// Number of scenes in which each rod is one strand from end to end, and there are no others.
fn whole_scenes(case: &str, options: impl Fn(&str, usize) -> TraceOptions) -> Option<usize> {
    let folder = folder()?;
    let mut count = 0;
    for kind in KINDS {
        for number in 0..2 {
            let scene = scene(&folder, format!("{kind}{number}"));
            let found = trace(&scene.picture, &options(kind, scene.rods.len()));
            let strands = found.map(|found| found.strands).unwrap_or_default();
            let is_found = |rod: &Vec<Point>| strands.iter().any(|strand| is_whole(strand, rod));
            if strands.len() == scene.rods.len() && scene.rods.iter().all(is_found) {
                count += 1;
            } else {
                println!("{case}: {}: {} strands", scene.name, strands.len());
            }
        }
    }
    println!("{case}: {count} of {} whole", 2 * KINDS.len());
    Some(count)
}

#[test]
fn rods_of_the_scenes_are_whole_by_default() {
    let count = whole_scenes("default", |_, _| TraceOptions::default());
    assert!(count.is_none_or(|count| count >= 26), "{count:?}");
}

#[test]
fn rods_of_the_scenes_are_whole_if_their_number_is_given() {
    let count = whole_scenes("strands", |_, rods| TraceOptions {
        strands: Some(rods),
        ..TraceOptions::default()
    });
    assert!(count.is_none_or(|count| count >= 26), "{count:?}");
}

#[test]
fn rods_of_the_scenes_are_whole_if_their_colour_is_given() {
    let count = whole_scenes("colour", |kind, _| {
        let colours: &[&str] = match kind {
            "touch" | "samecolour" => &["red"],
            "white" => &["relief"],
            "lowlight" => &["tint"],
            "crossings" => &["red", "green", "#3c6ed2:45"],
            _ => &["red", "green"],
        };
        let mut rules = colours
            .iter()
            .map(|colour| ColourRule::parse(colour).expect("a rule"));
        TraceOptions {
            colour: rules.next().expect("a rule"),
            more_colours: rules.collect(),
            ..TraceOptions::default()
        }
    });
    assert!(count.is_none_or(|count| count >= 25), "{count:?}");
}
