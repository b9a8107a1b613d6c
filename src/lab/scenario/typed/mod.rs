//! The common tables of scenario files as typed, with every allowed key. Nothing is checked yet.
//! Tables that only some experiments have are typed in the modules of those experiments.
//!
//! The comments of these types are the descriptions in the JSON Schema and the texts of `rodlab explain`.

mod clamp;
mod kinds;
mod model;
mod movement;
mod network;
mod obstacle;
mod rod;
mod section;
mod shape;
mod start;
mod sweep;

pub use super::quantity::{Quantity, Vector};
pub use clamp::Clamp;
pub use model::{
    Begin, BuilderRod, Contact, ContactModel, Fluid, FluidModel, Mode, SchemeChoice, Time,
};
pub use movement::{Pose, TypedMovement};
pub use network::{Boundary, Network, NetworkShape};
pub use obstacle::{Capsule, Cuboid, Heights, Mesh, Obstacle, ObstacleShape};
pub use rod::{InertiaChoice, Material, Rod};
pub use section::{CrossSection, Profile, RodSection};
pub use shape::{
    Arc, Catenary, Coil, Helix, NaturalShape, Points, Ring, Shape, Slack, Straight, Strains,
};
pub use start::Start;
pub use sweep::{End, Sample, SampleMethod, Search, SearchMethod, Sweep, SweptDerivatives};

use super::tables::{
    BodyKeys, ContinuationKeys, JointKeys, LoadKeys, OutputKeys, PlaneKeys, ProbeKeys, SolverKeys,
    StopKeys,
};
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A rodlab scenario. Numbers are in SI units; text may carry a unit, such as "1.6 mm".
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "scenario")]
pub struct ScenarioFile {
    /// Title shown to readers. Default: the name of the file.
    pub title: Option<String>,
    /// Another scenario file, relative to this file, whose keys are used unless this file sets
    /// them. Tables are merged key by key, arrays are replaced.
    #[expect(dead_code, reason = "files are merged before they are decoded")]
    pub extends: Option<String>,
    /// Keys of that file that are not inherited, such as ["time.end", "rods.beam.twist"].
    #[expect(dead_code, reason = "files are merged before they are decoded")]
    pub unset: Option<Vec<String>>,
    /// Another file, or a list of files, relative to this file, whose tables are added: tables are
    /// merged, existing keys are kept, and arrays of tables such as [[rods]] grow.
    #[expect(dead_code, reason = "files are merged before they are decoded")]
    pub include: Option<Included>,
    /// Named numbers, with units or without, for expressions: radius = "2 mm" lets other keys be
    /// "2*radius + 1 mm". They may use each other in any order. `seed` is the seed of random
    /// numbers. Default of `seed`: 0.
    #[expect(dead_code, reason = "parameters are put in before files are decoded")]
    #[serde(default)]
    pub parameters: BTreeMap<String, Parameter>,
    /// Material of all rods without a material of their own.
    pub material: Option<Material>,
    /// Rods that an experiment such as "flagella" builds; scenes use [[rods]].
    pub rod: Option<BuilderRod>,
    /// The rods of a scene. In experiments that build rods, these are additional rods.
    #[serde(default)]
    pub rods: Vec<Rod>,
    /// Held or driven nodes.
    #[serde(default)]
    pub clamps: Vec<Clamp>,
    /// Joints between rods.
    #[serde(default)]
    pub joints: Vec<JointKeys>,
    /// Masses and rigid bodies that rods carry.
    #[serde(default)]
    pub bodies: Vec<BodyKeys>,
    /// Nets, gridshells, trees: many rods joined at their crossings.
    #[serde(default)]
    pub networks: Vec<Network>,
    /// External loads.
    #[serde(default)]
    pub loads: Vec<LoadKeys>,
    /// Rigid half spaces that rods may touch.
    #[serde(default)]
    pub planes: Vec<PlaneKeys>,
    /// Rigid bodies that rods may touch.
    #[serde(default)]
    pub obstacles: Vec<Obstacle>,
    /// The state from which the run starts. Default: everything as placed.
    pub start: Option<Start>,
    /// Quantities measured at every output: columns of series.csv and summary.csv.
    #[serde(default)]
    pub probes: Vec<ProbeKeys>,
    /// A condition on a probe that ends the run.
    pub stop_when: Option<StopKeys>,
    /// Contact between rods, with planes and with obstacles. Without this table everything passes
    /// through everything else.
    pub contact: Option<Contact>,
    /// The surrounding fluid. Default: a vacuum.
    pub fluid: Option<Fluid>,
    /// Dynamic, static or along a path of equilibria, and the time steps.
    pub time: Option<Time>,
    /// The path of equilibria of time.mode = "continuation".
    pub continuation: Option<ContinuationKeys>,
    /// Newton's method.
    #[serde(default)]
    pub solver: SolverKeys,
    /// Files that are written, and how often.
    #[serde(default)]
    pub output: OutputKeys,
    /// Many cases of this scenario: keys with lists or ranges of values.
    #[expect(dead_code, reason = "sweeps are taken out before files are decoded")]
    pub sweep: Option<Sweep>,
}

/// A number, or text: a number with a unit, or an expression.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
#[expect(dead_code, reason = "parameters are put in before files are decoded")]
pub enum Parameter {
    /// A number.
    Number(f64),
    /// A number with a unit, or an expression.
    Text(String),
}

/// A file, or several.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
#[expect(dead_code, reason = "files are merged before they are decoded")]
pub enum Included {
    /// Name of the file.
    One(String),
    /// Names of the files.
    Several(Vec<String>),
}
