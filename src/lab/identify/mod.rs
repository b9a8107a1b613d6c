//! Identification of keys of scenarios from measurements, with error bars.
//!
//! A scenario predicts the measurements; the fit finds the keys with the best predictions. Several
//! experiments may share the keys. The page `identification` of the guide explains the statistics.
//!
//! | file | what |
//! |---|---|
//! | `data` | files of measurements |
//! | `reading`, `places` | how they follow from a scene |
//! | `observe` | what a simulation predicts for them |
//! | `frequencies` | natural frequencies among them |
//! | `onset` | the onset of sliding among them |
//! | `frame` | coordinates in a mirrored frame |
//! | `parameter` | keys and their coordinates in the fit |
//! | `shooting` | motions in windows that follow the data |
//! | `problem` | predictions of all experiments, in parallel |
//! | `jacobian` | their derivatives: a trait, and central differences |
//! | `exact` | exact derivatives, where the scenes have them |
//! | `fit` | least squares with a trust region, bounds, priors and robust loss |
//! | `statistics`, `advice` | noise, error bars, what the data do not determine |
//! | `task` | the request, and all steps from it to the result |
//! | `closest` | keys with which a scenario comes closest to exact numbers |
//! | `hanging` | a rod in a photograph that is held at one end |
//! | `held`, `held_views` | a rod that an arm holds in several poses, each seen by a camera |
//! | `photographs`, `seen` | several photographs of it, turned about its clamp, and what they show |
//! | `identified`, `files`, `figure` | the result, its files, its figure |

mod advice;
mod closest;
mod data;
mod error;
mod exact;
mod figure;
mod files;
mod fit;
mod frame;
mod frequencies;
mod hanging;
mod held;
mod held_views;
mod identified;
mod jacobian;
mod observe;
mod onset;
mod parameter;
mod photographs;
mod places;
mod problem;
mod reading;
mod seen;
mod shooting;
mod statistics;
mod task;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod wires;

pub use closest::{Closest, closest};
pub use data::{At, DataFile, Datum, Measured, POSITION, Place, read_markers};
pub use error::IdentifyError;
pub use exact::Exact;
pub use files::{FITTED, IDENTIFIED, PARAMETERS, RESIDUALS, RESIDUALS_FIGURE, ROD, write};
pub use fit::Loss;
pub use hanging::{CURVATURE_KEY, HangingRod, LENGTH_KEY, measure_hanging};
pub use held::{CURLED, HAND_ERROR, HeldRod};
pub use held_views::{HeldView, identify_held};
pub use identified::{Identified, IdentifiedKey, Noise, Residual, Undetermined};
pub use jacobian::{CentralDifferences, Jacobian};
pub use parameter::{Parameter, Request};
pub use photographs::{Photographed, TWISTING_KEY, measure_photographs};
pub use places::arc_lengths;
pub use problem::{Experiment, Problem};
pub use reading::CRITICAL;
pub use seen::Photograph;
pub use statistics::Shared;
pub use task::{Progress, Task, identify};
