//! Sweeps: all cases of a scenario, some at a time, each in its own results directory.
//!
//! | file | what |
//! |---|---|
//! | `workers` | runs one case after the other: leases it, runs it, records its end |
//! | `case_table` | states of all cases; summary, timings and manifest of the whole |
//! | `derivatives` | derivatives of probes in the summary |
//! | `heartbeat` | signs of life of the leases |
//! | `search` | bisection and golden section over an outcome |
//! | `objective` | the outcome that a search reads |
//!
//! The authoritative record of a case is the manifest in its own directory; the tables of the
//! whole sweep are rebuilt from these manifests each time. So a sweep may be killed at any moment,
//! and several processes, on one or many machines, may work on one directory.

mod case_table;
mod derivatives;
mod error;
mod heartbeat;
mod objective;
mod outcome;
mod search;
mod workers;

pub use error::SweepError;
pub use outcome::{CaseCounts, Found, SweepOutcome};
pub use search::SEARCH_TABLE;

use crate::experiment::{case_set_from_text, prepare};
use crate::run::{Forecast, Interruption, PreparedRun, RunOptions, forecast, thread_pools};
use crate::scenario::{Case, CaseSet, INPUTS, Loaded, Portable, ScenarioError, earlier_id};
use case_table::CaseTable;
use heartbeat::Heartbeat;
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use rodlab_files::origin::{VERSION, commit};
use rodlab_files::results::{
    CASES, CaseRecord, CaseStatus, Manifest, SweepDirectory, host_name, scenario_hash_with_inputs,
};
use search::Searched;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::Path;
use workers::Workers;

/// Options of a sweep, apart from its cases.
#[derive(Clone, Debug)]
pub struct SweepOptions {
    /// Options of the run of a case. The directory, `force` and the time limit apply to the whole
    /// sweep.
    pub run: RunOptions,
    /// Number of cases to run at a time; they share the threads of the program.
    pub jobs: NonZeroUsize,
    /// The share of the cases to run.
    pub shard: Shard,
    /// Whether to run cases again that failed before.
    pub retry_failed: bool,
    /// Whether to start no further case after a failure.
    pub fail_fast: bool,
}

/// A share of the cases: every `of`-th case, starting at `number`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Number of the share, counted from 1.
    pub number: usize,
    /// Number of shares.
    pub of: usize,
}

impl Shard {
    /// All cases.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Indices of the cases of this share among `count` cases.
    pub fn indices(self, count: usize) -> impl Iterator<Item = usize> {
        (self.number - 1..count).step_by(self.of)
    }
}

/// Runs the remaining cases of a sweep.
///
/// Idempotent: finished cases are skipped and interrupted ones resume from their checkpoints.
/// Failed cases are skipped too, unless the options ask to retry them. Cases that other processes
/// work on are waited for, and resumed here if those processes die.
///
/// # Errors
/// [`SweepError`] if the sweep could not begin, or its directory could not be written. A failed
/// case is not an error here: [`SweepOutcome`] counts failures.
pub fn run_sweep(case_set: &CaseSet, options: &SweepOptions) -> Result<SweepOutcome, SweepError> {
    let cases = all_cases(case_set);
    refuse_repeated(&cases)?;
    let (directory, manifest) = open(case_set, &cases, &options.run)?;
    let case_table = CaseTable::new(&directory, case_set, manifest);
    let interruption = Interruption::watch();
    let workers = Workers::new(case_set, &directory, &case_table, options, &interruption);
    let heartbeat = Heartbeat::start(workers.leased());
    match case_set.search() {
        Some(search) => search::run(&workers, search, cases.len())?,
        None => workers.run_all(&cases)?,
    }
    let synced = workers.sync_finished();
    drop(heartbeat);
    // The remaining work can be repeated: from here on signals end the program at once.
    interruption.leave_unattended();
    let all = all_and_found(case_set, cases, directory.path())?;
    let published = if workers.stops() {
        case_table.publish_if_quick(&all.cases)
    } else {
        case_table.publish(&all.cases).map(|()| true)
    };
    let share: Vec<&Case> = match case_set.search() {
        Some(_) => all.cases.iter().collect(),
        None => {
            let indices = options.shard.indices(all.cases.len());
            indices.map(|index| &all.cases[index]).collect()
        }
    };
    let outcome = SweepOutcome {
        found: all.found,
        tables_are_old: matches!(published, Ok(false)),
        ..workers.outcome(share)
    };
    // The error that ended the sweep takes precedence over its consequences.
    if let Some(fault) = workers.into_fault() {
        return Err(fault.into());
    }
    synced?;
    published?;
    if case_set.search().is_some() {
        search::write(&directory, case_set, &outcome.found)?;
    }
    Ok(outcome)
}

/// The cases that were or will be run, and the findings of searches.
fn all_and_found(
    case_set: &CaseSet,
    cases: Vec<Case>,
    directory: &Path,
) -> Result<Searched, SweepError> {
    match case_set.search() {
        Some(search) => search::replay(case_set, search, directory),
        None => Ok(Searched {
            cases,
            found: Vec::new(),
        }),
    }
}

/// Creates the directory of a sweep whose cases other processes will run.
///
/// # Errors
/// As [`run_sweep`].
pub fn establish(case_set: &CaseSet, options: &RunOptions) -> Result<(), SweepError> {
    let cases = all_cases(case_set);
    refuse_repeated(&cases)?;
    open(case_set, &cases, options).map(drop)
}

fn open(
    case_set: &CaseSet,
    cases: &[Case],
    options: &RunOptions,
) -> Result<(SweepDirectory, Manifest), SweepError> {
    let first = check_every_value(case_set)?;
    let portable = case_set.portable()?;
    let manifest = first_manifest(case_set, &first, &portable, options);
    let directory = SweepDirectory::open(
        &options.directory,
        &manifest,
        &first.own_files,
        options.force,
    )?;
    directory.keep_inputs(INPUTS, inputs_of(&portable))?;
    directory.rename_cases(
        cases
            .iter()
            .map(|case| (earlier_id(&case.id), case.id.as_str())),
    )?;
    Ok((directory, manifest))
}

/// Names and contents of the files that a sweep reads.
fn inputs_of(portable: &Portable) -> impl Iterator<Item = (&str, &[u8])> {
    let inputs = portable.inputs.iter();
    inputs.map(|input| (input.name.as_str(), input.contents.as_slice()))
}

fn all_cases(case_set: &CaseSet) -> Vec<Case> {
    (0..case_set.count() as usize)
        .map(|index| case_set.case(index))
        .collect()
}

/// Estimated cost of a case, from a trial run.
///
/// # Errors
/// The faults of its scenario.
pub fn forecast_of(case_set: &CaseSet, index: usize) -> Result<Forecast, ScenarioError> {
    let loaded = match case_set.search() {
        Some(search) => case_set.searched_scenario(index, search.from)?,
        None => case_set.scenario_of(index)?,
    };
    Ok(forecast(&prepared(&loaded)?))
}

fn prepared(loaded: &Loaded) -> Result<PreparedRun, ScenarioError> {
    prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues))
}

/// Prepares enough cases that each value of each key occurs, so that a bad value is found before
/// any case runs. Returns the first case.
///
/// # Errors
/// All faults of the first faulty case.
pub fn check_every_value(case_set: &CaseSet) -> Result<PreparedRun, ScenarioError> {
    let check = |index: usize| {
        let from = case_set.search().map(|search| search.from);
        let first = match case_set.search() {
            Some(search) => {
                prepared(&case_set.searched_scenario(index, search.to)?)?;
                prepared(&case_set.searched_scenario(index, search.from)?)?
            }
            None => prepared(&case_set.scenario_of(index)?)?,
        };
        derivatives::check(case_set, index, from)?;
        Ok::<_, ScenarioError>(first)
    };
    let first = check(0)?;
    let others: Vec<usize> = case_set.probes().skip(1).collect();
    let faulty = others.into_par_iter().map(|index| check(index).map(drop));
    faulty.collect::<Result<(), _>>()?;
    Ok(first)
}

fn refuse_repeated(cases: &[Case]) -> Result<(), SweepError> {
    let mut ids = BTreeMap::new();
    for case in cases {
        if ids.insert(case.id.as_str(), ()).is_some() {
            return Err(SweepError::RepeatedCase {
                id: case.id.clone(),
            });
        }
    }
    Ok(())
}

/// The manifest with which the sweep begins.
fn first_manifest(
    case_set: &CaseSet,
    first: &PreparedRun,
    portable: &Portable,
    options: &RunOptions,
) -> Manifest {
    Manifest {
        version: VERSION.into(),
        commit: commit().map(Into::into),
        command_line: options.command_line.clone(),
        name: case_set.name().to_owned(),
        experiment: first.experiment.clone(),
        title: first.title.clone(),
        scenario_hash: scenario_hash_with_inputs(&portable.toml, inputs_of(portable)),
        scenario: portable.toml.clone(),
        rods: Vec::new(),
        host: host_name(),
        threads: rayon::current_num_threads(),
        start: jiff::Timestamp::now(),
        end: None,
        continuations: 0,
        seeds: case_set
            .seed()
            .map(|seed| ("sweep.sample".to_owned(), seed))
            .into_iter()
            .collect(),
        cases: BTreeMap::new(),
        files: BTreeMap::new(),
    }
}

/// Updates the summary, timings and manifest of a sweep's directory, and counts its cases.
///
/// # Errors
/// [`SweepError`] if the directory holds no sweep, or cannot be read or written.
pub fn gather(directory: &Path) -> Result<SweepOutcome, SweepError> {
    let (case_set, manifest) = case_set_in(directory)?;
    let sweep = SweepDirectory::open(directory, &manifest, &[], false)?;
    let case_table = CaseTable::new(&sweep, &case_set, manifest);
    let all = all_and_found(&case_set, all_cases(&case_set), directory)?;
    case_table.publish(&all.cases)?;
    if case_set.search().is_some() {
        search::write(&sweep, &case_set, &all.found)?;
    }
    Ok(SweepOutcome {
        directory: directory.to_owned(),
        counts: case_table.counts(&all.cases),
        interrupted: None,
        found: all.found,
        tables_are_old: false,
    })
}

/// States of the cases in a sweep's directory, in the order of the sweep; for a search, only the
/// started ones. Nothing is written.
///
/// # Errors
/// [`SweepError`] if the directory holds no sweep, or cannot be read.
pub fn case_records(directory: &Path) -> Result<Vec<(Case, CaseRecord)>, SweepError> {
    let (case_set, _) = case_set_in(directory)?;
    let all = all_and_found(&case_set, all_cases(&case_set), directory)?;
    let case_records = all.cases.into_iter().map(|case| {
        let record = case_table::record_in(&directory.join(CASES).join(&case.id))?;
        let record = record.unwrap_or_else(|| CaseRecord::new(CaseStatus::Pending));
        Ok((case, record))
    });
    case_records.collect()
}

/// The set of cases whose results a directory holds, and its manifest.
fn case_set_in(directory: &Path) -> Result<(CaseSet, Manifest), SweepError> {
    let manifest = Manifest::read(directory)?.ok_or_else(|| SweepError::NoSweep {
        directory: directory.to_owned(),
    })?;
    let case_set = case_set_from_text(&manifest.name, &manifest.scenario, directory)?;
    if !case_set.is_sweep() {
        return Err(SweepError::NoSweep {
            directory: directory.to_owned(),
        });
    }
    Ok((case_set, manifest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_a_partition_of_the_cases() {
        for (count, of) in [(10, 3), (2, 5), (7, 1)] {
            let mut all: Vec<usize> = (1..=of)
                .flat_map(|number| Shard { number, of }.indices(count))
                .collect();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..count));
        }
    }
}
