//! Probes as resolved.

use crate::scenario::place::Place;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A quantity that is measured at every output.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Probe {
    /// Name with which its columns begin.
    pub name: String,
    /// What is measured.
    #[serde(flatten)]
    pub kind: ProbeKind,
    /// What of it stands in the summary.
    pub summary: Option<Summary>,
}

/// What of the values of a probe stands in the summary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Summary {
    /// That of the last row.
    Last,
    /// The largest.
    Max,
    /// The smallest.
    Min,
    /// The mean of all rows that have one.
    Mean,
}

/// Kinds of probes.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ProbeKind {
    /// Position of a node.
    Position(AtPlace),
    /// Displacement of a node from where it was placed.
    Displacement(AtPlace),
    /// Velocity of a node.
    Velocity(AtPlace),
    /// Distance of two nodes or rods.
    Distance(Between),
    /// Force and moment of a clamp.
    Reaction(AtPlace),
    /// Tension of an edge.
    Tension(AtPlace),
    /// Bending moment at a node.
    BendingMoment(AtPlace),
    /// Twisting moment at a node.
    TwistingMoment(AtPlace),
    /// Curvature at a node.
    Curvature(AtPlace),
    /// Torsion at an edge.
    Torsion(AtPlace),
    /// Twist per length at a node.
    Twist(AtPlace),
    /// Contact force on a rod.
    ContactForce(PressedRod),
    /// Energies of a rod.
    Energy(OneRod),
    /// Writhe of a rod.
    Writhe(OneRod),
    /// Linking number of two rods.
    LinkingNumber(TwoRods),
    /// Length of a rod.
    ArcLength(OneRod),
    /// Force of a spring between nodes.
    SpringForce(OneSpring),
}

/// A place on a rod.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AtPlace {
    /// Name of the rod; `None` means the only one.
    pub rod: Option<String>,
    /// Node or edge; `None` means the largest along the rod.
    pub at: Option<Place>,
}

/// Two nodes, or two rods.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Between {
    /// Name of the one rod; `None` means the only one.
    pub rod: Option<String>,
    /// Name of the other rod; `None` means the same.
    pub to_rod: Option<String>,
    /// The nodes; `None` means the least distance of the rods.
    #[serde(flatten)]
    pub nodes: Option<TwoNodes>,
}

/// Two nodes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TwoNodes {
    /// Node of the one rod.
    pub at: Place,
    /// Node of the other.
    pub to: Place,
}

/// A rod on which something presses.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PressedRod {
    /// Name of the rod; `None` means the only one.
    pub rod: Option<String>,
    /// Name of the rod that presses on it.
    pub from_rod: Option<String>,
    /// The plane that presses on it.
    pub from_plane: Option<usize>,
    /// Name of the obstacle that presses on it; `None` of all three means all rods, planes and obstacles.
    pub from_obstacle: Option<String>,
}

/// A rod.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OneRod {
    /// Name of the rod; `None` means the only one.
    pub rod: Option<String>,
}

/// A spring between nodes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OneSpring {
    /// Name of the joint that it is.
    pub joint: String,
}

/// Two rods.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TwoRods {
    /// Name of the one.
    pub rod: String,
    /// Name of the other.
    pub to_rod: String,
}

/// A condition that ends a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StopWhen {
    /// Name of a probe or column.
    pub probe: String,
    /// It ends where the column exceeds this.
    pub above: Option<f64>,
    /// It ends where the column falls below this; exactly one of the two is given.
    pub below: Option<f64>,
}
