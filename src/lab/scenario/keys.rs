//! Items with which a kind of experiment defines its own keys.
//!
//! A kind declares each of its tables as a struct of optional values. The doc comments of the
//! struct explain the keys, in the JSON Schema and in `rodlab explain`. The kind lists the tables
//! ([`OwnTable`]) and resolves them to SI units from a [`Request`], which collects faults by key:
//!
//! ```
//! use rodlab_lab::scenario::keys::{ExperimentKeys, Length, OwnTable, POSITIVE, Quantity, Request};
//! use rodlab_lab::scenario::Experiment;
//!
//! /// A pendulum.
//! #[derive(serde::Deserialize, schemars::JsonSchema)]
//! #[schemars(deny_unknown_fields, rename = "pendulum")]
//! struct TypedPendulum {
//!     /// Length of the string.
//!     length: Option<Quantity<Length>>,
//! }
//!
//! #[derive(serde::Serialize)]
//! struct Tables {
//!     pendulum: Pendulum,
//! }
//!
//! #[derive(serde::Serialize)]
//! struct Pendulum {
//!     length: f64,
//! }
//!
//! static TABLES: [OwnTable; 1] = [OwnTable::new::<TypedPendulum>("pendulum", "The pendulum.")];
//!
//! struct PendulumKind;
//!
//! impl ExperimentKeys for PendulumKind {
//!     fn name(&self) -> &'static str {
//!         "pendulum"
//!     }
//!     fn summary(&self) -> &'static str {
//!         "A pendulum."
//!     }
//!     fn tables(&self) -> &'static [OwnTable] {
//!         &TABLES
//!     }
//!     fn resolve(&self, request: &Request<'_>) -> Option<Experiment> {
//!         let typed: &TypedPendulum = request.table("pendulum")?;
//!         let section = request.top.below("pendulum");
//!         let length = section.required("length", &typed.length, POSITIVE);
//!         let pendulum = Pendulum { length };
//!         Some(Experiment::new(self.name(), Tables { pendulum }))
//!     }
//! }
//! ```

pub(crate) use super::declaration::keys;
pub use super::own_tables::OwnTable;
pub use super::part::Part;
pub use super::resolve::{
    BuiltRod, CommonTables, ExperimentKeys, FINITE, FRACTION, NON_NEGATIVE, POSITIVE, Range,
    Request, Section, read_columns, triangle_mesh,
};
pub use super::typed::{Quantity, Vector};
pub use super::units::{
    Acceleration, Angle, AngularVelocity, Curvature, Density, Dimension, Dimensionless, Force,
    Length, LinearDrag, Pressure, Rigidity, Time, Twist, Velocity, Viscosity,
};
