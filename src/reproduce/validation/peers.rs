//! The same cases by other programs, which `pip` installs: their scripts, runs and rows.
//!
//! A script is a Python file beside the page. It prints one JSON object a line, with a quantity and
//! its value. The lines of a run are kept among the runs of all artefacts, under the hash of the
//! script, so that a run is made once. A program that is not installed is left out.

mod catalogue;
mod verdict;

pub(super) use catalogue::{LEFT_OUT, MODULES, PEERS};
pub(super) use verdict::{best_of_peers, verdict};

use super::benchmark::{Benchmark, BenchmarkRun, digits};
use crate::reproduce::page::stem;
use crate::reproduce::prelude::*;
use rodlab_files::results::{ResultsError, write_whole};
use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::process::Command;

/// Names the Python that runs the scripts.
const PYTHON: &str = "RODLAB_PYTHON";
/// Number of digits of the hash of a script in the name of its output.
const HASH_DIGITS: usize = 8;
/// Ends with 0 if the module named by its argument can be imported.
const FIND: &str =
    "import importlib.util, sys; sys.exit(importlib.util.find_spec(sys.argv[1]) is None)";

/// Another program.
#[derive(Debug, PartialEq)]
pub(super) struct Program {
    /// Name of the program.
    pub name: &'static str,
    /// The package that `pip` installs.
    pub package: &'static str,
    /// The module that its scripts import.
    pub module: &'static str,
    /// Name and text of the file with functions for its scripts.
    pub common: (&'static str, &'static str),
}

/// A case by another program.
pub(super) struct Peer {
    /// The last part of the name of the case.
    pub case: &'static str,
    /// The program.
    pub program: &'static Program,
    /// Name and text of the script.
    pub script: (&'static str, &'static str),
    /// The method, for the page.
    pub method: &'static str,
    /// The exact values of the problem that the program solves, if it differs from that of the case.
    pub exact: Option<fn() -> Vec<f64>>,
}

/// A row of the table of other programs: a quantity at a number of edges.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct PeerRow {
    pub case: String,
    pub program: String,
    pub version: String,
    pub quantity: String,
    pub edges: usize,
    pub value: f64,
    pub exact: f64,
    pub error: f64,
    pub cpu_time_s: f64,
}

/// A line that a script prints.
#[derive(Deserialize)]
struct Line {
    version: String,
    quantity: String,
    value: f64,
    time: f64,
}

/// End of the runs of a peer.
#[derive(Debug, PartialEq)]
pub(super) enum Outcome {
    /// Rows of all meshes.
    Rows(Vec<PeerRow>),
    /// The module cannot be imported.
    Absent,
    /// A script failed, with its last words.
    Failed(String),
}

/// The peers of a case.
pub(super) fn peers_of(case: &str) -> impl Iterator<Item = &'static Peer> {
    PEERS.iter().filter(move |peer| peer.case == case)
}

/// The Python that runs the scripts.
pub(super) fn python() -> OsString {
    std::env::var_os(PYTHON).unwrap_or_else(|| "python3".into())
}

impl Peer {
    /// Runs the script for each mesh of a case, or reads what earlier calls left in the folder of
    /// runs.
    pub fn rows(
        &self,
        benchmark: &Benchmark,
        cases: &[Case<BenchmarkRun>],
        python: &OsStr,
    ) -> Result<Outcome> {
        let exact = self.exact.unwrap_or(benchmark.exact)();
        let mut rows = Vec::new();
        for case in cases {
            let folder = case.directory.parent().unwrap_or(&case.directory);
            let text = match self.printed(folder, case.run.edges, python)? {
                Ok(text) => text,
                Err(outcome) => return Ok(outcome),
            };
            for line in text.lines() {
                let Ok(line) = serde_json::from_str::<Line>(line) else {
                    return Ok(Outcome::Failed(line.into()));
                };
                let mut all = benchmark.quantities.iter().zip(&exact);
                let Some((quantity, exact)) = all.find(|(known, _)| known.name == line.quantity)
                else {
                    return Ok(Outcome::Failed(format!(
                        "unknown quantity {}",
                        line.quantity
                    )));
                };
                rows.push(PeerRow {
                    case: self.case.into(),
                    program: self.program.name.into(),
                    version: line.version,
                    quantity: line.quantity,
                    edges: case.run.edges,
                    value: line.value,
                    exact: *exact,
                    error: (line.value - exact) / quantity.scale.unwrap_or(*exact),
                    cpu_time_s: line.time,
                });
            }
        }
        Ok(Outcome::Rows(rows))
    }

    /// The lines of the script at a number of edges.
    fn printed(
        &self,
        folder: &Path,
        edges: usize,
        python: &OsStr,
    ) -> Result<Result<String, Outcome>> {
        let mut hasher = blake3::Hasher::new();
        for (_, text) in self.files() {
            hasher.update(text.as_bytes());
        }
        let hash = hasher.finalize().to_hex();
        let program = self.program.module;
        let name = format!(
            "peer_{}_{program}_{edges}-{}.jsonl",
            self.case,
            &hash[..HASH_DIGITS]
        );
        let kept = folder.join(name);
        if let Ok(text) = std::fs::read_to_string(&kept) {
            return Ok(Ok(text));
        }
        if !has_module(python, program) {
            return Ok(Err(Outcome::Absent));
        }
        let scripts = tempfile::tempdir().map_err(|source| ResultsError::Io {
            action: "create",
            path: std::env::temp_dir(),
            source,
        })?;
        for (name, text) in self.files() {
            write_whole(&scripts.path().join(name), text.as_bytes())?;
        }
        let mut command = Command::new(python);
        command.arg(scripts.path().join(self.script.0));
        command.arg("--edges").arg(edges.to_string());
        let ended = command.current_dir(scripts.path()).output();
        let text = match ended {
            Ok(ended) if ended.status.success() => String::from_utf8_lossy(&ended.stdout).into(),
            Ok(ended) => return Ok(Err(Outcome::Failed(last_line(&ended.stderr)))),
            Err(error) => return Ok(Err(Outcome::Failed(error.to_string()))),
        };
        write_whole(&kept, String::as_bytes(&text))?;
        Ok(Ok(text))
    }

    /// Names and texts of the script and of the modules that it imports.
    fn files(&self) -> [(&'static str, &'static str); 3] {
        [self.script, self.program.common, catalogue::COMMON]
    }

    /// A sentence on the runs, for the page.
    pub fn note(&self, outcome: &Outcome) -> String {
        let Program { name, package, .. } = self.program;
        let script = self.script.0;
        match outcome {
            Outcome::Rows(_) => format!(
                "{name} (`pip install {package}`): {}; `PYTHONPATH=.. python3 {script} --edges 40`.",
                self.method
            ),
            Outcome::Absent => format!(
                "{name} was not installed where this page was made: `pip install {package}` installs it; `PYTHONPATH=.. \
                 python3 {script} --edges 40` makes its run."
            ),
            Outcome::Failed(words) => format!("{name}: `{script}` failed: {words}."),
        }
    }
}

/// The notes on programs that do not solve a case.
pub(super) fn left_out(case: &str) -> impl Iterator<Item = String> {
    let of_case = LEFT_OUT
        .iter()
        .filter(move |(cases, ..)| cases.contains(&case));
    of_case.map(|(_, program, reason)| format!("{} is left out: {reason}.", program.name))
}

/// Whether Python finds a module.
fn has_module(python: &OsStr, module: &str) -> bool {
    let found = Command::new(python).args(["-c", FIND, module]).output();
    found.is_ok_and(|found| found.status.success())
}

/// The last line of an output that is not empty.
fn last_line(output: &[u8]) -> String {
    let text = String::from_utf8_lossy(output);
    let mut lines = text.lines().rev().map(str::trim);
    lines
        .find(|line| !line.is_empty())
        .unwrap_or("no output")
        .into()
}

/// The section of other programs on the page of a case.
pub(super) struct Section {
    /// Rows of all programs.
    pub rows: Vec<PeerRow>,
    notes: Vec<String>,
}

impl Section {
    /// Makes the runs of a case; the quick version makes none.
    pub fn of(benchmark: &Benchmark, cases: &[Case<BenchmarkRun>], is_quick: bool) -> Result<Self> {
        let name = stem(benchmark.name);
        let mut section = Self {
            rows: Vec::new(),
            notes: Vec::new(),
        };
        if is_quick {
            let note = "The quick version runs no other programs.";
            section.notes.push(note.into());
            return Ok(section);
        }
        let python = python();
        for peer in peers_of(name) {
            let outcome = peer.rows(benchmark, cases, &python)?;
            section.notes.push(peer.note(&outcome));
            if let Outcome::Rows(rows) = outcome {
                section.rows.extend(rows);
            }
        }
        section.notes.extend(left_out(name));
        Ok(section)
    }

    /// Writes the notes, the scripts and the rows beside the page. The modules that the scripts
    /// import are beside the table of all cases.
    pub fn write(&self, page: &mut Page, case: &str) -> Result<()> {
        for (name, text) in peers_of(case).map(|peer| peer.script) {
            page.file(name, text.as_bytes())?;
        }
        if !self.rows.is_empty() {
            page.csv_as("peers.csv", &self.rows)?;
        }
        for note in &self.notes {
            page.text(note);
        }
        Ok(())
    }

    /// Observed order of convergence of a row, from the mesh of half as many edges.
    fn order(&self, row: &PeerRow) -> Option<f64> {
        let is_coarser = |other: &&PeerRow| {
            other.program == row.program
                && other.quantity == row.quantity
                && 2 * other.edges == row.edges
        };
        let ratio = self.rows.iter().find(is_coarser)?.error / row.error;
        (ratio > 0.0).then(|| libm::log2(ratio))
    }

    /// The cells of the rows in the table of the page.
    pub fn cells(&self) -> impl Iterator<Item = Vec<String>> + '_ {
        self.rows.iter().map(|row| {
            vec![
                row.quantity.clone(),
                row.edges.to_string(),
                format!("{} {}", row.program, row.version),
                digits(row.value),
                digits(row.exact),
                format!("{:.1e}", row.error),
                number(self.order(row), 2),
                number(row.cpu_time_s, 3),
            ]
        })
    }
}

#[cfg(test)]
mod tests;
