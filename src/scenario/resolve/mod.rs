//! From the scenario as typed to the scenario as resolved: units, defaults, ranges.

mod columns;
mod continuation;
mod load;
mod model;
mod polyline;
mod poses;
mod request;
mod rod;
mod section;
mod shape;

pub use columns::read_columns;
pub use polyline::read as read_polyline;
pub use request::{BuiltRod, CommonTables, Request};
pub use section::{FINITE, FRACTION, NON_NEGATIVE, POSITIVE, Range, Section};

use super::document::Node;
use super::experiments::{Experiments, TypedFile};
use super::issue::{Issues, KeyPath};
use super::resolved::{Experiment, Scenario};
use std::cell::RefCell;
use std::path::PathBuf;

/// What resolving needs beside the file's keys.
pub struct Context<'a> {
    /// Stem of the scenario file.
    pub name: &'a str,
    /// The experiments that there are.
    pub experiments: Experiments,
    /// The file as a tree.
    pub document: &'a Node,
    /// The directory against which the value of a key names files.
    pub directory_of: &'a dyn Fn(&KeyPath) -> PathBuf,
}

/// Resolves a scenario.
///
/// # Errors
/// All values that are missing, out of range, of the wrong dimension or at odds with each other.
pub fn resolve(context: &Context<'_>, typed: &TypedFile) -> Result<Scenario, Issues> {
    let issues = RefCell::new(Issues::default());
    let top = Section::new(KeyPath::root(), &issues);
    let file = &typed.common;
    let usual_time = typed.kind.and_then(|kind| kind.usual_time());
    let time = match (usual_time, &file.time) {
        (Some(usual), None) => usual,
        _ => model::time(&top, file),
    };
    let experiment = typed.kind.and_then(|kind| {
        typed.refuse_tables_of_others(&top, kind);
        kind.resolve(&Request {
            top: &top,
            time: &time,
            file: typed,
            context,
        })
    });
    if typed.kind.is_none() {
        top.missing("experiment", context.experiments.in_words());
    }
    let rods = rod::rods(context, &top, file);
    let smallest_radius = rods
        .iter()
        .map(|rod| rod.radius)
        .chain(experiment.as_ref().map(Experiment::smallest_radius))
        .fold(f64::INFINITY, f64::min);
    let solver = model::solver(&top, &file.solver);
    model::refuse_small_steps(&top, &time, &solver);
    let contact = model::contact(&top, file.contact.as_ref(), smallest_radius);
    model::refuse_rigid_statics(&top, &contact, &time);
    let fluid = model::fluid(&top, file.fluid.as_ref());
    if let Some(kind) = typed.kind {
        let common = CommonTables {
            rods: &rods,
            contact: &contact,
            fluid: &fluid,
            time: &time,
        };
        kind.judge(&top, &common);
    }
    let continuation = continuation::continuation(&top, file, &time);
    let loads = load::loads(&top, &file.loads);
    let planes = load::planes(&top, &file.planes);
    continuation::refuse_friction(&top, &time, contact.friction(), &planes);
    continuation::refuse_without_energy(&top, &time, &fluid, &loads);
    let scenario = experiment.map(|experiment| Scenario {
        name: context.name.to_owned(),
        title: file
            .title
            .clone()
            .unwrap_or_else(|| context.name.to_owned()),
        experiment,
        clamps: load::clamps(context, &top, &file.clamps),
        loads,
        planes,
        contact,
        fluid,
        output: model::output(&top, &file.output, &time),
        rods,
        time,
        continuation,
        solver,
    });
    match scenario {
        Some(scenario) => issues.into_inner().or_ok(scenario),
        None => Err(issues.into_inner()),
    }
}
