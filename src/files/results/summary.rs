//! `summary.csv` and `timings.csv`: one row per case.
//!
//! The summary holds values that follow from the scenario; values that depend on the machine and
//! its load are in the timings. The last bits may differ between machines if their C libraries
//! compute sines, exponentials and logarithms differently.

use super::atomic::write_whole_before;
use super::files::{SUMMARY, TIMINGS};
use super::stream::header_of;
use super::{CaseOutcome, CaseStatus, NamedValues, ResultsError, Usage, Value};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A row of `summary.csv`; the fields are the columns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SummaryRow {
    /// Id of the case.
    pub case: String,
    /// Status of the case.
    pub status: CaseStatus,
    /// Simulated time reached.
    pub simulated_time_s: f64,
    /// Accepted steps.
    pub steps: u64,
    /// Number of times a step was halved before it was accepted.
    pub retries: u64,
    /// Mean number of Newton iterations per step.
    pub newton_iterations_mean: Option<f64>,
    /// Mean number of Newton iterations per step with contact.
    pub newton_iterations_mean_with_contact: Option<f64>,
    /// Mean number of Krylov iterations of the fluid solves per step.
    pub fluid_iterations_mean: Option<f64>,
    /// Number of steps that ended with contact.
    pub steps_with_contact: u64,
    /// End of the first step with contact; empty if there was none.
    pub first_contact_s: Option<f64>,
    /// Distance of the bodies, including planes, that were nearest to contact; empty if none were
    /// near.
    pub min_distance_m: Option<f64>,
    /// Ratio of that distance to the one at which the surfaces of these bodies touch.
    pub min_distance_ratio: Option<f64>,
    /// Mean gap between surfaces in contact, weighted by their normal forces; empty if none touch.
    pub mean_gap_m: Option<f64>,
    /// Elastic energy at the last output.
    pub elastic_energy_j: Option<f64>,
    /// Potential of gravity at the last output.
    pub gravitational_energy_j: Option<f64>,
    /// Path parameter of the first fold, bifurcation or onset of flutter; empty if there is no
    /// path, or no such point on it.
    pub critical_parameter: Option<f64>,
    /// Remarks on the case, sentences joined by "; ".
    #[serde(default)]
    pub remarks: String,
    /// Values of observers: further columns of tables that contain this case.
    #[serde(skip)]
    pub observed: NamedValues,
}

impl SummaryRow {
    /// Names of the columns that every summary has.
    pub fn columns() -> Vec<String> {
        header_of(&Self::new("", CaseStatus::Pending, &CaseOutcome::default()))
    }

    /// The row of a case.
    pub fn new(case: &str, status: CaseStatus, outcome: &CaseOutcome) -> Self {
        Self {
            case: case.to_owned(),
            status,
            simulated_time_s: outcome.simulated_time,
            steps: outcome.steps,
            retries: outcome.retries,
            newton_iterations_mean: outcome.newton_iterations_mean(),
            newton_iterations_mean_with_contact: outcome.newton_iterations_mean_with_contact(),
            fluid_iterations_mean: outcome.fluid_iterations_mean(),
            steps_with_contact: outcome.steps_with_contact,
            first_contact_s: outcome.first_contact,
            min_distance_m: outcome.minimum_distance,
            min_distance_ratio: outcome.minimum_distance_ratio,
            mean_gap_m: outcome.mean_gap,
            elastic_energy_j: outcome.elastic_energy,
            gravitational_energy_j: outcome.gravitational_energy,
            critical_parameter: outcome.critical_parameter,
            remarks: outcome.remarks.join("; "),
            observed: outcome.observed.clone(),
        }
    }
}

/// A row of `timings.csv`; the fields are the columns.
#[derive(Serialize)]
struct TimingRow<'a> {
    case: &'a str,
    wall_time_s: f64,
    wall_time_with_contact_s: f64,
    cpu_time_s: Option<f64>,
    peak_memory_bytes: Option<u64>,
}

/// Writes the whole of `summary.csv`; the manifest, written after it, makes it durable.
pub fn write_summary(directory: &Path, rows: &[SummaryRow]) -> Result<(), ResultsError> {
    write_whole_before(&directory.join(SUMMARY), &summary_table(rows.iter()))
}

/// Writes `timings.csv`: the cost of each case. See [`write_summary`].
pub fn write_timings(directory: &Path, cases: &[(&str, Usage)]) -> Result<(), ResultsError> {
    let rows = cases.iter().map(|(case, usage)| TimingRow {
        case,
        wall_time_s: usage.wall_time.as_secs_f64(),
        wall_time_with_contact_s: usage.wall_time_with_contact.as_secs_f64(),
        cpu_time_s: usage.cpu_time.map(|time| time.as_secs_f64()),
        peak_memory_bytes: usage.peak_memory,
    });
    write_whole_before(&directory.join(TIMINGS), &table(rows))
}

/// Writes `summary.csv` of a sweep: `case`, a column for each of `keys`, then the other columns.
/// Each row is given with its values of the keys. See [`write_summary`].
pub fn write_sweep_summary(
    directory: &Path,
    keys: &[&str],
    rows: &[(Vec<String>, SummaryRow)],
) -> Result<(), ResultsError> {
    let plain = summary_table(rows.iter().map(|(_, row)| row));
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(plain.as_slice());
    let header: Vec<String> = keys.iter().map(|key| (*key).to_owned()).collect();
    let parameters = std::iter::once(&header).chain(rows.iter().map(|(values, _)| values));
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (record, values) in reader.records().zip(parameters) {
        let record = record.expect("the table was written here");
        let case = record.iter().take(1);
        let fields = case
            .chain(values.iter().map(String::as_str))
            .chain(record.iter().skip(1));
        writer
            .write_record(fields)
            .expect("plain rows go into memory");
    }
    let bytes = writer.into_inner().expect("memory takes all bytes");
    write_whole_before(&directory.join(SUMMARY), &bytes)
}

/// Column names and rows of a summary, with all columns that observers of any case add, in order
/// of first occurrence.
fn summary_table<'a>(rows: impl Iterator<Item = &'a SummaryRow> + Clone) -> Vec<u8> {
    let mut observed: Vec<&str> = Vec::new();
    for name in rows.clone().flat_map(|row| row.observed.names()) {
        if !observed.contains(&name) {
            observed.push(name);
        }
    }
    let mut writer = csv::WriterBuilder::new()
        .has_headers(false)
        .from_writer(Vec::new());
    for (index, row) in rows.enumerate() {
        if index == 0 {
            let fixed = header_of(row);
            let header = fixed.iter().map(String::as_str).chain(observed.clone());
            writer
                .write_record(header)
                .expect("plain rows go into memory");
        }
        let value = |name: &&str| row.observed.get(name).unwrap_or(&Value::Empty);
        let values: Vec<&Value> = observed.iter().map(value).collect();
        writer
            .serialize((row, values))
            .expect("plain rows go into memory");
    }
    writer.into_inner().expect("memory takes all bytes")
}

/// Column names and rows.
fn table(rows: impl Iterator<Item = impl Serialize>) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).expect("plain rows go into memory");
    }
    writer.into_inner().expect("memory takes all bytes")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::time::Duration;

    #[test]
    fn means_are_over_their_own_steps_and_absent_values_are_empty() {
        let directory = tempfile::tempdir().unwrap();
        let outcome = CaseOutcome {
            simulated_time: 10.0,
            steps: 8,
            newton_iterations: 20,
            steps_with_contact: 4,
            newton_iterations_with_contact: 14,
            first_contact: Some(2.5),
            remarks: vec!["stretched, by 7 %".into(), "bent".into()],
            ..CaseOutcome::default()
        };
        let rows = [
            SummaryRow::new("main", CaseStatus::Finished, &outcome),
            SummaryRow::new("none", CaseStatus::TimeLimit, &CaseOutcome::default()),
        ];
        write_summary(directory.path(), &rows).unwrap();
        let text = fs::read_to_string(directory.path().join(SUMMARY)).unwrap();
        assert_eq!(
            text.lines().nth(1),
            Some("main,finished,10.0,8,0,2.5,3.5,0.0,4,2.5,,,,,,,\"stretched, by 7 %; bent\"")
        );
        assert_eq!(
            text.lines().nth(2),
            Some("none,time-limit,0.0,0,0,,,,0,,,,,,,,")
        );
        let mut reader = csv::Reader::from_path(directory.path().join(SUMMARY)).unwrap();
        let read: Vec<SummaryRow> = reader.deserialize().map(Result::unwrap).collect();
        assert_eq!(read, rows);
    }

    #[test]
    fn columns_observed_in_some_cases_are_empty_in_the_others() {
        let directory = tempfile::tempdir().unwrap();
        let row = |case, observed: NamedValues| {
            let outcome = CaseOutcome {
                observed,
                ..CaseOutcome::default()
            };
            SummaryRow::new(case, CaseStatus::Finished, &outcome)
        };
        let one = NamedValues::from([("tip_z_m", Value::from(0.5)), ("knot", "reef".into())]);
        let other = NamedValues::from([("knot", Value::Empty), ("turns", 3_u64.into())]);
        let rows = [
            row("a", NamedValues::default()),
            row("b", one),
            row("c", other),
        ];
        write_summary(directory.path(), &rows).unwrap();
        let text = fs::read_to_string(directory.path().join(SUMMARY)).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[0].ends_with(",critical_parameter,remarks,tip_z_m,knot,turns"));
        assert!(lines[1].ends_with(",,,,"), "{}", lines[1]);
        assert!(lines[2].ends_with(",0.5,reef,"), "{}", lines[2]);
        assert!(lines[3].ends_with(",,,3"), "{}", lines[3]);
    }

    #[test]
    fn the_summary_of_a_sweep_has_the_swept_keys_after_the_case() {
        let directory = tempfile::tempdir().unwrap();
        let row = |case| SummaryRow::new(case, CaseStatus::Finished, &CaseOutcome::default());
        let rows = [
            (vec!["0.1".into(), "imc, \"old\"".into()], row("a")),
            (vec!["0.2".into(), "ipc".into()], row("b")),
        ];
        write_sweep_summary(directory.path(), &["contact.friction", "title"], &rows).unwrap();
        let text = fs::read_to_string(directory.path().join(SUMMARY)).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[0].starts_with("case,contact.friction,title,status,simulated_time_s,"));
        assert!(lines[1].starts_with("a,0.1,\"imc, \"\"old\"\"\",finished,0.0,"));
        assert!(lines[2].starts_with("b,0.2,ipc,finished,"));
        let mut reader = csv::Reader::from_path(directory.path().join(SUMMARY)).unwrap();
        let read: Vec<SummaryRow> = reader.deserialize().map(Result::unwrap).collect();
        assert_eq!(read, [row("a"), row("b")]);
    }

    #[test]
    fn timings_have_a_row_per_case() {
        let directory = tempfile::tempdir().unwrap();
        let usage = Usage {
            wall_time: Duration::from_millis(1500),
            wall_time_with_contact: Duration::from_millis(250),
            cpu_time: None,
            peak_memory: Some(4096),
        };
        write_timings(directory.path(), &[("main", usage)]).unwrap();
        let text = fs::read_to_string(directory.path().join(TIMINGS)).unwrap();
        assert_eq!(
            text,
            "case,wall_time_s,wall_time_with_contact_s,cpu_time_s,peak_memory_bytes\nmain,1.5,0.25,,4096\n"
        );
    }
}
