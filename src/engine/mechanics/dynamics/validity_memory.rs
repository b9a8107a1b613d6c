//! Record of strains, energy and small steps so far: part of the state in checkpoints.

use serde::{Deserialize, Serialize};

/// The largest strain of a kind, and since when the bound has been exceeded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LargeStrain {
    /// Size of the strain; signed for a stretch.
    pub size: f64,
    /// Node of the whole scene.
    pub node: usize,
    /// When it was so large, s.
    pub time: f64,
    /// Time at which the bound was first exceeded, s.
    pub since: f64,
}

/// The largest gain of energy, relative to the largest energy that is not spurious.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gain {
    /// The gain relative to that energy.
    pub relative: f64,
    /// Time at which a gain was first found, s.
    pub since: f64,
}

/// Series of steps far smaller than requested, with the same advice.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SmallSteps {
    /// Time and reason of the first series.
    pub message: String,
    /// Advice; empty if there is none.
    pub advice: String,
    /// Number of rows.
    pub rows: usize,
}

impl SmallSteps {
    /// The first row.
    pub(crate) fn first(message: String, advice: String) -> Self {
        Self {
            message,
            advice,
            rows: 1,
        }
    }

    /// All rows in one sentence.
    pub(crate) fn in_words(&self) -> String {
        let mut words = self.message.clone();
        if self.rows > 1 {
            words += &format!(" (the first of {} times)", self.rows);
        }
        if !self.advice.is_empty() {
            words += &format!("; {}", self.advice);
        }
        words
    }
}

/// A node that slides along a rod and is slowed down by its corners.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaughtSlide {
    /// The equivalent friction coefficient.
    pub friction: f64,
    /// Length of edges with which the friction would be negligible, m.
    pub edge: f64,
    /// The sliding node, of the whole scene.
    pub node: usize,
    /// First node of the rod along which it slides.
    pub rail: usize,
    /// When it was so large, s.
    pub time: f64,
}

/// Two rods that pass through each other in a fluid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlowOverlap {
    /// First nodes of the edges that overlap, of the whole scene.
    pub nodes: [usize; 2],
    /// When it was found, s.
    pub time: f64,
}

/// Record so far: part of the state in checkpoints.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ValidityMemory {
    /// Steps so far.
    pub steps: usize,
    /// Work of clamps and obstacles minus the losses since the start, J.
    pub taken_in: f64,
    /// Part of it that stiffer contacts added, J.
    pub stiffened: f64,
    /// Sum of the absolute values of work and losses, J.
    pub exchanged: f64,
    /// Least value so far of the energy minus the energy taken in until then, J.
    pub lowest: Option<f64>,
    /// Largest kinetic and elastic energy so far that is not spurious, J.
    pub explained: f64,
    /// Time integral of the normal forces of all contacts, N s.
    pub impulse: f64,
    /// Whether all sources and losses of energy are counted, so that any other gain is an error of
    /// the scheme.
    pub is_conservative: bool,
    /// The largest stretch beyond its bound.
    pub stretch: Option<LargeStrain>,
    /// The largest strain by bending beyond its bound.
    pub bending: Option<LargeStrain>,
    /// The largest shear by twist beyond its bound.
    pub twist: Option<LargeStrain>,
    /// The largest gain of spurious energy.
    pub gain: Option<Gain>,
    /// Time from which velocities have been ringing, s.
    pub ringing: Option<f64>,
    /// Steps far smaller than requested, one entry for each advice.
    pub small_steps: Vec<SmallSteps>,
    /// The slide with the largest equivalent friction.
    pub slide: Option<CaughtSlide>,
    /// The first rods that overlap in a fluid.
    pub overlap: Option<FlowOverlap>,
    /// The remark on an unstable equilibrium.
    pub instability: Option<String>,
}
