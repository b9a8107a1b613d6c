//! Joints between rods.

use crate::scenario::declaration::keys;
use crate::scenario::section::{FINITE, NON_NEGATIVE, POSITIVE, Section};
use crate::scenario::units::{
    Angle, Dimensionless, Force, ForcePerLength, Length, Moment, TurningStiffness,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

keys! {
    /// A connection between two nodes of one rod or of two rods. Depending on its kind the nodes
    /// coincide from time zero on, one slides along the rod of the other, or a spring ties them.
    /// To connect three rods at a point, use two joints that share a node.
    kinds JointKeys "joint", "kebab-case" => Joint(index: usize)
    before {
        /// Name for messages. Default: "joint 0", "joint 1", ...
        name: text() derived(format!("joint {index}")),
        /// Names of the two rods; the same name twice joins a rod to itself. In a slide, a node of
        /// the first rod slides along the second rod.
        rods: word([String; 2], "the names of two rods, such as [\"mast\", \"boom\"]") required,
        /// Node of each rod: "start", "end", or a number, as in ["end", 4]. The second node of a
        /// slide is the place where the slide begins.
        at: places("a node of each rod, such as [\"end\", \"start\"]") required,
        /// Largest force that the joint withstands, in a dynamic run. The joint breaks if the force
        /// is larger at the end of a step. The nodes of balls, hinges and rigid joints that can
        /// break must not belong to other joints. Default: it never breaks.
        break_at: number(Force, POSITIVE) optional,
    }
    also {
        /// Largest moment that the joint withstands, including the moment of its spring; otherwise
        /// like `break_at`.
        break_at_moment: number(Moment, POSITIVE) optional,
    }
    #[derive(Copy)] JointKind {
        /// The rods turn freely relative to each other.
        Ball,
        /// The rods are welded: angles between them, and between their cross-sections, stay as placed.
        Rigid also,
        /// The second rod turns relative to the first rod about one axis only.
        Hinge also {
            /// Direction of the axis as placed; it turns with the first rod.
            axis: direction() required,
            /// Moment per angle of a spring about the axis. Default: no spring.
            stiffness: number(TurningStiffness, POSITIVE) optional,
            /// Angle of the second rod relative to the first at which this spring exerts no
            /// moment, measured from the placed orientation. Default: 0.
            rest_angle: number(Angle, FINITE) optional,
        },
        /// The first node slides along the rod of the second node, between stops at its ends.
        Slide {
            /// Coefficient of friction along that rod, in dynamic runs; the normal force is the
            /// force of the joint across the rod.
            /// Default: 0.
            #[serde(skip_serializing_if = "Option::is_none")]
            friction: number(Dimensionless, NON_NEGATIVE) optional,
            /// Distance that the node moves before it slides with friction. Default: 1e-5 of the
            /// length of that rod.
            #[serde(skip_serializing_if = "Option::is_none")]
            presliding: number(Length, POSITIVE) optional,
        },
        /// A spring between the nodes, which need not coincide. A `stiffness` acts on the distance
        /// of the nodes, a `turning_stiffness` on the rotation of the rods relative to each other;
        /// give one or both.
        Spring also {
            /// Force per lengthening.
            stiffness: number(ForcePerLength, POSITIVE) optional,
            /// Natural length of the spring. Default: the distance of the nodes as placed.
            rest_length: number(Length, NON_NEGATIVE) optional,
            /// Limits the force to one sign: "tension" for ties, cables and bungees, which are
            /// slack when shorter than `rest_length`; "compression" for bumpers, which are out of
            /// touch when longer. Default: the spring pulls and pushes.
            #[serde(skip_serializing_if = "Option::is_none")]
            only: word(SpringOnly) optional,
            /// Moment per angle of rotation of the second rod's material frame relative to the
            /// first rod's, about any axis, up to half a turn. Default: none.
            turning_stiffness: number(TurningStiffness, POSITIVE) optional,
            /// Rotation of the second frame relative to the first at which the moment is zero,
            /// measured from the placed orientation. It is a rotation vector: its direction is the
            /// axis, which turns with the first rod, its length the angle. Default: [0, 0, 0].
            rest_rotation: vector(Angle) optional,
        },
    }
    after {}
}

/// Sign of the force of a spring.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum SpringOnly {
    /// The spring pulls.
    #[default]
    Tension,
    /// The spring pushes.
    Compression,
}

impl Joint {
    /// Whether a force or moment can break it.
    pub fn may_break(&self) -> bool {
        self.break_at.is_some() || self.break_at_moment.is_some()
    }
}

impl JointKind {
    /// Whether a node slides with friction.
    pub fn rubs(&self) -> bool {
        matches!(self, Self::Slide { friction: Some(friction), .. } if *friction > 0.0)
    }

    /// Whether it transmits moments between the rods.
    pub fn turns(&self) -> bool {
        let springs_turn =
            matches!(self, Self::Spring { turning_stiffness, .. } if turning_stiffness.is_some());
        springs_turn || matches!(self, Self::Rigid | Self::Hinge { .. })
    }
}

/// Resolves all joints; `is_dynamic` is true for a run in time.
pub fn joints(top: &Section<'_>, typed: &[JointKeys], is_dynamic: bool) -> Vec<Joint> {
    let joint = |(index, (section, typed)): (usize, (Section<'_>, &JointKeys))| {
        refuse_half_a_law(&section, typed);
        let joint = typed.resolve(&section, index);
        check(&section, &joint, is_dynamic);
        joint
    };
    let joints = top.elements("joints", typed).enumerate();
    joints.map(joint).collect()
}

/// Reports keys of springs and of friction without the stiffness or coefficient to which they
/// belong.
fn refuse_half_a_law(section: &Section<'_>, typed: &JointKeys) {
    match typed {
        JointKeys::Hinge {
            stiffness: None,
            rest_angle: Some(_),
            ..
        } => section.missing(
            "stiffness",
            "needed by `rest_angle`: the spring about the axis",
        ),
        JointKeys::Spring {
            stiffness,
            rest_length,
            only,
            turning_stiffness,
            rest_rotation,
            break_at,
            break_at_moment,
            ..
        } => {
            if stiffness.is_none() {
                let help = if rest_length.is_some() {
                    Some("needed by `rest_length`: the force per lengthening")
                } else if only.is_some() {
                    Some("needed by `only`: the force per lengthening")
                } else if turning_stiffness.is_none() {
                    Some("the force per lengthening, or `turning_stiffness`, or both")
                } else if break_at.is_some() {
                    Some("needed by `break_at`: the spring exerts no force without it")
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
                let help = format!("needed by `{key}`: the moment per angle");
                section.missing("turning_stiffness", help);
            }
        }
        JointKeys::Slide {
            friction: None,
            presliding: Some(_),
            ..
        } => section.missing("friction", "needed by `presliding`: the coefficient"),
        _ => {}
    }
}

/// Checks of several keys, or of more than the range of a key.
fn check(section: &Section<'_>, joint: &Joint, is_dynamic: bool) {
    if let JointKind::Spring {
        rest_rotation: Some(vector),
        ..
    } = joint.kind
    {
        let angle = vector.iter().map(|part| part * part).sum::<f64>().sqrt();
        if angle > PI {
            let message =
                format!("its length {angle:?} rad is more than half a turn; allowed: up to π");
            section.fault("rest_rotation", message);
        }
    }
    if !is_dynamic {
        section.refuse(
            &[
                ("break_at", joint.break_at.is_some()),
                ("break_at_moment", joint.break_at_moment.is_some()),
            ],
            "joints break only in dynamic runs; allowed: time.mode = \"dynamic\"",
        );
    }
}
