//! Options that every subcommand has: threads, log, colours.

use super::failure::Failure;
use clap::{ArgAction, Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;

/// Options that every subcommand has.
#[derive(Debug, Args)]
pub struct Common {
    /// Number of threads; results do not depend on it [default: one per core]
    #[arg(long, global = true, hide_short_help = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Log more: -v stages, -vv time steps, -vvv Newton iterations
    #[arg(short, long, global = true, action = ArgAction::Count)]
    pub verbose: u8,
    /// Log errors only, and show no progress
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Format of the log on standard error; "json" includes the stages, as -v does
    #[arg(
        long,
        global = true,
        hide_short_help = true,
        value_name = "FORMAT",
        default_value = "text"
    )]
    pub log: LogFormat,
    /// When to use colours
    #[arg(
        long,
        global = true,
        hide_short_help = true,
        value_name = "WHEN",
        default_value = "auto"
    )]
    pub color: Color,
}

/// Formats of the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LogFormat {
    /// Lines of text.
    Text,
    /// One JSON object per line.
    Json,
}

/// When to use colours.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Color {
    /// On a terminal, unless the environment sets `NO_COLOR`.
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

impl Common {
    /// Whether text on standard error is coloured.
    pub fn colours_stderr(&self) -> bool {
        self.colours(std::io::stderr().is_terminal())
    }

    /// Whether text on standard output is styled.
    pub fn styles_stdout(&self) -> bool {
        self.colours(std::io::stdout().is_terminal())
    }

    fn colours(&self, is_terminal: bool) -> bool {
        match self.color {
            Color::Always => true,
            Color::Never => false,
            Color::Auto => {
                is_terminal && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
            }
        }
    }

    /// Progress bar; hidden with `--quiet`.
    pub fn progress(&self, bar: ProgressBar, template: &str) -> ProgressBar {
        if self.quiet {
            return ProgressBar::hidden();
        }
        let style = ProgressStyle::with_template(template);
        bar.with_style(style.expect("the template is in order"))
    }

    /// Sets the number of threads.
    pub fn start_threads(&self) -> Result<(), Failure> {
        let Some(threads) = self.threads else {
            return Ok(());
        };
        refuse_too_many_threads("--threads", threads)?;
        rayon::ThreadPoolBuilder::new()
            .num_threads(usize::from(threads))
            .build_global()
            .map_err(|error| Failure::System(format!("cannot start {threads} threads: {error}")))
    }
}

/// Number of threads per processor beyond which threads only wait for each other.
const THREADS_OF_A_PROCESSOR: usize = 16;

/// Rejects numbers of threads whose start would take longer than the work.
pub fn refuse_too_many_threads(option: &str, threads: u16) -> Result<(), Failure> {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let most = (THREADS_OF_A_PROCESSOR * processors).max(64);
    if usize::from(threads) > most {
        return Err(Failure::Input(format!(
            "{option} {threads} is out of range; allowed on this machine of {processors} processors: 1 to {most}"
        )));
    }
    Ok(())
}
