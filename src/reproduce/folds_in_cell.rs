//! Sheets that are folded through drivers and camera, in a virtual cell that runs beside (thesis 4.6).

use super::folds::{COMPARED, SCENARIOS, Scenario};
use super::{ReproduceError, ReproduceOptions};
use crate::cell::Cell;
use crate::experiment::{FoldingTables, from_text};
use crate::plan::fold::{Algorithm, Objective};
use crate::results::{ResultsError, write_whole};
use crate::task::{FoldRequest, FoldTask, FoldTaskError};
use crate::virtual_cell::{HeldSheet, Response, Settings, SimulatedSheet, VirtualCell};
use crate::vision::ColourRule;
use serde::{Deserialize, Serialize};
use std::net::SocketAddr;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Friction of the table.
pub(super) const FRICTION: f64 = 0.12;
/// Parts of a way, after each of which the camera looks (thesis sec. 4.6.5).
pub(super) const PARTS: usize = 5;
/// The cell; its clients find it where it listens.
const CELL: &str = include_str!("../../scenarios/cells/gantry.toml");
const ADDRESS: &str = "127.0.0.1:9090";
/// Hard steps of a simulation take longer than a driver may be silent otherwise.
const PATIENCE: [&str; 2] = ["[streaming]\n", "[streaming]\nwatchdog = \"10 s\"\n"];
/// How many times as fast as real time the cell is, if it can.
const RATE: f64 = 20.0;
/// Speeds of the hand, m/s: while it folds, and on the way there.
const SPEED: f64 = 0.05;
const APPROACH_SPEED: f64 = 0.2;
/// Least distance of the arm to anything else, m.
const MARGIN: f64 = 0.01;
/// Folder of the runs of all artefacts, and the row of a run.
const CASES: &str = "cases";
const ROW: &str = "row.json";

/// A row of the CSV file; lengths in mm.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Row {
    /// The scenario.
    pub scenario: String,
    /// How the edge is held: `held` by a moment, or `optimal` without one.
    pub way: String,
    /// `folded`, or why not.
    pub status: String,
    /// How far the sheet slid at most while it was held, in simulation.
    pub largest_sliding_mm: f64,
    /// How far it had slid when the gripper let go, or held it last, in simulation.
    pub final_sliding_mm: f64,
    /// The same as the camera saw it last.
    pub seen_sliding_mm: Option<f64>,
    /// Error of the fold length, in simulation.
    pub fold_length_error_mm: Option<f64>,
    /// The same by camera and joints.
    pub seen_fold_length_error_mm: Option<f64>,
    /// Parts of the way that were planned anew.
    pub planned_anew: usize,
    /// Time of all of it, s.
    pub wall_time_s: f64,
}

/// The seven scenarios, or the first one for a quick look.
pub(super) fn scenarios(quick: bool) -> &'static [Scenario] {
    &SCENARIOS[..if quick { 1 } else { COMPARED }]
}

/// Name of the run of a scenario.
pub(super) fn id(scenario: &Scenario) -> String {
    format!("fold-in-cell_{}", scenario.id)
}

/// Folds a sheet, unless an earlier call has.
pub(super) fn folded(
    scenario: &Scenario,
    options: &ReproduceOptions,
) -> Result<(Row, bool), ReproduceError> {
    let directory = options.directory.join(CASES).join(id(scenario));
    let path = directory.join(ROW);
    let known = std::fs::read(&path).ok();
    if let Some(row) = known.and_then(|bytes| serde_json::from_slice(&bytes).ok()) {
        return Ok((row, true));
    }
    let row = run(scenario, &directory)?;
    let text = serde_json::to_vec_pretty(&row).expect("a row is a JSON value");
    write_whole(&path, &text)?;
    Ok((row, false))
}

fn run(scenario: &Scenario, directory: &Path) -> Result<Row, ReproduceError> {
    let begin = Instant::now();
    // What an earlier call has left is of a fold that was not finished.
    if directory.exists() {
        let removed = std::fs::remove_dir_all(directory);
        removed.map_err(ResultsError::io("remove", directory))?;
    }
    std::fs::create_dir_all(directory).map_err(ResultsError::io("create", directory))?;
    let loaded = from_text(
        scenario.id,
        &scenario.text(),
        Path::new(""),
        &[format!("folding.crease={}", scenario.crease)],
    );
    let loaded = loaded.unwrap_or_else(|error| panic!("{error}"));
    let tables: Option<&FoldingTables> = loaded.scenario.experiment.tables();
    let folding = &tables.expect("the tables of a fold").folding;
    let paper = directory.join("paper.toml");
    write_whole(&paper, scenario.paper.as_bytes())?;
    let file = directory.join("cell.toml");
    write_whole(&file, CELL.as_bytes())?;
    let unusable = |error: &dyn std::fmt::Display| ReproduceError::Cell(error.to_string());
    let cell = Cell::read(&file).map_err(|error| unusable(&error))?;
    let table = cell.table.expect("the gantry has a table").top;
    let is_diagonal = scenario.crease == "diagonal";
    let sheet = SimulatedSheet::new(&paper, FRICTION, is_diagonal, None, &table);
    let mut served = VirtualCell::new(
        &cell,
        Settings {
            address: SocketAddr::from(([127, 0, 0, 1], 0)),
            token: None,
            rate: RATE,
            response: Response::default(),
            supply: None,
            sheet: Some(sheet.map_err(|error| unusable(&error))?),
            faults: Vec::new(),
        },
    )
    .map_err(|error| unusable(&error))?;
    let address = served.address().map_err(|error| unusable(&error))?;
    let client = CELL.replace(ADDRESS, &address.to_string());
    let client = client.replace(PATIENCE[0], PATIENCE[1]);
    write_whole(&file, client.as_bytes())?;
    let cell = Cell::read(&file).map_err(|error| unusable(&error))?;
    let algorithm = if scenario.is_held {
        Algorithm::Held { friction: FRICTION }
    } else {
        Algorithm::Optimal(Objective::Sum)
    };
    let task = FoldTask {
        cell: &cell,
        arm: 0,
        paper: folding.paper,
        crease: folding.crease,
        request: FoldRequest {
            sheet: folding.sheet(),
            thickness: folding.paper.thickness,
            target: folding.target(),
            algorithm,
            parts: PARTS,
        },
        is_closed_loop: true,
        heading: 0.0,
        colour: &ColourRule::Background,
        speed: SPEED,
        approach_speed: APPROACH_SPEED,
        margin: MARGIN,
        directory,
    };
    let is_over = AtomicBool::new(false);
    let (end, ended) = std::thread::scope(|scope| {
        let server = scope.spawn(|| served.serve(&|| is_over.load(Ordering::Relaxed)));
        let end = task.run(&|| false);
        is_over.store(true, Ordering::Relaxed);
        let ended = server.join().expect("the thread of the cell");
        (end, ended)
    });
    let held = served.sheet().and_then(SimulatedSheet::last_held);
    let held = held.ok_or_else(|| {
        let error = end.score.as_ref().err().map(FoldTaskError::to_string);
        ReproduceError::Cell(error.unwrap_or_default())
    })?;
    let status = match (&end.score, &ended) {
        (_, Err(error)) => error.to_string(),
        (Err(error), _) => error.to_string(),
        (Ok(_), Ok(())) => "folded".into(),
    };
    let mm = |metres: f64| 1e3 * metres;
    let seen = end.looks.iter().rev().find_map(|look| look.slid_m);
    let score = end.score.ok();
    let HeldSheet {
        largest_sliding,
        sliding,
        edge,
    } = held;
    Ok(Row {
        scenario: scenario.id.into(),
        way: if scenario.is_held { "held" } else { "optimal" }.into(),
        status,
        largest_sliding_mm: mm(largest_sliding),
        final_sliding_mm: mm(sliding),
        seen_sliding_mm: seen.map(mm),
        fold_length_error_mm: score.map(|_| mm(edge[0] - folding.target() - sliding)),
        seen_fold_length_error_mm: score.map(|score| mm(score.fold_length_error_m)),
        planned_anew: end.looks.iter().filter(|look| look.is_planned_anew).count(),
        wall_time_s: begin.elapsed().as_secs_f64(),
    })
}
