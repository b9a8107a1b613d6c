//! Keys of sheaths.

use crate::scenario::keys::{POSITIVE, keys};
use crate::scenario::units::{Angle, Force, Length};

keys! {
    /// A straight sheath out of which a rod is fed: the sheath of a catheter, the guide of a cable
    /// that comes from a reel, a gripper that lets a rod slide. It holds the rod from one end to the
    /// mouth, without clearance: inside, the rod is straight and moves as a whole.
    table SheathKeys "sheath" {
        /// Name for probes and messages. Default: "sheath 0", "sheath 1", ...
        name: text() derived,
        /// Name of the rod.
        rod: text("the name of a rod") required,
        /// End of the rod that is in the sheath: "start" or "end".
        from: word(InnerEnd) default(InnerEnd::Start),
        /// Natural length of the rod in the sheath at time zero. This part of the rod is placed
        /// straight; the mouth of the sheath is at its end.
        inside: number(Length, POSITIVE) required,
        /// Length that is fed out at given times, [[time, length], ...], linear between them and
        /// constant outside. Negative values draw the rod in. One edge of the rod stays inside.
        /// Default: none.
        fed: corners(Length) derived,
        /// Force that feeds the rod at given times, [[time, force], ...], linear between them and
        /// constant outside, instead of `fed`: the length fed out follows from the motion. Negative
        /// forces draw the rod in. The rod stops where only its first edge is inside, and where all
        /// of it is, or all up to a clamp, joint or body. Default: none.
        pushed: corners(Force) derived,
        /// Angle by which the rod is turned in the sheath at given times, [[time, angle], ...],
        /// linear between them, about the direction in which the rod is fed. Default: none.
        turned: corners(Angle) derived,
    }
}

/// An end of a rod.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    serde::Serialize,
    serde::Deserialize,
    schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum InnerEnd {
    #[default]
    /// The first node.
    Start,
    /// The last node.
    End,
}
