//! `rodlab fold --simulate`.

use super::fold_arguments::FoldArguments;
use super::log_directory::results_directory;
use super::prelude::*;
use super::run::simulate;
use super::view::show;
use super::watchdog;
use rodlab_lab::experiment::case_set_from_table;
use rodlab_lab::run::RunOptions;
use toml::{Table, Value, toml};

/// Duration of a fold, s.
const TIME: f64 = 15.0;

/// Folds a sheet in simulation, writes the page and prints the score.
pub fn fold_in_simulation(
    arguments: &FoldArguments,
    title: &str,
    friction: f64,
    common: &Common,
) -> Result<(), Failure> {
    watchdog::watch(None);
    let stem = arguments.paper.file_stem().unwrap_or_default();
    let name = format!("fold_{}", stem.to_string_lossy());
    let scenario = scenario(arguments, title, friction)?;
    let cases = case_set_from_table(&name, scenario, Path::new(""), &[], &[])?;
    let directory = results_directory(arguments.out.as_deref(), &name);
    let options = RunOptions {
        force: arguments.force,
        ..RunOptions::new(directory)
    };
    let page = simulate(&cases, options, common)?;
    if arguments.open { show(&page) } else { Ok(()) }
}

/// The scenario of a fold.
fn scenario(arguments: &FoldArguments, title: &str, friction: f64) -> Result<Table, Failure> {
    let paper = std::path::absolute(&arguments.paper);
    let paper = paper.map_err(Failure::system)?;
    let crease = Value::try_from(arguments.crease).map_err(Failure::system)?;
    let mut folding = toml! {
        crease = crease
        algorithm = (arguments.algorithm.as_str())
        seed = (arguments.seed)
    };
    if let Some(parts) = arguments.feedback {
        folding.insert("feedback".into(), toml! { parts = parts }.into());
    }
    if let Some(jitter) = arguments.jitter {
        folding.insert("jitter".into(), jitter.into());
    }
    Ok(toml! {
        extends = (paper.to_string_lossy().into_owned())
        experiment = "folding"
        title = title
        folding = folding
        contact = { friction = friction, distance_tolerance = "20 µm", slip_tolerance = "0.02 mm/s" }
        time = { step = "5 ms", end = TIME }
        output = { interval = "0.1 s" }
    })
}
