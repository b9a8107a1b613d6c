//! Resolving joints and bodies.

use super::load::{place, rod};
use super::section::{FINITE, NON_NEGATIVE, POSITIVE, Section};
use crate::scenario::resolved::{Body, BodyShape, Joint, JointKind, Place, Time};
use crate::scenario::typed;

/// Resolves all joints of a run in `time`.
pub fn joints(top: &Section<'_>, typed: &[typed::Joint], time: &Time) -> Vec<Joint> {
    let section = top.below("joints");
    typed
        .iter()
        .enumerate()
        .filter_map(|(index, typed)| joint(&section.below(&index.to_string()), typed, index, time))
        .collect()
}

fn joint(section: &Section<'_>, typed: &typed::Joint, index: usize, time: &Time) -> Option<Joint> {
    let (name, rods, at, break_at, kind) = match typed {
        typed::Joint::Ball {
            name,
            rods,
            at,
            break_at,
        } => (name, rods, at, break_at, JointKind::Ball),
        typed::Joint::Slide {
            name,
            rods,
            at,
            break_at,
        } => (name, rods, at, break_at, JointKind::Slide),
        typed::Joint::Rigid { name, rods, at } => (name, rods, at, &None, JointKind::Rigid),
        typed::Joint::Hinge {
            name,
            rods,
            at,
            axis,
            stiffness,
            rest_angle,
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
            (name, rods, at, &None, hinge)
        }
        typed::Joint::Spring {
            name,
            rods,
            at,
            stiffness,
            rest_length,
            break_at,
        } => {
            let spring = JointKind::Spring {
                stiffness: section.required("stiffness", stiffness, POSITIVE),
                rest_length: section.optional("rest_length", rest_length, NON_NEGATIVE),
            };
            (name, rods, at, break_at, spring)
        }
    };
    let break_at = section.optional("break_at", break_at, POSITIVE);
    if break_at.is_some() && !matches!(time, Time::Dynamic { .. }) {
        section.fault(
            "break_at",
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
    let node = |k: usize| match at[k] {
        typed::Place::Start => Place::Start,
        typed::Place::End => Place::End,
        typed::Place::Number(number) => match usize::try_from(number) {
            Ok(number) => Place::Number(number),
            Err(_) => {
                let message = format!("{number} is out of range; allowed: 0 and up");
                below.fault(&k.to_string(), message);
                Place::Start
            }
        },
    };
    Some(Joint {
        name: name.clone().unwrap_or_else(|| format!("joint {index}")),
        at: [node(0), node(1)],
        rods,
        break_at,
        kind,
    })
}

/// Resolves all bodies.
pub fn bodies(top: &Section<'_>, typed: &[typed::Body]) -> Vec<Body> {
    let section = top.below("bodies");
    typed
        .iter()
        .enumerate()
        .map(|(index, typed)| body(&section.below(&index.to_string()), typed, index))
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
        typed::BodyShape::Box { size } => {
            let size = section.required_vector("size", size);
            for (axis, side) in size.iter().enumerate() {
                if *side <= 0.0 {
                    let message = format!("{side:?} is out of range; allowed: greater than 0");
                    section.below("size").fault(&axis.to_string(), message);
                }
            }
            BodyShape::Box { size }
        }
    }
}
