//! Checks of robots from URDF files: unique names, usable numbers, a bounded number of parts.

use super::model::{self, Geometry, Robot};
use rodlab_files::finite::{self, NotFinite};
use std::collections::BTreeSet;

/// Largest number of links, of joints, and of collision shapes of a file.
const MOST: usize = 1000;
/// Largest length, m. Squares of larger lengths lose precision in distances.
pub(super) const LARGEST_LENGTH: f64 = 1e6;

/// Checks a parsed robot.
///
/// # Errors
/// A message about the first fault.
pub(super) fn check(robot: &Robot) -> Result<(), String> {
    let shapes = robot.links.iter().map(|link| link.collision.len()).sum();
    for (what, count) in [
        ("links", robot.links.len()),
        ("joints", robot.joints.len()),
        ("collision shapes", shapes),
    ] {
        if count > MOST {
            return Err(format!("it has {count} {what}; allowed: at most {MOST}"));
        }
    }
    unique(
        "link",
        robot.links.iter().map(|link| (&link.name, link.line)),
    )?;
    unique(
        "joint",
        robot.joints.iter().map(|joint| (&joint.name, joint.line)),
    )?;
    robot.joints.iter().try_for_each(joint)?;
    robot.links.iter().try_for_each(link)
}

fn unique<'a>(what: &str, names: impl Iterator<Item = (&'a String, u32)>) -> Result<(), String> {
    let mut known = BTreeSet::new();
    for (name, line) in names {
        if !known.insert(name) {
            return Err(format!(
                "line {line}: {what} `{name}` is in the file twice; names must be unique"
            ));
        }
    }
    Ok(())
}

fn joint(joint: &model::Joint) -> Result<(), String> {
    let what = format!("line {}: joint `{}`", joint.line, joint.name);
    origin(&what, &joint.origin)?;
    finite(&format!("{what}: `xyz` of its axis"), &joint.axis)?;
    let limit = &joint.limit;
    // Limits may be infinite.
    for (name, value) in [("lower", limit.lower), ("upper", limit.upper)] {
        if value.is_some_and(f64::is_nan) {
            return Err(format!("{what}: `{name}` of its limit is not a number"));
        }
    }
    // Exporters write zero for unknown limits.
    for (name, value) in [
        ("velocity", limit.velocity),
        ("acceleration", limit.acceleration),
        ("jerk", limit.jerk),
    ] {
        if let Some(value) = value.filter(|value| !(*value >= 0.0)) {
            return Err(format!(
                "{what}: `{name}` of its limit is {value}; allowed: above 0, or 0 for none"
            ));
        }
    }
    if let Some(mimic) = &joint.mimic {
        finite(
            &format!("{what}: `multiplier` or `offset` of its mimic"),
            &[mimic.multiplier, mimic.offset],
        )?;
    }
    Ok(())
}

fn link(link: &model::Link) -> Result<(), String> {
    let what = format!(
        "line {}: link `{}`: its collision shape",
        link.line, link.name
    );
    link.collision.iter().try_for_each(|collision| {
        origin(&what, &collision.origin)?;
        match &collision.geometry {
            Geometry::Box { size } => positive(&what, "size", size),
            Geometry::Sphere { radius } => positive(&what, "radius", &[*radius]),
            Geometry::Cylinder { radius, length } => {
                positive(&what, "radius", &[*radius])?;
                positive(&what, "length", &[*length])
            }
            Geometry::Capsule { radius, length } => {
                positive(&what, "radius", &[*radius])?;
                // A capsule of zero length is a sphere.
                match *length {
                    0.0 => Ok(()),
                    length => positive(&what, "length", &[length]),
                }
            }
            Geometry::Mesh { scale, .. } => scaled(&what, scale),
        }
    })
}

fn origin(what: &str, pose: &model::Origin) -> Result<(), String> {
    let name = format!("{what}: `xyz` of its origin");
    finite(&name, &pose.xyz)?;
    if pose.xyz.iter().any(|length| length.abs() > LARGEST_LENGTH) {
        return Err(format!("{name} is larger than {LARGEST_LENGTH} m"));
    }
    finite(&format!("{what}: `rpy` of its origin"), &pose.rpy)
}

fn finite(what: &str, numbers: &[f64]) -> Result<(), String> {
    finite::check(numbers, |_| what).map_err(|error: NotFinite| error.to_string())
}

fn positive(what: &str, name: &str, sizes: &[f64]) -> Result<(), String> {
    let is_size = |size: &f64| *size > 0.0 && *size <= LARGEST_LENGTH;
    match sizes.iter().find(|size| !is_size(size)) {
        Some(size) => Err(format!(
            "{what}: its `{name}` {size} is not allowed; allowed: above 0, at most {LARGEST_LENGTH} m"
        )),
        None => Ok(()),
    }
}

/// A negative scale mirrors a mesh; zero collapses it.
fn scaled(what: &str, scale: &[f64]) -> Result<(), String> {
    let is_scale = |factor: &f64| *factor != 0.0 && factor.abs() <= LARGEST_LENGTH;
    match scale.iter().find(|factor| !is_scale(factor)) {
        Some(factor) => Err(format!(
            "{what}: its `scale` {factor} is not allowed; allowed: finite numbers except 0"
        )),
        None => Ok(()),
    }
}
