//! Clamps as typed.

use super::movement::{Pose, Translation, Turn, TypedMovement, moving};
use crate::scenario::declaration::keys;
use crate::scenario::resolved::Hold;
use crate::scenario::section::{FINITE, Section};
use crate::scenario::units::{Angle, AngularVelocity, Length};

moving! {
    /// A held or driven node.
    table Clamp "clamp" {
        /// Name of the rod.
        rod: text("the name of a rod") required,
        /// "start", "end", or the number of a node, counted from zero.
        at: place() required,
        /// "position", "frame" (tangent and material frame), or "both" (the default).
        hold: word(Hold) default(Hold::Both),
        /// Displacement of the clamp, before the run, from where the rod is placed. The rod is carried along; its shape
        /// without stress stays.
        offset: vector(Length) default([0.0; 3]),
        /// Rotation of the clamp about its node in the same way: an axis times an angle.
        rotation: vector(Angle) default([0.0; 3]),
    }
}
