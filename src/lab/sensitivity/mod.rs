//! Derivatives of what a scenario measures over its keys.
//!
//! A [`Problem`] is a scenario with some of its keys, each of them also set to a little more and a little less. [`Problem::follow`] runs
//! it with the derivatives of its state ([`rodlab_engine::mechanics::dynamics::sensitivity`]) to given times, and shows them to a
//! function: a fit of parameters reads the positions of its markers there. [`derivatives`] does so for the probes of the scenario, at its
//! outputs, and [`differences`] by whole runs with other values, for comparison.
//!
//! | file | what |
//! |---|---|
//! | `error` | what cannot be differentiated |
//! | `problem` | a scenario, its keys, and the run |
//! | `chosen` | the columns of its probes that are asked for |
//! | `probed` | derivatives of probes |
//! | `check` | differences of whole runs |
//! | `fields` | derivatives of probes over fields along rods |

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
