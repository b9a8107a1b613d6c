//! `rodlab fold --simulate`.

use super::fold_arguments::FoldArguments;
use super::log_directory::results_directory;
use super::prelude::*;
use super::run::simulate;
use super::view::show;
use super::watchdog;
use rodlab_lab::experiment::{Crease, case_set_from_text};
use rodlab_lab::run::RunOptions;

/// Time of a fold, s.
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
    let text = scenario(arguments, title, friction)?;
    let cases = case_set_from_text(&name, &text, Path::new(""))?;
    let directory = results_directory(arguments.out.as_deref(), &name);
    let options = RunOptions {
        force: arguments.force,
        ..RunOptions::new(directory)
    };
    let page = simulate(&cases, options, common)?;
    if arguments.open { show(&page) } else { Ok(()) }
}

/// The scenario of a fold.
fn scenario(arguments: &FoldArguments, title: &str, friction: f64) -> Result<String, Failure> {
    let paper = std::path::absolute(&arguments.paper);
    let paper = paper.map_err(Failure::system)?;
    let quoted = |text: &str| toml::Value::from(text).to_string();
    let crease = match arguments.crease {
        Crease::Half => quoted("half"),
        Crease::Diagonal => quoted(Crease::DIAGONAL_STRIP),
        Crease::At(target) => format!("{target:?}"),
    };
    let mut text = format!(
        "extends = {}\nexperiment = \"folding\"\ntitle = {}\n\n[folding]\ncrease = {crease}\nalgorithm = {}\nseed = {}\n",
        quoted(&paper.to_string_lossy()),
        quoted(title),
        quoted(&arguments.algorithm),
        arguments.seed
    );
    // Writing to a string cannot fail.
    if let Some(parts) = arguments.feedback {
        let _ = writeln!(text, "feedback = {{ parts = {parts} }}");
    }
    if let Some(jitter) = arguments.jitter {
        let _ = writeln!(text, "jitter = {jitter:?}");
    }
    let _ = write!(
        text,
        "\n[contact]\nfriction = {friction:?}\ndistance_tolerance = \"20 µm\"\nslip_tolerance = \"0.02 mm/s\"\n\n\
         [time]\nstep = \"5 ms\"\nend = {TIME:?}\n\n[output]\ninterval = \"0.1 s\"\n"
    );
    Ok(text)
}
