//! Handles stop signals. After Ctrl-C, SIGTERM or the closing of the terminal a run ends after the
//! current step, with a checkpoint. SIGUSR1, by which batch systems announce that the time limit
//! is near, has the same effect.

use super::stop::StopRequest;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1};
use signal_hook::{SigId, flag, low_level};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Watches for a request to stop, from its creation until it is dropped.
///
/// Signals end the program at once until the first call of [`requested`](Self::requested): there
/// is nothing to save yet. After that call the caller has work to save and will stop. A second
/// signal, which shells and wrappers often send within milliseconds of the first, then has no
/// effect until everything is saved.
pub struct Interruption {
    interrupted: Arc<AtomicBool>,
    time_is_up: Arc<AtomicBool>,
    /// Whether the caller does not poll for requests, either not yet or no longer.
    unattended: Arc<AtomicBool>,
    handlers: Vec<SigId>,
}

/// Number of instances in this process that poll for requests.
static ATTENDANTS: AtomicUsize = AtomicUsize::new(0);
/// Whether one of them has received a request and ends the program itself.
static HEARD: AtomicBool = AtomicBool::new(false);

/// Whether any code in this process polls for requests to stop, or has received one. If not, such
/// as before the first run and between two runs, there is no work to save.
pub fn is_attended() -> bool {
    ATTENDANTS.load(Ordering::Relaxed) > 0 || HEARD.load(Ordering::Relaxed)
}

/// Exit code of a program ended by Ctrl-C.
const EXIT_CODE: i32 = 130;

impl Interruption {
    /// Installs the handlers. If that fails, logs a warning; signals then end the program at once.
    pub fn watch() -> Self {
        Self::install().unwrap_or_else(|error| {
            tracing::warn!("Ctrl-C will end the run without a checkpoint: {error}");
            Self::deaf()
        })
    }

    /// An instance that receives no signals.
    fn deaf() -> Self {
        Self {
            interrupted: Arc::default(),
            time_is_up: Arc::default(),
            unattended: Arc::new(AtomicBool::new(true)),
            handlers: Vec::new(),
        }
    }

    fn install() -> io::Result<Self> {
        let mut interruption = Self::deaf();
        for signal in [SIGINT, SIGTERM, SIGHUP] {
            let unattended = Arc::clone(&interruption.unattended);
            let at_once = flag::register_conditional_shutdown(signal, EXIT_CODE, unattended)?;
            let noted = flag::register(signal, Arc::clone(&interruption.interrupted))?;
            interruption.handlers.extend([at_once, noted]);
        }
        let warning = flag::register(SIGUSR1, Arc::clone(&interruption.time_is_up))?;
        interruption.handlers.push(warning);
        Ok(interruption)
    }

    /// Whether the run was asked to stop.
    pub fn requested(&self) -> Option<StopRequest> {
        if self.unattended.swap(false, Ordering::Relaxed) {
            ATTENDANTS.fetch_add(1, Ordering::Relaxed);
        }
        let request = if self.interrupted.load(Ordering::Relaxed) {
            StopRequest::Interrupt
        } else if self.time_is_up.load(Ordering::Relaxed) {
            StopRequest::TimeLimit
        } else {
            return None;
        };
        HEARD.store(true, Ordering::Relaxed);
        Some(request)
    }
}

impl Interruption {
    /// Ends the polling for requests, because later work need not be saved. A request that was
    /// received earlier remains valid.
    pub fn leave_unattended(&self) {
        if !self.unattended.swap(true, Ordering::Relaxed) {
            ATTENDANTS.fetch_sub(1, Ordering::Relaxed);
        }
    }
}

impl Drop for Interruption {
    fn drop(&mut self) {
        for handler in self.handlers.drain(..) {
            low_level::unregister(handler);
        }
        self.leave_unattended();
    }
}
