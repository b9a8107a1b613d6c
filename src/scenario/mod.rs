//! Scenario files: the TOML schema as Rust types, units, validation with source positions.

mod canonical;
mod cross_section;
mod issue;
mod resolved;

pub use issue::{Issue, Issues, KeyPath, did_you_mean};
pub use resolved::{
    BuilderRod, Clamp, Contact, CrossSection, Experiment, Flagella, Fluid, Handedness, Head, Hold,
    Load, LoadKind, Material, NaturalShape, Output, Place, Plane, Rod, Scenario, Scheme, Shape,
    Solver, Step, Stiffness, Time,
};
