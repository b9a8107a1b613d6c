//! Tracing of rods on tables with grain, in low light, beside other objects and in noise.

use super::render::{RenderOptions, RenderedRod, render};
use super::trace_tests::{Dice, camera, distance, imaged, scene};
use super::*;
use image::{Rgb, RgbImage};
use nalgebra::Vector3;

/// A smooth rod across the picture, at the height `y` of its middle, m.
fn rod(y: f64, colour: [u8; 3]) -> RenderedRod {
    let point = |index: i32| {
        let x = f64::from(index) / 400.0 - 0.5;
        Vector3::new(0.5 * x, y + 0.03 * (7.0 * x).sin(), 0.004)
    };
    RenderedRod {
        points: (0..=400).map(point).collect(),
        radius: 0.004,
        colour,
    }
}

const RED: [u8; 3] = [205, 60, 60];
const GREEN: [u8; 3] = [60, 170, 90];
const BLUE: [u8; 3] = [50, 80, 210];

fn picture(rods: &[RenderedRod], table: impl Fn(Point) -> [f64; 3]) -> RgbImage {
    let options = RenderOptions {
        noise: 3.0,
        ..RenderOptions::default()
    };
    render(&camera(0.0, 0.0), rods, table, &options)
}

fn dark(_: Point) -> [f64; 3] {
    [22.0, 24.0, 28.0]
}

/// Wood: one hue, whose brightness varies across the grain.
fn wood(place: Point) -> [f64; 3] {
    let grain = (260.0 * place.y + 4.0 * (9.0 * place.x).sin()).sin()
        + 0.7 * (611.0 * place.y - 3.0 * (13.0 * place.x).cos()).sin();
    [150.0, 104.0, 62.0].map(|part| part * (1.0 + 0.25 * grain))
}

/// Largest distance of the points of a strand from the nearest of the rods, and of the rods from
/// the nearest strand, pixels.
fn worst(found: &Trace, rods: &[RenderedRod]) -> f64 {
    let lines: Vec<Vec<Point>> = rods
        .iter()
        .map(|rod| imaged(&camera(0.0, 0.0), rod))
        .collect();
    let strands: Vec<Vec<Point>> = found.strands.iter().map(|one| one.points.clone()).collect();
    let apart = |from: &[Vec<Point>], to: &[Vec<Point>]| {
        let points = from.iter().flatten();
        points
            .map(|point| {
                let away = to.iter().map(|line| distance(line, *point).0);
                away.fold(f64::INFINITY, f64::min)
            })
            .fold(0.0, f64::max)
    };
    apart(&strands, &lines).max(apart(&lines, &strands))
}

#[test]
fn rods_on_wood_are_found_by_their_tint() {
    let rods = [rod(0.06, RED), rod(-0.06, GREEN)];
    let picture = picture(&rods, wood);
    let plain = Contrast::new(&picture, &ColourRule::Background).expect("a contrast");
    let by_difference = trace_contrast(&picture, &plain, &TraceOptions::default());
    assert!(by_difference.is_err() || by_difference.is_ok_and(|found| found.strands.len() > 2));
    let found = trace(&picture, &TraceOptions::default()).expect("strands");
    assert_eq!(found.strands.len(), 2);
    let worst = worst(&found, &rods);
    assert!(worst < 4.0, "{worst}");
}

#[test]
fn rods_in_low_light_are_found_with_advice() {
    let rods = [rod(0.06, RED), rod(-0.06, GREEN)];
    let mut picture = picture(&rods, dark);
    let mut dice = Dice(5);
    for pixel in picture.pixels_mut() {
        pixel.0 = pixel.0.map(|value| value / 9 + (3.0 * dice.roll()) as u8);
    }
    let found = trace(&picture, &TraceOptions::default()).expect("strands");
    assert_eq!(found.strands.len(), 2);
    let worst = worst(&found, &rods);
    assert!(worst < 4.0, "{worst}");
    let is_dark = |doubt: &Doubt| matches!(doubt, Doubt::Dark { .. });
    assert!(found.doubts.iter().any(is_dark), "{:?}", found.doubts);
}

#[test]
fn noise_is_refused_with_a_remedy() {
    let mut dice = Dice(11);
    let mut picture = RgbImage::new(640, 480);
    for row in (0..480).step_by(6) {
        for column in (0..640).step_by(6) {
            let value = if dice.roll() < 0.4 { 210 } else { 40 };
            for (u, v) in (0..6).flat_map(|u| (0..6).map(move |v| (column + u, row + v))) {
                if u < 640 {
                    picture.put_pixel(u, v, Rgb([value; 3]));
                }
            }
        }
    }
    let error = trace(&picture, &TraceOptions::default()).expect_err("noise");
    assert!(matches!(error, VisionError::Noise { .. }), "{error}");
    assert!(error.to_string().contains("--region"), "{error}");
}

#[test]
fn the_strands_most_like_rods_are_kept() {
    let rods = [rod(0.06, RED), rod(-0.06, RED)];
    // Short stripes of even width.
    let table = |place: Point| {
        let is_stripe = (place.y.abs() - 0.13).abs() < 0.004 && place.x.abs() < 0.03;
        if is_stripe {
            [200.0, 70.0, 60.0]
        } else {
            dark(place)
        }
    };
    let picture = picture(&rods, table);
    let all = trace(&picture, &TraceOptions::default()).expect("strands");
    assert!(all.strands.len() > 2, "{}", all.strands.len());
    let options = TraceOptions {
        strands: Some(2),
        ..TraceOptions::default()
    };
    let found = trace(&picture, &options).expect("strands");
    assert_eq!(found.strands.len(), 2);
    let worst = worst(&found, &rods);
    assert!(worst < 3.0, "{worst}");
    let many = TraceOptions {
        strands: Some(40),
        ..TraceOptions::default()
    };
    let found = trace(&picture, &many).expect("strands");
    let is_few = |doubt: &Doubt| matches!(doubt, Doubt::Few { wanted: 40, .. });
    assert!(found.doubts.iter().any(is_few), "{:?}", found.doubts);
}

#[test]
fn strands_are_cut_at_the_edge_of_the_region() {
    let rods = [rod(0.06, RED), rod(-0.06, RED)];
    let picture = picture(&rods, dark);
    let whole = trace(&picture, &TraceOptions::default()).expect("strands");
    assert_eq!(whole.strands.len(), 2);
    let options = TraceOptions {
        region: Some(Region::parse("200,0,150,240").expect("a region")),
        ..TraceOptions::default()
    };
    let found = trace(&picture, &options).expect("a strand");
    assert_eq!(found.strands.len(), 1);
    assert_eq!(found.labels.dimensions(), picture.dimensions());
    let points = found.strands[0].points.clone();
    for point in &points {
        assert!(
            (199.0..350.5).contains(&point.x) && point.y < 240.0,
            "{point}"
        );
    }
    let ends = [points[0].x, points[points.len() - 1].x];
    assert!(
        ends[0].min(ends[1]) < 203.0 && ends[0].max(ends[1]) > 346.0,
        "{ends:?}"
    );
    let lines: Vec<Vec<Point>> = rods
        .iter()
        .map(|rod| imaged(&camera(0.0, 0.0), rod))
        .collect();
    for point in &points {
        let away = distance(&lines[0], *point)
            .0
            .min(distance(&lines[1], *point).0);
        assert!(away < 2.0, "{away}");
    }
    // A picked pixel counts from the corner of the whole picture.
    let on_rod = points[points.len() / 2];
    let picking = TraceOptions {
        colour: ColourRule::Pick {
            u: on_rod.x.round() as u32,
            v: on_rod.y.round() as u32,
            radius: 40.0,
        },
        ..options.clone()
    };
    let found = trace(&picture, &picking).expect("a strand");
    assert_eq!(found.strands.len(), 1);
    let polygon = TraceOptions {
        region: Some(Region::parse("200,0 350,0 350,240 200,240").expect("a region")),
        ..TraceOptions::default()
    };
    assert_eq!(
        trace(&picture, &polygon).expect("a strand").strands.len(),
        1
    );
}

#[test]
fn several_colours_give_the_strands_of_each() {
    let mut rods = vec![rod(0.06, RED), rod(-0.02, GREEN), rod(-0.1, BLUE)];
    // The blue rod turns upwards and crosses the others.
    for point in &mut rods[2].points {
        *point = Vector3::new(0.4 * point.y + 0.05, 0.9 * point.x, 0.015);
    }
    let picture = picture(&rods, dark);
    let rule = |text| ColourRule::parse(text).expect("a rule");
    let options = TraceOptions {
        colour: rule("red"),
        more_colours: vec![rule("green")],
        ..TraceOptions::default()
    };
    // Blue is above both and is not asked for: gaps under it are closed.
    let found = trace(&picture, &options).expect("strands");
    assert_eq!(found.strands.len(), 2);
    let worst = worst(&found, &rods[..2]);
    assert!(worst < 4.0, "{worst}");
}

#[test]
fn short_strands_are_left_out() {
    let mut rods = vec![rod(0.06, RED), rod(-0.06, RED)];
    rods[1].points.truncate(120);
    let picture = picture(&rods, dark);
    let found = trace(&picture, &TraceOptions::default()).expect("strands");
    assert_eq!(found.strands.len(), 2);
    let options = TraceOptions {
        least_length: 300.0,
        ..TraceOptions::default()
    };
    let found = trace(&picture, &options).expect("a strand");
    assert_eq!((found.strands.len(), found.rejected.len()), (1, 1));
    let too_long = TraceOptions {
        least_length: 3000.0,
        ..TraceOptions::default()
    };
    let error = trace(&picture, &too_long).expect_err("none is so long");
    assert!(matches!(error, VisionError::Short { .. }), "{error}");
}

#[test]
fn clear_pictures_raise_no_doubt() {
    let picture = picture(&scene(2, 1), dark);
    let found = trace(&picture, &TraceOptions::default()).expect("a strand");
    assert_eq!(found.doubts, []);
}

#[test]
fn lighter_and_darker_compare_with_the_surroundings() {
    // The light decreases to the right; one line is lighter, one darker than the table.
    let picture = RgbImage::from_fn(400, 200, |u, v| {
        let light = 1.0 - f64::from(u) / 600.0;
        let paper = match v {
            58..=64 => 190.0,
            140..=146 => 90.0,
            _ => 140.0,
        };
        Rgb([(paper * light) as u8; 3])
    });
    for (rule, row) in [("lighter", 61.0), ("darker", 143.0)] {
        let options = TraceOptions {
            colour: ColourRule::parse(rule).expect("a rule"),
            ..TraceOptions::default()
        };
        let found = trace(&picture, &options).expect("a strand");
        assert_eq!(found.strands.len(), 1, "{rule}");
        for point in &found.strands[0].points {
            assert!((point.y - row).abs() < 1.0, "{rule}: {point}");
        }
    }
}

#[test]
fn white_rods_on_white_are_found_beside_a_dark_one() {
    let white = |place: Point| [226.0, 226.0, 220.0].map(|part| part * (1.0 + 0.05 * place.x));
    let mut rods = vec![
        rod(0.09, [230, 230, 226]),
        rod(-0.09, [232, 231, 226]),
        rod(0.0, BLUE),
    ];
    for light in [[0.3, 0.4, 1.0], [-0.5, 0.2, 1.0], [0.1, -0.6, 1.0]] {
        for point in &mut rods[0].points {
            point.y -= 0.01;
        }
        let options = RenderOptions {
            noise: 2.0,
            light: Vector3::from(light),
            shadow: 0.25,
            ..RenderOptions::default()
        };
        let picture = render(&camera(0.0, 0.0), &rods, white, &options);
        for rule in ["", "relief"] {
            let options = TraceOptions {
                colour: match rule {
                    "" => ColourRule::Background,
                    rule => ColourRule::parse(rule).expect("a rule"),
                },
                ..TraceOptions::default()
            };
            let found = trace(&picture, &options).expect("strands");
            assert_eq!(found.strands.len(), 3, "{light:?}, rule {rule:?}");
            // The shadow is part of the mask: at the ends, up to one width of the rods.
            let worst = worst(&found, &rods);
            assert!(worst < 8.0, "{light:?}, rule {rule:?}: {worst}");
        }
    }
}
