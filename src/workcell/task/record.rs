//! What all tasks leave in a results directory: `manifest.json` for programs and `report.md` for people.

use super::error::{TaskError, TaskStage};
use super::stopped::Stopped;
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
        let because = self.error.iter();
        let because = because.map(|error| ("because", error.clone()));
        let status = ("status", self.status.in_words().to_owned());
        let stopped = self.stopped.iter().flat_map(Stopped::rows);
        std::iter::once(status)
            .chain(because)
            .chain(stopped)
            .collect()
    }
}

/// What a task leaves.
pub trait TaskRecord: Serialize {
    /// What is known of any task.
    fn head(&mut self) -> &mut TaskHead;

    /// The text of `report.md`, with the pictures that are in a directory.
    fn report(&self, directory: &Path) -> String;

    /// Writes `manifest.json` and `report.md`.
    ///
    /// # Errors
    /// They cannot be written.
    fn write(&self, directory: &Path) -> Result<(), ResultsError> {
        write_manifest(self, directory)?;
        write_whole(
            &directory.join("report.md"),
            self.report(directory).as_bytes(),
        )
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

/// Adds the pictures that are in a directory to a report.
pub fn add_pictures<'a>(
    text: &mut String,
    directory: &Path,
    pictures: impl IntoIterator<Item = (&'a str, &'a str)>,
) {
    for (name, words) in pictures {
        if directory.join(name).is_file() {
            *text += &format!("\n![{words}]({name})\n");
        }
    }
}
