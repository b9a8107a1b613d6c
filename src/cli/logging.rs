//! The log on standard error.

use super::common::{Common, LogFormat};
use super::terminal::Printable;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::SubscriberInitExt;

/// Starts logging as set by the common options.
///
/// Messages of this crate are shown down to the requested level. Other crates show only warnings
/// and errors, so that their debugging messages do not hide the steps of a simulation.
pub fn start(common: &Common) {
    let level = match (common.quiet, common.verbose) {
        (true, _) => LevelFilter::ERROR,
        // A log for programs includes the stages.
        (false, 0) if common.log == LogFormat::Json => LevelFilter::INFO,
        (false, 0) => LevelFilter::WARN,
        (false, 1) => LevelFilter::INFO,
        (false, 2) => LevelFilter::DEBUG,
        (false, _) => LevelFilter::TRACE,
    };
    // The DDS library warns about connecting and leaving peers in lines of a thousand characters,
    // and that of SVG without the name of the file. The drivers and the reader of drawings report
    // everything important.
    let of_libraries = if level == LevelFilter::TRACE {
        LevelFilter::WARN
    } else {
        LevelFilter::OFF
    };
    let filter = Targets::new()
        .with_default(level.min(LevelFilter::WARN))
        .with_target("rustdds", of_libraries)
        .with_target("usvg", of_libraries)
        .with_target(env!("CARGO_PKG_NAME"), level);
    let lines = tracing_subscriber::fmt::layer()
        .with_writer(|| Printable(std::io::stderr()))
        // A failed write to standard error cannot be reported there, either.
        .log_internal_errors(false)
        .with_ansi(common.colours_stderr());
    let subscriber = tracing_subscriber::registry().with(filter);
    // If logging was started before, as in tests, the first subscriber stays.
    let _ = match common.log {
        LogFormat::Json => subscriber.with(lines.json()).try_init(),
        LogFormat::Text => subscriber.with(lines.with_target(false)).try_init(),
    };
}
