//! `rodlab verify`: comparison of the engine with theory.
//!
//! Every [`Check`] compares a number from a simulation with one from an independent theory: a
//! closed form or an independent solution in [`theory`]. The groups run in parallel; the table
//! keeps its order.

mod actuation;
mod background_flow;
mod bodies;
mod buckling;
mod check;
mod conservation;
mod contact;
mod continuation;
mod crawling;
mod damping;
mod derivatives;
mod determinism;
mod drag;
mod drag_of_bodies;
mod filaments;
mod flow;
mod flow_wall;
mod free_bodies;
mod frequencies;
mod friction;
mod helix;
mod helix_manipulation;
mod joints;
mod localized_buckling;
mod obstacles;
mod overdamped;
mod page;
mod rods;
mod rolling;
mod scale_invariance;
mod scenario;
mod sections;
mod sensitivities;
mod sheaths;
mod sleeve;
mod slides;
mod smooth_contact;
mod spatial_rods;
mod springs;
mod statics;
mod symmetry;
mod tendons;
#[cfg(test)]
mod tests;
pub mod theory;
mod ties;
mod tube_buckling;
mod tube_coiling;
mod turning_springs;
mod vibration;
mod yielding;

pub use check::{Check, Expectation, Verdict, table};
pub use page::markdown;

use rayon::prelude::*;
use std::error::Error;

/// A group of checks. With `full` a group may take minutes and cover more parameters.
type CheckGroup = fn(full: bool) -> Result<Vec<Check>, GroupError>;

/// The error of a group without results.
type GroupError = Box<dyn Error + Send + Sync>;

/// All groups, in the order of the table.
const GROUPS: [(&str, CheckGroup); 31] = [
    ("derivatives", derivatives::checks),
    ("sensitivities", sensitivities::checks),
    ("statics", statics::checks),
    ("spatial rods", spatial_rods::checks),
    ("vibration", vibration::checks),
    ("sections", sections::checks),
    ("damping", damping::checks),
    ("yielding", yielding::checks),
    ("actuation", actuation::checks),
    ("buckling", buckling::checks),
    ("continuation", continuation::checks),
    ("helix", helix::checks),
    ("helix manipulation", helix_manipulation::checks),
    ("localised buckling", localized_buckling::checks),
    ("friction", friction::checks),
    ("contact", contact::checks),
    ("smooth contact", smooth_contact::checks),
    ("obstacles", obstacles::checks),
    ("joints", joints::checks),
    ("springs", springs::checks),
    ("tendons", tendons::checks),
    ("sheaths", sheaths::checks),
    ("free bodies", free_bodies::checks),
    ("drag", drag::checks),
    ("drag of bodies", drag_of_bodies::checks),
    ("overdamped", overdamped::checks),
    ("background flow", background_flow::checks),
    ("conservation", conservation::checks),
    ("symmetry", symmetry::checks),
    ("scale invariance", scale_invariance::checks),
    ("determinism", determinism::checks),
];

/// Result of a group.
#[derive(Clone, Debug)]
pub struct GroupResult {
    /// Name of the group.
    pub name: &'static str,
    /// Checks of the group, in order.
    pub checks: Vec<Check>,
}

/// Runs every check. A group whose simulation fails is reported as one failed check with the
/// reason.
pub fn verify(full: bool) -> Vec<GroupResult> {
    GROUPS
        .par_iter()
        .map(|&(name, group)| GroupResult {
            name,
            checks: group(full)
                .unwrap_or_else(|error| vec![Check::not_run(name, &error.to_string())]),
        })
        .collect()
}
