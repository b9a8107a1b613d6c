//! Sheaths out of which rods are fed.

/// A straight sheath that holds one part of a rod, from an end to the mouth of the sheath, and
/// feeds the rod out, draws it in and turns it. It has no clearance: inside, the rod is straight
/// and moves as a whole; at the mouth, it is clamped.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheath {
    /// Name in scenarios and messages.
    pub name: String,
    /// Index of the rod.
    pub rod: usize,
    /// Whether the last node of the rod is in the sheath, instead of the first.
    pub from_end: bool,
    /// Natural length of the rod in the sheath at time zero, m.
    pub inside: f64,
    /// Length fed out at given times, [(s, m), ...]: linear between them and constant outside; 0 if
    /// empty, negative where the rod is drawn in.
    pub fed: Vec<(f64, f64)>,
    /// Force that feeds the rod out at given times, [(s, N), ...], linear between them and constant
    /// outside: the length fed out then follows from the motion. Empty if the length is given.
    pub pushed: Vec<(f64, f64)>,
    /// Angle by which the rod is turned in the sheath at given times, [(s, rad), ...], about the
    /// direction in which it is fed out; 0 if empty.
    pub turned: Vec<(f64, f64)>,
}
