//! `rodlab design`.

use super::candidates::keys;
use super::exit_code::ExitCode;
use super::log_directory::results_directory;
use super::prelude::*;
use rodlab_lab::design::{self, DesignError, Designed, RESULT, Request};
use rodlab_lab::experiment;

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab design curl --shape curl.csv --vary rods.curl.natural_curvature
  rodlab design hook.toml --shape hook.csv --vary rods.hook.natural_curvature --out hook_designed",
    "\
The curve is a CSV file with columns x_m,y_m,z_m, from the first node of the rod to its last; the
rod is moved onto it with its clamps. The loads are those of the scenario at time zero. designed.toml
is the scenario with the natural shape, natural.csv its table for the key rods.natural_shape.
`rodlab guide design` has the equations."
);

/// Arguments of `rodlab design`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct DesignArguments {
    /// The scenario with the rod, its clamps and its loads
    #[arg(value_parser = file_or_preset(PresetKind::Scenario), add = presets(PresetKind::Scenario))]
    pub scenario: PathBuf,
    /// The wanted curve in equilibrium, a CSV file
    #[arg(long, value_name = "FILE")]
    pub shape: PathBuf,
    /// The key to find: rods.NAME.natural_curvature
    #[arg(long, value_name = "KEY", add = keys(""))]
    pub vary: String,
    /// Directory for the results [default: results/<name of the scenario>-designed]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Set a key of the scenario, such as rods.curl.edges=200; repeatable
    #[arg(long = "set", value_name = "KEY=VALUE", add = keys("="))]
    pub overrides: Vec<String>,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

/// Designs and prints.
pub fn design(arguments: &DesignArguments) -> Result<(), Failure> {
    let scenario = experiment::case_set(&arguments.scenario, &arguments.overrides, &[])?;
    let directory = results_directory(
        arguments.out.as_deref(),
        &format!("{}-designed", scenario.name()),
    );
    refuse_other_files(&directory)?;
    let request = Request {
        scenario: &scenario,
        shape: &arguments.shape,
        vary: &arguments.vary,
    };
    let found = design::design(&request).map_err(failure)?;
    let paths = design::write(&directory, &found).map_err(failure)?;
    match arguments.json {
        true => print_json(&found),
        false => {
            print(&summary(&found))?;
            print_paths(&paths)
        }
    }
}

/// Refuses a directory that holds anything but an earlier design.
fn refuse_other_files(directory: &Path) -> Result<(), Failure> {
    let is_used = std::fs::read_dir(directory).is_ok_and(|mut entries| entries.next().is_some());
    match is_used && !directory.join(RESULT).is_file() {
        true => Err(Failure::Input(format!(
            "--out: {} is not empty and holds no {RESULT}; choose another directory",
            directory.display()
        ))),
        false => Ok(()),
    }
}

fn failure(error: DesignError) -> Failure {
    match error {
        DesignError::Scenario(error) => error.into(),
        DesignError::Results(error) => error.into(),
        DesignError::Simulation(ref source) => Failure::Other {
            exit_code: source.exit_code(),
            message: error.to_string(),
        },
        DesignError::Engine(_) => Failure::Unreachable(error.to_string()),
        DesignError::Input(_) => Failure::input(error),
    }
}

fn summary(found: &Designed) -> String {
    let stability = match found.unstable_directions {
        Some(0) => "stable".to_owned(),
        Some(1) => "unstable in 1 direction".to_owned(),
        Some(count) => format!("unstable in {count} directions"),
        None => "not determined with friction or rigid contact".to_owned(),
    };
    let displaced = found.distance_from_displaced_start_m;
    let rows = [
        ("rod", format!("{}, {} edges", found.rod, found.edges)),
        (
            "natural length",
            format!(
                "{:.6} m (curve {:.6} m)",
                found.natural_length_m, found.curve_length_m
            ),
        ),
        (
            "distance from the curve",
            format!(
                "{:.1e} m, {:.1e} of the length",
                found.distance_m, found.distance_over_length
            ),
        ),
        (
            "from a displaced start",
            displaced.map_or("no equilibrium".to_owned(), |one| format!("{one:.1e} m")),
        ),
        ("equilibrium", stability),
        (
            "largest natural curvature",
            format!(
                "{:.4} 1/m, times radius {:.4}",
                found.natural_curvature_per_m, found.curvature_times_radius
            ),
        ),
        (
            "largest natural twist",
            format!("{:.4} rad/m", found.natural_twist_rad_per_m),
        ),
        (
            "largest strain",
            format!("{:.1e} of stretching", found.stretching_strain),
        ),
    ];
    let mut text = String::new();
    for (name, value) in rows {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{name:<27}{value}");
    }
    for remark in &found.remarks {
        let _ = writeln!(text, "{remark}");
    }
    text
}
