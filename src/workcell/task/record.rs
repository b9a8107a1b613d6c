//! The record of all tasks in a results directory: `manifest.json` for programs and `report.md` for people.

use super::error::{TaskError, WorkError};
use super::stage::Stage;
use super::stopped::Stopped;
use rodlab_files::figure::{document_page, escape_markdown};
use rodlab_files::origin::VERSION;
use rodlab_files::results::{MANIFEST, ResultsError, write_whole};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Status of a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Planned only.
    Planned,
    /// In progress.
    Running,
    /// Done.
    Finished,
    /// Carried out but not scored, since the camera does not show the whole rod.
    NotSeenWhole,
    /// Failed.
    Failed,
    /// Interrupted by the user.
    Interrupted,
}

impl Status {
    /// Returns the status as text.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Planned => "planned, and nothing moved",
            Self::Running => "in progress",
            Self::Finished => "finished",
            Self::NotSeenWhole => "not seen whole, and not scored",
            Self::Failed => "failed",
            Self::Interrupted => "interrupted",
        }
    }
}

/// Record common to all tasks, with which `manifest.json` begins.
#[derive(Clone, Debug, Serialize)]
pub struct TaskHead {
    /// Version of the program.
    pub version: &'static str,
    /// Command line of the task.
    pub command_line: Vec<String>,
    /// File of the cell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cell_file: Option<PathBuf>,
    /// Time of the start.
    pub start: jiff::Timestamp,
    /// Time of the end.
    pub end: Option<jiff::Timestamp>,
    /// Status.
    pub status: Status,
    /// Reason for an early end.
    pub error: Option<String>,
    /// State of the cell after an early end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopped: Option<Stopped>,
    /// Completed steps with their durations, s, on the clock of this machine.
    pub times_s: Vec<(Stage, f64)>,
}

impl TaskHead {
    /// Record of a task that is planned now, with its command line.
    pub fn planned(command_line: Vec<String>) -> Self {
        Self {
            version: VERSION,
            command_line,
            cell_file: None,
            start: jiff::Timestamp::now(),
            end: None,
            status: Status::Planned,
            error: None,
            stopped: None,
            times_s: Vec::new(),
        }
    }

    /// Records that the task has ended now; early if there is an error.
    pub fn ended(&mut self, error: Option<&TaskError>) {
        self.end = Some(jiff::Timestamp::now());
        self.error = error.map(ToString::to_string);
        self.status = match error.map(|error| &error.error) {
            None => Status::Finished,
            Some(WorkError::Interrupted) => Status::Interrupted,
            Some(WorkError::NotSeenWhole(_)) => Status::NotSeenWhole,
            Some(WorkError::Failed(_) | WorkError::Results(_)) => Status::Failed,
        };
    }
}

/// Record of a specific task, in addition to the common record.
pub trait TaskRecord: Serialize {
    /// Builds the report, with the pictures in a directory.
    fn report(&self, head: &TaskHead, directory: &Path) -> Report;

    /// JSON answer of the command; `None` if it is the whole manifest.
    fn answer(&self) -> Option<serde_json::Value> {
        None
    }
}

/// Writes `manifest.json`.
///
/// # Errors
/// The file cannot be written.
pub fn write_manifest<R: Serialize + ?Sized>(
    record: &R,
    directory: &Path,
) -> Result<(), ResultsError> {
    let mut text = serde_json::to_vec_pretty(record).expect("names and numbers are JSON values");
    text.push(b'\n');
    write_whole(&directory.join(MANIFEST), &text)
}

/// File name and caption of the picture with the detected rod.
pub const OVERLAY: (&str, &str) = (
    "overlay.png",
    "Picture of the camera, with the rod that was found",
);

/// A report: a title, a table of two columns, then text in Markdown.
pub struct Report {
    title: String,
    rows: Vec<(String, String)>,
    /// The text after the table, Markdown.
    pub text: String,
}

impl Report {
    /// A report with a title and a table without rows.
    pub fn new(title: &str) -> Self {
        Self {
            title: title.to_owned(),
            rows: Vec::new(),
            text: String::new(),
        }
    }

    /// Adds a row to the table.
    pub fn row(&mut self, name: &str, value: impl Into<String>) {
        self.rows.push((name.to_owned(), value.into()));
    }

    /// The table in aligned columns, after the title.
    pub fn table(&self) -> String {
        let width = |(name, _): &(String, String)| name.chars().count();
        let widest = self.rows.iter().map(width).max().unwrap_or(0);
        let rows = self.rows.iter();
        let rows = rows.map(|(name, value)| format!("{name:<widest$}  {value}\n"));
        format!("{}\n{}", self.title, rows.collect::<String>())
    }

    /// The whole report as Markdown.
    pub fn markdown(&self) -> String {
        let rows = self.rows.iter();
        let rows = rows.map(|(name, value)| format!("| {name} | {} |\n", escape_markdown(value)));
        format!(
            "# {}\n\n| | |\n|---|---|\n{}{}",
            escape_markdown(&self.title),
            rows.collect::<String>(),
            self.text
        )
    }

    /// Writes `report.md`, and `report.html` with embedded pictures.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, directory: &Path) -> Result<(), ResultsError> {
        self.write_text(directory)?;
        let picture = |name: &str| std::fs::read(directory.join(name)).ok();
        let page = document_page(&self.title, &self.markdown(), &picture);
        write_whole(&directory.join("report.html"), page.as_bytes())
    }

    /// Writes `report.md` alone.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_text(&self, directory: &Path) -> Result<(), ResultsError> {
        write_whole(&directory.join("report.md"), self.markdown().as_bytes())
    }

    /// Adds rows to the table: the status of a task, and the reason for an early end.
    pub fn head(&mut self, head: &TaskHead) {
        self.row("status", head.status.in_words());
        if let Some(error) = &head.error {
            self.row("because", error.as_str());
        }
        for (name, value) in head.stopped.iter().flat_map(Stopped::rows) {
            self.row(name, value);
        }
    }

    /// Adds rows to the table: the duration of each step, s. A virtual cell may be faster or
    /// slower than its own clock.
    pub fn times(&mut self, head: &TaskHead) {
        for (stage, time) in &head.times_s {
            let time = format!("{time:.1} s by the clock of this machine");
            self.row(&stage.words, time);
        }
    }

    /// Adds a row to the table: the duration of a motion, s.
    pub fn duration(&mut self, name: &str, duration: f64) {
        self.row(name, format!("{duration:.1} s by the clock of the cell"));
    }

    /// Adds rows to the table: the duration of a motion, s, and its clearance, m.
    pub fn motion(&mut self, duration: f64, clearance: f64) {
        self.duration("motion", duration);
        self.row(
            "least distance to anything else",
            format!("{:.0} mm", 1e3 * clearance),
        );
    }

    /// Adds a link, with the given text, to the 3-D page of a motion.
    pub fn page(&mut self, words: &str) {
        self.text += &format!("\n[{words}](cell.html)\n");
    }

    /// Adds those of the named pictures that exist in a directory.
    pub fn pictures<N: AsRef<str>>(
        &mut self,
        directory: &Path,
        pictures: impl IntoIterator<Item = (N, N)>,
    ) {
        for (name, words) in pictures {
            let (name, words) = (name.as_ref(), words.as_ref());
            if directory.join(name).is_file() {
                self.text += &format!("\n![{words}]({name})\n");
            }
        }
    }
}
