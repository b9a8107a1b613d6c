//! Kinematic chains from URDF files.

use crate::body::{Body, Shape};
use crate::chain::{Chain, Follower, Joint, JointKind, Limits, MOST_JOINTS, Motion, Segment};
use crate::mesh::{locate, read_stl};
use crate::pose::{Pose, pose_of_angles};
use nalgebra::{UnitVector3, Vector3};
use rodlab_files::input;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

mod check;
mod model;

use model::{Geometry, JointType, Robot};

/// Largest file, bytes.
const LARGEST: u64 = 16 << 20;

/// Assumed velocity limit of revolute joints without one in the file, rad/s.
const ASSUMED_TURNING: f64 = 1.0;
/// Assumed velocity limit of prismatic joints without one, m/s.
const ASSUMED_SLIDING: f64 = 0.1;

/// Reason why a URDF file is rejected.
#[derive(Debug, thiserror::Error)]
pub enum UrdfError {
    /// The file cannot be read, or is not a URDF file.
    #[error("{path}: {reason}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The links and joints of the file do not form the requested chain.
    #[error("{path}: {reason}")]
    Chain {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
}

/// A chain and the collision shapes of its links.
#[derive(Debug)]
pub struct UrdfArm {
    /// The chain; accelerations and jerks are unlimited if the file gives no limits.
    pub chain: Chain,
    /// Shapes of the links of the chain and of everything fixed to them, in the frames of the
    /// chain's links.
    pub bodies: Vec<Body>,
    /// Collision meshes that were ignored. Only STL files are used, as convex hulls; `package://`
    /// is resolved only in the folder of the URDF and in those above it.
    pub meshes: Vec<String>,
    /// Messages about other ignored parts and assumed values.
    pub notes: Vec<String>,
}

/// Reads the chain from the link `base` to the link `tip` . If they are not given, `base` is the
/// only link without a parent, and `tip` the only one without children.
///
/// # Errors
/// The file cannot be read, is nested too deep, or has too many links, joints or shapes; a name is
/// used twice, a number is not finite, or a size is not positive; the file has a loop, lacks a
/// link or a mesh, has a lower limit above the upper one, or has more than twelve joints in the
/// chain.
pub fn read_urdf(path: &Path, base: Option<&str>, tip: Option<&str>) -> Result<UrdfArm, UrdfError> {
    let unreadable = |reason: String| UrdfError::Unreadable {
        path: path.to_owned(),
        reason,
    };
    let bytes = input::read(path, LARGEST)
        .map_err(|reason| unreadable(format!("cannot be read: {reason}")))?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let robot = robot(&input::xml_text(&bytes), &name).map_err(unreadable)?;
    arm(robot, base, tip, path.parent().unwrap_or(Path::new(""))).map_err(|reason| {
        UrdfError::Chain {
            path: path.to_owned(),
            reason,
        }
    })
}

/// Parses a robot from text; checks that names are unique and numbers are usable.
fn robot(text: &str, name: &str) -> Result<Robot, String> {
    let robot = Robot::read(text, name)?;
    check::check(&robot)?;
    Ok(robot)
}

fn arm(
    mut robot: Robot,
    base: Option<&str>,
    tip: Option<&str>,
    directory: &Path,
) -> Result<UrdfArm, String> {
    let mut notes = std::mem::take(&mut robot.notes);
    let robot = &robot;
    let links: BTreeSet<&str> = robot.links.iter().map(|link| link.name.as_str()).collect();
    let mut parents: BTreeMap<&str, &model::Joint> = BTreeMap::new();
    for joint in &robot.joints {
        for (role, link) in [("parent", &joint.parent), ("child", &joint.child)] {
            if !links.contains(link.as_str()) {
                return Err(format!(
                    "line {}: joint `{}`: its {role} link `{link}` is not in the file",
                    joint.line, joint.name
                ));
            }
        }
        if let Some(other) = parents.insert(&joint.child, joint) {
            return Err(format!(
                "link `{}` is the child of two joints, `{}` and `{}`: the chain has a loop",
                joint.child, other.name, joint.name
            ));
        }
    }
    for link in &links {
        let mut at = *link;
        for _ in 0..links.len() {
            match parents.get(at) {
                Some(joint) => at = &joint.parent,
                None => break,
            }
        }
        if parents.contains_key(at) {
            return Err(format!("link `{link}` is part of a loop of joints"));
        }
    }
    let base = end_of(base, "base_link", &links, |link| {
        !parents.contains_key(link)
    })?;
    let tip = match tip {
        Some(_) => end_of(tip, "tip_link", &links, |_| false)?,
        None => moving_tip(robot, base, &links, &parents, &mut notes)?,
    };
    let mut path = Vec::new();
    let mut at = tip;
    while at != base {
        let joint = parents
            .get(at)
            .ok_or_else(|| format!("no joints lead from link `{base}` to link `{tip}`"))?;
        path.push(*joint);
        at = &joint.parent;
    }
    path.reverse();
    let chain = chain(robot, &path, &mut notes)?;
    let (bodies, meshes) = bodies(robot, &chain, base, directory)?;
    Ok(UrdfArm {
        chain,
        bodies,
        meshes,
        notes,
    })
}

/// The only link without children. If there are several, the only one of them that moves.
fn moving_tip<'a>(
    robot: &'a Robot,
    base: &str,
    links: &BTreeSet<&'a str>,
    parents: &BTreeMap<&str, &'a model::Joint>,
    notes: &mut Vec<String>,
) -> Result<&'a str, String> {
    let parent_links: BTreeSet<&str> = robot
        .joints
        .iter()
        .map(|joint| joint.parent.as_str())
        .collect();
    let is_end = |link: &&&str| !parent_links.contains(**link);
    let ends: Vec<&str> = links.iter().filter(is_end).copied().collect();
    // Number of moving joints between the base and a link; `None` if they are not connected.
    let moving = |link: &str| {
        let (mut at, mut count) = (link, 0);
        while at != base {
            let joint = parents.get(at)?;
            count += usize::from(kind(joint).is_some());
            at = &joint.parent;
        }
        Some(count)
    };
    let counted: Vec<(&str, usize)> = ends
        .iter()
        .filter_map(|end| Some((*end, moving(end)?)))
        .filter(|(_, count)| *count > 0)
        .collect();
    match (counted.as_slice(), ends.as_slice()) {
        ([(only, _)], [_, _, ..]) => {
            notes.push(format!(
                "the tip is link `{only}`, the only end that moves; `tip_link` names another"
            ));
            Ok(only)
        }
        ([(only, _)], _) | ([], [only]) => Ok(only),
        ([], []) => Err("the file has no links".into()),
        ([], several) => Err(format!(
            "several links could be the tip; set `tip_link` to one of: {}",
            several.join(", ")
        )),
        (several, _) => {
            let listed = several.iter().map(|(end, count)| match count {
                1 => format!("{end} (1 moving joint)"),
                _ => format!("{end} ({count} moving joints)"),
            });
            Err(format!(
                "several links could be the tip; set `tip_link` to one of: {}",
                listed.collect::<Vec<_>>().join(", ")
            ))
        }
    }
}

fn end_of<'a>(
    given: Option<&str>,
    key: &str,
    links: &BTreeSet<&'a str>,
    is_end: impl Fn(&str) -> bool,
) -> Result<&'a str, String> {
    let listed = |names: &[&str]| names.join(", ");
    if let Some(name) = given {
        let all: Vec<&str> = links.iter().copied().collect();
        return links
            .get(name)
            .copied()
            .ok_or_else(|| format!("no link `{name}` in the file; allowed: {}", listed(&all)));
    }
    let ends: Vec<&str> = links.iter().copied().filter(|link| is_end(link)).collect();
    match ends.as_slice() {
        [only] => Ok(only),
        [] => Err("the file has no links".into()),
        several => Err(format!(
            "several links are possible; set `{key}` to one of: {}",
            listed(several)
        )),
    }
}

/// The joints of a path as a chain. If a joint mimics another joint, that joint must be on the
/// path, too.
fn chain(robot: &Robot, path: &[&model::Joint], notes: &mut Vec<String>) -> Result<Chain, String> {
    let own: Vec<&&model::Joint> = path
        .iter()
        .filter(|joint| joint.mimic.is_none() && kind(joint).is_some())
        .collect();
    if own.is_empty() {
        return Err("no joint between base and tip can move".into());
    }
    if own.len() > MOST_JOINTS {
        return Err(format!(
            "{} joints between base and tip; allowed: {MOST_JOINTS} at most",
            own.len()
        ));
    }
    let joints = own
        .iter()
        .map(|joint| own_joint(joint, notes))
        .collect::<Result<Vec<Joint>, String>>()?;
    let index = |name: &str| own.iter().position(|joint| joint.name == name);
    let segments = path
        .iter()
        .map(|joint| {
            let motion = match kind(joint) {
                None => match &joint.joint_type {
                    JointType::Other(kind) => {
                        return Err(format!(
                            "line {}: joint `{}`: {kind} joints cannot be part of a chain; \
                             allowed: revolute, continuous, prismatic, fixed",
                            joint.line, joint.name
                        ));
                    }
                    _ => Motion::Fixed,
                },
                Some(kind) => driven(robot, joint, kind, &index)?,
            };
            Ok(Segment {
                link: joint.child.clone(),
                origin: pose_of(&joint.origin),
                motion,
            })
        })
        .collect::<Result<Vec<Segment>, String>>()?;
    let mut chain = Chain {
        joints,
        followers: followers(path, &segments),
        segments,
        tool: Pose::identity(),
    };
    chain.apply_followers()?;
    Ok(chain)
}

/// The joints that mimic others, with their own limits.
fn followers(path: &[&model::Joint], segments: &[Segment]) -> Vec<Follower> {
    let pairs = path.iter().zip(segments);
    let followers = pairs.filter_map(|(joint, segment)| match segment.motion {
        Motion::Driven {
            joint: leader,
            ratio,
            offset,
            ..
        } if joint.mimic.is_some() => Some(Follower {
            name: joint.name.clone(),
            joint: leader,
            ratio,
            offset,
            limits: follower_limits(joint),
        }),
        _ => None,
    });
    followers.collect()
}

fn driven(
    robot: &Robot,
    joint: &model::Joint,
    kind: JointKind,
    index: &dyn Fn(&str) -> Option<usize>,
) -> Result<Motion, String> {
    let axis = UnitVector3::try_new(Vector3::from(joint.axis), 1e-9).ok_or_else(|| {
        format!(
            "line {}: joint `{}`: its axis has no direction",
            joint.line, joint.name
        )
    })?;
    let (name, ratio, offset) = match &joint.mimic {
        None => (&joint.name, 1.0, 0.0),
        Some(mimic) => (&mimic.joint, mimic.multiplier, mimic.offset),
    };
    let joint_index = index(name).ok_or_else(|| {
        let known = robot.joints.iter().any(|other| other.name == *name);
        let what = if known {
            "is not between base and tip"
        } else {
            "is not in the file"
        };
        format!(
            "line {}: joint `{}`: joint `{name}`, which it mimics, {what}",
            joint.line, joint.name
        )
    })?;
    Ok(Motion::Driven {
        kind,
        axis,
        joint: joint_index,
        ratio,
        offset,
    })
}

fn kind(joint: &model::Joint) -> Option<JointKind> {
    match joint.joint_type {
        JointType::Revolute | JointType::Continuous => Some(JointKind::Revolute),
        JointType::Prismatic => Some(JointKind::Prismatic),
        _ => None,
    }
}

/// An independent joint. A range and a speed that the file does not state are assumed, with a
/// message.
fn own_joint(joint: &model::Joint, notes: &mut Vec<String>) -> Result<Joint, String> {
    let kind = kind(joint).unwrap_or(JointKind::Revolute);
    let mut limits = limits_of(joint);
    let model::Limit { lower, upper, .. } = joint.limit;
    let mut assumed = Vec::new();
    if joint.joint_type == JointType::Revolute && (lower, upper) == (None, None) {
        (limits.lower, limits.upper) = (-PI, PI);
        assumed.push("a range from -π to π".to_owned());
    }
    if limits.velocity.is_infinite() {
        let unit;
        (limits.velocity, unit) = match kind {
            JointKind::Revolute => (ASSUMED_TURNING, "rad/s"),
            JointKind::Prismatic => (ASSUMED_SLIDING, "m/s"),
        };
        assumed.push(format!("a velocity of at most {} {unit}", limits.velocity));
    }
    if !assumed.is_empty() {
        notes.push(format!(
            "line {}: joint `{}` does not state all of its <limit>; assumed: {}",
            joint.line,
            joint.name,
            assumed.join(", ")
        ));
    }
    if !(limits.lower < limits.upper) {
        return Err(format!(
            "line {}: joint `{}`: its lower limit {} must be below its upper limit {}",
            joint.line, joint.name, limits.lower, limits.upper
        ));
    }
    Ok(Joint {
        name: joint.name.clone(),
        kind,
        limits,
    })
}

/// Limits of a joint as stated; a missing side of its range is 0. A velocity, acceleration or jerk
/// of 0 means no limit.
fn limits_of(joint: &model::Joint) -> Limits {
    let limit = &joint.limit;
    let (lower, upper) = if joint.joint_type == JointType::Continuous {
        (f64::NEG_INFINITY, f64::INFINITY)
    } else {
        (limit.lower.unwrap_or(0.0), limit.upper.unwrap_or(0.0))
    };
    let positive = |value: Option<f64>| value.filter(|value| *value > 0.0).unwrap_or(f64::INFINITY);
    Limits {
        lower,
        upper,
        velocity: positive(limit.velocity),
        acceleration: positive(limit.acceleration),
        jerk: positive(limit.jerk),
    }
}

/// Limits of a joint that mimics another. A range from 0 to 0 means a `<limit>` without a range,
/// so that the range is unlimited.
fn follower_limits(joint: &model::Joint) -> Limits {
    let mut limits = limits_of(joint);
    if limits.lower == 0.0 && limits.upper == 0.0 {
        (limits.lower, limits.upper) = (f64::NEG_INFINITY, f64::INFINITY);
    }
    limits
}

fn pose_of(origin: &model::Origin) -> Pose {
    pose_of_angles(origin.xyz, origin.rpy)
}

/// Collision shapes of the base, of the links of the chain and of everything attached to them;
/// joints off the chain are at zero.
fn bodies(
    robot: &Robot,
    chain: &Chain,
    base: &str,
    directory: &Path,
) -> Result<(Vec<Body>, Vec<String>), String> {
    let mut frames: BTreeMap<&str, (Option<usize>, Pose)> = BTreeMap::new();
    frames.insert(base, (None, Pose::identity()));
    for (index, segment) in chain.segments.iter().enumerate() {
        frames.insert(&segment.link, (Some(index), Pose::identity()));
    }
    loop {
        let before = frames.len();
        for joint in &robot.joints {
            if let Some((link, pose)) = frames.get(joint.parent.as_str()).copied() {
                let pose = pose * pose_of(&joint.origin);
                frames.entry(&joint.child).or_insert((link, pose));
            }
        }
        if frames.len() == before {
            break;
        }
    }
    let (mut bodies, mut meshes) = (Vec::new(), Vec::new());
    for link in &robot.links {
        let Some((index, frame)) = frames.get(link.name.as_str()).copied() else {
            continue;
        };
        for collision in &link.collision {
            let pose = frame * pose_of(&collision.origin);
            let shape = match &collision.geometry {
                Geometry::Box { size } => Shape::Box {
                    half: size.map(|side| side / 2.0),
                },
                Geometry::Sphere { radius } => Shape::Capsule {
                    half_length: 0.0,
                    radius: *radius,
                },
                // A capsule with the length of the cylinder contains the cylinder.
                Geometry::Cylinder { radius, length } | Geometry::Capsule { radius, length } => {
                    Shape::Capsule {
                        half_length: length / 2.0,
                        radius: *radius,
                    }
                }
                Geometry::Mesh { filename, scale } => {
                    let fault =
                        |what: String| format!("line {}: link `{}`: {what}", link.line, link.name);
                    let is_stl = |path: &PathBuf| {
                        path.extension()
                            .is_some_and(|extension| extension.eq_ignore_ascii_case("stl"))
                    };
                    let found = locate(filename, directory);
                    let Some(path) = found.filter(is_stl) else {
                        meshes.push(filename.clone());
                        continue;
                    };
                    let mut corners = read_stl(&path).map_err(fault)?;
                    for corner in &mut corners {
                        *corner = [0, 1, 2].map(|k| corner[k] * scale[k]);
                    }
                    let mut lengths = corners.iter().flatten();
                    if !lengths.all(|length| length.abs() <= check::LARGEST_LENGTH) {
                        return Err(fault(format!(
                            "its mesh {filename} has corners beyond {} m",
                            check::LARGEST_LENGTH
                        )));
                    }
                    let hull = Body::hull(index, &pose, &corners)
                        .ok_or_else(|| fault(format!("its mesh {filename} spans no surface")))?;
                    bodies.push(hull);
                    continue;
                }
            };
            bodies.push(Body {
                link: index,
                pose,
                shape,
            });
        }
    }
    Ok((bodies, meshes))
}
