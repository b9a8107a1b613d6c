//! What the results say of a prepared run.

use super::RunOptions;
use crate::experiment::PreparedRun;
use crate::mechanics::scene::RodDescription;
use crate::results::{
    CaseOutcome, CaseRecord, CaseStatus, MAIN_CASE, Manifest, RecorderPlan, RodRecord,
};
use std::collections::BTreeMap;

/// What readers of the results need to know of the rods.
pub(super) fn rod_records(prepared: &PreparedRun) -> Vec<RodRecord> {
    let record = |rod: &RodDescription| RodRecord {
        name: rod.name.clone(),
        nodes: rod.centreline.len(),
        closed: rod.closed,
        radius: rod.radius,
    };
    prepared.scene.rods.iter().map(record).collect()
}

/// Which files the run writes.
pub(super) fn recorder_plan(prepared: &PreparedRun) -> RecorderPlan {
    let output = prepared.output;
    RecorderPlan {
        nodes: output.nodes,
        forces: output.forces,
        vtk: output.vtk,
    }
}

/// The manifest of a run that starts now.
pub(super) fn new_manifest(
    prepared: &PreparedRun,
    options: &RunOptions,
    scenario_hash: String,
    rods: Vec<RodRecord>,
) -> Manifest {
    let running = CaseRecord {
        status: CaseStatus::Running,
        outcome: CaseOutcome::default(),
        wall_time: 0.0,
    };
    Manifest {
        version: env!("CARGO_PKG_VERSION").into(),
        commit: option_env!("RODLAB_COMMIT").map(Into::into),
        command_line: options.command_line.clone(),
        name: prepared.name.clone(),
        experiment: prepared.experiment.clone(),
        title: prepared.title.clone(),
        scenario: prepared.scenario_toml.clone(),
        scenario_hash,
        rods,
        host: host_name(),
        threads: rayon::current_num_threads(),
        start: jiff::Timestamp::now(),
        end: None,
        continuations: 0,
        seeds: BTreeMap::new(),
        cases: BTreeMap::from([(MAIN_CASE.into(), running)]),
    }
}

/// Name of the machine, where the system tells it in a file or in the environment.
fn host_name() -> Option<String> {
    let from_file = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    from_file
        .map(|name| name.trim().to_owned())
        .or_else(|| std::env::var("HOSTNAME").ok())
}
