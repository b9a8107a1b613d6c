//! Sweeps of `rodlab run`: their cases, and the results.

use super::exit_code::ExitCode;
use super::prelude::*;
use rodlab_lab::scenario::{CaseSet, Parameter};
use rodlab_lab::sweep::{
    self, Found, SEARCH_TABLE, Shard, SweepOptions, SweepOutcome, forecast_of,
};

/// Number of cases beyond which `--yes` must be given.
const MOST_CASES: u128 = 100_000;
/// Number of cases beyond which a sweep does not fit into memory; each case takes up to a
/// kilobyte.
const HELD_CASES: u128 = 1_000_000;
/// Number of cases that are run for a second each to estimate the total cost.
const TRIED_CASES: usize = 3;

/// Runs a sweep, and prints the outcome as text or as JSON.
pub fn run(case_set: &CaseSet, options: &SweepOptions, json: bool) -> Result<(), Failure> {
    let outcome = sweep::run_sweep(case_set, options)?;
    if json {
        print_json(&as_json(case_set, &outcome))?;
        return verdict(&outcome);
    }
    report(case_set, &outcome)
}

/// Rejects numbers of cases that are probably a typing error or that exceed the memory.
pub fn refuse_too_many(case_set: &CaseSet, yes: bool) -> Result<(), Failure> {
    let count = case_set.count();
    let number = match count {
        u128::MAX => "more cases than can be counted".to_owned(),
        count => format!("{count} cases"),
    };
    if count > HELD_CASES {
        return Err(Failure::Input(format!(
            "the sweep has {number}; allowed: at most {HELD_CASES}, which take about 1 GB of memory"
        )));
    }
    if count > MOST_CASES && !yes {
        return Err(Failure::Input(format!(
            "the sweep has {number}; pass --yes to run them"
        )));
    }
    Ok(())
}

/// Prints the cases of a share, their values and their estimated cost.
pub fn list(case_set: &CaseSet, options: &SweepOptions) -> Result<(), Failure> {
    let (shard, jobs) = (options.shard, options.jobs.get());
    sweep::check_every_value(case_set)?;
    let count = case_set.count() as usize;
    let mut text = String::new();
    for index in shard.indices(count) {
        let case = case_set.case(index);
        // Writing to a string cannot fail.
        let _ = write!(text, "{}", case.id);
        for Parameter { key, typed, .. } in &case.parameters {
            let _ = write!(text, "  {key} = {typed}");
        }
        text.push('\n');
    }
    let cases = shard.indices(count).count();
    let _ = writeln!(
        text,
        "{cases} cases, {jobs} at a time; {}",
        cost(case_set, shard, jobs)?
    );
    if let Some(search) = case_set.search() {
        let _ = writeln!(
            text,
            "each case is a search by `{}`, which runs several cases",
            search.objective
        );
    }
    print(&text)
}

/// Estimates the time for all cases from trials of some.
fn cost(case_set: &CaseSet, shard: Shard, jobs: usize) -> Result<String, Failure> {
    let indices: Vec<usize> = shard.indices(case_set.count() as usize).collect();
    let tried = indices.len().min(TRIED_CASES);
    let (mut seconds, mut trial) = (0.0, 0.0);
    for place in 0..tried {
        // Trials are spread over the sweep and include its ends, which may differ in cost.
        let index = indices[place * (indices.len() - 1) / (tried - 1).max(1)];
        let forecast = forecast_of(case_set, index)?;
        trial += forecast.trial_time;
        match forecast.processor_time {
            Some(time) => seconds += time,
            None => return Ok("no estimate of the time they take".to_owned()),
        }
    }
    let seconds = seconds * indices.len() as f64 / tried.max(1) as f64;
    Ok(format!(
        "roughly {seconds:.1} s of processor time, {:.1} s for each job, by trials of {tried} of them for {trial:.1} s",
        seconds / jobs.min(indices.len()).max(1) as f64
    ))
}

/// Outcome of a sweep as JSON.
fn as_json(case_set: &CaseSet, outcome: &SweepOutcome) -> serde_json::Value {
    let found = outcome.found.iter().map(|found| {
        serde_json::json!({
            "case": case_set.case(found.index).id,
            "value": found.value,
            "interval": found.interval,
            "evaluations": found.evaluations,
            "failure": found.failure,
        })
    });
    serde_json::json!({
        "results": outcome.directory,
        "cases": outcome.counts,
        "found": found.collect::<Vec<_>>(),
    })
}

/// Prints the outcome of a sweep; failed cases determine the exit code.
fn report(case_set: &CaseSet, outcome: &SweepOutcome) -> Result<(), Failure> {
    let mut text = format!("{}\n", outcome.counts);
    let mut line = |name: &str, value: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{name:<24}{value}");
    };
    line("results", outcome.directory.display().to_string());
    match outcome.counts.remarked {
        0 => {}
        1 => line("remarks", "on 1 case: see `remarks` in summary.csv".into()),
        count => line(
            "remarks",
            format!("on {count} cases: see `remarks` in summary.csv"),
        ),
    }
    for found in &outcome.found {
        line("found", found_in_words(case_set, found));
    }
    if !outcome.found.is_empty() {
        line(
            "table",
            outcome.directory.join(SEARCH_TABLE).display().to_string(),
        );
    }
    print(&text)?;
    verdict(outcome)
}

/// The failure of the worst case, if any failed.
pub fn verdict(outcome: &SweepOutcome) -> Result<(), Failure> {
    match outcome.exit_code() {
        0 => Ok(()),
        exit_code => Err(Failure::Other {
            exit_code,
            message: why(outcome),
        }),
    }
}

fn found_in_words(case_set: &CaseSet, found: &Found) -> String {
    let case = case_set.searched_case(found.index, found.value.unwrap_or(found.interval[0]));
    let mut words: Vec<String> = case
        .parameters
        .iter()
        .map(|parameter| format!("{} = {}", parameter.key, parameter.typed))
        .collect();
    if let Some(failure) = &found.failure {
        words.pop();
        words.push(failure.clone());
    }
    format!("{} ({} cases)", words.join(", "), found.evaluations)
}

fn why(outcome: &SweepOutcome) -> String {
    let directory = outcome.directory.display();
    if outcome.interrupted.is_some() {
        let tables = if outcome.tables_are_old {
            format!("; its tables are not up to date, `rodlab gather {directory}` writes them")
        } else {
            String::new()
        };
        return format!("stopped; run the same command again to resume, in `{directory}`{tables}");
    }
    if outcome.counts.not_good() > 0 {
        return format!(
            "{} cases failed; `{directory}/manifest.json` holds the reasons, --retry-failed runs them again",
            outcome.counts.not_good()
        );
    }
    if outcome.counts.unfinished > 0 {
        return format!(
            "not all cases were run; run the same command again to resume, in `{directory}`"
        );
    }
    "the search did not reach its end; `search.csv` holds the reason".to_owned()
}
