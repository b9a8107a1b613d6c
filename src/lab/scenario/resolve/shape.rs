//! Resolving shapes.

use super::{natural_strains, polyline};
use crate::scenario::resolved::{NaturalShape, Shape};
use crate::scenario::section::Section;
use crate::scenario::typed;
use std::f64::consts::TAU;

/// Resolves a placed shape.
pub fn shape(section: &Section<'_>, typed: &typed::Shape) -> Shape {
    match typed {
        typed::Shape::Straight(line) => straight(section, line),
        typed::Shape::Helix(curve) => helix(section, curve),
        typed::Shape::Arc(curve) => arc(section, curve),
        typed::Shape::Ring(curve) => ring(section, curve),
        typed::Shape::Catenary(chain) => catenary(section, chain),
        typed::Shape::Slack(rod) => slack(section, rod),
        typed::Shape::Coil(rod) => coil(section, rod),
        typed::Shape::Points(points) => polyline::points(section, points),
    }
}

/// Resolves a natural shape.
pub fn natural_shape(section: &Section<'_>, typed: &typed::NaturalShape) -> NaturalShape {
    match typed {
        typed::NaturalShape::AsPlaced(_) => NaturalShape::AsPlaced,
        typed::NaturalShape::Straight(line) if line.start.is_none() && line.end.is_none() => {
            NaturalShape::Straight
        }
        typed::NaturalShape::Straight(line) => NaturalShape::Curve(straight(section, line)),
        typed::NaturalShape::Curved(curved) => NaturalShape::Curved {
            curvature: curved.curvature(section).unwrap_or_default(),
            twist: curved.twist(section),
        },
        typed::NaturalShape::Helix(curve) => NaturalShape::Curve(helix(section, curve)),
        typed::NaturalShape::Arc(curve) => NaturalShape::Curve(arc(section, curve)),
        typed::NaturalShape::Ring(curve) => NaturalShape::Curve(ring(section, curve)),
        typed::NaturalShape::Points(points) => {
            NaturalShape::Curve(polyline::points(section, points))
        }
        typed::NaturalShape::Strains(strains) => {
            NaturalShape::Strains(natural_strains::strains(section, strains))
        }
    }
}

fn straight(section: &Section<'_>, typed: &typed::Straight) -> Shape {
    let start = typed.start(section);
    let end = typed.end(section);
    if start == end {
        section.fault(
            "end",
            "the line has no length: `start` and `end` are the same",
        );
    }
    Shape::Straight { start, end }
}

/// Least horizontal distance of the ends of a chain over its length: for a smaller distance the
/// chain hangs in two strands without a smooth bend.
const LEAST_SPAN: f64 = 1e-3;

fn catenary(section: &Section<'_>, typed: &typed::Catenary) -> Shape {
    let start = typed.start(section);
    let end = typed.end(section);
    let length = typed.length(section);
    let down = typed.down(section);
    let along: [f64; 3] = std::array::from_fn(|i| end[i] - start[i]);
    let fall: f64 = (0..3).map(|i| along[i] * down[i]).sum();
    let span = norm(std::array::from_fn(|i| along[i] - fall * down[i]));
    if !refuse_taut(section, length, norm(along)) && span < LEAST_SPAN * length {
        section.fault(
            "end",
            format!(
                "the horizontal distance of the ends is {span:?} m; allowed: at least a thousandth of the length"
            ),
        );
    }
    Shape::Catenary {
        start,
        end,
        length,
        down,
    }
}

/// Largest ratio of the length of a slack rod to the distance of its ends: with a larger ratio the
/// rod is practically a closed ring.
const MOST_SLACK: f64 = 1e3;

fn slack(section: &Section<'_>, typed: &typed::Slack) -> Shape {
    let start = typed.start(section);
    let end = typed.end(section);
    let length = typed.length(section);
    let towards = typed.towards(section);
    let along: [f64; 3] = std::array::from_fn(|i| end[i] - start[i]);
    let distance = norm(along);
    if !refuse_taut(section, length, distance) && length > MOST_SLACK * distance {
        section.fault(
            "end",
            format!(
                "the ends are {distance:?} m apart; allowed: at least a thousandth of the length"
            ),
        );
    }
    let along = along.map(|component| component / distance);
    let across = part_normal_to(towards, along);
    if across.is_none() {
        let message = "the direction must not be along the line from `start` to `end`";
        section.fault("towards", message);
    }
    Shape::Slack {
        start,
        end,
        length,
        towards: across.unwrap_or(towards),
    }
}

/// Reports a rod that is not longer than the distance of its ends.
fn refuse_taut(section: &Section<'_>, length: f64, distance: f64) -> bool {
    let taut = length <= distance;
    if taut {
        section.out_of_range(
            "length",
            format_args!("{length:?} m"),
            format_args!("greater than the distance of the ends, {distance:?} m"),
        );
    }
    taut
}

fn coil(section: &Section<'_>, typed: &typed::Coil) -> Shape {
    Shape::Coil {
        centre: typed.centre(section),
        normal: typed.normal(section),
        inner_radius: typed.inner_radius(section),
        spacing: typed.spacing(section),
        length: typed.length(section),
        phase: typed.phase(section),
    }
}

fn norm(vector: [f64; 3]) -> f64 {
    vector.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// The normalised component of a unit vector normal to another one; `None` if it is nearly zero.
fn part_normal_to(direction: [f64; 3], axis: [f64; 3]) -> Option<[f64; 3]> {
    let along: f64 = (0..3).map(|i| axis[i] * direction[i]).sum();
    let across: [f64; 3] = std::array::from_fn(|i| direction[i] - along * axis[i]);
    let size = norm(across);
    if size < 1e-6 {
        // Smaller components are lost in round-off.
        None
    } else if along.abs() < 4.0 * f64::EPSILON {
        // An exactly normal direction is unchanged.
        Some(direction)
    } else {
        Some(across.map(|component| component / size))
    }
}

fn helix(section: &Section<'_>, typed: &typed::Helix) -> Shape {
    let axis = typed.axis(section);
    let radius = typed.radius(section);
    let pitch = typed.pitch(section);
    let handedness = typed.handedness(section);
    let phase = typed.phase(section);
    let turns = typed.turns(section);
    let length = typed.length(section);
    let length = match (turns, length) {
        (Some(turns), None) => turns * pitch,
        (None, Some(length)) => length,
        (None, None) => {
            section.missing(
                "length",
                "the length along the axis, or the number of `turns`",
            );
            f64::NAN
        }
        (Some(_), Some(_)) => {
            section.fault("turns", "give `turns` or `length`, not both");
            f64::NAN
        }
    };
    let start = typed.start(section);
    let centre = typed.centre(section);
    let centre = match (start, centre) {
        (None, Some(centre)) => centre,
        (Some(start), None) => {
            let outward = radial_direction(axis, phase);
            std::array::from_fn(|i| start[i] - radius * outward[i])
        }
        (None, None) => {
            section.missing(
                "start",
                "the first point, or the `centre` beside it on the axis",
            );
            [f64::NAN; 3]
        }
        (Some(_), Some(_)) => {
            section.fault("centre", "give `start` or `centre`, not both");
            [f64::NAN; 3]
        }
    };
    Shape::Helix {
        centre,
        axis,
        radius,
        pitch,
        length,
        handedness,
        phase,
    }
}

/// Unit vector from the axis to the point of a helix at the given angle; see [`Shape::Helix`].
fn radial_direction(axis: [f64; 3], phase: f64) -> [f64; 3] {
    let [first, second] = Shape::normal_plane(axis);
    let (sine, cosine) = libm::sincos(phase);
    std::array::from_fn(|i| first[i] * cosine + second[i] * sine)
}

fn arc(section: &Section<'_>, typed: &typed::Arc) -> Shape {
    let tangent = typed.tangent(section);
    let normal = typed.normal(section);
    let across = part_normal_to(normal, tangent);
    if across.is_none() {
        section.fault("normal", "the normal must not be along the tangent");
    }
    let normal = across.unwrap_or(normal);
    let angle = typed.angle(section);
    if angle > TAU {
        let allowed = "greater than 0 and at most a full turn";
        section.out_of_range("angle", format_args!("{angle} rad"), allowed);
    }
    Shape::Arc {
        start: typed.start(section),
        tangent,
        normal,
        radius: typed.radius(section),
        angle,
    }
}

fn ring(section: &Section<'_>, typed: &typed::Ring) -> Shape {
    Shape::Ring {
        centre: typed.centre(section),
        normal: typed.normal(section),
        radius: typed.radius(section),
    }
}
