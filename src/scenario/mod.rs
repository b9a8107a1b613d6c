//! Scenario files: the TOML schema as Rust types, units, validation with source positions.

mod canonical;
mod cross_section;
mod decode;
mod document;
mod error;
mod explain;
mod issue;
mod load;
mod overrides;
mod resolve;
mod resolved;
mod source;
#[cfg(test)]
mod tests;
mod typed;
mod units;

pub use error::{Located, ScenarioError};
pub use explain::{explain, json_schema};
pub use issue::{Issue, Issues, KeyPath, did_you_mean};
pub use load::{Loaded, from_text, load};
pub use resolved::{
    BuilderRod, Clamp, Contact, CrossSection, Experiment, Flagella, Fluid, Handedness, Head, Hold,
    Load, LoadKind, Material, NaturalShape, Output, Place, Plane, Rod, Scenario, Scheme, Shape,
    Solver, Step, Stiffness, Time,
};
pub use units::seconds;
