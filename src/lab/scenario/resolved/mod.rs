//! The resolved scenario: complete and validated, with every number in SI units.
//!
//! A [`Scenario`] leaves nothing open: defaults are filled in, units converted, shape files read.
//! The serialised form of a scenario uses the keys of scenario files, so it is itself a scenario
//! file. TOML has no null, so `None` values are left out.

mod experiment;
mod load;
mod model;
mod movement;
mod network;
mod obstacle;
mod parts;
mod rod;
mod run;
mod section;
mod start;

pub use super::place::Place;
pub use super::tables::{
    Body, BodyShape, Continuation, Flow, FlowKind, Joint, JointKind, Load, LoadFrame, LoadKind,
    Output, PathMethod, Plane, Probe, ProbeKind, Solver, SpringOnly, Stiffness, StopWhen, Summary,
};
pub use experiment::{BuilderRod, Experiment};
pub use load::{Clamp, Hold};
pub use model::{Contact, Fluid, FrictionAt, Geometry};
pub use movement::{Movement, Pose};
pub use network::{HeldEnds, NetworkJoint};
pub use obstacle::{Obstacle, ObstacleShape};
pub use parts::Parts;
pub use rod::{Handedness, Inertia, Material, NaturalShape, Rod, Shape, Strains};
pub use run::{Begin, Scheme, Step, Time};
pub use section::{CrossSection, RodSection};
pub use start::Start;

use serde::Serialize;

/// A validated scenario in SI units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scenario {
    /// Stem of the scenario file, the name of the results.
    #[serde(skip)]
    pub name: String,
    /// Title for readers.
    pub title: String,
    /// The experiment that builds the scene, with its own tables.
    #[serde(flatten)]
    pub experiment: Experiment,
    /// Rods of the scene; with a builder, rods in addition to those it builds.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rods: Vec<Rod>,
    /// Held or driven nodes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub clamps: Vec<Clamp>,
    /// Nodes that are joined.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<Joint>,
    /// Masses and rigid bodies that rods carry.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<Body>,
    /// External loads.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub loads: Vec<Load>,
    /// Parts with tables of their own.
    #[serde(flatten)]
    pub parts: Parts,
    /// Rigid half spaces.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub planes: Vec<Plane>,
    /// Rigid bodies.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<Obstacle>,
    /// The state from which the run starts. Default: everything as placed.
    pub start: Option<Start>,
    /// Quantities measured at every output.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<Probe>,
    /// The condition that ends the run.
    pub stop_when: Option<StopWhen>,
    /// Contact model.
    pub contact: Contact,
    /// Surrounding fluid.
    pub fluid: Fluid,
    /// Dynamic, static or along a path, and the time steps.
    pub time: Time,
    /// The path, if the mode needs one.
    pub continuation: Option<Continuation>,
    /// Newton's method.
    pub solver: Solver,
    /// Output of the run.
    pub output: Output,
}
