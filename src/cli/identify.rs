//! `rodlab identify`.

use super::candidates::keys;
use super::exit_code::{ExitCode, INTERRUPTED};
use super::identify_held::HeldArguments;
use super::in_cell::InCell;
use super::log_directory::results_directory;
use super::prelude::*;
use indicatif::ProgressBar;
use rodlab_lab::experiment;
use rodlab_lab::identify::{
    self, DataFile, Exact, Experiment, IDENTIFIED, Identified, IdentifiedKey, IdentifyError, Loss,
    Progress, Request, Task, read_markers,
};
use rodlab_lab::run::Interruption;
use rodlab_lab::scenario::number_with_unit;
use std::collections::BTreeMap;

/// Treatments of large residuals.
const LOSSES: [Named<Loss>; 2] = [
    ("squares", Loss::Squares, "Least squares, for normal noise"),
    (
        "huber",
        Loss::Huber,
        "Linear beyond 1.345 standard deviations, for data with outliers",
    ),
];
/// Correlation of the errors of two keys above which it is printed.
const NOTABLE_CORRELATION: f64 = 0.9;

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab identify swing.toml --data swing.csv --fit parameters.ei,material.viscosity
  rodlab identify loop.toml --data a.csv --with twist.toml:b.csv --fit parameters.ei,parameters.gj
  rodlab identify --rod green_vps --simulated-rod mine.toml    by an arm, in a virtual cell
  rodlab identify swing.toml --data swing.csv --markers markers.csv --fit parameters.ei \\
    --prior \"parameters.ei=2e-3+-5e-4\" --noise \"position=0.5 mm\" --loss huber",
    "\
Data are CSV files. Positions of markers: time_s,marker,x_m,y_m,z_m with a column `node` or
`arc_length_m`, and `rod` where there are several; --markers names a file with these columns for
each marker instead. Centrelines: x_m,y_m,z_m, matched by arc length. Series: time_s and columns of
probes, such as grip_force_x_n; `sliding_onset_s` is the time at which rods begin to slide.
Data of equilibria have no time_s. `frequency_1_hz` is a natural frequency of an equilibrium;
`critical_parameter` is the first fold or bifurcation of a path of equilibria. Empty cells were not
measured. Exit code 3: the fit has not converged. `rodlab guide identification` explains the error
bars.

With --rod instead of a scenario, an arm identifies a rod. Its gripper receives the end of the rod,
so that the length --free hangs down. The arm holds the rod in three poses, the camera takes
pictures, and the gravito-bending length and the natural curvature are fitted to them. rod.toml is
--rod with the fitted length. Other results are look_1.png to look_3.png, overlay_1.png to
overlay_3.png, and the record of a task, as with `rodlab deploy`."
);

/// Arguments of `rodlab identify`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct IdentifyArguments {
    /// The scenario, with a start value for each key
    #[arg(required_unless_present_any = ["rod", "cell"], value_parser = file_or_preset(PresetKind::Scenario), add = presets(PresetKind::Scenario))]
    pub scenario: Option<PathBuf>,
    /// Measurements on this scenario, CSV files
    #[arg(long, value_name = "FILE,...", required_unless_present_any = ["rod", "cell"], value_delimiter = ',')]
    pub data: Vec<PathBuf>,
    /// Further scenario and measurements, fitted with the same keys; repeatable
    #[arg(long = "with", value_name = "SCENARIO:FILE,...")]
    pub others: Vec<String>,
    /// Keys to fit, such as rods.wire.stiffness.twisting
    #[arg(long, value_name = "KEY,...", required_unless_present_any = ["rod", "cell"], value_delimiter = ',', add = keys(""))]
    pub fit: Vec<String>,
    /// Set a key of all scenarios, such as a start; repeatable
    #[arg(long = "set", value_name = "KEY=VALUE", add = keys("="))]
    pub overrides: Vec<String>,
    /// Places of markers on their rods: CSV with marker, rod, and node or arc_length_m
    #[arg(long, hide_short_help = true, value_name = "FILE")]
    pub markers: Option<PathBuf>,
    /// Range of a key; repeatable
    #[arg(long, value_name = "KEY=LEAST:MOST", value_parser = bounds)]
    pub bounds: Vec<(String, [f64; 2])>,
    /// Expected value of a key with its standard deviation; repeatable
    #[arg(long, value_name = "KEY=VALUE+-SD", value_parser = prior)]
    pub prior: Vec<(String, [f64; 2])>,
    /// Standard deviation of the noise of `position` or a column [default: from the residuals]
    #[arg(long, value_name = "NAME=SD", value_parser = noise)]
    pub noise: Vec<(String, f64)>,
    /// Treatment of large residuals
    #[arg(long, default_value = "squares", value_parser = named(&LOSSES))]
    pub loss: Loss,
    /// Multiple shooting: first number of windows of a motion in which a rod snaps or whips
    ///
    /// Each window begins from a state that follows the markers. The windows become four times as long in each round, until one window covers the whole motion. Choose a number for which a window is shorter than the snap.
    #[arg(long, hide_short_help = true, value_name = "WINDOWS", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..), conflicts_with = "rod")]
    pub shooting: u32,
    #[command(flatten)]
    pub held: InCell<HeldArguments>,
}

/// Fits keys of scenarios to measurements.
pub fn identify(arguments: &IdentifyArguments, common: &Common) -> Result<(), Failure> {
    let held = &arguments.held;
    let Some(scenario) = &arguments.scenario else {
        return held.run(common);
    };
    if held.choice.cell.is_some() {
        return Err(Failure::Input(
            "--cell needs --rod, a rod that an arm identifies; a scenario is fitted to --data"
                .into(),
        ));
    }
    let task = arguments.task(scenario)?;
    let name = task.experiments[0].scenario.name();
    let out = held.what.out.as_deref();
    let directory = results_directory(out, &format!("{name}-identified"));
    refuse_other_files(&directory)?;
    let interruption = Interruption::watch();
    let goes_on = || interruption.requested().is_none();
    let bar = common.progress(
        ProgressBar::new_spinner(),
        "{spinner} {msg} [{elapsed_precise}]",
    );
    bar.set_message("first run");
    let mut report = |progress: &Progress| {
        bar.set_message(in_words(progress, &arguments.fit));
        bar.tick();
    };
    let found = identify::identify(&task, &Exact::default(), &goes_on, &mut report);
    bar.finish_and_clear();
    let found = found.map_err(failure)?;
    identify::write(&directory, &found, &task.experiments).map_err(failure)?;
    if held.choice.json {
        print_json(&found)?;
    } else {
        print(&summary(&found, &directory))?;
    }
    match found.converged {
        true => Ok(()),
        false => Err(Failure::Unreachable(
            "the fit has not converged; give a start value closer to the solution by --set KEY=VALUE, or give --bounds".into(),
        )),
    }
}

impl IdentifyArguments {
    fn task(&self, scenario: &Path) -> Result<Task, Failure> {
        let markers = match &self.markers {
            Some(file) => read_markers(file).map_err(failure)?,
            None => BTreeMap::new(),
        };
        let experiment = |scenario: &Path, files: &[PathBuf]| -> Result<Experiment, Failure> {
            let scenario = experiment::case_set(scenario, &self.overrides, &[])?;
            let files = files.iter().map(|file| DataFile::read(file, &markers));
            let files: Result<Vec<DataFile>, IdentifyError> = files.collect();
            Ok(Experiment {
                scenario,
                files: files.map_err(failure)?,
            })
        };
        let mut experiments = vec![experiment(scenario, &self.data)?];
        for other in &self.others {
            let (scenario, files) = other.split_once(':').ok_or_else(|| {
                Failure::Input(format!(
                    "--with {other}: expected SCENARIO:FILE, such as twist.toml:twist.csv"
                ))
            })?;
            let files: Vec<PathBuf> = files.split(',').map(PathBuf::from).collect();
            experiments.push(experiment(Path::new(scenario), &files)?);
        }
        for (option, key) in (self.bounds.iter().map(|(key, _)| ("--bounds", key)))
            .chain(self.prior.iter().map(|(key, _)| ("--prior", key)))
        {
            if !self.fit.contains(key) {
                return Err(Failure::Input(format!(
                    "{option} {key}: this key is not fitted; --fit names {}",
                    self.fit.join(", ")
                )));
            }
        }
        let of = |list: &[(String, [f64; 2])], key: &String| {
            let found = list.iter().find(|(other, _)| other == key);
            found.map(|(_, pair)| *pair)
        };
        let requests = self.fit.iter().map(|key| Request {
            key: key.clone(),
            bounds: of(&self.bounds, key),
            prior: of(&self.prior, key),
        });
        Ok(Task {
            experiments,
            keys: requests.collect(),
            loss: self.loss,
            noise: self.noise.iter().cloned().collect(),
            shared: None,
            windows: self.shooting as usize,
        })
    }
}

/// Rejects a directory that contains anything except an earlier identification.
fn refuse_other_files(directory: &Path) -> Result<(), Failure> {
    let is_used = std::fs::read_dir(directory).is_ok_and(|mut entries| entries.next().is_some());
    match is_used && !directory.join(IDENTIFIED).is_file() {
        true => Err(Failure::Input(format!(
            "--out: {} is not empty and holds no {IDENTIFIED}; choose another directory",
            directory.display()
        ))),
        false => Ok(()),
    }
}

/// Converts the failure of an identification.
pub(super) fn failure(error: IdentifyError) -> Failure {
    match error {
        IdentifyError::Scenario(error) => error.into(),
        IdentifyError::Results(error) => error.into(),
        IdentifyError::Interrupted => Failure::Other {
            exit_code: INTERRUPTED,
            message: error.to_string(),
        },
        IdentifyError::Simulation { ref source, .. } => Failure::Other {
            exit_code: source.exit_code(),
            message: error.to_string(),
        },
        IdentifyError::Input(_) | IdentifyError::Row { .. } => Failure::input(error),
    }
}

fn in_words(progress: &Progress, keys: &[String]) -> String {
    let values = keys.iter().zip(&progress.values);
    let values = values.map(|(key, value)| {
        let name = key.rsplit('.').next().unwrap_or(key);
        format!("{name} {value:.4e}")
    });
    format!(
        "iteration {}: residual {:.3} σ; {}",
        progress.iterations,
        progress.root_mean_square,
        values.collect::<Vec<_>>().join(", ")
    )
}

/// Formats the table of the keys, with remarks on its limits.
fn summary(found: &Identified, directory: &Path) -> String {
    let noises = found.groups.iter();
    let noises: Vec<String> = noises
        .map(|one| format!("noise of {}", one.group))
        .collect();
    let names = found.parameters.iter().map(|one| &one.key).chain(&noises);
    let width = names.map(|name| name.chars().count()).max().unwrap_or(0) + 2;
    let mut text = format!(
        "{} measurements, {} iterations\n",
        found.measurements, found.iterations
    );
    for key in &found.parameters {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:<width$}{}", key.key, value_in_words(key));
    }
    for (noise, name) in found.groups.iter().zip(&noises) {
        let given = if noise.given { " (given)" } else { "" };
        let _ = writeln!(
            text,
            "{name:<width$}{:.3e}{given}, residual {:.3e}",
            noise.standard_deviation, noise.root_mean_square
        );
    }
    for (one, row) in found.correlations.iter().enumerate() {
        for (other, correlation) in row.iter().enumerate().take(one) {
            if correlation.abs() > NOTABLE_CORRELATION {
                let [one, other] = [one, other].map(|key| &found.parameters[key].key);
                let _ = writeln!(text, "correlation {correlation:.3} of {other} and {one}");
            }
        }
    }
    for combination in &found.undetermined {
        let _ = writeln!(text, "{}; {}", combination.words, combination.advice);
    }
    for remark in &found.remarks {
        let _ = writeln!(text, "{remark}");
    }
    let _ = writeln!(text, "{:<width$}{}", "results", directory.display());
    text
}

fn value_in_words(key: &IdentifiedKey) -> String {
    let unit = match key.unit.as_str() {
        "" => String::new(),
        unit => format!(" {unit}"),
    };
    match key.standard_error {
        Some(error) => format!(
            "{:.5e} ± {error:.1e}{unit} ({:.2} %; start {:.5e})",
            key.value,
            100.0 * error / key.value.abs(),
            key.start
        ),
        None => format!("not determined (start {:.5e}{unit})", key.start),
    }
}

/// Parses a number with or without a unit.
fn quantity(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok();
    number
        .or_else(|| number_with_unit(text))
        .filter(|number: &f64| number.is_finite())
        .ok_or_else(|| {
            format!(
                "{text:?} is not a number, such as 0.5, or a number with a unit, such as \"5 mm\""
            )
        })
}

fn key_and_value(text: &str) -> Result<(&str, &str), String> {
    text.split_once('=')
        .map(|(key, value)| (key.trim(), value))
        .ok_or_else(|| "expected KEY=VALUE".to_owned())
}

fn bounds(text: &str) -> Result<(String, [f64; 2]), String> {
    let (key, value) = key_and_value(text)?;
    let (least, most) = value
        .split_once(':')
        .ok_or("expected KEY=LEAST:MOST, such as material.density=900:1200")?;
    let pair = [quantity(least)?, quantity(most)?];
    match pair[0] < pair[1] {
        true => Ok((key.to_owned(), pair)),
        false => Err(format!(
            "the least value {least} is not below the most {most}"
        )),
    }
}

fn prior(text: &str) -> Result<(String, [f64; 2]), String> {
    let (key, value) = key_and_value(text)?;
    let parts = value.split_once("+-").or_else(|| value.split_once('±'));
    let (expected, deviation) =
        parts.ok_or("expected KEY=VALUE+-SD, such as parameters.ei=1e-3+-2e-4")?;
    let pair = [quantity(expected)?, quantity(deviation)?];
    match is_positive(pair[1]) {
        true => Ok((key.to_owned(), pair)),
        false => Err(format!(
            "the standard deviation {deviation} must be above 0"
        )),
    }
}

fn noise(text: &str) -> Result<(String, f64), String> {
    let (name, value) = key_and_value(text)?;
    let deviation = quantity(value)?;
    match is_positive(deviation) {
        true => Ok((name.to_owned(), deviation)),
        false => Err(format!("the standard deviation {value} must be above 0")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_priors_and_noise_are_read_with_their_units() {
        assert_eq!(prior("a.b=1e-3+-2e-4"), Ok(("a.b".into(), [1e-3, 2e-4])));
        assert_eq!(prior("a=5 MPa±1 MPa"), Ok(("a".into(), [5e6, 1e6])));
        assert_eq!(bounds("a=-1:2"), Ok(("a".into(), [-1.0, 2.0])));
        assert_eq!(noise("position=0.5 mm"), Ok(("position".into(), 5e-4)));
        for (fault, expected) in [
            (prior("a=1").unwrap_err(), "KEY=VALUE+-SD"),
            (prior("a=1+-0").unwrap_err(), "above 0"),
            (bounds("a=2:1").unwrap_err(), "not below"),
            (bounds("a").unwrap_err(), "KEY=VALUE"),
            (noise("position=nan").unwrap_err(), "not a number"),
        ] {
            assert!(fault.contains(expected), "{fault}");
        }
    }
}
