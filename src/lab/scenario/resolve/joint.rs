//! Resolving joints and bodies.

use super::load::{place, rod};
use crate::scenario::section::{FINITE, NON_NEGATIVE, POSITIVE, Section};
use crate::scenario::resolved::{Body, BodyShape, Joint, JointKind, Time};
use crate::scenario::typed;
use std::f64::consts::PI;

/// Resolves all joints of a run in `time`.
pub fn joints(top: &Section<'_>, typed: &[typed::Joint], time: &Time) -> Vec<Joint> {
    let joints = top.elements("joints", typed).enumerate();
    joints
        .filter_map(|(index, (section, typed))| joint(&section, typed, index, time))
        .collect()
}

fn joint(section: &Section<'_>, typed: &typed::Joint, index: usize, time: &Time) -> Option<Joint> {
    let (name, rods, at, strength, kind) = match typed {
        typed::Joint::Ball {
            name,
            rods,
            at,
            break_at,
        } => (name, rods, at, (break_at, &None), JointKind::Ball),
        typed::Joint::Slide {
            name,
            rods,
            at,
            break_at,
        } => (name, rods, at, (break_at, &None), JointKind::Slide),
        typed::Joint::Rigid {
            name,
            rods,
            at,
            break_at,
            break_at_moment,
        } => (
            name,
            rods,
            at,
            (break_at, break_at_moment),
            JointKind::Rigid,
        ),
        typed::Joint::Hinge {
            name,
            rods,
            at,
            axis,
            stiffness,
            rest_angle,
            break_at,
            break_at_moment,
        } => {
            if stiffness.is_none() && rest_angle.is_some() {
                section.missing(
                    "stiffness",
                    "what `rest_angle` is for: the spring about the axis",
                );
            }
            let hinge = JointKind::Hinge {
                axis: section.required_direction("axis", axis),
                stiffness: section.optional("stiffness", stiffness, POSITIVE),
                rest_angle: section.optional("rest_angle", rest_angle, FINITE),
            };
            (name, rods, at, (break_at, break_at_moment), hinge)
        }
        typed::Joint::Spring {
            name,
            rods,
            at,
            stiffness,
            rest_length,
            turning_stiffness,
            rest_rotation,
            break_at,
            break_at_moment,
        } => {
            if stiffness.is_none() {
                let help = if rest_length.is_some() {
                    Some("what `rest_length` is for: the force per lengthening")
                } else if turning_stiffness.is_none() {
                    Some("the force per lengthening, or `turning_stiffness`, or both")
                } else if break_at.is_some() {
                    Some("what `break_at` is for: the spring exerts no force without it")
                } else {
                    None
                };
                help.inspect(|help| section.missing("stiffness", *help));
            }
            let for_turning = [
                ("rest_rotation", rest_rotation.is_some()),
                ("break_at_moment", break_at_moment.is_some()),
            ];
            if turning_stiffness.is_none()
                && let Some((key, _)) = for_turning.iter().find(|(_, is_given)| *is_given)
            {
                let help = format!("what `{key}` is for: the moment per angle");
                section.missing("turning_stiffness", help);
            }
            let rest_rotation = section.vector("rest_rotation", rest_rotation);
            if let Some(vector) = rest_rotation {
                let square: f64 = vector.iter().map(|part| part * part).sum();
                let angle = square.sqrt();
                if angle > PI {
                    section.fault(
                        "rest_rotation",
                        format!(
                            "its length {angle:?} rad is more than half a turn; allowed: up to π"
                        ),
                    );
                }
            }
            let spring = JointKind::Spring {
                stiffness: section.optional("stiffness", stiffness, POSITIVE),
                rest_length: section.optional("rest_length", rest_length, NON_NEGATIVE),
                turning_stiffness: section.optional(
                    "turning_stiffness",
                    turning_stiffness,
                    POSITIVE,
                ),
                rest_rotation,
            };
            (name, rods, at, (break_at, break_at_moment), spring)
        }
    };
    let break_at = section.optional("break_at", strength.0, POSITIVE);
    let break_at_moment = section.optional("break_at_moment", strength.1, POSITIVE);
    if !matches!(time, Time::Dynamic { .. }) {
        section.refuse(
            &[
                ("break_at", break_at.is_some()),
                ("break_at_moment", break_at_moment.is_some()),
            ],
            "a joint breaks at some time, which only a dynamic run has; allowed: time.mode = \"dynamic\"",
        );
    }
    let rods = section.needed(
        "rods",
        rods.clone(),
        "the names of two rods, such as [\"mast\", \"boom\"]",
    );
    let at = section.needed(
        "at",
        *at,
        "a node of each rod, such as [\"end\", \"start\"]",
    );
    let (rods, at) = (rods?, at?);
    let below = section.below("at");
    let node = |k: usize| below.place(&k.to_string(), at[k]);
    Some(Joint {
        name: name.clone().unwrap_or_else(|| format!("joint {index}")),
        at: [node(0), node(1)],
        rods,
        break_at,
        break_at_moment,
        kind,
    })
}

/// Resolves all bodies.
pub fn bodies(top: &Section<'_>, typed: &[typed::Body]) -> Vec<Body> {
    let bodies = top.elements("bodies", typed).enumerate();
    bodies
        .map(|(index, (section, typed))| body(&section, typed, index))
        .collect()
}

fn body(section: &Section<'_>, typed: &typed::Body, index: usize) -> Body {
    let mass = section.required("mass", &typed.mass, POSITIVE);
    if typed.shape.is_some() && typed.inertia.is_some() {
        section.fault("inertia", "give `shape` or `inertia`, not both");
    }
    let given = typed.inertia.as_ref().map(|moments| {
        let below = section.below("inertia");
        let given: [f64; 3] =
            std::array::from_fn(|k| below.number(&k.to_string(), &moments[k], NON_NEGATIVE));
        let sum: f64 = given.iter().sum();
        if let Some(k) = given
            .iter()
            .position(|moment| *moment > 0.5 * sum * (1.0 + 1e-9))
        {
            let message = format!(
                "{:?} kg m² is more than the other two together, {:?} kg m²: no body is like that",
                given[k],
                sum - given[k]
            );
            below.fault(&k.to_string(), message);
        }
        given
    });
    let name = typed.name.clone();
    Body {
        name: name.unwrap_or_else(|| format!("body {index}")),
        rod: rod(section, &typed.rod),
        at: place(section, typed.at),
        mass,
        shape: typed
            .shape
            .as_ref()
            .map(|typed| shape(&section.below("shape"), typed)),
        offset: section
            .vector("offset", &typed.offset)
            .filter(|offset| *offset != [0.0; 3]),
        inertia: given,
    }
}

/// Resolves the shape of a body.
fn shape(section: &Section<'_>, typed: &typed::BodyShape) -> BodyShape {
    match typed {
        typed::BodyShape::Sphere { radius } => BodyShape::Sphere {
            radius: section.required("radius", radius, POSITIVE),
        },
        typed::BodyShape::Disk { radius, thickness } => BodyShape::Disk {
            radius: section.required("radius", radius, POSITIVE),
            thickness: section.with_default("thickness", thickness, NON_NEGATIVE, 0.0),
        },
        typed::BodyShape::Box { size } => BodyShape::Box {
            size: section.sides("size", size),
        },
    }
}
