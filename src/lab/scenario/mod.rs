//! Scenario files: the TOML schema as Rust types, units, and validation with positions in the
//! files.
//!
//! A scenario is a file ([`load`]), text ([`from_text`]), or a table that is built in Rust
//! ([`from_table`]), with the same keys, checks and messages. These modules process it in order:
//!
//! | file | what |
//! |---|---|
//! | `source`, `document`, `document_values` | the texts; TOML as a tree with the place of every key, from text or values in memory, and back |
//! | `input_file`, `named_files` | regular files of a bounded size; the keys that name them |
//! | `merged`, `include`, `overrides` | reading a file, the files that it `extends` and `include`s, `--set key=value` |
//! | `load` | all steps from a file, a text or a table to the scenario |
//! | `expression`, `expansion` | `[parameters]`, `"2*radius"`, copies of tables: a tree without them |
//! | `declaration`, `form` | one declaration for each key: words, unit, range, default; forms of values |
//! | `tables` | tables that are resolved as they are typed, and the checks between their keys |
//! | `decode`, `typed` | serde from the tree to the file as typed: unknown keys, wrong types |
//! | `quantity`, `place`, `section` | values as typed; judging the values of one table |
//! | `experiments`, `own_tables`, `part`, [`keys`] | the available experiments, and the definition of the keys of one, or of a part |
//! | `units`, `resolve` | SI units, defaults, ranges: from the file as typed to the scenario as resolved |
//! | `sweep` | many cases of one scenario: lists, ranges, samples, searches |
//! | `resolved`, `cross_section`, `canonical` | the [`Scenario`], its stiffnesses, its own TOML |
//! | `issue`, `error` | faults by key path; the same with file, line and column |
//! | `schema`, `schema_tree`, `explain`, `sentences` | JSON Schema; its part for each key of a document; explanations of keys |
//!
//! The module is independent of mechanics and of particular experiments: vectors are arrays, models are names and numbers.

mod canonical;
mod cross_section;
pub(crate) mod declaration;
mod decode;
mod document;
mod document_values;
mod error;
mod expansion;
mod experiments;
mod explain;
mod expression;
pub(crate) mod form;
mod include;
mod input_file;
mod issue;
pub mod keys;
mod load;
mod merged;
mod named_files;
mod overrides;
mod own_tables;
mod part;
pub(crate) mod place;
pub(crate) mod quantity;
mod rescale;
mod resolve;
mod resolved;
mod rows;
mod schema;
mod schema_tree;
pub(crate) mod section;
mod sentences;
mod source;
mod sweep;
mod tables;
#[cfg(test)]
mod tests;
mod typed;
mod typed_file;
pub(crate) mod units;

pub use error::{Located, ScenarioError};
pub use expansion::Copied;
pub use experiments::Experiments;
pub use explain::{explain, json_schema, unit};
pub use input_file::read_text_file;
pub use issue::{Issue, Issues, KeyPath, did_you_mean};
pub use load::{Loaded, from_table, from_text, load};
pub use named_files::INPUTS;
pub use rescale::{Scales, rescaled};
pub use resolve::{END_STATE, read_polyline};
pub use resolved::{
    Begin, Body, BodyShape, BuilderRod, Clamp, Contact, Continuation, CrossSection, Experiment,
    Flow, FlowKind, Fluid, FrictionAt, Geometry, Handedness, Hold, Inertia, Joint, JointKind, Load,
    LoadFrame, LoadKind, Material, Movement, NaturalShape, Obstacle, ObstacleShape, Output, Parts,
    PathMethod, Place, Plane, Pose, Rod, RodSection, Scenario, Scheme, Shape, Solver, SpringOnly,
    Start, Step, Stiffness, Strains, Time,
};
pub use resolved::{Probe, ProbeKind, StopWhen, Summary};
pub use sweep::{
    Case, CaseSet, InputFile, Parameter, Portable, Search, SweptDerivatives, earlier_id,
};
pub use typed::{Quantity, SearchMethod, Vector};
pub use typed_file::TypedFile;
pub use units::{angle, metres, parse_any as number_with_unit, seconds};

/// Physical dimensions, for [`Quantity`].
pub mod dimension {
    pub use super::units::{
        Angle, AngularVelocity, Curvature, Density, Dimension, Dimensionless, Force, Length,
        Moment, Pressure, Time, Velocity,
    };
}
