//! Kinematic chains from URDF files.

use crate::body::{Body, Shape};
use crate::chain::{Chain, Follower, Joint, JointKind, Limits, MOST_JOINTS, Motion, Segment};
use crate::mesh::{locate, read_stl};
use crate::pose::{Pose, pose_of_angles};
use nalgebra::{UnitVector3, Vector3};
use rodlab_files::input;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use urdf_rs::{Geometry, JointType, Robot};

mod check;

/// Largest file, bytes.
const LARGEST: u64 = 16 << 20;

/// What is wrong with a URDF file.
#[derive(Debug, thiserror::Error)]
pub enum UrdfError {
    /// It cannot be read, or is no URDF.
    #[error("{path}: {reason}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// Its links and joints make no chain of the kind asked for.
    #[error("{path}: {reason}")]
    Chain {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
}

/// A chain and the collision bodies of its links.
#[derive(Debug)]
pub struct UrdfArm {
    /// The chain; accelerations and jerks are infinite where the file gives none.
    pub chain: Chain,
    /// Shapes of the links of the chain and of all that is fixed to them, in the frames of the chain's links.
    pub bodies: Vec<Body>,
    /// Collision meshes that were passed over: only STL files count, as their convex hulls, and of `package://` only
    /// those that are found in a folder above the URDF.
    pub meshes: Vec<String>,
}

/// Reads the chain from the link `base` to the link `tip` (the only link without a parent, and the only one without
/// children, where they are not given).
///
/// # Errors
/// If the file cannot be read, is nested too deep or has too many links, joints or shapes; if a name is used twice, a number is
/// not finite or a size not positive; if it has a loop, misses a link or a mesh, has limits the wrong way round, or more
/// than twelve joints in the chain.
pub fn read_urdf(path: &Path, base: Option<&str>, tip: Option<&str>) -> Result<UrdfArm, UrdfError> {
    let unreadable = |reason: String| UrdfError::Unreadable {
        path: path.to_owned(),
        reason,
    };
    let text = input::read_text(path, LARGEST)
        .map_err(|reason| unreadable(format!("cannot be read: {reason}")))?;
    let robot = robot(&text).map_err(unreadable)?;
    arm(&robot, base, tip, path.parent().unwrap_or(Path::new(""))).map_err(|reason| {
        UrdfError::Chain {
            path: path.to_owned(),
            reason,
        }
    })
}

/// The robot of a text whose names are unique and whose numbers are usable.
fn robot(text: &str) -> Result<Robot, String> {
    input::check_nesting(text)?;
    let robot =
        urdf_rs::read_from_string(text).map_err(|error| format!("not a URDF file: {error}"))?;
    check::check(&robot)?;
    Ok(robot)
}

fn arm(
    robot: &Robot,
    base: Option<&str>,
    tip: Option<&str>,
    directory: &Path,
) -> Result<UrdfArm, String> {
    let links: BTreeSet<&str> = robot.links.iter().map(|link| link.name.as_str()).collect();
    let mut parents: BTreeMap<&str, &urdf_rs::Joint> = BTreeMap::new();
    for joint in &robot.joints {
        for (role, link) in [("parent", &joint.parent.link), ("child", &joint.child.link)] {
            if !links.contains(link.as_str()) {
                return Err(format!(
                    "joint `{}`: its {role} link `{link}` is not in the file",
                    joint.name
                ));
            }
        }
        if let Some(other) = parents.insert(&joint.child.link, joint) {
            return Err(format!(
                "link `{}` is the child of two joints, `{}` and `{}`: the chain has a loop",
                joint.child.link, other.name, joint.name
            ));
        }
    }
    for link in &links {
        let mut at = *link;
        for _ in 0..links.len() {
            match parents.get(at) {
                Some(joint) => at = &joint.parent.link,
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
    let tip = end_of(tip, "tip_link", &links, |link| {
        !robot.joints.iter().any(|joint| joint.parent.link == link)
    })?;
    let mut path = Vec::new();
    let mut at = tip;
    while at != base {
        let joint = parents
            .get(at)
            .ok_or_else(|| format!("no joints lead from link `{base}` to link `{tip}`"))?;
        path.push(*joint);
        at = &joint.parent.link;
    }
    path.reverse();
    let chain = chain(robot, &path)?;
    let (bodies, meshes) = bodies(robot, &chain, base, directory)?;
    Ok(UrdfArm {
        chain,
        bodies,
        meshes,
    })
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
            .ok_or_else(|| format!("there is no link `{name}`; its links: {}", listed(&all)));
    }
    let ends: Vec<&str> = links.iter().copied().filter(|link| is_end(link)).collect();
    match ends.as_slice() {
        [only] => Ok(only),
        [] => Err("it has no links".into()),
        several => Err(format!("`{key}` must say which: {}", listed(several))),
    }
}

/// The joints of a path as a chain. Joints mimicked by those of the path must be on it too.
fn chain(robot: &Robot, path: &[&urdf_rs::Joint]) -> Result<Chain, String> {
    let own: Vec<&&urdf_rs::Joint> = path
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
        .map(|joint| own_joint(joint))
        .collect::<Result<Vec<Joint>, String>>()?;
    let index = |name: &str| own.iter().position(|joint| joint.name == name);
    let segments = path
        .iter()
        .map(|joint| {
            let motion = match kind(joint) {
                _ if matches!(joint.joint_type, JointType::Floating | JointType::Planar | JointType::Spherical) => {
                    return Err(format!(
                        "joint `{}`: {:?} joints cannot be part of a chain; allowed: revolute, continuous, prismatic, fixed",
                        joint.name, joint.joint_type
                    ));
                }
                None => Motion::Fixed,
                Some(kind) => driven(robot, joint, kind, &index)?,
            };
            Ok(Segment {
                link: joint.child.link.clone(),
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
fn followers(path: &[&urdf_rs::Joint], segments: &[Segment]) -> Vec<Follower> {
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
    joint: &urdf_rs::Joint,
    kind: JointKind,
    index: &dyn Fn(&str) -> Option<usize>,
) -> Result<Motion, String> {
    let axis = UnitVector3::try_new(Vector3::from(joint.axis.xyz.0), 1e-9)
        .ok_or_else(|| format!("joint `{}`: its axis has no direction", joint.name))?;
    let (name, ratio, offset) = match &joint.mimic {
        None => (&joint.name, 1.0, 0.0),
        Some(mimic) => (
            &mimic.joint,
            mimic.multiplier.unwrap_or(1.0),
            mimic.offset.unwrap_or(0.0),
        ),
    };
    let joint_index = index(name).ok_or_else(|| {
        let known = robot.joints.iter().any(|other| other.name == *name);
        let what = if known {
            "is not between base and tip"
        } else {
            "is not in the file"
        };
        format!(
            "joint `{}`: joint `{name}`, which it mimics, {what}",
            joint.name
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

fn kind(joint: &urdf_rs::Joint) -> Option<JointKind> {
    match joint.joint_type {
        JointType::Revolute | JointType::Continuous => Some(JointKind::Revolute),
        JointType::Prismatic => Some(JointKind::Prismatic),
        _ => None,
    }
}

fn own_joint(joint: &urdf_rs::Joint) -> Result<Joint, String> {
    let limits = limits_of(joint, false);
    let Limits { lower, upper, .. } = limits;
    if !(lower < upper) {
        return Err(format!(
            "joint `{}`: its lower limit {lower} must be below its upper limit {upper}",
            joint.name
        ));
    }
    Ok(Joint {
        name: joint.name.clone(),
        kind: kind(joint).unwrap_or(JointKind::Revolute),
        limits,
    })
}

/// Limits of a joint, of which a range without an end is that of a continuous one, or of one `without_range`.
fn limits_of(joint: &urdf_rs::Joint, without_range: bool) -> Limits {
    let limit = &joint.limit;
    let (lower, upper) = if joint.joint_type == JointType::Continuous || without_range {
        (f64::NEG_INFINITY, f64::INFINITY)
    } else {
        (limit.lower, limit.upper)
    };
    let positive = |value: f64| if value > 0.0 { value } else { f64::INFINITY };
    Limits {
        lower,
        upper,
        velocity: positive(limit.velocity),
        acceleration: positive(limit.acceleration),
        jerk: positive(limit.jerk),
    }
}

/// Limits of a joint that mimics another. A range from 0 to 0 is that of a `<limit>` without a range.
fn follower_limits(joint: &urdf_rs::Joint) -> Limits {
    limits_of(joint, joint.limit.lower == 0.0 && joint.limit.upper == 0.0)
}

fn pose_of(origin: &urdf_rs::Pose) -> Pose {
    pose_of_angles(origin.xyz.0, origin.rpy.0)
}

/// Collision shapes of the base, of the chain's links and of all that hangs on them; joints off the chain are at zero.
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
            if let Some((link, pose)) = frames.get(joint.parent.link.as_str()).copied() {
                let pose = pose * pose_of(&joint.origin);
                frames.entry(&joint.child.link).or_insert((link, pose));
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
                    half: size.0.map(|side| side / 2.0),
                },
                Geometry::Sphere { radius } => Shape::Capsule {
                    half_length: 0.0,
                    radius: *radius,
                },
                // A capsule of the cylinder's length contains it.
                Geometry::Cylinder { radius, length } | Geometry::Capsule { radius, length } => {
                    Shape::Capsule {
                        half_length: length / 2.0,
                        radius: *radius,
                    }
                }
                Geometry::Mesh { filename, scale } => {
                    let fault = |what: String| format!("link `{}`: {what}", link.name);
                    let is_stl = |path: &PathBuf| {
                        path.extension()
                            .is_some_and(|extension| extension.eq_ignore_ascii_case("stl"))
                    };
                    let found = locate(filename, directory).map_err(fault)?;
                    let Some(path) = found.filter(is_stl) else {
                        meshes.push(filename.clone());
                        continue;
                    };
                    let mut corners = read_stl(&path).map_err(fault)?;
                    let scale = scale.map_or([1.0; 3], |scale| scale.0);
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
