//! Runs cases. Each of several workers leases, runs and records one case after the other.

use super::case_table::CaseTable;
use super::derivatives::CaseDerivatives;
use super::heartbeat::HeldLeases;
use super::outcome::SweepOutcome;
use super::{Shard, SweepError, SweepOptions, prepared, thread_pools};
use crate::run::{AmongBars, PreparedRun, RunError, RunOptions, StopRequest};
use crate::run::{Interruption, not_at_once, run_until};
use crate::scenario::{Case, CaseSet, ScenarioError};
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use rodlab_files::results::{
    CaseRecord, CaseStatus, LaterSync, LeaseAttempt, MAIN_CASE, Manifest, ResultsError,
    SweepDirectory, sync_file_system,
};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock};
use std::time::{Duration, Instant};

/// Time between two checks of cases that other processes work on.
const WAIT: Duration = Duration::from_millis(100);
/// Time between two syncs of the cases that finished in between.
const BETWEEN_SYNCS: Duration = Duration::from_secs(1);

/// A case and its position in the set of cases.
#[derive(Clone, Debug)]
pub(super) struct Job {
    /// The case.
    pub case: Case,
    /// Index of the case in the set of cases.
    pub index: usize,
    /// The value of the searched key.
    pub searched: Option<f64>,
}

/// Result of an attempt to run a case.
pub(super) enum Attempt {
    /// The case is in this state, and this process has nothing left to do for it.
    Settled(Box<CaseRecord>),
    /// Another process works on it.
    Held,
    /// The case was not started, because the sweep is about to stop.
    Stopped,
}

/// Finished cases whose files may not be on the disk.
struct Unsynced {
    /// Their ids.
    cases: BTreeSet<String>,
    /// When the last sync began.
    since: Instant,
}

/// The workers, and their shared state.
pub(super) struct Workers<'a> {
    case_set: &'a CaseSet,
    directory: &'a SweepDirectory,
    case_table: &'a CaseTable<'a>,
    options: &'a SweepOptions,
    interruption: &'a Interruption,
    leased: HeldLeases,
    /// Cases that failed before and that this call ran again.
    retried: Mutex<BTreeSet<String>>,
    /// Finished cases that are not synced; their leases are kept.
    unsynced: Mutex<Unsynced>,
    /// Set when no further case may start.
    stopped: AtomicBool,
    /// Reason why the whole sweep must be aborted.
    fault: OnceLock<ResultsError>,
    deadline: Option<Instant>,
    bars: MultiProgress,
}

impl<'a> Workers<'a> {
    /// Workers that have not started.
    pub fn new(
        case_set: &'a CaseSet,
        directory: &'a SweepDirectory,
        case_table: &'a CaseTable<'a>,
        options: &'a SweepOptions,
        interruption: &'a Interruption,
    ) -> Self {
        Self {
            case_set,
            directory,
            case_table,
            options,
            interruption,
            leased: Arc::new(Mutex::new(BTreeMap::new())),
            retried: Mutex::new(BTreeSet::new()),
            unsynced: Mutex::new(Unsynced {
                cases: BTreeSet::new(),
                since: Instant::now(),
            }),
            stopped: AtomicBool::new(false),
            fault: OnceLock::new(),
            deadline: options.run.deadline.map(not_at_once),
            bars: MultiProgress::new(),
        }
    }

    /// The held leases, for their heartbeat.
    pub fn leased(&self) -> HeldLeases {
        Arc::clone(&self.leased)
    }

    /// The share of the cases.
    pub fn shard(&self) -> Shard {
        self.options.shard
    }

    /// Cases at a time.
    pub fn jobs(&self) -> usize {
        self.options.jobs.get()
    }

    /// The results directory of a case.
    pub fn case_directory(&self, id: &str) -> PathBuf {
        self.directory.case(id)
    }

    /// The set of cases.
    pub fn case_set(&self) -> &CaseSet {
        self.case_set
    }

    /// Runs all cases of the share, and waits for cases that other processes work on.
    pub fn run_all(&self, cases: &[Case]) -> Result<(), SweepError> {
        let mut left: Vec<usize> = self.options.shard.indices(cases.len()).collect();
        let bar = self.whole_bar(left.len());
        while !left.is_empty() {
            let held = Mutex::new(Vec::new());
            thread_pools::for_each(left.len(), self.options.jobs.get(), |place| {
                let index = left[place];
                let job = Job {
                    case: cases[index].clone(),
                    index,
                    searched: None,
                };
                match self.attempt(&job) {
                    Attempt::Settled(_) => bar.inc(1),
                    Attempt::Held => held.lock().expect("no case panics").push(index),
                    Attempt::Stopped => return ControlFlow::Break(()),
                }
                if let Err(error) = self.case_table.publish_if_due(cases) {
                    self.give_up(error);
                }
                ControlFlow::Continue(())
            })?;
            if self.stops() {
                break;
            }
            left = held.into_inner().expect("no case panics");
            left.sort_unstable();
            if !left.is_empty() {
                bar.set_message(format!("waiting for {} of other processes", left.len()));
                std::thread::sleep(WAIT);
            }
        }
        bar.finish_and_clear();
        Ok(())
    }

    /// Runs one case, or waits for another process that works on it; `None` if the sweep stops.
    pub fn run_one(&self, job: &Job) -> Option<CaseRecord> {
        loop {
            match self.attempt(job) {
                Attempt::Settled(record) => return Some(*record),
                Attempt::Stopped => return None,
                Attempt::Held => std::thread::sleep(WAIT),
            }
        }
    }

    /// Starts a case, unless it is settled or another process holds it.
    fn attempt(&self, job: &Job) -> Attempt {
        match self.try_attempt(job) {
            Ok(attempt) => attempt,
            Err(error) => {
                self.give_up(error);
                Attempt::Stopped
            }
        }
    }

    fn try_attempt(&self, job: &Job) -> Result<Attempt, ResultsError> {
        // Checked first: reading the states of a million finished cases takes time, too.
        if self.stops() {
            return Ok(Attempt::Stopped);
        }
        if let Some(record) = self.settled(&job.case)? {
            return Ok(Attempt::Settled(Box::new(record)));
        }
        let id = &job.case.id;
        let lease = match self.directory.leases.acquire(id)? {
            LeaseAttempt::Granted(lease) => lease,
            LeaseAttempt::Held(_) => return Ok(Attempt::Held),
        };
        self.lock_leases().insert(id.clone(), lease);
        // Another process may have finished the case before this one had the lease.
        let attempt = match self.settled(&job.case) {
            Ok(Some(record)) => Ok(Attempt::Settled(Box::new(record))),
            Ok(None) => self.run_leased(job),
            Err(error) => Err(error),
        };
        if !self.lock_unsynced().cases.contains(id) {
            drop(self.lock_leases().remove(id));
        }
        self.sync_if_due()?;
        attempt
    }

    /// Syncs the finished cases if the last time was long enough ago.
    fn sync_if_due(&self) -> Result<(), ResultsError> {
        let is_due = {
            let mut unsynced = self.lock_unsynced();
            let is_due = unsynced.since.elapsed() >= BETWEEN_SYNCS && !unsynced.cases.is_empty();
            if is_due {
                // Other threads continue meanwhile.
                unsynced.since = Instant::now();
            }
            is_due
        };
        if is_due { self.sync_finished() } else { Ok(()) }
    }

    /// Waits until all finished cases are on the disk, and releases them.
    pub fn sync_finished(&self) -> Result<(), ResultsError> {
        let cases = std::mem::take(&mut self.lock_unsynced().cases);
        if cases.is_empty() {
            return Ok(());
        }
        sync_file_system(self.directory.path())?;
        let mut leases = self.lock_leases();
        for id in cases {
            drop(leases.remove(&id));
        }
        Ok(())
    }

    /// The record of a case that needs no further work.
    fn settled(&self, case: &Case) -> Result<Option<CaseRecord>, ResultsError> {
        let record = self.case_table.look_up(&case.id)?;
        let again = self.options.retry_failed
            && record.status != CaseStatus::Finished
            && !self.lock_retried().contains(&case.id);
        Ok((record.status.is_final() && !again).then_some(record))
    }

    fn run_leased(&self, job: &Job) -> Result<Attempt, ResultsError> {
        let id = &job.case.id;
        let before = self.case_table.look_up(id)?;
        let is_lost = self.case_table.is_lost(id);
        if is_lost {
            self.bars.suspend(|| {
                tracing::warn!(
                    "case `{id}` runs again: its process died before its files were on the disk"
                );
            });
        }
        let again = before.status.is_final() || is_lost;
        if again {
            self.lock_retried().insert(id.clone());
            self.case_table.forget(id);
        }
        let record = match self.prepare(job) {
            Ok(None) => self.case_table.look_up(id)?,
            Ok(Some(prepared)) => match self.run_prepared(job, &prepared, again) {
                Err(RunError::Results(ResultsError::Locked { .. })) => return Ok(Attempt::Held),
                Err(RunError::Results(error)) => return Err(error),
                Err(RunError::Scene(error)) => self.record_invalid(job, error.to_string())?,
                // The manifest of the case records its end.
                Ok(_)
                | Err(
                    RunError::Simulation { .. }
                    | RunError::TimeLimit { .. }
                    | RunError::Interrupted { .. },
                ) => self.case_table.look_up(id)?,
            },
            Err(error) => self.record_invalid(job, error.to_string())?,
        };
        self.case_table.commit(id, record.clone());
        let (status, wall_time) = (record.status.in_words(), record.wall_time);
        tracing::info!(case = %id, status, wall_time, "case ends");
        if record.status.is_final() && record.status != CaseStatus::Finished {
            let error = record.error.as_deref().unwrap_or_default();
            self.bars.suspend(|| {
                tracing::warn!("case `{id}`: {}: {error}", record.status.in_words());
            });
            if self.options.fail_fast {
                self.stopped.store(true, Ordering::Relaxed);
            }
        }
        Ok(Attempt::Settled(Box::new(record)))
    }

    /// Runs a case and computes its derivatives; `None` if it was stopped before these were found.
    fn prepare(&self, job: &Job) -> Result<Option<PreparedRun>, ScenarioError> {
        let (index, searched) = (job.index, job.searched);
        let source = |more: &[String]| self.case_set.changed_scenario(index, searched, more);
        let mut prepared = prepared(&source(&[])?)?;
        if let Some(asked) = self.case_set.derivatives() {
            let goes_on = || self.stop_of_case().is_none();
            let Some(found) = CaseDerivatives::of_case(asked, &source, &goes_on) else {
                return Ok(None);
            };
            prepared.observers.push(Box::new(found));
        }
        Ok(Some(prepared))
    }

    /// The request that stops a running case.
    fn stop_of_case(&self) -> Option<StopRequest> {
        let given_up = self.fault.get().map(|_| StopRequest::Interrupt);
        self.interruption.requested().or(given_up)
    }

    fn run_prepared(&self, job: &Job, prepared: &PreparedRun, again: bool) -> Result<(), RunError> {
        let options = RunOptions {
            directory: self.directory.case(&job.case.id),
            force: again,
            among: Some(AmongBars {
                bars: self.bars.clone(),
                name: job.case.id.clone(),
            }),
            ..self.options.run.clone()
        };
        let later = LaterSync::begin();
        let ran = run_until(prepared, &options, &|| self.stop_of_case());
        if later.is_needed() {
            self.lock_unsynced().cases.insert(job.case.id.clone());
        }
        ran.map(drop)
    }

    /// Writes a manifest with the reason why a case could not be started.
    fn record_invalid(&self, job: &Job, error: String) -> Result<CaseRecord, ResultsError> {
        let directory = self.directory.case(&job.case.id);
        let record = CaseRecord {
            error: Some(error),
            ..CaseRecord::new(CaseStatus::Invalid)
        };
        let io = |source| ResultsError::NotWritable {
            directory: directory.clone(),
            source,
        };
        std::fs::create_dir_all(&directory).map_err(io)?;
        Manifest {
            cases: BTreeMap::from([(MAIN_CASE.to_owned(), record.clone())]),
            ..self.case_table.manifest().clone()
        }
        .write(&directory)?;
        Ok(record)
    }

    fn give_up(&self, error: ResultsError) {
        // The first of several faults is reported.
        let _ = self.fault.set(error);
        self.stopped.store(true, Ordering::Relaxed);
    }

    /// Whether no further case may start.
    pub fn stops(&self) -> bool {
        self.stopped.load(Ordering::Relaxed) || self.stop_request().is_some()
    }

    fn stop_request(&self) -> Option<StopRequest> {
        let late = self
            .deadline
            .is_some_and(|deadline| Instant::now() >= deadline);
        self.interruption
            .requested()
            .or(late.then_some(StopRequest::TimeLimit))
    }

    /// States of the cases of this process.
    pub fn outcome<'c>(&self, cases: impl IntoIterator<Item = &'c Case>) -> SweepOutcome {
        let counts = self.case_table.counts(cases);
        let is_over = counts.unfinished == 0;
        SweepOutcome {
            directory: self.directory.path().to_owned(),
            counts,
            interrupted: self.stop_request().filter(|_| !is_over),
            found: Vec::new(),
            tables_are_old: false,
        }
    }

    /// The fault that aborted the sweep.
    pub fn into_fault(self) -> Option<ResultsError> {
        self.fault.into_inner()
    }

    fn whole_bar(&self, length: usize) -> ProgressBar {
        if !self.options.run.progress {
            return ProgressBar::hidden();
        }
        let style =
            ProgressStyle::with_template("{pos} of {len} cases {wide_bar} {msg} {eta} left")
                .expect("the template is right");
        self.bars
            .add(ProgressBar::new(length as u64).with_style(style))
    }

    fn lock_leases(
        &self,
    ) -> std::sync::MutexGuard<'_, BTreeMap<String, rodlab_files::results::Lease>> {
        self.leased.lock().expect("no thread panics with this lock")
    }

    fn lock_unsynced(&self) -> std::sync::MutexGuard<'_, Unsynced> {
        self.unsynced
            .lock()
            .expect("no thread panics with this lock")
    }

    fn lock_retried(&self) -> std::sync::MutexGuard<'_, BTreeSet<String>> {
        self.retried
            .lock()
            .expect("no thread panics with this lock")
    }
}
