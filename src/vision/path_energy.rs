//! Energy of a path from one arm of a crossing to another: its bending, and the change of its
//! colour.

use super::Point;
use super::colour::colour_difference;
use super::skeleton::{Arm, Branch, Skeleton};
use nalgebra::Matrix3;

/// Length of an arm that determines its direction, in widths.
const DIRECTION_STRETCH: f64 = 2.5;
/// Colour difference equivalent to an energy of one half.
const COLOUR_SCALE: f64 = 20.0;
/// Upper bound of the energy of a change of colour: light and shadow also change colours.
const COLOUR_CAP: f64 = 8.0;

/// Point at which an arm leaves the distorted part of the skeleton at a crossing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Departure {
    pub position: Point,
    /// Unit vector pointing away from the crossing.
    pub direction: Point,
    pub colour: [f64; 3],
}

pub(super) fn unit(vector: Point) -> Point {
    vector.try_normalize(1e-9).unwrap_or(Point::x())
}

/// Index on the branch of an arm's pixel with number `index` from the crossing.
fn place(branch: &Branch, arm: Arm, index: usize) -> usize {
    match arm.side {
        0 => index,
        _ => branch.pixels.len() - 1 - index,
    }
}

/// Number of pixels at the start of an arm that a crossing distorts. There, the mask is wider than
/// along the branch. The number corresponds to at least half a width, and to at most a third of
/// the branch.
pub(super) fn distorted_pixels(skeleton: &Skeleton, arm: Arm) -> usize {
    let branch = &skeleton.branches[arm.branch];
    let count = branch.pixels.len();
    let usual = branch.half_width();
    let wide = |index: usize| branch.half_widths[place(branch, arm, index)] > 1.1 * usual + 0.3;
    let widened = (0..count).take_while(|index| wide(*index)).count();
    widened.max(usual.ceil() as usize).min(count / 3)
}

pub(super) fn departure(
    skeleton: &Skeleton,
    arm: Arm,
    centre: Point,
    colour: impl Fn(Point) -> [f64; 3],
) -> Departure {
    let branch = &skeleton.branches[arm.branch];
    let count = branch.pixels.len();
    let skipped = distorted_pixels(skeleton, arm);
    let stretch = (DIRECTION_STRETCH * 2.0 * branch.half_width()).ceil() as usize;
    let used = stretch.max(4).min(count - skipped);
    let pixel = |index: usize| branch.pixels[place(branch, arm, skipped + index)];
    if used < 3 {
        let ends = branch.nodes.expect("an arm has nodes");
        let far = skeleton.nodes[ends[1 - arm.side]].position;
        let near = if used > 0 { pixel(0) } else { centre };
        return Departure {
            position: near,
            direction: unit(far - centre),
            colour: colour(near),
        };
    }
    let points: Vec<Point> = (0..used).map(pixel).collect();
    let (position, direction) = quadratic_start(&points);
    let mut sum = [0.0; 3];
    for point in &points {
        for (sum, value) in sum.iter_mut().zip(colour(*point)) {
            *sum += value / used as f64;
        }
    }
    Departure {
        position,
        direction: unit(direction),
        colour: sum,
    }
}

/// Position and derivative at the first point of a least-squares parabola through points.
pub(super) fn quadratic_start(points: &[Point]) -> (Point, Point) {
    let mut normal = Matrix3::zeros();
    let mut right = [nalgebra::Vector3::zeros(); 2];
    for (index, point) in points.iter().enumerate() {
        let s = index as f64 / points.len() as f64;
        let powers = nalgebra::Vector3::new(1.0, s, s * s);
        normal += powers * powers.transpose();
        right[0] += powers * point.x;
        right[1] += powers * point.y;
    }
    let chord = points[points.len() - 1] - points[0];
    let Some(inverse) = normal.try_inverse() else {
        return (points[0], chord);
    };
    let [x, y] = right.map(|right| inverse * right);
    let derivative = Point::new(x[1], y[1]);
    // Short arms bend less than their pixels suggest.
    let derivative = if derivative.dot(&chord) > 0.0 {
        derivative
    } else {
        chord
    };
    (Point::new(x[0], y[0]), derivative)
}

/// Energies of the paths between all pairs of arms, with the parts for the change of colour.
pub(super) fn pair_energies(departures: &[Departure], width: f64) -> Vec<Vec<f64>> {
    let row = |a: &Departure| {
        let energies = departures.iter().map(|b| pair_energy(a, b, width));
        energies.collect()
    };
    departures.iter().map(row).collect()
}

/// Energy of the path between two arms, with the part for the change of colour.
pub(super) fn pair_energy(a: &Departure, b: &Departure, width: f64) -> f64 {
    let colours = colour_difference(a.colour, b.colour) / COLOUR_SCALE;
    bending_energy(a, b, width) + (0.5 * colours * colours).min(COLOUR_CAP)
}

/// Bending energy of the cubic that joins two arms, times the width.
///
/// With L the length of the chord and a, b the angles between path and chord at both ends, a cubic
/// has ∫ κ² ds = 4 (a² + a b + b²)/L.
fn bending_energy(from: &Departure, to: &Departure, width: f64) -> f64 {
    let chord = to.position - from.position;
    let length = chord.norm().max(0.5 * width);
    let chord = unit(chord);
    let angle = |direction: Point| libm::atan2(chord.perp(&direction), chord.dot(&direction));
    let (a, b) = (angle(-from.direction), angle(to.direction));
    4.0 * (a * a + a * b + b * b) * width / length
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// An arm at a place that leaves the crossing at an angle.
    pub fn arm(x: f64, y: f64, degrees: f64) -> Departure {
        let angle = degrees.to_radians();
        Departure {
            position: Point::new(x, y),
            direction: Point::new(angle.cos(), angle.sin()),
            colour: [50.0, 0.0, 0.0],
        }
    }

    #[test]
    fn a_straight_path_does_not_bend_and_an_arc_bends_as_a_circle_does() {
        let straight = bending_energy(&arm(0.0, 0.0, 180.0), &arm(20.0, 0.0, 0.0), 5.0);
        assert!(straight < 1e-12);
        // A quarter of a right angle on a circle: ∫κ² ds = φ²/(R φ) = φ/R.
        let phi = 22.5f64.to_radians();
        let radius = 100.0;
        let from = arm(0.0, 0.0, 180.0);
        let end = Point::new(radius * phi.sin(), radius * (1.0 - phi.cos()));
        let arc = bending_energy(&from, &arm(end.x, end.y, 22.5), 1.0);
        assert!((arc / (phi / radius) - 1.0).abs() < 0.02, "{arc}");
    }
}
