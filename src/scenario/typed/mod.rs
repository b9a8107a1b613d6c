//! The scenario file as typed: every key that may stand in one, none of them judged yet.
//!
//! The comments of these types are the descriptions in the JSON Schema and the words of `rodlab explain`.

mod continuation;
mod helix_stability;
mod kinds;
mod knot;
mod load;
mod model;
mod probe;
mod quantity;
mod rod;
mod shape;
mod sweep;

pub use continuation::Continuation;
pub use helix_stability::{Directions, HelixStability, List};
pub use knot::{Knot, KnotKind};
pub use load::{Clamp, Load, Place, Plane, Pose};
pub use model::{
    BuilderRod, Contact, ContactModel, Flagella, Fluid, FluidModel, Mode, Output, Solver, Time,
};
pub use probe::{
    ContactForceProbe, DistanceProbe, EdgeProbe, NodeProbe, Probe, RodProbe, SectionProbe, StopWhen,
};
pub use quantity::{Quantity, Vector};
pub use rod::{CrossSection, Material, Rod, Stiffness};
pub use shape::{Arc, Helix, NaturalShape, Points, Ring, Shape, Straight};
pub use sweep::{End, Sample, SampleMethod, Search, SearchMethod, Sweep};

use schemars::JsonSchema;
use serde::Deserialize;

/// A rodlab scenario. Numbers are in SI units; text may carry a unit, such as "1.6 mm".
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "scenario")]
pub struct ScenarioFile {
    /// What is simulated: "scene" (the rods listed here), "flagella" (helices turned at their heads),
    /// "knot-tightening" (a knot whose ends are pulled apart), "knot-inversion" (an overhand knot until its loop
    /// has snapped onto the braid) or "helix-stability" (where clamped helical rods lose stability).
    pub experiment: Option<Experiment>,
    /// Title for people; the name of the file where absent.
    pub title: Option<String>,
    /// Another scenario file whose keys hold unless this one sets them, relative to this file. Tables are
    /// merged key by key, arrays replaced.
    #[expect(dead_code, reason = "files are merged before they are decoded")]
    pub extends: Option<String>,
    /// Material of all rods that have none of their own.
    pub material: Option<Material>,
    /// Rods that a builder such as "flagella" makes; scenes use [[rods]].
    pub rod: Option<BuilderRod>,
    /// The rods of a scene; in "flagella", rods beside the flagella.
    #[serde(default)]
    pub rods: Vec<Rod>,
    /// Held or driven nodes.
    #[serde(default)]
    pub clamps: Vec<Clamp>,
    /// External loads.
    #[serde(default)]
    pub loads: Vec<Load>,
    /// Rigid half spaces that rods may touch.
    #[serde(default)]
    pub planes: Vec<Plane>,
    /// What is measured at every output: columns of series.csv and summary.csv.
    #[serde(default)]
    pub probes: Vec<Probe>,
    /// A condition on a probe that ends the run.
    pub stop_when: Option<StopWhen>,
    /// Contact between rods and with planes; without this table everything passes through.
    pub contact: Option<Contact>,
    /// The surrounding fluid; without this table a vacuum.
    pub fluid: Option<Fluid>,
    /// Dynamic, static or along a path of equilibria, and the time steps.
    pub time: Option<Time>,
    /// The path of equilibria of time.mode = "continuation".
    pub continuation: Option<Continuation>,
    /// Newton's method.
    #[serde(default)]
    pub solver: Solver,
    /// What is written, and how often.
    #[serde(default)]
    pub output: Output,
    /// Number, geometry and drive of the flagella of the experiment "flagella".
    pub flagella: Option<Flagella>,
    /// The knot of the experiments "knot-tightening" and "knot-inversion" and how it is pulled tight.
    pub knot: Option<Knot>,
    /// Rod and directions of the experiment "helix-stability".
    pub helix_stability: Option<HelixStability>,
    /// Many cases of this scenario: keys with lists or ranges of values.
    #[expect(dead_code, reason = "sweeps are taken out before files are decoded")]
    pub sweep: Option<Sweep>,
}

/// The experiments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Experiment {
    /// The rods as listed.
    Scene,
    /// Helical flagella turned at their heads.
    Flagella,
    /// A knot whose ends are pulled apart.
    KnotTightening,
    /// An overhand knot whose ends are pulled apart until its loop has snapped onto the braid.
    KnotInversion,
    /// The loss of stability of clamped helical rods.
    HelixStability,
}
