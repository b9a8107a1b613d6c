//! Searches for the value of a key at which an outcome reaches a target (bisection) or has its
//! minimum (golden section).
//!
//! Each evaluation is a case like any other, so an interrupted search runs only the remaining evaluations.

use super::case_table::record_in;
use super::objective::objective;
use super::outcome::Found;
use super::workers::{Job, Workers};
use super::{SweepError, thread_pools};
use crate::scenario::{Case, CaseSet, Parameter, Search, SearchMethod};
use rodlab_files::results::{
    CASES, CaseRecord, CaseStatus, ResultsError, SweepDirectory, write_whole,
};
use std::cell::RefCell;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;

/// Results of the searches: a row for each combination of the other varied keys.
pub const SEARCH_TABLE: &str = "search.csv";

/// Why a search ends early.
enum SearchFailure {
    /// The sweep stops.
    Stopped,
    /// The search has no solution, or cannot continue; with the reason.
    Explained(String),
    /// The sweep must be aborted.
    Fault(SweepError),
}

/// All evaluations and findings, in the order of the set of cases.
pub(super) struct Searched {
    /// The cases that were evaluated.
    pub cases: Vec<Case>,
    /// The findings.
    pub found: Vec<Found>,
}

/// The finding of a search and its evaluations: the value of the searched key, and the case.
type Traced = (Found, Vec<(f64, Case)>);

/// Searches for each combination of the other keys in the share of this process. [`replay`]
/// returns the findings.
pub(super) fn run(workers: &Workers<'_>, search: &Search, count: usize) -> Result<(), SweepError> {
    let fault = Mutex::new(None);
    let share: Vec<usize> = workers.shard().indices(count).collect();
    thread_pools::for_each(share.len(), workers.jobs(), |place| {
        let index = share[place];
        let evaluate = |number: f64, case: &Case| {
            let record = workers
                .run_one(&Job {
                    case: case.clone(),
                    index,
                    searched: Some(number),
                })
                .ok_or(SearchFailure::Stopped)?;
            outcome_of(search, case, &record, &workers.case_directory(&case.id))
        };
        match trace(workers.case_set(), search, index, evaluate) {
            Ok(_) => ControlFlow::Continue(()),
            Err(error) => {
                fault.lock().expect("no search panics").get_or_insert(error);
                ControlFlow::Break(())
            }
        }
    })?;
    fault
        .into_inner()
        .expect("no search panics")
        .map_or(Ok(()), Err)
}

/// Findings of all searches, from the cases that this process or others have run so far.
pub(super) fn replay(
    case_set: &CaseSet,
    search: &Search,
    directory: &Path,
) -> Result<Searched, SweepError> {
    let mut searched = Searched {
        cases: Vec::new(),
        found: Vec::new(),
    };
    for index in 0..case_set.count() as usize {
        let evaluate = |_: f64, case: &Case| {
            let path = directory.join(CASES).join(&case.id);
            let record = record_in(&path).map_err(|error| SearchFailure::Fault(error.into()))?;
            outcome_of(search, case, &record.ok_or(SearchFailure::Stopped)?, &path)
        };
        let (found, mut evaluations) = trace(case_set, search, index, evaluate)?;
        evaluations.sort_by(|a, b| a.0.total_cmp(&b.0));
        searched.found.push(found);
        searched
            .cases
            .extend(evaluations.into_iter().map(|(_, case)| case));
    }
    Ok(searched)
}

/// Makes one search.
fn trace(
    case_set: &CaseSet,
    search: &Search,
    index: usize,
    evaluate: impl Fn(f64, &Case) -> Result<f64, SearchFailure>,
) -> Result<Traced, SweepError> {
    let evaluations = RefCell::new(Vec::new());
    let evaluate = |number: f64| {
        let case = case_set.searched_case(index, number);
        let value = evaluate(number, &case);
        let begun = !matches!(value, Err(SearchFailure::Stopped));
        let mut evaluations = evaluations.borrow_mut();
        if begun && evaluations.iter().all(|(known, _)| *known != number) {
            evaluations.push((number, case));
        }
        value
    };
    let mut interval = [search.from, search.to];
    let end = match search.method {
        SearchMethod::Bisect => bisect(search, &mut interval, evaluate),
        SearchMethod::Golden => golden(search, &mut interval, evaluate),
    };
    let evaluations = evaluations.into_inner();
    let (value, failure) = match end {
        Ok(value) => (Some(value), None),
        Err(SearchFailure::Explained(words)) => (None, Some(words)),
        Err(SearchFailure::Stopped) => (None, Some("not all its cases were run".to_owned())),
        Err(SearchFailure::Fault(error)) => return Err(error),
    };
    let found = Found {
        index,
        value,
        interval,
        evaluations: evaluations.len(),
        failure,
    };
    Ok((found, evaluations))
}

/// The objective of a case, or the reason why it is missing.
fn outcome_of(
    search: &Search,
    case: &Case,
    record: &CaseRecord,
    directory: &Path,
) -> Result<f64, SearchFailure> {
    let id = &case.id;
    match record.status {
        CaseStatus::Finished => {}
        status if status.is_final() => {
            return Err(SearchFailure::Explained(format!(
                "case `{id}`: {}",
                status.in_words()
            )));
        }
        _ => return Err(SearchFailure::Stopped),
    }
    let value = objective(directory, &search.objective).map_err(SearchFailure::Fault)?;
    value.ok_or_else(|| {
        SearchFailure::Explained(format!("case `{id}` has no `{}`", search.objective))
    })
}

/// Halves the interval in which the objective crosses the target.
fn bisect(
    search: &Search,
    interval: &mut [f64; 2],
    evaluate: impl Fn(f64) -> Result<f64, SearchFailure>,
) -> Result<f64, SearchFailure> {
    let above = |number| Ok::<bool, SearchFailure>(evaluate(number)? > search.target);
    let first = above(interval[0])?;
    if above(interval[1])? == first {
        return Err(SearchFailure::Explained(format!(
            "`{}` does not pass {} between the ends",
            search.objective, search.target
        )));
    }
    loop {
        let middle = 0.5 * (interval[0] + interval[1]);
        let width = (interval[1] - interval[0]).abs();
        if width <= search.tolerance || middle == interval[0] || middle == interval[1] {
            return Ok(middle);
        }
        let end = usize::from(above(middle)? != first);
        interval[end] = middle;
    }
}

/// Shrinks the interval around the minimum. Each step except the first takes one evaluation
/// (Kiefer 1953).
fn golden(
    search: &Search,
    interval: &mut [f64; 2],
    evaluate: impl Fn(f64) -> Result<f64, SearchFailure>,
) -> Result<f64, SearchFailure> {
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    let inner = |[a, b]: [f64; 2]| [b - ratio * (b - a), a + ratio * (b - a)];
    let mut points = inner(*interval);
    let mut values = [evaluate(points[0])?, evaluate(points[1])?];
    while (interval[1] - interval[0]).abs() > search.tolerance {
        if values[0] < values[1] {
            interval[1] = points[1];
            points = [inner(*interval)[0], points[0]];
            values = [evaluate(points[0])?, values[0]];
        } else {
            interval[0] = points[0];
            points = [points[1], inner(*interval)[1]];
            values = [values[1], evaluate(points[1])?];
        }
        if points[0] == points[1] {
            break;
        }
    }
    Ok(0.5 * (interval[0] + interval[1]))
}

/// Writes the table of the findings.
pub(super) fn write(
    directory: &SweepDirectory,
    case_set: &CaseSet,
    found: &[Found],
) -> Result<(), ResultsError> {
    let mut keys = case_set.keys();
    let searched = keys.pop().unwrap_or_default().to_owned();
    let mut writer = csv::Writer::from_writer(Vec::new());
    let names = [searched.as_str(), "from", "to", "evaluations", "failure"];
    let header = keys.iter().copied().chain(names);
    writer
        .write_record(header)
        .expect("plain rows go into memory");
    for found in found {
        let case = case_set.case(found.index);
        let number = |number: f64| {
            let case = case_set.searched_case(found.index, number);
            case.parameters
                .last()
                .map(Parameter::column)
                .unwrap_or_default()
        };
        let fields = [
            found.value.map(number).unwrap_or_default(),
            number(found.interval[0]),
            number(found.interval[1]),
            found.evaluations.to_string(),
            found.failure.clone().unwrap_or_default(),
        ];
        let others = case.parameters.iter().map(Parameter::column);
        writer
            .write_record(others.chain(fields))
            .expect("plain rows go into memory");
    }
    let bytes = writer.into_inner().expect("memory takes all bytes");
    directory.write_alone(|path| write_whole(&path.join(SEARCH_TABLE), &bytes))
}
