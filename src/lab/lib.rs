//! The laboratory: scenarios from files, experiments, runs, sweeps, reports.
//!
//! | module | contents |
//! |---|---|
//! | [`scenario`] | the TOML schema as Rust types, units, validation with positions in the files |
//! | [`experiment`] | one folder per kind of experiment: its keys, scene, observers, figures; the list of kinds |
//! | [`run`] | the run loop on a results directory |
//! | [`sweep`] | many cases |
//! | [`identify`] | keys of scenarios from measurements, with error bars |
//! | [`design`] | natural shapes, poses and loads for a target equilibrium |
//! | [`report`] | figures and pages of a results directory |
//! | [`sensitivity`] | derivatives of what a scenario measures over its keys |
//! | [`cluster`] | Slurm job arrays |

// Tests compare with a tolerance, and may ask any mathematical library.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod cluster;
pub mod design;
pub mod experiment;
pub mod identify;
pub mod report;
pub mod run;
pub mod scenario;
pub mod sensitivity;
pub mod sweep;
#[cfg(test)]
mod test_support;
