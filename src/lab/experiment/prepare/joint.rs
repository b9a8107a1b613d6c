//! Places joints and bodies in the scene.

use crate::experiment::places::find_place;
use crate::experiment::places::find_rod;
use crate::scenario::{self, Issue, KeyPath};
use rodlab_engine::mechanics::scene::{
    Body, CoulombFriction, HingeSpring, Joint, JointKind, RodDescription, RodNode, Scene, Spring,
    SpringForce, Strength, TurningStiffness,
};
use rodlab_engine::mechanics::system::check_joints;
use rodlab_engine::mechanics::{JointError, SceneError, Vector3};

/// Joins rods of a scene by a joint from its scenario.
///
/// # Errors
/// Rods and nodes that do not exist.
pub(super) fn place_joint(
    joint: &scenario::Joint,
    scene: &mut Scene,
    path: &KeyPath,
) -> Result<(), Issue> {
    let rods = &scene.rods;
    let node = |k: usize| -> Result<RodNode, Issue> {
        let rod = find_rod(&joint.rods[k], rods, &path.key("rods").index(k))?;
        let count = rods[rod].centreline.len();
        let at = path.key("at").index(k);
        let node = find_place(joint.at[k], count, "node", &rods[rod], &at)?;
        Ok(RodNode { rod, node })
    };
    let (name, nodes) = (joint.name.clone(), [node(0)?, node(1)?]);
    let strength = Strength {
        force: joint.break_at.unwrap_or(f64::INFINITY),
        moment: joint.break_at_moment.unwrap_or(f64::INFINITY),
    };
    let kind = match joint.kind {
        scenario::JointKind::Ball => JointKind::Ball,
        scenario::JointKind::Rigid => JointKind::Rigid,
        scenario::JointKind::Slide {
            friction,
            presliding,
        } => JointKind::Slide {
            friction: friction
                .filter(|coefficient| *coefficient > 0.0)
                .map(|coefficient| CoulombFriction {
                    coefficient,
                    presliding,
                }),
        },
        scenario::JointKind::Hinge {
            axis,
            stiffness,
            rest_angle,
        } => JointKind::Hinge {
            axis: Vector3::from(axis),
            spring: stiffness.map(|stiffness| HingeSpring {
                stiffness,
                rest_angle: rest_angle.unwrap_or(0.0),
            }),
        },
        scenario::JointKind::Spring {
            stiffness,
            rest_length,
            only,
            turning_stiffness,
            rest_rotation,
        } => {
            scene.springs.push(Spring {
                name,
                nodes,
                stiffness: stiffness.unwrap_or(0.0),
                turning: turning_stiffness.map(|stiffness| TurningStiffness {
                    stiffness,
                    rest_rotation: rest_rotation.map_or_else(Vector3::zeros, Vector3::from),
                }),
                rest_length,
                only: only.map(|only| match only {
                    scenario::SpringOnly::Tension => SpringForce::Tension,
                    scenario::SpringOnly::Compression => SpringForce::Compression,
                }),
                strength,
            });
            return Ok(());
        }
    };
    scene.joints.push(Joint {
        name,
        nodes,
        kind,
        strength,
    });
    Ok(())
}

/// The body of a scenario on one of these rods.
///
/// # Errors
/// A rod or node that does not exist.
pub(super) fn place_body(
    body: &scenario::Body,
    rods: &[RodDescription],
    path: &KeyPath,
) -> Result<Body, Issue> {
    let rod = find_rod(&body.rod, rods, &path.key("rod"))?;
    let count = rods[rod].centreline.len();
    let node = find_place(body.at, count, "node", &rods[rod], &path.key("at"))?;
    Ok(Body {
        name: body.name.clone(),
        at: RodNode { rod, node },
        mass: body.mass,
        offset: body.offset.map_or_else(Vector3::zeros, Vector3::from),
        inertia: body.moments_of_inertia(),
        ball: body.ball(),
    })
}

/// Checks whether the joints and bodies of a scene are possible. Faults name the keys of those
/// that the file lists.
///
/// # Errors
/// The fault of one of them.
pub(super) fn judge_joints(scene: &Scene, scenario: &scenario::Scenario) -> Result<(), Issue> {
    let Err(SceneError::Joint { name, reason }) = check_joints(scene) else {
        return Ok(());
    };
    let of_joint = scenario.joints.iter().position(|joint| joint.name == name);
    let of_body = scenario.bodies.iter().position(|body| body.name == name);
    let path = match (of_joint, of_body) {
        (Some(index), _) => KeyPath::from("joints").index(index),
        (None, Some(index)) => KeyPath::from("bodies").index(index),
        _ => KeyPath::from("joints"),
    };
    let key = match reason {
        JointError::Apart { .. }
        | JointError::SameNode
        | JointError::OnePoint
        | JointError::NoSuchNode { .. } => path.key("at"),
        JointError::NoDirection { .. } | JointError::NeverPushes => path.key("rest_length"),
        JointError::Unbreakable => {
            let joint = of_joint.map(|index| &scenario.joints[index]);
            let by_force = joint.is_none_or(|joint| joint.break_at.is_some());
            path.key(if by_force {
                "break_at"
            } else {
                "break_at_moment"
            })
        }
        _ => path,
    };
    Err(Issue::new(key, format!("`{name}`: {reason}")))
}
