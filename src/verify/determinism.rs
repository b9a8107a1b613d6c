//! Identical bytes for any number of threads and after interruptions.

use super::scenario::prepared;
use super::{Check, Expectation, GroupError};
use rodlab_lab::run::PreparedRun;
use rodlab_lab::run::{RunError, RunOptions, run};
use std::path::Path;
use std::time::{Duration, Instant};

const THREADS: Expectation =
    Expectation::new("1 thread = 2 threads", "same operations, same order");
const RESUMED: Expectation =
    Expectation::new("run = run, interrupt, resume", "checkpoint holds the state");

/// A rod sinks onto another one in viscous fluid; they touch after 24 ms and slide on each other.
const SCENARIO: &str = r#"
experiment = "scene"
[material]
youngs_modulus = "3 MPa"
poissons_ratio = 0.5
density = 1000.0
[[rods]]
name = "lower"
radius = "1 mm"
edges = 30
shape = { kind = "straight", start = [0, 0, 0], end = [0.1, 0, 0] }
[[rods]]
name = "upper"
radius = "1 mm"
edges = 30
shape = { kind = "straight", start = [0.04, -0.04, 0.00205], end = [0.07, 0.04, 0.00205] }
[[clamps]]
rod = "lower"
at = "start"
[[clamps]]
rod = "lower"
at = "end"
[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]
[contact]
model = "imc"
friction = 0.2
distance_tolerance = 5e-5
[fluid]
model = "rss"
viscosity = 0.1
[time]
step = 1e-3
end = 0.4
[output]
interval = 0.02
nodes = true
"#;

/// Checks the number of different bytes in `series.csv` and `nodes.csv`.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let prepared = prepared(SCENARIO, &[])?;
    let scratch = tempfile::tempdir()?;
    let directory = |name: &str| scratch.path().join(name);
    let (one, two, pieces) = (directory("one"), directory("two"), directory("pieces"));
    with_threads(1, || run_through(&prepared, &one))??;
    with_threads(2, || run_through(&prepared, &two))??;
    run_in_pieces(&prepared, &pieces)?;
    let mut checks = Vec::new();
    for (other, how, expectation) in [
        (&two, "1 and 2 threads", THREADS),
        (&pieces, "interrupted and continued", RESUMED),
    ] {
        for file in ["series.csv", "nodes.csv"] {
            let differing = differing_bytes(&one.join(file), &other.join(file))?;
            let name = format!("{file}, {how}: differing bytes");
            checks.push(expectation.of(name, "").zero(differing, 0.0));
        }
    }
    Ok(checks)
}

fn with_threads<T: Send>(count: usize, work: impl FnOnce() -> T + Send) -> Result<T, GroupError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build()?;
    Ok(pool.install(work))
}

fn options(directory: &Path) -> RunOptions {
    RunOptions {
        progress: false,
        ..RunOptions::new(directory)
    }
}

fn run_through(prepared: &PreparedRun, directory: &Path) -> Result<(), RunError> {
    run(prepared, &options(directory)).map(drop)
}

/// Stops and resumes the run repeatedly, with a longer time limit each time.
///
/// # Errors
/// The run fails, or the machine is so fast that nothing was interrupted.
fn run_in_pieces(prepared: &PreparedRun, directory: &Path) -> Result<(), GroupError> {
    let mut limit = Duration::from_millis(1);
    let mut interruptions = 0;
    loop {
        let hurried = RunOptions {
            deadline: Instant::now().checked_add(limit),
            ..options(directory)
        };
        match run(prepared, &hurried) {
            Ok(_) if interruptions == 0 => return Err("nothing was interrupted".into()),
            Ok(_) => return Ok(()),
            Err(RunError::TimeLimit { .. }) => interruptions += 1,
            Err(error) => return Err(error.into()),
        }
        limit *= 2;
    }
}

fn differing_bytes(a: &Path, b: &Path) -> Result<f64, GroupError> {
    let (a, b) = (std::fs::read(a)?, std::fs::read(b)?);
    let common = a.iter().zip(&b).filter(|(a, b)| a != b).count();
    Ok((common + a.len().abs_diff(b.len())) as f64)
}
