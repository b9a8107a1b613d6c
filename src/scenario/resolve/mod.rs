//! From the scenario as typed to the scenario as resolved: units, defaults, ranges.

mod load;
mod model;
mod polyline;
mod rod;
mod section;
mod shape;

pub use polyline::read as read_polyline;

use super::issue::{Issues, KeyPath};
use super::resolved::{Experiment, Scenario};
use super::typed::{self, ScenarioFile};
use section::Section;
use std::cell::RefCell;
use std::path::PathBuf;

/// What resolving needs beside the file's keys.
pub struct Context<'a> {
    /// Stem of the scenario file.
    pub name: &'a str,
    /// The directory against which the value of a key names files.
    pub directory_of: &'a dyn Fn(&KeyPath) -> PathBuf,
}

/// Resolves a scenario.
///
/// # Errors
/// All values that are missing, out of range, of the wrong dimension or at odds with each other.
pub fn resolve(context: &Context<'_>, file: &ScenarioFile) -> Result<Scenario, Issues> {
    let issues = RefCell::new(Issues::default());
    let top = Section::new(KeyPath::root(), &issues);
    let experiment = experiment(&top, file);
    let rods = rod::rods(context, &top, file);
    if rods.is_empty() && matches!(file.experiment, Some(typed::Experiment::Scene)) {
        top.missing("rods", "a scene needs at least one [[rods]]");
    }
    if !rods.is_empty()
        && rods.iter().all(|rod| rod.held)
        && matches!(file.experiment, Some(typed::Experiment::Scene))
    {
        top.fault(
            "rods",
            "every rod is held; at least one must be free to move",
        );
    }
    let smallest_radius = rods
        .iter()
        .map(|rod| rod.radius)
        .chain(experiment.iter().filter_map(|experiment| match experiment {
            Experiment::Scene => None,
            Experiment::Flagella { rod, .. } => Some(rod.radius),
        }))
        .fold(f64::INFINITY, f64::min);
    let time = model::time(&top, file);
    let solver = model::solver(&top, &file.solver);
    model::refuse_small_steps(&top, &time, &solver);
    let contact = model::contact(&top, file.contact.as_ref(), smallest_radius);
    model::refuse_rigid_statics(&top, &contact, &time);
    let scenario = experiment.map(|experiment| Scenario {
        name: context.name.to_owned(),
        title: file
            .title
            .clone()
            .unwrap_or_else(|| context.name.to_owned()),
        experiment,
        clamps: load::clamps(&top, &file.clamps),
        loads: load::loads(&top, &file.loads),
        planes: load::planes(&top, &file.planes),
        contact,
        fluid: model::fluid(&top, file.fluid.as_ref()),
        output: model::output(&top, &file.output, &time),
        rods,
        time,
        solver,
    });
    match scenario {
        Some(scenario) => issues.into_inner().or_ok(scenario),
        None => Err(issues.into_inner()),
    }
}

/// The experiment and its own tables; `None` if a fault was reported.
fn experiment(top: &Section<'_>, file: &ScenarioFile) -> Option<Experiment> {
    match top.needed("experiment", file.experiment, "\"scene\" or \"flagella\"")? {
        typed::Experiment::Scene => {
            for (key, present) in [
                ("rod", file.rod.is_some()),
                ("flagella", file.flagella.is_some()),
            ] {
                if present {
                    top.fault(
                        key,
                        "this table is for builders; a scene lists its rods as [[rods]]",
                    );
                }
            }
            Some(Experiment::Scene)
        }
        typed::Experiment::Flagella => {
            let rod = top.needed(
                "rod",
                file.rod.as_ref(),
                "a table [rod] with radius and nodes",
            );
            let flagella = top.needed("flagella", file.flagella.as_ref(), "a table [flagella]");
            let material = top.needed(
                "material",
                file.material.as_ref(),
                "a table [material] with youngs_modulus, poissons_ratio and density",
            );
            let (rod, flagella, material) = (rod?, flagella?, material?);
            model::flagella(top, material, rod, flagella)
        }
    }
}
