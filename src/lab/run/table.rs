//! A run whose result is a table of independent rows.
//!
//! Rows are computed in blocks, in parallel, and written in order. An interrupted run resumes
//! after the last complete block of the file: the table is its own checkpoint.

use super::prepared::{PreparedRun, TableRun};
use super::records::manifest_of_call;
use super::stop::{Stop, StopRequests};
use super::{Reached, RunError, RunOptions, RunOutcome, RunStatus, open_results};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use rodlab_files::results::{
    CaseOutcome, CaseRecord, CaseStatus, CsvStream, FileMark, FileMarks, MAIN_CASE, Manifest,
    Opened, ResultsDirectory, ResultsError, Usage, UsageMeter, WholeRows, check_files,
    read_whole_rows, sync,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt::Debug;
use std::ops::Range;
use std::path::Path;
use std::sync::OnceLock;
use tracing::info;

/// Rows per block. Larger blocks use the threads more evenly; smaller ones lose less work when
/// interrupted.
const BLOCK: usize = 256;

/// Job that fills a table.
pub trait TableJob: Debug + Send + Sync {
    /// A row of the table. Floats are read back bit for bit.
    type Row: Serialize + DeserializeOwned + Send;

    /// Name of the file of the table.
    const TABLE: &'static str;
    /// Noun for the rows, in the plural.
    const ROWS: &'static str;

    /// Number of rows.
    fn count(&self) -> usize;
    /// Computes a row, which records its own faults. `None` if `goes_on` returned false, which it
    /// then always does.
    fn row(&self, index: usize, goes_on: &(dyn Fn() -> bool + Sync)) -> Option<Self::Row>;
    /// Writes files derived from the whole table; returns remarks for the user.
    ///
    /// # Errors
    /// Files that cannot be written.
    fn conclude(&self, rows: &[Self::Row], directory: &Path) -> Result<Vec<String>, ResultsError>;
}

impl<Job: TableJob> TableRun for Job {
    fn rows(&self) -> usize {
        self.count()
    }

    fn run(
        &self,
        prepared: &PreparedRun,
        options: &RunOptions,
        stop_requested: StopRequests<'_>,
    ) -> Result<RunOutcome, RunError> {
        run_table(self, prepared, options, stop_requested)
    }
}

fn run_table<Job: TableJob>(
    job: &Job,
    prepared: &PreparedRun,
    options: &RunOptions,
    stop_requested: StopRequests<'_>,
) -> Result<RunOutcome, RunError> {
    let directory = match open_results(prepared, options)? {
        Opened::Finished(manifest) => {
            return Ok(RunOutcome::already_finished(&manifest, prepared, options));
        }
        Opened::Ready(directory) => directory,
    };
    let earlier = directory.unfinished().and_then(|manifest| {
        let case = manifest.cases.get(MAIN_CASE)?;
        Some(case.usage())
    });
    let WholeRows { rows, length } = rows_so_far::<Job>(&directory, job.count())?;
    let mut session = TableSession {
        meter: UsageMeter::start(),
        earlier: earlier.unwrap_or_default(),
        rows,
        length,
        mark: None,
        job,
        directory,
        options,
    };
    let begun = session.rows.len();
    let mut manifest =
        manifest_of_call(prepared, options, session.directory.unfinished(), begun > 0);
    manifest.place(session.directory.path())?;
    let result = session.fill(stop_requested).and_then(|()| {
        let path = session.directory.path();
        Ok(job.conclude(&session.rows, path)?)
    });
    let written = session.write_tables(&mut manifest, &result);
    let path = session.directory.path().to_owned();
    match result {
        Ok(_) => {
            let case = written?;
            Ok(RunOutcome {
                directory: path,
                status: match begun {
                    0 => RunStatus::Finished,
                    _ => RunStatus::Resumed {
                        from: Reached::Rows(begun),
                    },
                },
                case,
                wall_time: session.usage().wall_time,
                highlights: Vec::new(),
            })
        }
        Err(stop) => {
            let reached = Reached::Rows(session.rows.len());
            Err(stop.into_error(reached, path))
        }
    }
}

/// One call on a results directory.
struct TableSession<'a, Job: TableJob> {
    job: &'a Job,
    directory: ResultsDirectory,
    options: &'a RunOptions,
    meter: UsageMeter,
    earlier: Usage,
    rows: Vec<Job::Row>,
    /// Number of bytes of the table that these rows took at the start.
    length: u64,
    /// The table as last written.
    mark: Option<FileMark>,
}

impl<Job: TableJob> TableSession<'_, Job> {
    fn fill(&mut self, stop_requested: StopRequests<'_>) -> Result<(), Stop> {
        let path = self.directory.file(Job::TABLE);
        let mut stream = match self.length {
            0 => CsvStream::create(&path)?,
            length => CsvStream::continue_unmarked(&path, length)?,
        };
        sync(self.directory.path())?;
        self.mark = Some(stream.sync()?);
        let bar = self.bar();
        let stopped = OnceLock::new();
        let goes_on = || {
            let request = || stop_requested().map(|request| stopped.get_or_init(|| request));
            stopped.get().is_none() && request().is_none()
        };
        while self.rows.len() < self.job.count() {
            let block: Vec<Option<Job::Row>> = block_after(self.rows.len(), self.job.count())
                .into_par_iter()
                .map(|index| goes_on().then(|| self.job.row(index, &goes_on)).flatten())
                .collect();
            // Rows after an interrupted one are discarded, so that the table has no gaps.
            let block: Vec<Job::Row> = block.into_iter().map_while(|row| row).collect();
            for row in &block {
                stream.write(row)?;
            }
            self.mark = Some(stream.sync()?);
            bar.inc(block.len() as u64);
            self.rows.extend(block);
            info!(
                rows = self.rows.len(),
                of = self.job.count(),
                "rows written"
            );
            if let Some(request) = stopped.get() {
                return Err((*request).into());
            }
        }
        bar.finish_and_clear();
        Ok(())
    }

    fn bar(&self) -> ProgressBar {
        let template =
            |text: &str| ProgressStyle::with_template(text).expect("the template is right");
        let count = self.job.count() as u64;
        let bar = match &self.options.among {
            _ if !self.options.progress => ProgressBar::hidden(),
            None => ProgressBar::new(count).with_style(template(&format!(
                "{{wide_bar}} {{pos}} of {{len}} {}, {{eta}} left",
                Job::ROWS
            ))),
            Some(among) => among.bars.add(
                ProgressBar::new(count)
                    .with_style(template("{prefix:.dim} {bar:20} {pos} of {len}"))
                    .with_prefix(among.name.clone()),
            ),
        };
        bar.set_position(self.rows.len() as u64);
        // The progress of an earlier call must not affect the estimated speed.
        bar.reset_eta();
        bar
    }

    fn usage(&self) -> Usage {
        self.earlier + self.meter.usage()
    }

    fn write_tables(
        &self,
        manifest: &mut Manifest,
        result: &Result<Vec<String>, Stop>,
    ) -> Result<CaseOutcome, ResultsError> {
        // A table has no time steps.
        let outcome = CaseOutcome {
            remarks: result.as_ref().cloned().unwrap_or_default(),
            ..CaseOutcome::default()
        };
        let stop = result.as_ref().err();
        let status = stop.map_or(CaseStatus::Finished, Stop::status);
        let record = CaseRecord::with_usage(
            status,
            outcome.clone(),
            self.usage(),
            stop.map(Stop::reason),
        );
        let table = self.mark.clone().map(|mark| (Job::TABLE.to_owned(), mark));
        let files = FileMarks::from_iter(table);
        manifest.conclude(self.directory.path(), record, files)?;
        Ok(outcome)
    }
}

/// The next block. Blocks start at multiples of their size, wherever the table begins.
fn block_after(done: usize, count: usize) -> Range<usize> {
    done..((done / BLOCK + 1) * BLOCK).min(count)
}

/// The rows of an unfinished table; empty if it cannot be read.
///
/// # Errors
/// [`ResultsError::Altered`] if the file has changed since the previous call.
fn rows_so_far<Job: TableJob>(
    directory: &ResultsDirectory,
    count: usize,
) -> Result<WholeRows<Job::Row>, ResultsError> {
    let nothing = WholeRows {
        rows: Vec::new(),
        length: 0,
    };
    let Some(unfinished) = directory.unfinished() else {
        return Ok(nothing);
    };
    // A killed call has recorded no hash.
    check_files(directory.path(), &unfinished.files)?;
    let path = directory.file(Job::TABLE);
    if !path.exists() {
        return Ok(nothing);
    }
    Ok(match read_whole_rows(&path) {
        Ok(whole) if whole.rows.len() <= count => whole,
        Ok(_) => nothing,
        Err(error) => {
            tracing::warn!("{error}: starting again");
            nothing
        }
    })
}
