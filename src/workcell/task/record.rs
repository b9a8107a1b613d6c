//! What all tasks leave in a results directory: `manifest.json` for programs and `report.md` for people.

use super::error::{TaskError, TaskStage};
use super::stopped::Stopped;
use rodlab_files::figure::{document_page, escape_markdown};
use rodlab_files::origin::VERSION;
use rodlab_files::results::{MANIFEST, ResultsError, write_whole};
use serde::Serialize;
use std::path::Path;

/// How far a task has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// It was planned only.
    Planned,
    /// It goes on.
    Running,
    /// It is done.
    Finished,
    /// It was carried out, but the camera does not show the whole rod: nothing is scored.
    NotSeenWhole,
    /// Something went wrong.
    Failed,
    /// Somebody asked for the end.
    Interrupted,
}

impl Status {
    /// In words.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Planned => "planned, and nothing moved",
            Self::Running => "under way",
            Self::Finished => "finished",
            Self::NotSeenWhole => "not seen whole, and not scored",
            Self::Failed => "failed",
            Self::Interrupted => "interrupted",
        }
    }
}

/// What is known of any task: how `manifest.json` begins.
#[derive(Clone, Debug, Serialize)]
pub struct TaskHead {
    /// Version of the program.
    pub version: &'static str,
    /// As it was called.
    pub command_line: Vec<String>,
    /// When it began.
    pub start: jiff::Timestamp,
    /// When it ended.
    pub end: Option<jiff::Timestamp>,
    /// How far it came.
    pub status: Status,
    /// Why no further.
    pub error: Option<String>,
    /// How the cell was left where it ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopped: Option<Stopped>,
}

impl TaskHead {
    /// Of a task that is planned now, by a command line.
    pub fn planned(command_line: Vec<String>) -> Self {
        Self {
            version: VERSION,
            command_line,
            start: jiff::Timestamp::now(),
            end: None,
            status: Status::Planned,
            error: None,
            stopped: None,
        }
    }

    /// It ended now, early where there is an error.
    pub fn ended<S: TaskStage>(&mut self, error: Option<&TaskError<S>>) {
        self.end = Some(jiff::Timestamp::now());
        self.error = error.map(ToString::to_string);
        self.status = match error {
            None => Status::Finished,
            Some(TaskError::Interrupted { .. }) => Status::Interrupted,
            Some(TaskError::NotSeenWhole(_)) => Status::NotSeenWhole,
            Some(_) => Status::Failed,
        };
    }

    /// Rows of a report: how far it came, and why no further.
    pub fn rows(&self) -> Vec<(&'static str, String)> {
        let mut rows = vec![("status", self.status.in_words().to_owned())];
        rows.extend(self.error.iter().map(|error| ("because", error.clone())));
        rows.extend(self.stopped.iter().flat_map(Stopped::rows));
        rows
    }
}

/// What a task leaves.
pub trait TaskRecord: Serialize {
    /// What is known of any task.
    fn head(&mut self) -> &mut TaskHead;

    /// The report, with the pictures that are in a directory.
    fn report(&self, directory: &Path) -> Report;

    /// Writes `manifest.json` and the report, which is returned.
    ///
    /// # Errors
    /// They cannot be written.
    fn write(&self, directory: &Path) -> Result<Report, ResultsError> {
        write_manifest(self, directory)?;
        let report = self.report(directory);
        report.write(directory)?;
        Ok(report)
    }
}

/// Writes `manifest.json`.
///
/// # Errors
/// It cannot be written.
pub fn write_manifest<R: Serialize + ?Sized>(
    record: &R,
    directory: &Path,
) -> Result<(), ResultsError> {
    let mut text = serde_json::to_vec_pretty(record).expect("names and numbers are JSON values");
    text.push(b'\n');
    write_whole(&directory.join(MANIFEST), &text)
}

/// The picture with the rod that was found in it, and its words.
pub const OVERLAY: (&str, &str) = (
    "overlay.png",
    "What the camera saw, with the rod that was found",
);

/// A report: a title, a table of two columns, then text in Markdown.
pub struct Report {
    title: String,
    rows: Vec<(String, String)>,
    /// The text behind the table, Markdown.
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

    /// The table in aligned columns, with the title before it.
    pub fn table(&self) -> String {
        let width = |(name, _): &(String, String)| name.chars().count();
        let widest = self.rows.iter().map(width).max().unwrap_or(0);
        let rows = self.rows.iter();
        let rows = rows.map(|(name, value)| format!("{name:<widest$}  {value}\n"));
        format!("{}\n{}", self.title, rows.collect::<String>())
    }

    /// All of it as Markdown.
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

    /// Writes `report.md`, and `report.html`, which holds its pictures.
    ///
    /// # Errors
    /// They cannot be written.
    pub fn write(&self, directory: &Path) -> Result<(), ResultsError> {
        let markdown = self.markdown();
        let picture = |name: &str| std::fs::read(directory.join(name)).ok();
        let page = document_page(&self.title, &markdown, &picture);
        write_whole(&directory.join("report.md"), markdown.as_bytes())?;
        write_whole(&directory.join("report.html"), page.as_bytes())
    }

    /// Adds rows to the table: how far a task came, and why no further.
    pub fn head(&mut self, head: &TaskHead) {
        for (name, value) in head.rows() {
            self.row(name, value);
        }
    }

    /// Adds rows to the table: the time that each stage took, s.
    pub fn times<S: TaskStage>(&mut self, times: &[(S, f64)]) {
        for (stage, time) in times {
            self.row(stage.in_words(), format!("{time:.1} s"));
        }
    }

    /// Adds the 3-D page of a motion, with the words of the link.
    pub fn page(&mut self, words: &str) {
        self.text += &format!("\n[{words}](cell.html)\n");
    }

    /// Adds the pictures that are in a directory.
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
