//! Ctrl-C and SIGTERM end a run after the step at hand, with a checkpoint; so does SIGUSR1, by which batch
//! systems tell that the time is nearly up.

use super::stop::StopRequest;
use signal_hook::consts::{SIGINT, SIGTERM, SIGUSR1};
use signal_hook::{SigId, flag, low_level};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Watches for a request to stop, from its creation until it is dropped.
#[derive(Default)]
pub(crate) struct Interruption {
    interrupted: Arc<AtomicBool>,
    time_is_up: Arc<AtomicBool>,
    handlers: Vec<SigId>,
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

    /// A second signal ends the program at once, without a checkpoint.
    fn install() -> io::Result<Self> {
        let mut interruption = Self::default();
        for signal in [SIGINT, SIGTERM] {
            let interrupted = &interruption.interrupted;
            // In this order: the first signal finds the flag down, and raises it.
            let second =
                flag::register_conditional_shutdown(signal, EXIT_CODE, Arc::clone(interrupted))?;
            let first = flag::register(signal, Arc::clone(interrupted))?;
            interruption.handlers.extend([second, first]);
        }
        let warning = flag::register(SIGUSR1, Arc::clone(&interruption.time_is_up))?;
        interruption.handlers.push(warning);
        Ok(interruption)
    }

    /// Whether the run was asked to stop.
    pub fn requested(&self) -> Option<StopRequest> {
        if self.interrupted.load(Ordering::Relaxed) {
            Some(StopRequest::Interrupt)
        } else if self.time_is_up.load(Ordering::Relaxed) {
            Some(StopRequest::TimeLimit)
        } else {
            None
        }
    }
}

impl Drop for Interruption {
    fn drop(&mut self) {
        for handler in self.handlers.drain(..) {
            low_level::unregister(handler);
        }
    }
}
