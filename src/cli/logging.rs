//! The log on standard error.

use super::arguments::{Common, LogFormat};
use tracing_subscriber::filter::LevelFilter;

/// Starts logging as the common options ask.
pub fn start(common: &Common) {
    let level = match (common.quiet, common.verbose) {
        (true, _) => LevelFilter::ERROR,
        (false, 0) => LevelFilter::WARN,
        (false, 1) => LevelFilter::INFO,
        (false, _) => LevelFilter::DEBUG,
    };
    let builder = tracing_subscriber::fmt()
        .with_max_level(level)
        .with_writer(std::io::stderr)
        .with_ansi(common.colours_stderr());
    // A second start, as in tests, keeps the first subscriber.
    let _ = match common.log {
        LogFormat::Json => builder.json().try_init(),
        LogFormat::Text => builder.with_target(false).try_init(),
    };
}
