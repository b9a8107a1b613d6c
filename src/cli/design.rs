//! `rodlab design`.

use super::candidates::keys;
use super::exit_code::ExitCode;
use super::log_directory::results_directory;
use super::prelude::*;
use rodlab_lab::design::{self, Design, DesignError, Designed, DesignedNumbers, RESULT, Request};
use rodlab_lab::experiment;
use rodlab_lab::run::Interruption;

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab design curl --shape curl.csv --vary rods.curl.natural_curvature
  rodlab design hook.toml --shape hook.csv --vary rods.hook.natural_curvature --out hook_designed
  rodlab design arch.toml --shape arch.csv --vary clamps.1.pose,loads.0.force",
    "\
The curve is a CSV file with columns x_m,y_m,z_m, from the first node of the rod to its last. With
rods.NAME.natural_curvature alone, the rod is moved onto the curve with its clamps, and the natural
shape with which it rests there is found. natural.csv has this shape, as a table for
rods.natural_shape. Other keys are numbers that --set takes, vectors such as loads.0.force, or
clamps.N.pose: the place and the turn of clamp N, counted from 0. Their values are found so that the
equilibrium is closest to the curve. The loads are those of the scenario at time zero. designed.toml
is the scenario with the result. Exit code 3: the values have not converged. `rodlab guide design`
has the equations."
);

/// Arguments of `rodlab design`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct DesignArguments {
    /// The scenario with the rod, its clamps and its loads
    #[arg(value_parser = file_or_preset(PresetKind::Scenario), add = presets(PresetKind::Scenario))]
    pub scenario: PathBuf,
    /// CSV file of the target curve in equilibrium
    #[arg(long, value_name = "FILE")]
    pub shape: PathBuf,
    /// Keys to find: rods.NAME.natural_curvature, or numbers such as clamps.1.pose; repeatable
    #[arg(long, value_name = "KEY,...", required = true, value_delimiter = ',', add = keys(""))]
    pub vary: Vec<String>,
    /// Name of the rod to design, if the keys do not name it [default: the only one]
    #[arg(long, value_name = "NAME")]
    pub rod: Option<String>,
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
        rod: arguments.rod.as_deref(),
        vary: &arguments.vary,
    };
    let interruption = Interruption::watch();
    let found = design::design(&request, &|| interruption.requested().is_none());
    let found = found.map_err(failure)?;
    let paths = design::write(&directory, &found).map_err(failure)?;
    if arguments.json {
        print_json(&found)?;
    } else {
        print(&summary(&found))?;
        print_paths(&paths)?;
    }
    match &found {
        Design::Numbers(found) if !found.converged => Err(Failure::Unreachable(
            "the values have not converged; give a start value closer to the solution by --set KEY=VALUE".into(),
        )),
        _ => Ok(()),
    }
}

/// Rejects a directory that contains anything except an earlier design.
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
        DesignError::Identify(error) => super::identify::failure(error),
        DesignError::Simulation(ref source) => Failure::Other {
            exit_code: source.exit_code(),
            message: error.to_string(),
        },
        DesignError::Engine(_) => Failure::Unreachable(error.to_string()),
        DesignError::Input(_) => Failure::input(error),
    }
}

fn summary(found: &Design) -> String {
    let (rows, remarks) = match found {
        Design::Shape(found) => (rows_of_shape(found), &found.remarks),
        Design::Numbers(found) => (rows_of_numbers(found), &found.remarks),
    };
    let names = rows.iter().map(|(name, _)| name.chars().count());
    let width = names.max().unwrap_or(0).max(25) + 2;
    let mut text = String::new();
    for (name, value) in rows {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{name:<width$}{value}");
    }
    for remark in remarks {
        let _ = writeln!(text, "{remark}");
    }
    text
}

type Rows = Vec<(String, String)>;

fn stability(unstable_directions: Option<usize>) -> String {
    match unstable_directions {
        Some(0) => "stable".to_owned(),
        Some(1) => "unstable in 1 direction".to_owned(),
        Some(count) => format!("unstable in {count} directions"),
        None => "not determined with friction or rigid contact".to_owned(),
    }
}

fn displaced(distance: Option<f64>) -> String {
    distance.map_or("no equilibrium".to_owned(), |one| format!("{one:.1e} m"))
}

fn rows_of_numbers(found: &DesignedNumbers) -> Rows {
    let row = |name: &str, value: String| (name.to_owned(), value);
    let mut rows = vec![row("rod", format!("{}, {} edges", found.rod, found.edges))];
    rows.extend(found.keys.iter().map(|key| {
        let (value, unit) = (format!("{:.6e}", key.value), &key.unit);
        let space = if unit.is_empty() { "" } else { " " };
        row(
            &key.key,
            format!("{value}{space}{unit} (start {:.6e})", key.start),
        )
    }));
    rows.extend([
        row(
            "distance from the curve",
            format!(
                "{:.1e} m, {:.1e} of the length; mean {:.1e} m",
                found.distance_m, found.distance_over_length, found.mean_distance_m
            ),
        ),
        row(
            "curve",
            if found.met { "met" } else { "not met" }.to_owned(),
        ),
        row(
            "from a displaced start",
            displaced(found.distance_from_displaced_start_m),
        ),
        row("equilibrium", stability(found.unstable_directions)),
        row("iterations", found.iterations.to_string()),
    ]);
    rows
}

fn rows_of_shape(found: &Designed) -> Rows {
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
            displaced(found.distance_from_displaced_start_m),
        ),
        ("equilibrium", stability(found.unstable_directions)),
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
    rows.map(|(name, value)| (name.to_owned(), value)).to_vec()
}
