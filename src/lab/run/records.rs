//! Records about a prepared run for the results.

use super::RunOptions;
use super::participants::columns;
use crate::run::PreparedRun;
use rodlab_engine::mechanics::rigid_body::neighbourhood;
use rodlab_engine::mechanics::scene::{FreeBody, Obstacle, RodDescription, Scene};
use rodlab_files::origin::{VERSION, commit};
use rodlab_files::results::{
    CaseRecord, CaseStatus, MAIN_CASE, Manifest, ObstacleSurfaces, RecorderPlan, ResultsError,
    RodRecord, START, Surface, host_name, scenario_hash, write_whole,
};
use std::collections::BTreeMap;
use std::path::Path;

/// Data of the rods and free bodies for readers of the results.
pub fn rod_records(prepared: &PreparedRun) -> Vec<RodRecord> {
    let record = |rod: &RodDescription| RodRecord {
        name: rod.name.clone(),
        nodes: rod.centreline.len(),
        closed: rod.closed,
        radius: rod.radius,
        radii: match rod.least_radius() < rod.radius {
            true => (0..rod.centreline.len())
                .map(|node| rod.radius_at(node))
                .collect(),
            false => Vec::new(),
        },
        rigid: false,
        faces: Vec::new(),
    };
    let body = |body: &FreeBody| RodRecord {
        name: body.name.clone(),
        nodes: body.nodes(),
        radius: body.shape.radius,
        rigid: true,
        // Its first node is its centre of mass.
        faces: (body.shape.faces.iter())
            .map(|face| face.map(|vertex| vertex + 1))
            .collect(),
        ..RodRecord::default()
    };
    let scene = &prepared.scene;
    let rods = scene.rods.iter().map(record);
    rods.chain(scene.free_bodies.iter().map(body)).collect()
}

/// Copies the start state of the run beside its scenario, which names it.
///
/// # Errors
/// [`ResultsError::Io`].
pub fn place_start(prepared: &PreparedRun, directory: &Path) -> Result<(), ResultsError> {
    match &prepared.start {
        Some(start) => write_whole(&directory.join(START), start),
        None => Ok(()),
    }
}

/// Files that the run writes.
pub fn recorder_plan(prepared: &PreparedRun) -> RecorderPlan {
    let output = prepared.output;
    RecorderPlan {
        observed: columns(&prepared.observers),
        nodes: output.nodes,
        forces: output.forces,
        contacts: output.contacts,
        vtk: output.vtk,
        obstacles: (output.vtk && !prepared.scene.obstacles.is_empty())
            .then(|| obstacle_surfaces(&prepared.scene)),
    }
}

/// Surfaces of the obstacles at time zero. Of infinite surfaces only the part near the rods.
fn obstacle_surfaces(scene: &Scene) -> ObstacleSurfaces {
    let (centre, reach) = neighbourhood(scene.rods.iter().flat_map(|rod| &rod.centreline));
    let of = |obstacle: &Obstacle| Surface::from_triangles(&obstacle.body.surface(&centre, reach));
    ObstacleSurfaces {
        surfaces: scene.obstacles.iter().map(of).collect(),
        moving: scene.obstacles.iter().any(|body| body.motion.moves()),
    }
}

/// The manifest of a call that starts now. `earlier` is the manifest of the previous call, which
/// this call may continue.
pub fn manifest_of_call(
    prepared: &PreparedRun,
    options: &RunOptions,
    earlier: Option<&Manifest>,
    continued: bool,
) -> Manifest {
    let running = CaseRecord::new(CaseStatus::Running);
    Manifest {
        version: VERSION.into(),
        commit: commit().map(Into::into),
        command_line: options.command_line.clone(),
        name: prepared.name.clone(),
        experiment: prepared.experiment.clone(),
        title: prepared.title.clone(),
        scenario: prepared.scenario_toml.clone(),
        scenario_hash: scenario_hash(&prepared.scenario_toml),
        rods: rod_records(prepared),
        host: host_name(),
        threads: rayon::current_num_threads(),
        start: earlier.map_or_else(jiff::Timestamp::now, |manifest| manifest.start),
        end: None,
        continuations: earlier.map_or(0, |manifest| manifest.continuations) + u32::from(continued),
        seeds: BTreeMap::new(),
        cases: BTreeMap::from([(MAIN_CASE.into(), running)]),
        files: BTreeMap::new(),
    }
}
