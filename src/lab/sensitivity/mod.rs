//! Derivatives of the measured quantities of a scenario with respect to its keys.
//!
//! A [`Problem`] is a scenario and some of its keys, each with two neighbours of slightly larger
//! and smaller value. [`Problem::follow`] runs it to given times with the derivatives of its state
//! ([`rodlab_engine::mechanics::dynamics::sensitivity`]) and calls a function there; a fit of
//! parameters, for example, reads the positions of its markers. [`derivatives`] computes
//! derivatives of the probes at the outputs. [`differences`] computes them from whole runs with
//! other values, for comparison.
//!
//! | file | what |
//! |---|---|
//! | `error` | what cannot be differentiated |
//! | `problem` | a scenario, its keys, and the run |
//! | `chosen` | the columns of its probes that are asked for |
//! | `probed` | derivatives of probes |
//! | `check` | differences of whole runs |
//! | `fields` | derivatives of probes with respect to fields along rods |

mod check;
mod chosen;
mod error;
mod fields;
mod probed;
mod problem;

pub use check::differences;
pub use error::SensitivityError;
pub use fields::{Field, FieldDerivatives, FieldRow, field_derivatives};
pub use probed::{Derivatives, Row, derivatives, derivatives_at, refuse_unsuitable};
pub use problem::{Key, Moment, Problem, Source};

#[cfg(test)]
mod tests;
