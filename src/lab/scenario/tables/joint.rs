//! Joints between rods.

use crate::scenario::declaration::keys;
use crate::scenario::section::{FINITE, NON_NEGATIVE, POSITIVE, Section};
use crate::scenario::units::{Angle, Force, ForcePerLength, Length, Moment, TurningStiffness};
use std::f64::consts::PI;

keys! {
    /// Two nodes, of one rod or of two, that are one point from time zero on, of which one slides along the rod of the other, or
    /// that a spring ties. Where three rods meet, two
    /// joints share a node.
    kinds JointKeys "joint", "kebab-case" => Joint(index: usize)
    before {
        /// Name for messages. Default: "joint 0", "joint 1", ...
        name: text() derived(format!("joint {index}")),
        /// Names of the two rods; the same one twice to join a rod to itself. In a slide, a node of the first slides along the second.
        rods: word([String; 2], "the names of two rods, such as [\"mast\", \"boom\"]") required,
        /// "start", "end", or the number of a node, of each: ["end", 4]. A slide begins at the second.
        at: places("a node of each rod, such as [\"end\", \"start\"]") required,
        /// Largest force that it bears, in a dynamic run; it breaks where a step ends with more. Of balls, hinges and rigid joints
        /// only where they share their nodes with no other joint. Default: it never breaks.
        break_at: number(Force, POSITIVE) optional,
    }
    also {
        /// Largest moment that it bears, that of a spring included, as `break_at`.
        break_at_moment: number(Moment, POSITIVE) optional,
    }
    #[derive(Copy)] JointKind {
        /// The rods turn freely against each other.
        Ball,
        /// The rods are welded: angles between them, and between their cross-sections, stay as placed.
        Rigid also,
        /// The second rod turns against the first about an axis only.
        Hinge also {
            /// Direction of the axis as placed; it turns with the first rod.
            axis: direction() required,
            /// Moment per angle of a spring about the axis. Default: none.
            stiffness: number(TurningStiffness, POSITIVE) optional,
            /// Angle of the second rod against the first, from where they are placed, at which that spring exerts no moment.
            /// Default: 0.
            rest_angle: number(Angle, FINITE) optional,
        },
        /// The first node slides along the rod of the second, without friction, between stops at its ends.
        Slide,
        /// A spring pulls the nodes together and pushes them apart, or turns the rods towards each other there; the nodes need not
        /// lie at one point. It has a `stiffness`, a `turning_stiffness`, or both.
        Spring also {
            /// Force per lengthening.
            stiffness: number(ForcePerLength, POSITIVE) optional,
            /// Length without force. Default: the distance of the nodes as placed.
            rest_length: number(Length, NON_NEGATIVE) optional,
            /// Moment per angle by which the material frame of the second rod has turned against that of the first, about any
            /// axis, up to half a turn. Default: none.
            turning_stiffness: number(TurningStiffness, POSITIVE) optional,
            /// Rotation vector of the second frame against the first, from where they are placed, without moment: its direction is
            /// the axis, which turns with the first rod, its length the angle. Default: [0, 0, 0].
            rest_rotation: vector(Angle) optional,
        },
    }
    after {}
}

impl Joint {
    /// Whether there is a force or moment under which it breaks.
    pub fn may_break(&self) -> bool {
        self.break_at.is_some() || self.break_at_moment.is_some()
    }
}

impl JointKind {
    /// Whether rods are clamped to a frame that turns with it.
    pub fn turns(&self) -> bool {
        let springs_turn =
            matches!(self, Self::Spring { turning_stiffness, .. } if turning_stiffness.is_some());
        springs_turn || matches!(self, Self::Rigid | Self::Hinge { .. })
    }
}

/// Resolves all joints; `is_dynamic` is true for a run in time.
pub fn joints(top: &Section<'_>, typed: &[JointKeys], is_dynamic: bool) -> Vec<Joint> {
    let joint = |(index, (section, typed)): (usize, (Section<'_>, &JointKeys))| {
        refuse_half_a_spring(&section, typed);
        let joint = typed.resolve(&section, index);
        check(&section, &joint, is_dynamic);
        joint
    };
    let joints = top.elements("joints", typed).enumerate();
    joints.map(joint).collect()
}

/// Reports keys of springs without the stiffness that they are for.
fn refuse_half_a_spring(section: &Section<'_>, typed: &JointKeys) {
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
            turning_stiffness,
            rest_rotation,
            break_at,
            break_at_moment,
            ..
        } => {
            if stiffness.is_none() {
                let help = if rest_length.is_some() {
                    Some("needed by `rest_length`: the force per lengthening")
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
        _ => {}
    }
}

/// Checks that go beyond the range of a key.
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
            "a joint breaks at some time, which only a dynamic run has; allowed: time.mode = \"dynamic\"",
        );
    }
}
