//! Sweeps: all cases of a scenario, some at a time, each in its own results directory.
//!
//! | file | what |
//! |---|---|
//! | `crew` | runs one case after the other: claims it, runs it, notes how it ended |
//! | `board` | how all cases stand; summary, timings and manifest of the whole |
//! | `heartbeat` | signs of life of the claims |
//! | `search` | bisection and golden section over an outcome |
//! | `objective` | the outcome that a search looks at |
//!
//! The truth about a case is the manifest in its own directory; what the whole directory says of it is made
//! from that, again and again. So a sweep may be killed at any moment, and several processes, of one machine
//! or of many, may work on one directory.

mod board;
mod crew;
mod error;
mod heartbeat;
mod objective;
mod outcome;
mod search;

pub use error::SweepError;
pub use outcome::{CaseCounts, SweepOutcome};
pub use search::{Found, SEARCH_TABLE};

use crate::experiment::{DerivedNumbers, derived_numbers, prepare};
use crate::results::{
    CASES, CaseRecord, CaseStatus, Manifest, SweepDirectory, host_name, scenario_hash,
};
use crate::run::{Interruption, PreparedRun, RunOptions, workers};
use crate::scenario::{Case, Family, Loaded, ScenarioError};
use board::Board;
use crew::Crew;
use heartbeat::Heartbeat;
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use search::Searched;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::Path;

/// How to run a sweep, as opposed to what.
#[derive(Clone, Debug)]
pub struct SweepOptions {
    /// How to run a case; its directory and `force` are those of the whole sweep, its time limit, too.
    pub run: RunOptions,
    /// Cases at a time; they share the threads of the program.
    pub jobs: NonZeroUsize,
    /// The share of the cases that is run.
    pub shard: Shard,
    /// Run cases again that failed before.
    pub retry_failed: bool,
    /// Begin no further case after one that failed.
    pub fail_fast: bool,
}

/// A share of the cases: every `of`-th, from number `number` on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which share, counted from 1.
    pub number: usize,
    /// How many shares there are.
    pub of: usize,
}

impl Shard {
    /// All cases.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Indices of the cases of this share, `count` being that of all cases.
    pub fn indices(self, count: usize) -> impl Iterator<Item = usize> {
        (self.number - 1..count).step_by(self.of)
    }
}

/// Runs what is left to do of a sweep.
///
/// Idempotent: finished cases are left alone, interrupted ones are continued from their checkpoints; failed
/// ones are left alone, too, unless they are to be tried again. Cases that other processes work on are waited
/// for, and taken over should those die.
///
/// # Errors
/// [`SweepError`] where the sweep could not begin, or its directory could not be written. Cases that failed
/// are no error here: [`SweepOutcome`] counts them.
pub fn run_sweep(family: &Family, options: &SweepOptions) -> Result<SweepOutcome, SweepError> {
    let cases = all_cases(family);
    refuse_repeated(&cases)?;
    let (directory, manifest) = open(family, &options.run)?;
    let board = Board::new(&directory, family, manifest);
    let interruption = Interruption::watch();
    let crew = Crew::new(family, &directory, &board, options, &interruption);
    let heartbeat = Heartbeat::start(crew.claimed());
    match family.search() {
        Some(search) => search::run(&crew, search, cases.len())?,
        None => crew.run_all(&cases)?,
    }
    drop(heartbeat);
    let all = all_and_found(family, cases, directory.path())?;
    let published = board.publish(&all.cases);
    let share: Vec<&Case> = match family.search() {
        Some(_) => all.cases.iter().collect(),
        None => {
            let indices = options.shard.indices(all.cases.len());
            indices.map(|index| &all.cases[index]).collect()
        }
    };
    let outcome = SweepOutcome {
        found: all.found,
        ..crew.outcome(share)
    };
    // What ended the sweep counts more than what followed from it.
    if let Some(fault) = crew.into_fault() {
        return Err(fault.into());
    }
    published?;
    if family.search().is_some() {
        search::write(&directory, family, &outcome.found)?;
    }
    Ok(outcome)
}

/// The cases that were, or are to be, run, and what searches found.
fn all_and_found(
    family: &Family,
    cases: Vec<Case>,
    directory: &Path,
) -> Result<Searched, SweepError> {
    match family.search() {
        Some(search) => search::replay(family, search, directory),
        None => Ok(Searched {
            cases,
            found: Vec::new(),
        }),
    }
}

/// Makes the directory of a sweep whose cases other processes are to run.
///
/// # Errors
/// As [`run_sweep`].
pub fn establish(family: &Family, options: &RunOptions) -> Result<(), SweepError> {
    refuse_repeated(&all_cases(family))?;
    open(family, options).map(drop)
}

fn open(family: &Family, options: &RunOptions) -> Result<(SweepDirectory, Manifest), SweepError> {
    let first = check_every_value(family)?;
    let manifest = first_manifest(family, &first, options)?;
    let directory = SweepDirectory::open(&options.directory, &manifest, options.force)?;
    Ok((directory, manifest))
}

fn all_cases(family: &Family) -> Vec<Case> {
    (0..family.count() as usize)
        .map(|index| family.case(index))
        .collect()
}

/// What a case would cost, roughly, and the number of its unknowns.
///
/// # Errors
/// What is wrong with its scenario.
pub fn derived_numbers_of(family: &Family, index: usize) -> Result<DerivedNumbers, ScenarioError> {
    let loaded = match family.search() {
        Some(search) => family.searched_scenario(index, search.from)?,
        None => family.scenario_of(index)?,
    };
    Ok(derived_numbers(&prepared(&loaded)?))
}

fn prepared(loaded: &Loaded) -> Result<PreparedRun, ScenarioError> {
    prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues))
}

/// Prepares cases in which each value of each key occurs, so that a bad one is found before anything is run;
/// returns the first.
///
/// # Errors
/// Everything that is wrong with the first faulty one of these cases.
pub fn check_every_value(family: &Family) -> Result<PreparedRun, ScenarioError> {
    let check = |index: usize| match family.search() {
        Some(search) => {
            prepared(&family.searched_scenario(index, search.to)?)?;
            prepared(&family.searched_scenario(index, search.from)?)
        }
        None => prepared(&family.scenario_of(index)?),
    };
    let first = check(0)?;
    let others: Vec<usize> = family.probes().skip(1).collect();
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
    family: &Family,
    first: &PreparedRun,
    options: &RunOptions,
) -> Result<Manifest, SweepError> {
    let scenario = family.to_toml()?;
    Ok(Manifest {
        version: env!("CARGO_PKG_VERSION").into(),
        commit: option_env!("RODLAB_COMMIT").map(Into::into),
        command_line: options.command_line.clone(),
        name: family.name().to_owned(),
        experiment: first.experiment.clone(),
        title: first.title.clone(),
        scenario_hash: scenario_hash(&scenario),
        scenario,
        rods: Vec::new(),
        host: host_name(),
        threads: rayon::current_num_threads(),
        start: jiff::Timestamp::now(),
        end: None,
        continuations: 0,
        seeds: family
            .seed()
            .map(|seed| ("sweep.sample".to_owned(), seed))
            .into_iter()
            .collect(),
        cases: BTreeMap::new(),
    })
}

/// Brings summary, timings and manifest of a sweep's directory up to date with its cases, and counts them.
///
/// # Errors
/// [`SweepError`] where the directory holds no sweep, or cannot be read or written.
pub fn gather(directory: &Path) -> Result<SweepOutcome, SweepError> {
    let (family, manifest) = family_in(directory)?;
    let sweep = SweepDirectory::open(directory, &manifest, false)?;
    let board = Board::new(&sweep, &family, manifest);
    let all = all_and_found(&family, all_cases(&family), directory)?;
    board.publish(&all.cases)?;
    if family.search().is_some() {
        search::write(&sweep, &family, &all.found)?;
    }
    Ok(SweepOutcome {
        directory: directory.to_owned(),
        counts: board.counts(&all.cases),
        interrupted: None,
        found: all.found,
    })
}

/// How the cases of a sweep's directory stand, in the order of the sweep; of a search, those that were begun.
/// Nothing is written.
///
/// # Errors
/// [`SweepError`] where the directory holds no sweep, or cannot be read.
pub fn standing(directory: &Path) -> Result<Vec<(Case, CaseRecord)>, SweepError> {
    let (family, _) = family_in(directory)?;
    let all = all_and_found(&family, all_cases(&family), directory)?;
    let standing = all.cases.into_iter().map(|case| {
        let record = board::record_in(&directory.join(CASES).join(&case.id))?;
        let record = record.unwrap_or_else(|| CaseRecord::new(CaseStatus::Pending));
        Ok((case, record))
    });
    standing.collect()
}

/// The family whose results a directory holds, and its manifest.
fn family_in(directory: &Path) -> Result<(Family, Manifest), SweepError> {
    let manifest = Manifest::read(directory)?.ok_or_else(|| SweepError::NoSweep {
        directory: directory.to_owned(),
    })?;
    let family = Family::from_text(&manifest.name, &manifest.scenario, directory)?;
    if !family.is_sweep() {
        return Err(SweepError::NoSweep {
            directory: directory.to_owned(),
        });
    }
    Ok((family, manifest))
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
