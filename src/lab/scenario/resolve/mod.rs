//! Resolves the typed scenario: units, defaults, ranges.

mod clamp;
mod columns;
mod continuation;
mod cross_section;
mod experiment;
mod model;
mod movement;
mod natural_strains;
mod network;
mod obstacle;
mod own_friction;
mod polyline;
mod poses;
mod profile;
mod request;
mod rod;
mod sections;
mod shape;
mod slip;
mod start;
mod triangle_mesh;

pub use super::section::{FINITE, FRACTION, NON_NEGATIVE, POSITIVE, Range, Section};
pub use columns::read_columns;
pub use experiment::ExperimentKeys;
pub use polyline::read as read_polyline;
pub use request::{BuiltRod, CommonTables, Request};
pub use start::{END_STATE, file_of as start_file_of};
pub use triangle_mesh::triangle_mesh;

use super::document::Node;
use super::issue::{Issues, KeyPath};
use super::own_tables::OwnTables;
use super::resolved::{Contact, Experiment, Rod, Scenario, Time};
use super::tables;
use super::typed::ScenarioFile;
use std::cell::RefCell;
use std::path::PathBuf;

/// Inputs of the resolution besides the keys of the file.
pub struct Context<'a> {
    /// Stem of the scenario file.
    pub name: &'a str,
    /// Names of the available experiments, as text.
    pub experiments: String,
    /// The file as a tree.
    pub document: &'a Node,
}

/// Resolves a scenario.
///
/// # Errors
/// All values that are missing, out of range, of the wrong dimension, or inconsistent with each
/// other.
pub fn resolve(
    context: &Context<'_>,
    directory_of: &dyn Fn(&KeyPath) -> PathBuf,
    file: &ScenarioFile,
    kind: Option<&dyn ExperimentKeys>,
    own: &OwnTables,
) -> Result<Scenario, Issues> {
    let issues = RefCell::new(Issues::default());
    let top = Section::new(KeyPath::root(), &issues, directory_of);
    let usual_time = kind.and_then(|kind| kind.usual_time());
    let time = match (usual_time, &file.time) {
        (Some(usual), None) => usual,
        _ => model::time(&top, file),
    };
    let experiment = kind.and_then(|kind| {
        refuse_tables_of_others(&top, kind, own);
        kind.resolve(&Request {
            top: &top,
            time: &time,
            file,
            own,
            context,
        })
    });
    if kind.is_none() {
        top.missing("experiment", context.experiments.as_str());
    }
    let name = kind.map(|kind| kind.name());
    let mut rods = rod::rods(&top, file, name, own.lump_inertia());
    let material = rod::CommonMaterial::of(&top, file);
    let networks = network::networks(&top, &file.networks, &material);
    rods.extend(networks.rods);
    let parts = own.parts(&top, &time);
    let smallest_radius = rods
        .iter()
        .map(Rod::least_radius)
        .chain([parts.smallest_radius()])
        .chain(experiment.as_ref().map(Experiment::smallest_radius))
        .fold(f64::INFINITY, f64::min);
    let solver = model::solver(&top, &file.solver, &time);
    model::refuse_small_steps(&top, &time, &solver);
    let mut contact = model::contact(&top, file.contact.as_ref(), smallest_radius);
    model::refuse_rigid_statics(&top, &contact, &time);
    model::refuse_viscous_midpoint(&top, &rods, &time);
    let beside_wall = file.planes.iter().any(|plane| plane.wall != Some(false));
    let resists_spin = kind.is_none_or(|kind| kind.resists_spin());
    let fluid = model::fluid(&top, file.fluid.as_ref(), beside_wall, resists_spin);
    if let Some(kind) = kind {
        let common = CommonTables {
            rods: &rods,
            parts: &parts,
            contact: &contact,
            fluid: &fluid,
            time: &time,
        };
        kind.judge(&top, &common);
    }
    let continuation = continuation::continuation(&top, file, &time);
    let loads = tables::loads(&top, &file.loads);
    let planes = tables::planes(&top, &file.planes);
    let obstacles = obstacle::obstacles(&top, &file.obstacles);
    if !obstacles.is_empty() && contact == Contact::None {
        top.fault(
            "obstacles",
            "without a [contact] table rods pass through everything; add one",
        );
    }
    model::refuse_directed_friction(&top, &contact, &planes);
    continuation::refuse_friction(&top, &time, contact.friction(), &planes, &obstacles);
    own_friction::refuse(&top, file, &contact, &time, &planes);
    continuation::refuse_fluid(&top, &time, &fluid);
    let mut clamps = clamp::clamps(&top, &file.clamps);
    model::refuse_static_motion(&top, &time, &clamps, &loads, &obstacles);
    network::refuse_static_motion(&top, &file.networks, &time);
    clamps.extend(networks.clamps);
    if file
        .contact
        .as_ref()
        .is_some_and(|contact| contact.slip_tolerance.is_none())
    {
        contact.set_slip_tolerance(slip::default_slip_tolerance(
            smallest_radius,
            &loads,
            &clamps,
        ));
    }
    let is_dynamic = matches!(time, Time::Dynamic { .. });
    let mut joints = tables::joints(&top, &file.joints, is_dynamic);
    model::refuse_resting_friction(&top, &joints, &time);
    joints.extend(networks.joints);
    let bodies = tables::bodies(&top, &file.bodies);
    model::refuse_turning_midpoint(&top, &joints, &bodies, &time);
    let scenario = experiment.map(|experiment| Scenario {
        name: context.name.to_owned(),
        title: file
            .title
            .clone()
            .unwrap_or_else(|| context.name.to_owned()),
        experiment,
        clamps,
        joints,
        bodies,
        loads,
        parts,
        planes,
        obstacles,
        start: start::start(&top, file.start.as_ref()),
        probes: tables::probes(&top, &file.probes),
        stop_when: tables::stop_when(&top, file.stop_when.as_ref()),
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

/// Reports tables that belong only to other kinds.
fn refuse_tables_of_others(top: &Section<'_>, kind: &dyn ExperimentKeys, own: &OwnTables) {
    for key in own.keys() {
        if !kind.tables().iter().any(|table| table.key() == key) {
            top.fault(key, kind.refusal());
        }
    }
}
