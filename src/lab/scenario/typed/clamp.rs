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
        /// Displacement of the clamp from where the rod is placed, applied before the run. The rod
        /// moves with it; the natural shape of the rod does not change.
        offset: vector(Length) default([0.0; 3]),
        /// Rotation of the clamp about its node, applied before the run: an axis times an angle.
        rotation: vector(Angle) default([0.0; 3]),
    }
}
