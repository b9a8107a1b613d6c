//! Ends the program if a run does not respond to a request to stop.
//!
//! Runs check between steps, and in long steps at every iteration, whether their time limit has
//! passed or a signal was received. Set-up, or an iteration of an enormous system, may take
//! minutes without such a check. The watchdog then ends the program as if it had been killed. No
//! file is incomplete, and running the same command again resumes from the last checkpoint.

use super::exit_code::{INTERRUPTED, TIME_LIMIT};
use super::standard_error;
use rodlab_files::results::UsageMeter;
use rodlab_lab::run::{is_attended, is_deaf};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1};
use signal_hook::flag;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Time between two checks.
const LOOK: Duration = Duration::from_millis(50);
/// Wall time within which set-up must end and a run must respond.
const PATIENCE: Duration = Duration::from_secs(1);
/// Processor time within which set-up must end and a run must respond. On a busy machine, or while
/// the disk is slow, wall time is not a measure of progress.
const SPENT: Duration = Duration::from_millis(700);
/// Wall time after which the program is ended in any case.
const LONGEST_PATIENCE: Duration = Duration::from_secs(10);

/// Starts a watchdog that runs until the program ends. `deadline` is the time limit.
pub fn watch(deadline: Option<Instant>) {
    let watchdog = Watchdog {
        deadline,
        interrupted: Arc::default(),
        warned: Arc::default(),
    };
    for (signal, flag) in [
        (SIGINT, &watchdog.interrupted),
        (SIGTERM, &watchdog.interrupted),
        (SIGHUP, &watchdog.interrupted),
        (SIGUSR1, &watchdog.warned),
    ] {
        if let Err(error) = flag::register(signal, Arc::clone(flag)) {
            tracing::warn!("signals wait for the end of a step: {error}");
        }
    }
    std::thread::spawn(move || watchdog.watch());
}

struct Watchdog {
    deadline: Option<Instant>,
    interrupted: Arc<AtomicBool>,
    /// Whether the batch system has warned that the time limit is near.
    warned: Arc<AtomicBool>,
}

/// A request to stop: its exit code and its message.
type Request = (u8, &'static str);

impl Watchdog {
    fn watch(&self) {
        let request = loop {
            std::thread::sleep(LOOK);
            match self.request() {
                // Before the first run or between two runs there is nothing to save.
                Some((INTERRUPTED, _)) if !is_attended() => std::process::exit(INTERRUPTED.into()),
                Some(request) => break request,
                None => {}
            }
        };
        let meter = UsageMeter::start();
        loop {
            std::thread::sleep(LOOK);
            let waited = meter.wall_time();
            let spent = meter.usage().cpu_time.unwrap_or(waited);
            let is_over = waited >= PATIENCE && spent >= SPENT || waited >= LONGEST_PATIENCE;
            if is_over && !is_attended() {
                end(
                    request,
                    "before the first step; nothing is lost, run the same command again to start",
                );
            } else if is_over && is_deaf() {
                end(
                    request,
                    "within a long step; run the same command again to resume from the last \
                     checkpoint",
                );
            }
        }
    }

    fn request(&self) -> Option<Request> {
        if self.interrupted.load(Ordering::Relaxed) {
            return Some((INTERRUPTED, "interrupted"));
        }
        let is_late = self.deadline.is_some_and(|at| Instant::now() >= at);
        let is_up = is_late || self.warned.load(Ordering::Relaxed);
        is_up.then_some((TIME_LIMIT, "time limit reached"))
    }
}

fn end((code, what): Request, how: &str) -> ! {
    standard_error::report(&format!("error: {what} {how}\n"));
    std::process::exit(code.into())
}
