//! States of all cases of a sweep, and the tables of the whole sweep.

use super::outcome::CaseCounts;
use crate::scenario::{Case, CaseSet, Parameter};
use rodlab_files::results::{
    CaseRecord, CaseStatus, MAIN_CASE, Manifest, ResultsError, SummaryRow, SweepDirectory,
    check_quickly, write_sweep_summary, write_timings,
};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Least time between two writes of the tables while cases run.
const INTERVAL: Duration = Duration::from_secs(1);
/// Maximum number of cases whose tables are written during the sweep, in about half a second: each
/// case takes up to 50 µs. Tables of larger sweeps are written at the end, or by `rodlab gather`.
const QUICKLY_PUBLISHED: usize = 10_000;
/// Least ratio of the time between two writes to the duration of a write.
const PAUSE_FACTOR: u32 = 50;

/// States of the cases as last read by this process.
pub(super) struct CaseTable<'a> {
    directory: &'a SweepDirectory,
    keys: Vec<String>,
    manifest: Manifest,
    state: Mutex<State>,
}

struct State {
    /// Records of cases that only this process can still change.
    settled: BTreeMap<String, CaseRecord>,
    next_writing: Instant,
}

/// The record of the case in a directory; `None` if it was not started.
///
/// # Errors
/// [`ResultsError::Altered`] if files of a finished case are missing or changed, see
/// [`check_quickly`].
pub(super) fn record_in(directory: &Path) -> Result<Option<CaseRecord>, ResultsError> {
    let Some(mut manifest) = Manifest::read(directory)? else {
        return Ok(None);
    };
    if manifest.is_finished() {
        check_quickly(directory, &manifest.files)?;
    }
    Ok(manifest.cases.remove(MAIN_CASE))
}

impl<'a> CaseTable<'a> {
    /// An empty table of cases. `manifest` is that of the whole sweep.
    pub fn new(directory: &'a SweepDirectory, case_set: &CaseSet, manifest: Manifest) -> Self {
        Self {
            directory,
            keys: case_set.keys().into_iter().map(str::to_owned).collect(),
            manifest,
            state: Mutex::new(State {
                settled: BTreeMap::new(),
                next_writing: Instant::now() + INTERVAL,
            }),
        }
    }

    /// Current state of a case, from its own directory.
    pub fn look_up(&self, id: &str) -> Result<CaseRecord, ResultsError> {
        let record = match record_in(&self.directory.case(id)) {
            Err(ResultsError::Altered { .. }) if self.directory.leases.is_left_by_dead(id) => None,
            record => record?,
        };
        let record = record.unwrap_or_else(|| CaseRecord::new(CaseStatus::Pending));
        if record.status.is_final() {
            self.commit(id, record.clone());
        }
        Ok(record)
    }

    /// Whether files of a finished case were lost with the power of the machine: they are not those
    /// in its manifest, and its process died before they were synced.
    pub fn is_lost(&self, id: &str) -> bool {
        let record = record_in(&self.directory.case(id));
        matches!(record, Err(ResultsError::Altered { .. }))
            && self.directory.leases.is_left_by_dead(id)
    }

    /// Records the state of a case of this process.
    pub fn commit(&self, id: &str, record: CaseRecord) {
        let mut state = self.state.lock().expect("no thread panics with this lock");
        state.settled.insert(id.to_owned(), record);
    }

    /// Removes a case that is to be run again.
    pub fn forget(&self, id: &str) {
        let mut state = self.state.lock().expect("no thread panics with this lock");
        state.settled.remove(id);
    }

    /// State of a case when it was last read.
    fn known(&self, id: &str) -> Option<CaseRecord> {
        let state = self.state.lock().expect("no thread panics with this lock");
        state.settled.get(id).cloned()
    }

    /// The manifest with which the sweep began.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Counts the cases as they were last seen.
    pub fn counts<'c>(&self, cases: impl IntoIterator<Item = &'c Case>) -> CaseCounts {
        let mut counts = CaseCounts::default();
        for case in cases {
            let record = self.known(&case.id);
            let remarked = record
                .as_ref()
                .is_some_and(|record| !record.outcome.remarks.is_empty());
            counts.remarked += usize::from(remarked);
            counts.add(record.map_or(CaseStatus::Pending, |record| record.status));
        }
        counts
    }

    /// Writes the tables if the last write was long enough ago. Does nothing for a large sweep.
    pub fn publish_if_due(&self, cases: &[Case]) -> Result<(), ResultsError> {
        if cases.len() > QUICKLY_PUBLISHED {
            // A request to stop would have to wait for the tables.
            return Ok(());
        }
        {
            let mut state = self.state.lock().expect("no thread panics with this lock");
            if Instant::now() < state.next_writing {
                return Ok(());
            }
            // No other thread tries while this thread writes.
            state.next_writing = Instant::now() + Duration::from_secs(3600);
        }
        let start = Instant::now();
        let written = self.write(cases, None);
        let pause = INTERVAL.max(PAUSE_FACTOR * start.elapsed());
        let mut state = self.state.lock().expect("no thread panics with this lock");
        state.next_writing = Instant::now() + pause;
        written
    }

    /// Writes the tables of a stopped sweep, unless the sweep is so large that this would take
    /// longer than a second. Returns whether the tables were written.
    pub fn publish_if_quick(&self, cases: &[Case]) -> Result<bool, ResultsError> {
        let quick = cases.len() <= QUICKLY_PUBLISHED;
        if quick {
            self.publish(cases)?;
        }
        Ok(quick)
    }

    /// Writes summary, timings and manifest of the whole sweep, with rows in the order of `cases`.
    pub fn publish(&self, cases: &[Case]) -> Result<(), ResultsError> {
        self.write(cases, Some(jiff::Timestamp::now()))?;
        let counts = self.counts(cases);
        if counts.finished == counts.total() {
            self.directory.leases.remove_dead()?;
        }
        Ok(())
    }

    fn write(&self, cases: &[Case], end: Option<jiff::Timestamp>) -> Result<(), ResultsError> {
        // No other process reads the tables between this read and write, so the last writer has
        // all records.
        self.directory.write_alone(|path| {
            let mut rows = Vec::with_capacity(cases.len());
            let mut records = Vec::with_capacity(cases.len());
            for case in cases {
                let record = match self.known(&case.id) {
                    Some(record) => record,
                    None => self.look_up(&case.id)?,
                };
                let values = case.parameters.iter().map(Parameter::column).collect();
                rows.push((
                    values,
                    SummaryRow::new(&case.id, record.status, &record.outcome),
                ));
                records.push((case.id.as_str(), record));
            }
            let keys: Vec<&str> = self.keys.iter().map(String::as_str).collect();
            write_sweep_summary(path, &keys, &rows)?;
            let timings = records.iter().map(|(id, record)| (*id, record.usage()));
            write_timings(path, &timings.collect::<Vec<_>>())?;
            // The record of the process that started the sweep; others may have read the scenario
            // from this directory.
            let first = Manifest::read(path)?.unwrap_or_else(|| self.manifest.clone());
            let mut manifest = Manifest {
                name: first.name,
                start: first.start,
                end,
                cases: records
                    .into_iter()
                    .map(|(id, record)| (id.to_owned(), record))
                    .collect(),
                ..self.manifest.clone()
            };
            manifest.mark_whole_files(path)?;
            manifest.write(path)
        })
    }
}
