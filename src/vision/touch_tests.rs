//! Tracing of strands of one colour that touch with their ends, and of rods under a gripper.

use super::trace_tests::{Dice, distance};
use super::*;
use image::{Rgb, RgbImage};

const WIDTH: f64 = 10.0;
const RED: [f64; 3] = [190.0, 55.0, 50.0];
const GREEN: [f64; 3] = [60.0, 160.0, 80.0];

/// Lines of a given colour and of [`WIDTH`] on a dark table with noise.
fn picture(lines: &[(&[Point], [f64; 3])], seed: u64) -> RgbImage {
    let mut dice = Dice(seed);
    RgbImage::from_fn(640, 480, |u, v| {
        let place = Point::new(f64::from(u), f64::from(v));
        let mut colour = [46.0, 48.0, 52.0];
        for (line, own) in lines {
            let away = distance(line, place).0;
            let inside = (0.5 * WIDTH - away + 0.5).clamp(0.0, 1.0);
            // The middle of a rod is lighter.
            let shade = 1.0 - 0.35 * (2.0 * away / WIDTH).powi(2);
            for (value, own) in colour.iter_mut().zip(own) {
                *value += inside * (own * shade - *value);
            }
        }
        Rgb(colour.map(|value| (value + 6.0 * (dice.roll() - 0.5)) as u8))
    })
}

/// A line of a given length, direction and curvature from a point.
fn arc(from: Point, degrees: f64, curvature: f64, length: f64) -> Vec<Point> {
    let mut points = vec![from];
    for step in 0..length as usize {
        let angle = degrees.to_radians() + curvature * (step as f64 + 0.5);
        let last = points[step];
        points.push(last + Point::new(angle.cos(), angle.sin()));
    }
    points
}

fn traced(picture: &RgbImage, rule: &str, strands: Option<usize>) -> Vec<Strand> {
    let options = TraceOptions {
        colour: match rule {
            "" => ColourRule::Background,
            rule => ColourRule::parse(rule).expect("a rule"),
        },
        strands,
        ..TraceOptions::default()
    };
    trace(picture, &options).expect("strands").strands
}

/// Largest distance between a strand and a line, in both directions.
fn apart(strand: &Strand, line: &[Point]) -> f64 {
    let there = strand.points.iter().map(|point| distance(line, *point).0);
    let back = line.iter().map(|point| distance(&strand.points, *point).0);
    there.chain(back).fold(0.0, f64::max)
}

/// Asserts that each line has its own strand within a distance.
fn assert_found(strands: &[Strand], lines: &[&[Point]], tolerance: f64, case: &str) {
    assert_eq!(strands.len(), lines.len(), "{case}");
    for line in lines {
        let nearest = strands.iter().map(|strand| apart(strand, line));
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        assert!(nearest < tolerance, "{case}: {nearest}");
    }
}

#[test]
fn drawn_lines_keep_their_corners() {
    let joint = Point::new(320.0, 240.0);
    let [first, second] = [10.0, 100.0].map(|turned| arc(joint, turned, 0.0, 190.0));
    let picture = picture(&[(&first, RED), (&second, RED)], 7);
    let count = |has_corners| {
        let options = TraceOptions {
            has_corners,
            ..TraceOptions::default()
        };
        trace(&picture, &options).expect("strands").strands.len()
    };
    assert_eq!([count(true), count(false)], [1, 2]);
}

#[test]
fn ends_that_meet_at_an_angle_are_two_strands() {
    let joint = Point::new(320.0, 240.0);
    for (turned, apart) in [(10.0, 90.0), (100.0, 75.0), (215.0, 105.0), (300.0, 60.0)] {
        let first = arc(joint, turned, 0.004, 190.0);
        let second = arc(joint, turned + apart, -0.003, 190.0);
        let picture = picture(&[(&first, RED), (&second, RED)], 3);
        for rule in ["", "red"] {
            let case = format!("{apart}° from {turned}°, rule {rule:?}");
            let strands = traced(&picture, rule, None);
            // A strand ends where its round cap ends, half a width beyond its line.
            assert_found(&strands, &[&first, &second], 1.1 * WIDTH, &case);
        }
        // A drawn line may have a corner.
        let negative = RgbImage::from_fn(640, 480, |u, v| {
            Rgb(picture.get_pixel(u, v).0.map(|value| 255 - value))
        });
        assert_eq!(traced(&negative, "pen", None).len(), 1, "{turned}°");
    }
}

#[test]
fn bends_of_three_widths_are_one_strand() {
    for degrees in [60.0, 90.0, 180.0f64] {
        let radius = 3.0 * WIDTH;
        let mut line = arc(Point::new(120.0, 200.0), 0.0, 0.0, 200.0);
        let bend = arc(
            line[line.len() - 1],
            0.0,
            1.0 / radius,
            degrees.to_radians() * radius,
        );
        line.extend(&bend[1..]);
        let rest = arc(line[line.len() - 1], degrees, 0.0, 150.0);
        line.extend(&rest[1..]);
        let strands = traced(&picture(&[(&line, RED)], 5), "", None);
        assert_found(&strands, &[&line], WIDTH, &format!("{degrees}°"));
    }
}

#[test]
fn the_number_of_rods_divides_a_strand_at_a_weak_kink() {
    let joint = Point::new(320.0, 240.0);
    let first = arc(joint, 20.0, 0.003, 190.0);
    let second = arc(joint, 160.0, 0.002, 190.0);
    let picture = picture(&[(&first, RED), (&second, RED)], 9);
    assert_eq!(traced(&picture, "", None).len(), 1);
    let strands = traced(&picture, "", Some(2));
    assert_found(&strands, &[&first, &second], 1.1 * WIDTH, "two rods");
}

#[test]
fn strands_with_a_common_stem_both_reach_its_end() {
    let tip = Point::new(60.0, 240.0);
    for (degrees, curvature) in [(7.0, 0.001), (12.0, 0.0005), (18.0, 0.0)] {
        let first = arc(tip, -0.5 * degrees, -curvature, 420.0);
        let second = arc(tip, 0.5 * degrees, curvature, 300.0);
        for mirrored in [false, true] {
            let flip = |line: &[Point]| -> Vec<Point> {
                let flipped = line.iter().map(|point| match mirrored {
                    true => Point::new(639.0 - point.x, point.y),
                    false => *point,
                });
                flipped.collect()
            };
            let lines = [flip(&first), flip(&second)];
            let picture = picture(&[(&lines[0], RED), (&lines[1], RED)], 11);
            let strands = traced(&picture, "", None);
            let case = format!("{degrees}°, mirrored {mirrored}");
            assert_found(&strands, &[&lines[0], &lines[1]], WIDTH, &case);
        }
    }
}

#[test]
fn an_end_on_the_side_of_another_strand_stays_there() {
    let through = arc(Point::new(60.0, 240.0), 0.0, 0.0, 500.0);
    for degrees in [35.0, 60.0, 90.0] {
        let ending = arc(Point::new(320.0, 240.0), degrees, 0.001, 180.0);
        let picture = picture(&[(&ending, RED), (&through, RED)], 13);
        let strands = traced(&picture, "", None);
        let case = format!("{degrees}°");
        assert_found(&strands, &[&through, &ending], 1.5 * WIDTH, &case);
    }
}

/// Draws a grey gripper: two jaws around a place, and the arm above it.
fn add_gripper(picture: &mut RgbImage, place: Point, [jaws, arm]: [u8; 2]) {
    for (u, v, pixel) in picture.enumerate_pixels_mut() {
        let (x, y) = (f64::from(u) - place.x, f64::from(v) - place.y);
        let (across, along) = (0.8 * x + 0.6 * y, 0.8 * y - 0.6 * x);
        if x.abs() < 14.0 && y < 0.0 {
            *pixel = Rgb([arm; 3]);
        } else if across.abs() < 22.0 && along.abs() < 16.0 {
            *pixel = Rgb([jaws; 3]);
        }
    }
}

#[test]
fn a_rod_under_a_gripper_is_one_strand() {
    let held = arc(Point::new(70.0, 340.0), -35.0, 0.0025, 480.0);
    let other = arc(Point::new(90.0, 100.0), 10.0, -0.002, 130.0);
    for (index, shades) in [(200, [92, 72]), (280, [80, 64]), (330, [110, 76])] {
        let mut picture = picture(&[(&held, RED), (&other, GREEN)], 17);
        add_gripper(&mut picture, held[index], shades);
        let strands = traced(&picture, "", None);
        let case = format!("at {index}, shades {shades:?}");
        assert_found(&strands, &[&held, &other], WIDTH, &case);
    }
}
