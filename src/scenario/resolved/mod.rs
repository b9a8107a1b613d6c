//! The scenario as resolved: complete, validated, every number in SI units.
//!
//! A [`Scenario`] leaves no choice open: defaults are filled in, units converted, shape files read. Its
//! serialised form uses the keys of scenario files, so that it is itself a scenario file.

mod continuation;
mod flagella;
mod helix_stability;
mod knot;
mod load;
mod model;
mod probe;
mod rod;
mod run;

pub use continuation::{Continuation, PathMethod};
pub use flagella::{BuilderRod, Flagella, Head};
pub use helix_stability::{Directions, HelixSearch, HelixStability};
pub use knot::{Knot, KnotEnds, KnotKind, KnotStart};
pub use load::{Clamp, Hold, Load, LoadKind, Place, Plane, Pose};
pub use model::{Contact, Fluid};
pub use probe::{
    AtPlace, Between, OneRod, PressedRod, Probe, ProbeKind, StopWhen, Summary, TwoNodes, TwoRods,
};
pub use rod::{CrossSection, Handedness, Material, NaturalShape, Rod, Shape, Stiffness};
pub use run::{Output, Scheme, Solver, Step, Time};

use serde::Serialize;

/// A validated scenario in SI units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scenario {
    /// Stem of the scenario file, by which results are called.
    #[serde(skip)]
    pub name: String,
    /// Title for people.
    pub title: String,
    /// Which experiment builds the scene.
    #[serde(flatten)]
    pub experiment: Experiment,
    /// Rods of the scene; in a builder, rods beside those it builds.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rods: Vec<Rod>,
    /// Held or driven nodes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub clamps: Vec<Clamp>,
    /// External loads.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub loads: Vec<Load>,
    /// Rigid half spaces.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub planes: Vec<Plane>,
    /// What is measured at every output.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<Probe>,
    /// The condition that ends the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop_when: Option<StopWhen>,
    /// Contact model.
    pub contact: Contact,
    /// Surrounding fluid.
    pub fluid: Fluid,
    /// Dynamic, static or along a path, and the time steps.
    pub time: Time,
    /// The path, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub continuation: Option<Continuation>,
    /// Newton's method.
    pub solver: Solver,
    /// What is written.
    pub output: Output,
}

/// The experiments and the tables that only they read.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "experiment", rename_all = "kebab-case")]
pub enum Experiment {
    /// The rods as listed.
    Scene,
    /// Helical flagella driven at their heads.
    Flagella {
        /// Material of the flagella.
        material: Material,
        /// Radius and nodes of each flagellum.
        rod: BuilderRod,
        /// Number, geometry and drive.
        flagella: Flagella,
    },
    /// A knot whose ends are pulled apart.
    KnotTightening {
        /// Material of the rod.
        material: Material,
        /// Radius and nodes of the rod.
        rod: BuilderRod,
        /// The knot and how it is pulled.
        knot: Knot,
    },
    /// An overhand knot whose ends are pulled apart until its loop has snapped onto the braid.
    KnotInversion {
        /// Material of the rod.
        material: Material,
        /// Radius and nodes of the rod.
        rod: BuilderRod,
        /// The knot and how it is pulled.
        knot: Knot,
    },
    /// Where clamped helical rods lose stability.
    HelixStability {
        /// Rod and directions.
        helix_stability: HelixStability,
    },
}

impl Experiment {
    /// The name by which scenario files call the experiment.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Flagella { .. } => "flagella",
            Self::KnotTightening { .. } => "knot-tightening",
            Self::KnotInversion { .. } => "knot-inversion",
            Self::HelixStability { .. } => "helix-stability",
        }
    }

    /// The knot and its rod, where there is one.
    pub fn knot(&self) -> Option<(&BuilderRod, &Knot)> {
        match self {
            Self::KnotTightening { rod, knot, .. } | Self::KnotInversion { rod, knot, .. } => {
                Some((rod, knot))
            }
            Self::Scene | Self::Flagella { .. } | Self::HelixStability { .. } => None,
        }
    }
}
