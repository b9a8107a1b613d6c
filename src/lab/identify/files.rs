//! The files of an identification.

use super::error::IdentifyError;
use super::figure::residuals_figure;
use super::identified::Identified;
use super::problem::Experiment;
use crate::experiment::{self, RodFile};
use crate::run::PreparedRun;
use libm::cbrt;
use rodlab_files::figure::Paper;
use rodlab_files::results::{ResultsError, write_files};
use rodlab_planning::plan::deployment::DeployedRod;
use serde::Serialize;
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

/// The result with correlations and remarks.
pub const IDENTIFIED: &str = "identified.json";
/// A row for each key.
pub const PARAMETERS: &str = "parameters.csv";
/// A row for each measured number.
pub const RESIDUALS: &str = "residuals.csv";
/// The residuals as a figure.
pub const RESIDUALS_FIGURE: &str = "residuals.svg";
/// The first scenario with the estimates.
pub const FITTED: &str = "fitted.toml";
/// Scenario file of the rod, for `--rod`.
pub const ROD: &str = "rod.toml";
/// Acceleration of free fall in the gravito-bending length, m/s².
const GRAVITY: f64 = 9.81;

#[derive(Serialize)]
struct Row<'a> {
    key: &'a str,
    value: f64,
    unit: &'a str,
    standard_error: Option<f64>,
    low_95: Option<f64>,
    high_95: Option<f64>,
    start: f64,
}

/// Writes all files into a directory, which is created if it is missing. Each file is written
/// completely or not at all. Returns their paths.
///
/// # Errors
/// A file cannot be written, or the first scenario is wrong at the estimates.
pub fn write(
    directory: &Path,
    identified: &Identified,
    experiments: &[Experiment],
) -> Result<Vec<PathBuf>, IdentifyError> {
    let whole = |name: &str, bytes: io::Result<Vec<u8>>| {
        bytes.map_err(ResultsError::io("write", &directory.join(name)))
    };
    let json = serde_json::to_vec_pretty(identified).map_err(io::Error::from);
    let rows = identified.parameters.iter().map(|one| Row {
        key: &one.key,
        value: one.value,
        unit: &one.unit,
        standard_error: one.standard_error,
        low_95: one.interval_95.map(|interval| interval[0]),
        high_95: one.interval_95.map(|interval| interval[1]),
        start: one.start,
    });
    let mut files = vec![
        (IDENTIFIED, whole(IDENTIFIED, json)?),
        (PARAMETERS, whole(PARAMETERS, table(rows))?),
        (
            RESIDUALS,
            whole(RESIDUALS, table(identified.residuals.iter()))?,
        ),
        (
            RESIDUALS_FIGURE,
            residuals_figure(identified)
                .svg(&Paper::default())
                .into_bytes(),
        ),
    ];
    if let Some(first) = experiments.first() {
        let fitted = fitted(first, identified)?;
        files.push((FITTED, fitted.scenario_toml.clone().into_bytes()));
        if let Some(rod) = rod_file(&fitted) {
            files.push((ROD, rod.into_bytes()));
        }
    }
    Ok(write_files(directory, &files)?)
}

fn table(rows: impl Iterator<Item = impl Serialize>) -> Result<Vec<u8>, io::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).map_err(io::Error::other)?;
    }
    writer.into_inner().map_err(|error| error.into_error())
}

/// The run of an experiment with the estimates.
fn fitted(experiment: &Experiment, identified: &Identified) -> Result<PreparedRun, IdentifyError> {
    let mut numbers = Vec::new();
    for one in &identified.parameters {
        if experiment.scenario.number(&one.key)?.is_some() {
            numbers.push((one.key.as_str(), one.value));
        }
    }
    let loaded = experiment.scenario.scenario_with(&numbers)?;
    Ok(experiment::prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues))?)
}

/// The file of the only rod of a scene, if its section is the same everywhere, with its gravito-bending length L_gb = (EI/(2 ρ g A))^(1/3), for `--rod`.
fn rod_file(prepared: &PreparedRun) -> Option<String> {
    let [rod] = prepared.scene.rods.as_slice() else {
        return None;
    };
    if !rod.sections.is_empty() {
        return None;
    }
    let area = std::f64::consts::PI * rod.radius * rod.radius;
    let length: f64 = rod
        .centreline
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).norm())
        .sum();
    let [one, other] = rod.stiffness.bending;
    let softer = one.min(other);
    let file = RodFile {
        title: prepared.title.clone(),
        rod: DeployedRod {
            gravito_bending_length: cbrt(softer / (2.0 * rod.mass_per_length * GRAVITY)),
            radius: rod.radius,
            length,
        },
        density: rod.mass_per_length / area,
        edges: None,
        friction: BTreeMap::new(),
    };
    Some(file.text())
}
