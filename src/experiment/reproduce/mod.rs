//! Tables and figures of the thesis, made again with this engine.
//!
//! An [`Artifact`] is a set of runs and what is made of them. Each run is an ordinary one, with its own
//! results directory: an interrupted [`reproduce`] continues where it was, and artefacts share their runs.
//!
//! | file | what |
//! |---|---|
//! | `artifact` | what there is, and its runs |
//! | `bundling` | a run of bundling flagella (thesis 2.4.2) |
//! | `cases` | running the runs |
//! | `page` | CSV, Markdown and manifest of an artefact |
//! | `table_2_1`, `table_2_2`, `figure_2_5`, `figure_2_6` | one artefact each |

mod artifact;
mod bundling;
mod cases;
mod figure_2_5;
mod figure_2_6;
mod page;
mod table_2_1;
mod table_2_2;

pub use artifact::Artifact;

use super::RunError;
use crate::results::ResultsError;
use page::Page;
use std::path::PathBuf;

/// How to reproduce, as opposed to what.
#[derive(Clone, Debug)]
pub struct ReproduceOptions {
    /// Where things go: each artefact into a directory of its name, the runs into `cases`.
    pub directory: PathBuf,
    /// Simulate a short time only.
    pub quick: bool,
    /// Runs at a time, at least 1; they share the threads of the program.
    pub jobs: usize,
    /// The command line, for the manifests.
    pub command_line: Vec<String>,
}

/// Why an artefact was not made.
#[derive(Debug, thiserror::Error)]
pub enum ReproduceError {
    /// A run did not begin, or was stopped. A run that the mechanics ended is a result, not an error.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Results could not be written or read.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The system could not start the threads of a run.
    #[error("cannot start the threads of a run: {0}")]
    Threads(String),
}

impl ReproduceError {
    /// Exit code of the program.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Run(error) => error.exit_code(),
            Self::Results(error) => error.exit_code(),
            Self::Threads(_) => 1,
        }
    }
}

/// Makes an artefact and returns the files written; `report` is told of each run that ended.
///
/// # Errors
/// See [`ReproduceError`].
pub fn reproduce(
    artifact: Artifact,
    options: &ReproduceOptions,
    report: &(dyn Fn(&str) + Sync),
) -> Result<Vec<PathBuf>, ReproduceError> {
    let cases = cases::run_all(&artifact.runs(options.quick), options, report)?;
    let mut page = Page::begin(artifact, options, &cases)?;
    match artifact {
        Artifact::Table2_1 => table_2_1::write(&mut page, &cases),
        Artifact::Table2_2 => table_2_2::write(&mut page, &cases),
        Artifact::Figure2_5 => figure_2_5::write(&mut page, &cases),
        Artifact::Figure2_6 => figure_2_6::write(&mut page, &cases),
    }?;
    Ok(page.finish()?)
}
