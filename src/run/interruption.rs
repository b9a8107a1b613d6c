//! Ctrl-C, SIGTERM and a terminal that closes end a run after the step at hand, with a checkpoint; so does SIGUSR1, by
//! which batch systems say that the time is nearly up.

use super::stop::StopRequest;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1};
use signal_hook::{SigId, flag, low_level};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Watches for a request to stop, from its creation until it is dropped.
///
/// Signals end the program at once as long as nobody has asked for them: there is nothing to save yet. From the first
/// call of [`requested`](Self::requested) on, whoever asks has work to save and will stop; a second signal, which shells
/// and wrappers often send within milliseconds of the first, then changes nothing, until all is saved.
#[derive(Default)]
pub(crate) struct Interruption {
    interrupted: Arc<AtomicBool>,
    time_is_up: Arc<AtomicBool>,
    /// Whether nobody has asked yet.
    unattended: Arc<AtomicBool>,
    handlers: Vec<SigId>,
}

/// Whether anybody in this process has asked yet.
static ATTENDED: AtomicBool = AtomicBool::new(false);

/// Whether anybody in this process has begun to ask for requests to stop. Until then nothing is at work that would have to
/// be saved.
pub(crate) fn is_attended() -> bool {
    ATTENDED.load(Ordering::Relaxed)
}

/// Exit code of a program ended by Ctrl-C.
const EXIT_CODE: i32 = 130;

impl Interruption {
    /// Installs the handlers; where that fails, a warning says so and signals end the program at once.
    pub fn watch() -> Self {
        Self::install().unwrap_or_else(|error| {
            tracing::warn!("Ctrl-C will end the run without a checkpoint: {error}");
            Self::default()
        })
    }

    fn install() -> io::Result<Self> {
        let mut interruption = Self::default();
        interruption.unattended.store(true, Ordering::Relaxed);
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
        self.unattended.store(false, Ordering::Relaxed);
        ATTENDED.store(true, Ordering::Relaxed);
        if self.interrupted.load(Ordering::Relaxed) {
            Some(StopRequest::Interrupt)
        } else if self.time_is_up.load(Ordering::Relaxed) {
            Some(StopRequest::TimeLimit)
        } else {
            None
        }
    }
}

impl Interruption {
    /// Nobody will ask any more: what is still done need not be saved. A request that has come already stands.
    pub fn leave_unattended(&self) {
        self.unattended.store(true, Ordering::Relaxed);
    }
}

impl Drop for Interruption {
    fn drop(&mut self) {
        for handler in self.handlers.drain(..) {
            low_level::unregister(handler);
        }
    }
}
