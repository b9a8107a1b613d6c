//! Experiments: they turn a scenario into a scene with observers.
//!
//! Each kind of experiment has a folder in this module, implements [`Kind`] and is listed in
//! [`KINDS`]. No other code names it.
//!
//! | file | what |
//! |---|---|
//! | `kind` | the interface of a kind of experiment |
//! | `prepare` | from a scenario to a run: the common tables, then what its kind adds |
//! | `parts` | parts of scenes with tables of their own |
//! | `places` | rods, nodes and edges at keys |
//! | `probes` | the quantities that a scenario measures, in terms of its scene |
//! | `data_set` | common parts of kinds that fill a table, such as samples for a network |
//! | `on_table` | common parts of kinds in which a gripper handles a rod or a sheet on a table |
//! | `derived` | numbers for `rodlab check` |
//! | `scene`, `flagella`, `knot`, `helix`, `deployment`, `grasp_samples`, `fold_samples`, `folding` | the kinds |

#[cfg(test)]
mod contact_tests;
mod data_set;
pub mod deployment;
mod derived;
mod described;
mod flagella;
mod flow_guard;
#[cfg(test)]
mod flow_tests;
mod fold_samples;
pub mod folding;
mod grasp_samples;
pub mod helix;
#[cfg(test)]
mod joint_tests;
mod kind;
pub mod knot;
#[cfg(test)]
mod obstacle_tests;
mod on_table;
mod parts;
mod places;
mod prepare;
mod probes;
#[cfg(test)]
mod probes_tests;
#[cfg(test)]
mod remark_tests;
#[cfg(test)]
mod root_tests;
mod scene;
#[cfg(test)]
mod start_tests;
#[cfg(test)]
mod tests;

pub use deployment::{
    Deployment, DeploymentMonitor, DeploymentOutcome, DeploymentTables, Fixtures, GripperTask,
    GripperWork, LaidOutlines, Landing, Outline, PassedPegs, Placement, PlacementError, RodFile,
    TiedKnot, knot_of_patterns, knot_on_table, laid_outlines, svg_drawing,
};
pub use derived::{DerivedNumbers, DerivedRod, derived_numbers};
pub use described::{Described, describe, described_files, files_with_column};
pub use folding::{
    AlgorithmName, Crease, FoldedOutlines, FoldingOutcome, FoldingTables, Paper, PaperFile,
    folded_outlines, planned_fold,
};
pub use helix::manipulation::{ClampPoses, ClampedRod};
pub use helix::stability::{
    HelixSearch, HelixStability, discrete_critical_distance, estimated_critical_distance,
};
pub use kind::{FigureError, Figures, Kind, OwnNumbers, Page, SampleColumns};
pub use knot::{
    KnotEnding, KnotMonitor, KnotObserver, KnotOutcome, KnotRow, KnotSample, read_knot_series,
};
#[cfg(test)]
pub use parts::{Actuation, ActuationKind};
pub use parts::{Eyelets, TABLES as PARTS, Tendon};
pub use prepare::{Jitter, place_obstacles, prepare, try_scene};

use crate::scenario::keys::ExperimentKeys;
use crate::scenario::{self, CaseSet, Experiments, Loaded, Scales, ScenarioError};
use std::path::Path;
use std::sync::LazyLock;

/// All kinds of experiments, in the order in which messages list them.
pub static KINDS: &[&dyn Kind] = &[
    &scene::SceneKind,
    &flagella::FlagellaKind,
    &knot::TIGHTENING,
    &knot::INVERSION,
    &helix::stability::HELIX_STABILITY,
    &deployment::DeploymentKind,
    &grasp_samples::GRASP_SAMPLES,
    &fold_samples::FOLD_SAMPLES,
    &folding::FoldingKind,
];

/// All kinds of experiments, with the parts of scenes, for the reading of scenario files.
static EXPERIMENTS: LazyLock<Experiments> = LazyLock::new(|| {
    let keys: Vec<&dyn ExperimentKeys> = KINDS.iter().map(|kind| *kind as _).collect();
    Experiments::new(keys.leak(), parts::TABLES)
});

/// The kind of a name.
pub fn kind_named(name: &str) -> Option<&'static dyn Kind> {
    KINDS.iter().copied().find(|kind| kind.name() == name)
}

/// Reads, merges, overrides and resolves a scenario file; see [`scenario::load`].
///
/// # Errors
/// All its faults.
pub fn load(path: &Path, overrides: &[String]) -> Result<Loaded, ScenarioError> {
    scenario::load(*EXPERIMENTS, path, overrides)
}

/// Resolves the text of a scenario called `name`. File names are relative to `directory`; see
/// [`scenario::from_text`].
///
/// # Errors
/// All its faults.
pub fn from_text(
    name: &str,
    text: &str,
    directory: &Path,
    overrides: &[String],
) -> Result<Loaded, ScenarioError> {
    scenario::from_text(*EXPERIMENTS, name, text, directory, overrides)
}

/// Resolves a scenario called `name`, given as a table in memory. File names are relative to
/// `directory`; see [`scenario::from_table`].
///
/// # Errors
/// All its faults.
pub fn from_table(
    name: &str,
    table: toml::Table,
    directory: &Path,
    overrides: &[String],
) -> Result<Loaded, ScenarioError> {
    scenario::from_table(*EXPERIMENTS, name, table, directory, overrides)
}

/// Reads a scenario file with its sweep; see [`CaseSet::load`].
///
/// # Errors
/// All faults of the file and its sweep.
pub fn case_set(
    path: &Path,
    overrides: &[String],
    varied: &[String],
) -> Result<CaseSet, ScenarioError> {
    CaseSet::load(*EXPERIMENTS, path, overrides, varied)
}

/// The cases in the text of a scenario; see [`CaseSet::from_text`].
///
/// # Errors
/// As [`case_set`].
pub fn case_set_from_text(
    name: &str,
    text: &str,
    directory: &Path,
) -> Result<CaseSet, ScenarioError> {
    CaseSet::from_text(*EXPERIMENTS, name, text, directory)
}

/// The cases in a table in memory; see [`CaseSet::from_table`].
///
/// # Errors
/// As [`case_set`].
pub fn case_set_from_table(
    name: &str,
    table: toml::Table,
    directory: &Path,
    overrides: &[String],
    varied: &[String],
) -> Result<CaseSet, ScenarioError> {
    CaseSet::from_table(*EXPERIMENTS, name, table, directory, overrides, varied)
}

/// JSON Schema of scenario files; see [`scenario::json_schema`].
pub fn json_schema() -> serde_json::Value {
    scenario::json_schema(*EXPERIMENTS)
}

/// A scenario after expansion; see [`Loaded::expanded_toml`].
pub fn expanded_toml(loaded: &Loaded) -> String {
    loaded.expanded_toml(*EXPERIMENTS)
}

/// A scenario file in other units; see [`scenario::rescaled`].
///
/// # Errors
/// Syntax errors in the TOML text.
pub fn rescaled(text: &str, scales: &Scales) -> Result<String, toml::de::Error> {
    scenario::rescaled(*EXPERIMENTS, text, scales)
}

/// The SI unit of a key of scenario files, if it has one.
pub fn unit(key: &str) -> Option<String> {
    // A fit needs units in each of its iterations, and to build the schema takes longer than a small
    // simulation.
    static SCHEMA: LazyLock<serde_json::Value> = LazyLock::new(json_schema);
    scenario::unit(&SCHEMA, key)
}

/// Explains a dotted key; see [`scenario::explain`].
///
/// # Errors
/// A message with the nearest key, if there is no such key.
pub fn explain(key: &str) -> Result<String, String> {
    scenario::explain(*EXPERIMENTS, key)
}
