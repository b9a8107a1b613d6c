//! Readings of measured numbers from a scene.

use super::data::{DataFile, Datum, Measured};
use super::frequencies::{frequency, frequency_of};
use super::onset::{ONSET, Onset};
use super::places::weights;
use crate::run::{Mode, PreparedRun};
use rodlab_engine::mechanics::Vector3;

/// The column of the first critical point of a path.
pub const CRITICAL: &str = "critical_parameter";
/// Relative difference below which times are equal.
const SAME_TIME: f64 = 1e-9;

/// Reading of the number of a datum from a simulation.
pub(super) enum Reading {
    /// A weighted sum of the positions of nodes along a direction.
    Along {
        weights: Vec<(usize, f64)>,
        direction: Vector3,
    },
    /// A column of the observers, by its index.
    Column(usize),
    /// The critical parameter.
    Critical,
    /// A natural frequency, from 0.
    Frequency(usize),
    /// The onset of sliding.
    Onset,
}

/// Whether times are equal.
pub(super) fn is_same(one: f64, other: f64) -> bool {
    (one - other).abs() <= SAME_TIME * one.abs().max(other.abs())
}

/// Returns the time of a datum, checked against the run.
pub(super) fn time_of(
    prepared: &PreparedRun,
    file: &DataFile,
    datum: &Datum,
) -> Result<Option<f64>, String> {
    if matches!(&datum.measured, Measured::Column(name) if name == ONSET) {
        return Ok(None);
    }
    match (prepared.mode, datum.time) {
        (Mode::Dynamic { end, .. }, Some(time)) => {
            let inside = (0.0..=end).contains(&time) || is_same(time, end);
            inside.then_some(Some(time.min(end))).ok_or_else(|| {
                format!("the time {time} s is outside of the run; allowed: 0 to {end} s (time.end)")
            })
        }
        (Mode::Dynamic { .. }, None) => {
            Err("the time is missing; a motion needs a column `time_s`".to_owned())
        }
        (_, Some(time)) => match file.data[0].time == Some(time) {
            true => Ok(None),
            false => Err(format!(
                "the time {time} s differs from that of the first row; an equilibrium has one time, or no column `time_s`"
            )),
        },
        (_, None) => Ok(None),
    }
}

/// Returns the reading of a datum from the scene.
pub(super) fn reading(prepared: &PreparedRun, datum: &Datum) -> Result<Reading, String> {
    let is_path = matches!(prepared.mode, Mode::Continuation(_));
    match &datum.measured {
        Measured::Column(name) if name == CRITICAL => match is_path {
            true => Ok(Reading::Critical),
            false => Err(format!(
                "`{CRITICAL}` needs a path of equilibria: time.mode = \"continuation\""
            )),
        },
        _ if is_path => Err(format!(
            "along a path of equilibria (time.mode = \"continuation\") only `{CRITICAL}` is compared"
        )),
        Measured::Coordinate { place, axis } => Ok(Reading::Along {
            weights: weights(prepared, place)?,
            direction: Vector3::ith(*axis, 1.0),
        }),
        Measured::Along { place, direction } => Ok(Reading::Along {
            weights: weights(prepared, place)?,
            direction: Vector3::from(*direction),
        }),
        Measured::Column(name) if name == ONSET => match prepared.mode {
            Mode::Dynamic { .. } => Onset::new(prepared).map(|_| Reading::Onset),
            _ => Err(format!("`{ONSET}` needs a motion: time.mode = \"dynamic\"")),
        },
        Measured::Column(name) => match frequency_of(name) {
            Some(number) => frequency(prepared, number).map(Reading::Frequency),
            None => column(prepared, name),
        },
    }
}

fn column(prepared: &PreparedRun, name: &str) -> Result<Reading, String> {
    let columns: Vec<String> = prepared
        .observers
        .iter()
        .flat_map(|one| one.columns())
        .collect();
    let number = columns.iter().position(|column| column == name);
    number.map(Reading::Column).ok_or_else(|| {
        let known = match columns.is_empty() {
            true => "the scenario has no [[probes]]".to_owned(),
            false => format!("the probes have: {}", columns.join(", ")),
        };
        format!(
            "no probe has the column `{name}`; {known}; allowed, too: {CRITICAL}, {ONSET}, frequency_1_hz, frequency_2_hz, ..."
        )
    })
}
