//! Signals to commands that move something, or that serve until they are stopped.

use super::exit_code::INTERRUPTED;
use super::failure::Failure;
use rodlab_robot::Moving;
use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGTSTP, SIGUSR1, SIGUSR2};
use signal_hook::iterator::Signals;
use std::sync::Arc;
use std::sync::atomic::{AtomicI32, Ordering};
use std::time::{Duration, Instant};

/// Signals that end the program, with their names. They come from the terminal (Ctrl-C, Ctrl-\,
/// Ctrl-Z, a closed window), from the operating system and from batch systems.
const SIGNALS: [(i32, &str); 7] = [
    (SIGINT, "SIGINT"),
    (SIGTERM, "SIGTERM"),
    (SIGHUP, "SIGHUP"),
    (SIGQUIT, "SIGQUIT"),
    (SIGTSTP, "SIGTSTP"),
    (SIGUSR1, "SIGUSR1"),
    (SIGUSR2, "SIGUSR2"),
];
/// Time after the first signal in which further signals count as the same request, since launchers
/// send two signals.
const SAME_REQUEST: Duration = Duration::from_secs(1);

/// The first signal of [`SIGNALS`] that was received.
#[derive(Clone)]
pub struct Interruption(Arc<AtomicI32>);

impl Interruption {
    /// Whether a signal was received.
    pub fn is_raised(&self) -> bool {
        self.0.load(Ordering::Relaxed) != 0
    }

    /// Name of the signal that was received.
    pub fn signal(&self) -> Option<&'static str> {
        let raised = self.0.load(Ordering::Relaxed);
        let mut signals = SIGNALS.iter();
        Some(signals.find(|(signal, _)| *signal == raised)?.1)
    }
}

/// Watches for signals, except those that were ignored when the program was started, as by
/// `nohup`. A further signal ends the program at once if nothing moves; a motion is always
/// cancelled first.
pub fn watch_for_interruption() -> Result<Interruption, Failure> {
    let ignored = ignored_signals();
    let watched = SIGNALS.iter().map(|(signal, _)| *signal);
    let watched = watched.filter(|signal| ignored & (1 << (signal - 1)) == 0);
    let mut signals = Signals::new(watched.collect::<Vec<_>>()).map_err(|error| {
        Failure::System(format!(
            "cannot watch for signals, so nothing is moved: {error}"
        ))
    })?;
    let raised = Interruption(Arc::default());
    let first = Arc::clone(&raised.0);
    std::thread::spawn(move || {
        let mut since = Instant::now();
        for signal in signals.forever() {
            let is_first = first.compare_exchange(0, signal, Ordering::Relaxed, Ordering::Relaxed);
            if is_first.is_ok() {
                since = Instant::now();
            } else if since.elapsed() > SAME_REQUEST && !Moving::is_under_way() {
                std::process::exit(INTERRUPTED.into());
            }
        }
    });
    Ok(raised)
}

/// Bit mask of the ignored signals; bit 0 is signal 1. Zero if the operating system does not
/// report them.
fn ignored_signals() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    line.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .unwrap_or(0)
}
