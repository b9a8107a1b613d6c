//! Resolves an arm of a cell file: its chain from URDF or from its own joints, its limits, tool
//! and shapes.

use super::resolved::Arm;
use super::resolver::Resolver;
use super::typed::{self, FixedJoint, MovingJoint, OneOrMany};
use nalgebra::{UnitVector3, Vector3};
use rodlab_lab::scenario::dimension::Dimension;
use rodlab_lab::scenario::{Issue, KeyPath, did_you_mean};
use rodlab_robot::{
    Body, Chain, Follower, Joint, JointKind, Limits, MOST_JOINTS, Motion, Pose, Segment, Shape,
    read_urdf,
};
use std::collections::BTreeSet;

/// Resolves an arm; `None` if its chain is invalid.
pub(super) fn resolve_arm(
    resolver: &Resolver<'_>,
    path: &KeyPath,
    typed: &typed::Arm,
) -> Option<Arm> {
    let (mut chain, mut bodies) = match &typed.urdf {
        Some(_) if !typed.joints.is_empty() => {
            resolver.fault(
                &path.key("joints"),
                "either `urdf` or `joints` may be given, not both",
            );
            return None;
        }
        Some(file) => {
            let key = path.key("urdf");
            let file = resolver.file_at(&key, file);
            let (base, tip) = (typed.base_link.as_deref(), typed.tip_link.as_deref());
            match read_urdf(&file, base, tip) {
                Ok(arm) => {
                    if !arm.meshes.is_empty() {
                        resolver.warnings.borrow_mut().push(format!(
                            "arm {}: {} collision meshes are ignored, because they are not STL files or not found, such as {}; use `link_radius` or `capsules` instead",
                            typed.name,
                            arm.meshes.len(),
                            arm.meshes[0]
                        ));
                    }
                    let notes = arm.notes.into_iter();
                    let notes =
                        notes.map(|note| format!("arm {}: {}: {note}", typed.name, file.display()));
                    resolver.warnings.borrow_mut().extend(notes);
                    (arm.chain, arm.bodies)
                }
                Err(error) => {
                    resolver.fault(&key, error.to_string());
                    return None;
                }
            }
        }
        None => {
            for (key, given) in [
                ("base_link", &typed.base_link),
                ("tip_link", &typed.tip_link),
            ] {
                if given.is_some() {
                    resolver.fault(&path.key(key), "it belongs to a `urdf`");
                }
            }
            (chain_of_joints(resolver, path, &typed.joints)?, Vec::new())
        }
    };
    limits(resolver, path, typed, &mut chain);
    if let Err(message) = chain.apply_followers() {
        resolver.fault(path, message);
    }
    if let Some(tool) = &typed.tool {
        chain.tool = resolver.pose(
            &path.key("tool"),
            &tool.position,
            &tool.quaternion,
            &tool.rpy,
        );
    }
    let joints = chain.joint_names();
    let home = home(resolver, path, typed, &chain);
    shapes(resolver, path, typed, &chain, &mut bodies);
    let may_touch = typed.may_touch.iter().enumerate().map(|(k, pair)| {
        let key = path.key("may_touch").index(k);
        [0, 1].map(|end| link(resolver, &key.index(end), &chain, &pair[end]))
    });
    let efforts = typed.effort.as_ref();
    let efforts = efforts
        .and_then(|efforts| for_joints(resolver, &path.key("effort"), efforts, joints.len()));
    Some(Arm {
        name: typed.name.clone(),
        efforts: efforts.unwrap_or_default(),
        may_touch: may_touch.collect(),
        base: resolver.pose(path, &typed.position, &typed.quaternion, &typed.rpy),
        home,
        bodies,
        driver: typed
            .driver
            .as_ref()
            .map(|driver| resolver.driver(&path.key("driver"), driver, false, &joints)),
        gripper: typed
            .gripper
            .as_ref()
            .map(|gripper| resolver.gripper(&path.key("gripper"), gripper, typed.driver.as_ref())),
        chain,
    })
}

fn chain_of_joints(
    resolver: &Resolver<'_>,
    path: &KeyPath,
    typed: &[typed::Joint],
) -> Option<Chain> {
    let mut chain = Chain {
        joints: Vec::new(),
        segments: Vec::new(),
        followers: Vec::new(),
        tool: Pose::identity(),
    };
    let mut names = BTreeSet::new();
    // A mimicked joint may be listed after the joint that mimics it.
    for (k, joint) in typed.iter().enumerate() {
        let path = path.key("joints").index(k);
        let name = match joint {
            typed::Joint::Revolute(joint) => &joint.name,
            typed::Joint::Prismatic(joint) => &joint.name,
            typed::Joint::Fixed(joint) => &joint.name,
        };
        if !names.insert(name) {
            resolver.fault(
                &path.key("name"),
                format!("another joint is called {name:?}"),
            );
        }
        let own = match joint {
            typed::Joint::Revolute(joint) => own_joint(resolver, &path, JointKind::Revolute, joint),
            typed::Joint::Prismatic(joint) => {
                own_joint(resolver, &path, JointKind::Prismatic, joint)
            }
            typed::Joint::Fixed(_) => None,
        };
        if let Some(joint) = own {
            chain.joints.push(joint);
        }
    }
    if chain.joints.is_empty() {
        resolver.fault(path, "an arm needs a `urdf`, or `joints` that can move");
        return None;
    }
    if chain.joints.len() > MOST_JOINTS {
        resolver.fault(
            &path.key("joints"),
            format!(
                "{} joints; allowed: {MOST_JOINTS} at most",
                chain.joints.len()
            ),
        );
        return None;
    }
    for (k, joint) in typed.iter().enumerate() {
        let path = path.key("joints").index(k);
        let segment = match joint {
            typed::Joint::Revolute(joint) => {
                moving(resolver, &path, JointKind::Revolute, joint, &mut chain)
            }
            typed::Joint::Prismatic(joint) => {
                moving(resolver, &path, JointKind::Prismatic, joint, &mut chain)
            }
            typed::Joint::Fixed(joint) => fixed(resolver, &path, joint),
        };
        if chain.link(&segment.link).is_some() {
            resolver.fault(&path, format!("another link is called {:?}", segment.link));
        }
        chain.segments.push(segment);
    }
    Some(chain)
}

fn own_joint<P: Dimension, V: Dimension>(
    resolver: &Resolver<'_>,
    path: &KeyPath,
    kind: JointKind,
    joint: &MovingJoint<P, V>,
) -> Option<Joint> {
    if joint.mimic.is_some() {
        return None;
    }
    let limits = limits_of(resolver, path, kind, joint);
    let Limits { lower, upper, .. } = limits;
    if kind == JointKind::Prismatic && !(lower.is_finite() && upper.is_finite()) {
        resolver.fault(path, "a prismatic joint needs `lower` and `upper`");
    }
    Some(Joint {
        name: joint.name.clone(),
        kind,
        limits,
    })
}

/// Limits of a joint; infinite where it has none.
fn limits_of<P: Dimension, V: Dimension>(
    resolver: &Resolver<'_>,
    path: &KeyPath,
    kind: JointKind,
    joint: &MovingJoint<P, V>,
) -> Limits {
    let [lower, upper] = resolver.range(path, [&joint.lower, &joint.upper], kind.unit());
    let velocity = joint.velocity.as_ref().map_or(f64::INFINITY, |velocity| {
        resolver.positive_si(&path.key("velocity"), velocity)
    });
    let bound = |key: &str, bound: Option<f64>| {
        bound.map_or(f64::INFINITY, |bound| {
            resolver.positive(&path.key(key), bound)
        })
    };
    Limits {
        lower,
        upper,
        velocity,
        acceleration: bound("acceleration", joint.acceleration),
        jerk: bound("jerk", joint.jerk),
    }
}

fn moving<P: Dimension, V: Dimension>(
    resolver: &Resolver<'_>,
    path: &KeyPath,
    kind: JointKind,
    joint: &MovingJoint<P, V>,
    chain: &mut Chain,
) -> Segment {
    let axis = Vector3::from(joint.axis.unwrap_or([0.0, 0.0, 1.0]));
    let has_direction = axis.norm().is_finite();
    let axis = UnitVector3::try_new(axis, 1e-9).filter(|_| has_direction);
    let axis = axis.unwrap_or_else(|| {
        resolver.fault(&path.key("axis"), "the axis must have a direction");
        Vector3::z_axis()
    });
    let (name, ratio, offset) = match &joint.mimic {
        None => (&joint.name, 1.0, 0.0),
        Some(mimic) => (
            &mimic.joint,
            mimic.multiplier.unwrap_or(1.0),
            mimic.offset.unwrap_or(0.0),
        ),
    };
    let position = chain.joints.iter().position(|other| other.name == *name);
    let index = position.unwrap_or_else(|| {
        let key = path.key("mimic").key("joint");
        let names = chain.joints.iter().map(|joint| joint.name.as_str());
        resolver.issue(
            Issue::new(key, format!("no independent joint is called {name:?}"))
                .with_help(did_you_mean(name, names)),
        );
        0
    });
    if joint.mimic.is_some() {
        let limits = limits_of(resolver, path, kind, joint);
        for (key, number) in [("multiplier", ratio), ("offset", offset)] {
            if !number.is_finite() {
                resolver.fault(&path.key("mimic").key(key), "a finite number is needed");
            }
        }
        chain.followers.push(Follower {
            name: joint.name.clone(),
            joint: index,
            ratio,
            offset,
            limits,
        });
    }
    Segment {
        link: joint.link.clone().unwrap_or_else(|| joint.name.clone()),
        origin: resolver.pose(path, &joint.position, &joint.quaternion, &joint.rpy),
        motion: Motion::Driven {
            kind,
            axis,
            joint: index,
            ratio,
            offset,
        },
    }
}

fn fixed(resolver: &Resolver<'_>, path: &KeyPath, joint: &FixedJoint) -> Segment {
    Segment {
        link: joint.link.clone().unwrap_or_else(|| joint.name.clone()),
        origin: resolver.pose(path, &joint.position, &joint.quaternion, &joint.rpy),
        motion: Motion::Fixed,
    }
}

/// One number for all joints or one for each, above 0, as one for each.
fn for_joints(
    resolver: &Resolver<'_>,
    path: &KeyPath,
    given: &OneOrMany,
    count: usize,
) -> Option<Vec<f64>> {
    let values = match given {
        OneOrMany::One(value) => vec![*value; count],
        OneOrMany::Many(values) => values.clone(),
    };
    if values.len() != count {
        resolver.fault(
            path,
            format!("one number or {count} are needed, found {}", values.len()),
        );
        return None;
    }
    let values = values.into_iter();
    Some(values.map(|value| resolver.positive(path, value)).collect())
}

/// Replaces limits of the joints by those of the arm.
fn limits(resolver: &Resolver<'_>, path: &KeyPath, typed: &typed::Arm, chain: &mut Chain) {
    let mut lay = |key: &str, given: &Option<OneOrMany>, slot: fn(&mut Limits) -> &mut f64| {
        let given = given.as_ref();
        let values =
            given.and_then(|given| for_joints(resolver, &path.key(key), given, chain.joints.len()));
        for (joint, value) in chain.joints.iter_mut().zip(values.unwrap_or_default()) {
            *slot(&mut joint.limits) = value;
        }
    };
    lay("velocity", &typed.velocity, |limits| &mut limits.velocity);
    lay("acceleration", &typed.acceleration, |limits| {
        &mut limits.acceleration
    });
    lay("jerk", &typed.jerk, |limits| &mut limits.jerk);
    for joint in &chain.joints {
        if !joint.limits.velocity.is_finite() {
            resolver.fault(
                path,
                format!(
                    "joint {:?} needs a `velocity`: its own, or one of the arm",
                    joint.name
                ),
            );
        }
    }
}

fn home(resolver: &Resolver<'_>, path: &KeyPath, typed: &typed::Arm, chain: &Chain) -> Vec<f64> {
    let Some(home) = &typed.home else {
        return chain.middle();
    };
    let key = path.key("home");
    if home.len() != chain.joints.len() {
        resolver.fault(
            &key,
            format!(
                "{} joint positions are needed, found {}",
                chain.joints.len(),
                home.len()
            ),
        );
        return chain.middle();
    }
    for (k, (joint, position)) in chain.joints.iter().zip(home).enumerate() {
        if !joint.limits.allow(*position) {
            let Limits { lower, upper, .. } = joint.limits;
            let message = format!(
                "{position} is out of the range of {:?}; allowed: {lower} to {upper}",
                joint.name
            );
            resolver.fault(&key.index(k), message);
        }
    }
    home.clone()
}

/// The link with a name: an index of a segment, `None` for the base.
fn link(resolver: &Resolver<'_>, path: &KeyPath, chain: &Chain, name: &str) -> Option<usize> {
    let index = chain.link(name);
    if index.is_none() && name != "base" {
        let names = chain.segments.iter().map(|segment| segment.link.as_str());
        let names: Vec<&str> = std::iter::once("base").chain(names).collect();
        resolver.fault(
            path,
            format!("there is no link {name:?}; allowed: {}", names.join(", ")),
        );
    }
    index
}

fn shapes(
    resolver: &Resolver<'_>,
    path: &KeyPath,
    typed: &typed::Arm,
    chain: &Chain,
    bodies: &mut Vec<Body>,
) {
    if let Some(radius) = &typed.link_radius {
        let radius = resolver.positive_si(&path.key("link_radius"), radius);
        bodies.extend(capsules_between_joints(chain, radius));
    }
    for (k, capsule) in typed.capsules.iter().enumerate() {
        let path = path.key("capsules").index(k);
        bodies.push(Body::capsule(
            link(resolver, &path.key("link"), chain, &capsule.link),
            resolver.vector(&path.key("from"), &capsule.from),
            resolver.vector(&path.key("to"), &capsule.to),
            resolver.positive_si(&path.key("radius"), &capsule.radius),
        ));
    }
    for (k, shape) in typed.boxes.iter().enumerate() {
        let path = path.key("boxes").index(k);
        let sides = resolver.sides(&path.key("size"), &shape.size);
        bodies.push(Body {
            link: link(resolver, &path.key("link"), chain, &shape.link),
            pose: resolver.pose(&path, &shape.position, &shape.quaternion, &shape.rpy),
            shape: Shape::Box {
                half: sides.map(|side| side / 2.0),
            },
        });
    }
}

/// A capsule along each link, from its joint to the next one; the last capsule ends at the hand.
fn capsules_between_joints(chain: &Chain, radius: f64) -> Vec<Body> {
    let ends = chain.segments.iter().skip(1).map(|next| next.origin);
    let ends = ends.chain([chain.tool]);
    ends.enumerate()
        .filter(|(_, end)| end.translation.vector.norm() > 1e-6)
        .map(|(link, end)| {
            Body::capsule(Some(link), [0.0; 3], end.translation.vector.into(), radius)
        })
        .collect()
}
