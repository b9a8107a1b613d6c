//! Resolves the motion of a clamp or an obstacle.

use super::poses;
use crate::scenario::resolved::Movement;
use crate::scenario::section::{FINITE, Section};
use crate::scenario::typed::TypedMovement;

/// Resolves a motion: by its own keys or by poses.
pub fn movement(section: &Section<'_>, typed: &TypedMovement<'_>) -> Movement {
    let movement = Movement {
        translation: section.corners("move", typed.translation, |corner, displacement| {
            corner.components("1", displacement)
        }),
        angle: section.corners("turn", typed.angle, |corner, angle| {
            corner.number("1", angle, FINITE)
        }),
        angular_velocity: typed.angular_velocity,
        axis: typed.axis,
        pivot: typed.pivot,
        poses: poses::poses(section, typed.follow, typed.poses),
    };
    for (key, given) in given_keys(&movement) {
        if given && key != "poses" && !movement.poses.is_empty() {
            section.fault(
                key,
                "the poses define how it moves and turns; leave the key out",
            );
        }
    }
    movement
}

/// The keys of a motion, and whether each is given.
pub fn given_keys(movement: &Movement) -> [(&'static str, bool); 6] {
    [
        ("move", !movement.translation.is_empty()),
        ("turn", !movement.angle.is_empty()),
        ("angular_velocity", movement.angular_velocity != 0.0),
        ("axis", movement.axis.is_some()),
        ("pivot", movement.pivot.is_some()),
        ("poses", !movement.poses.is_empty()),
    ]
}

/// Reports the keys of a motion in a run without time. Without motion, `axis` and `pivot` could be
/// misread as the held direction and position, which are those of the rod as placed.
pub fn refuse_motion(movement: &Movement, refuse: impl Fn(&str)) {
    for (key, given) in given_keys(movement) {
        if given {
            refuse(key);
        }
    }
}
