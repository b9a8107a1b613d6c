//! `rodlab dataset --format`: demonstrations of the planners, which the Python package makes.

use super::log_directory::results_directory;
use super::prelude::*;
use super::preset_file::resolve;
use clap::builder::{PathBufValueParser, TypedValueParser};

/// Environments in which planners give demonstrations.
const TASKS: [&str; 2] = ["CableShape", "Folding"];
/// Formats of the files.
const FORMATS: [Named<&str>; 3] = [
    ("npz", "npz", "Arrays of numpy, a file for each episode"),
    ("parquet", "parquet", "One table with a row for each step"),
    ("lerobot", "lerobot", "A data set of LeRobot, version 2.1"),
];
const EPISODES: u32 = 10;

/// Options of `rodlab dataset` for demonstrations.
#[derive(Debug, Args)]
pub struct DemonstrationArguments {
    /// Write demonstrations of a planner, as a part of the Python package
    #[arg(long, value_name = "FORMAT", value_parser = named(&FORMATS), conflicts_with_all = [
        "overrides", "force", "dry_run", "vary", "jobs", "shard", "retry_failed", "fail_fast", "yes",
        "watch", "json", "timeout",
    ])]
    pub format: Option<&'static str>,
    /// Number of episodes [default: 10]
    #[arg(long, value_name = "N", requires = "format", hide_short_help = true, value_parser = clap::value_parser!(u32).range(1..))]
    pub count: Option<u32>,
    /// Seed of the first episode, from which the others count up [default: 0]
    #[arg(long, value_name = "N", requires = "format", hide_short_help = true, value_parser = clap::value_parser!(u32))]
    pub seed: Option<u32>,
    /// Record no pictures
    #[arg(long, requires = "format", hide_short_help = true)]
    pub no_pictures: bool,
}

/// Demonstrations that a command line asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Demonstrations {
    /// Name of the environment.
    pub task: &'static str,
    /// Number of episodes.
    pub count: u32,
    /// Directory to write to.
    pub out: PathBuf,
    /// Format of the files: `npz`, `parquet` or `lerobot`.
    pub format: &'static str,
    /// Seed of the first episode.
    pub seed: u32,
    /// Whether pictures are recorded.
    pub pictures: bool,
    /// Whether no progress is reported.
    pub quiet: bool,
}

impl DemonstrationArguments {
    /// What they ask for in the environment that is given in place of a scenario; `None` without `--format`.
    pub(super) fn of(
        &self,
        task: &Path,
        out: Option<&Path>,
        common: &Common,
    ) -> Result<Option<Demonstrations>, Failure> {
        let tasks = TASKS.join(", ");
        let found = TASKS.into_iter().find(|name| task == Path::new(name));
        match (found, self.format) {
            (None, None) => Ok(None),
            (Some(name), None) => Err(Failure::Input(format!(
                "{name} is an environment: --format is needed; allowed: {}",
                FORMATS.map(|(name, ..)| name).join(", ")
            ))),
            (None, Some(_)) => Err(Failure::Input(format!(
                "--format: {} is not an environment with a planner; allowed: {tasks}",
                task.display()
            ))),
            (Some(name), Some(format)) => Ok(Some(Demonstrations {
                task: name,
                count: self.count.unwrap_or(EPISODES),
                out: results_directory(out, name),
                format,
                seed: self.seed.unwrap_or(0),
                pictures: !self.no_pictures,
                quiet: common.quiet,
            })),
        }
    }
}

/// A parser of scenarios, presets and names of environments.
pub(super) fn scenario_or_task() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| {
        match TASKS.into_iter().any(|name| path == Path::new(name)) {
            true => Ok(path),
            false => resolve(PresetKind::Scenario, path),
        }
    })
}
