//! `rodlab sensitivity`: derivatives of probes with respect to keys and to fields along rods.

use super::candidates::keys;
use super::exit_code::ExitCode;
use super::prelude::*;
use super::sensitivity_fields::FieldArguments;
use rodlab_engine::mechanics::dynamics::sensitivity as engine;
use rodlab_lab::experiment;
use rodlab_lab::scenario::{Loaded, ScenarioError};
use rodlab_lab::sensitivity::{Derivatives, Key, Row, SensitivityError, derivatives, differences};

/// Name of the table with all outputs.
const TABLE: &str = "sensitivity.csv";

/// Arguments of `rodlab sensitivity`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab sensitivity beam.toml --of tip --to rods.beam.radius,material.density
  rodlab sensitivity beam.toml --of tip_z_m --to loads.0.acceleration.2 --check
  rodlab sensitivity beam.toml --to contact.friction --out results/beam_sensitivity
  rodlab sensitivity beam.toml --of tip --field natural_curvature,force --out results/tip

Derivatives are those of the computed motion, by the Newton matrices of its steps. The elasticity
(p/y) dy/dp is the percentage by which y changes if p changes by one per cent.")]
pub struct SensitivityArguments {
    /// The scenario file
    #[arg(value_parser = file_or_preset(PresetKind::Scenario), add = presets(PresetKind::Scenario))]
    pub scenario: PathBuf,
    /// Keys of the derivatives, named as in `rodlab run --vary`; repeatable
    #[arg(long = "to", value_name = "KEY", value_delimiter = ',', required_unless_present = "fields", add = keys(""))]
    pub keys: Vec<String>,
    #[command(flatten)]
    pub fields: FieldArguments,
    /// Probes to differentiate, or columns of them; repeatable [default: all probes]
    #[arg(long = "of", value_name = "PROBE", value_delimiter = ',')]
    pub probes: Vec<String>,
    /// Set a key of the scenario, such as rods.beam.radius="7 mm"; repeatable
    #[arg(long = "set", value_name = "KEY=VALUE", add = keys("="))]
    pub overrides: Vec<String>,
    /// Compare with differences of four runs for each key
    #[arg(long)]
    pub check: bool,
    /// Directory for sensitivity.csv, with a row for each output of the run, or fields.csv and fields.svg
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the results as JSON
    #[arg(long)]
    pub json: bool,
}

/// Differentiates and prints.
pub fn sensitivity(arguments: &SensitivityArguments) -> Result<(), Failure> {
    let source = |more: &[String]| -> Result<Loaded, ScenarioError> {
        let overrides = [arguments.overrides.as_slice(), more].concat();
        experiment::load(&arguments.scenario, &overrides)
    };
    if !arguments.fields.are_empty() {
        let out = arguments.out.as_deref();
        return (arguments.fields).differentiate(&source, &arguments.probes, out, arguments.json);
    }
    let (of, to) = (&arguments.probes, &arguments.keys);
    let found = derivatives(&source, of, to)?;
    let checked = match arguments.check {
        true => Some(differences(&source, of, to)?),
        false => None,
    };
    if let Some(directory) = &arguments.out {
        write_files(directory, vec![(TABLE, found.to_csv().into_bytes())])?;
    }
    match arguments.json {
        true => print_json(&as_json(&found, checked.as_deref())),
        false => {
            print(&as_text(&found, checked.as_deref()))?;
            match &arguments.out {
                Some(directory) => print_paths(&[directory.join(TABLE)]),
                None => Ok(()),
            }
        }
    }
}

/// Formats the last row, in one block for each column.
fn as_text(found: &Derivatives, checked: Option<&[Vec<Option<f64>>]>) -> String {
    let Some(row) = found.rows.last() else {
        return String::new();
    };
    let width = found.keys.iter().map(|key| key.key.len()).max();
    let width = width.unwrap_or(0).max(3);
    let mut text = match found.rows.len() {
        1 => "in equilibrium\n".to_owned(),
        _ => format!("at t = {} s, after {} steps\n", row.time, found.steps),
    };
    for (column, name) in found.columns.iter().enumerate() {
        let value = in_words(row.values[column]);
        // Writing to a string cannot fail.
        let _ = writeln!(text, "\n{name} = {value}");
        let _ = write!(
            text,
            "  {:<width$}  {:<22}{:>14}{:>12}",
            "key p", "value", "derivative", "(p/y) dy/dp"
        );
        text.push_str(if checked.is_some() {
            "   by differences\n"
        } else {
            "\n"
        });
        for (index, key) in found.keys.iter().enumerate() {
            let own = row.derivatives[index][column];
            let elasticity = found.elasticity(row, index, column);
            let elasticity = elasticity.map_or("-".to_owned(), |number| format!("{number:.4}"));
            let value = match &key.unit {
                Some(unit) => format!("{} {unit}", key.value),
                None => key.value.to_string(),
            };
            let _ = write!(
                text,
                "  {:<width$}  {value:<22}{:>14}{elasticity:>12}",
                key.key,
                in_words(own)
            );
            if let Some(checked) = checked {
                let other = checked[index][column];
                let _ = write!(text, "{:>17}", in_words(other));
                if let Some(off) = deviation(own, other) {
                    let _ = write!(text, ", {off:.0e} off");
                }
            }
            text.push('\n');
        }
    }
    text
}

fn in_words(number: Option<f64>) -> String {
    number.map_or("-".to_owned(), |number| format!("{number:.6e}"))
}

/// Relative deviation of a derivative from that by finite differences.
fn deviation(own: Option<f64>, other: Option<f64>) -> Option<f64> {
    let (own, other) = (own?, other?);
    (other != 0.0).then(|| (own / other - 1.0).abs())
}

fn as_json(found: &Derivatives, checked: Option<&[Vec<Option<f64>>]>) -> serde_json::Value {
    let row = found.rows.last();
    let of_key = |row: &Row, column: usize| {
        let entry = |(index, key): (usize, &Key)| {
            let mut entry = serde_json::json!({
                "key": key.key,
                "value": key.value,
                "unit": key.unit,
                "derivative": row.derivatives[index][column],
                "elasticity": found.elasticity(row, index, column),
            });
            if let Some(checked) = checked {
                entry["by_differences"] = checked[index][column].into();
            }
            entry
        };
        let entries = found.keys.iter().enumerate().map(entry);
        entries.collect::<Vec<_>>()
    };
    let columns = row.map(|row| {
        let entry = |(column, name): (usize, &String)| {
            serde_json::json!({
                "column": name,
                "value": row.values[column],
                "derivatives": of_key(row, column),
            })
        };
        let entries = found.columns.iter().enumerate().map(entry);
        entries.collect::<Vec<_>>()
    });
    serde_json::json!({
        "time_s": row.map(|row| row.time),
        "steps": found.steps,
        "columns": columns,
    })
}

impl From<SensitivityError> for Failure {
    fn from(error: SensitivityError) -> Self {
        match error {
            SensitivityError::Scenario(error) => error.into(),
            SensitivityError::Key { .. }
            | SensitivityError::Probe { .. }
            | SensitivityError::Unsuitable(_) => Self::input(error),
            SensitivityError::Interrupted => Self::interrupted(error.to_string()),
            SensitivityError::Engine(error) => error.into(),
        }
    }
}

impl ExitCode for engine::SensitivityError {
    fn exit_code(&self) -> u8 {
        match self {
            Self::Simulation(error) => error.exit_code(),
            Self::Unsuitable(_) => 2,
            Self::NotRepeated { .. } | Self::Singular { .. } => 3,
        }
    }
}
