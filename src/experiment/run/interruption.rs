//! Ctrl-C and SIGTERM end a run after the step at hand, with a checkpoint.

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::{SigId, flag, low_level};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Watches for a request to stop, from its creation until it is dropped.
#[derive(Default)]
pub(super) struct Interruption {
    requested: Arc<AtomicBool>,
    handlers: Vec<SigId>,
}

/// Exit code of a program ended by Ctrl-C.
const EXIT_CODE: i32 = 130;

impl Interruption {
    /// Installs the handlers. A second signal ends the program at once, without a checkpoint.
    pub fn install() -> io::Result<Self> {
        let mut interruption = Self::default();
        for signal in [SIGINT, SIGTERM] {
            let requested = &interruption.requested;
            // In this order: the first signal finds the flag down, and raises it.
            let second =
                flag::register_conditional_shutdown(signal, EXIT_CODE, Arc::clone(requested))?;
            let first = flag::register(signal, Arc::clone(requested))?;
            interruption.handlers.extend([second, first]);
        }
        Ok(interruption)
    }

    /// Whether the run was asked to stop.
    pub fn requested(&self) -> bool {
        self.requested.load(Ordering::Relaxed)
    }
}

impl Drop for Interruption {
    fn drop(&mut self) {
        for handler in self.handlers.drain(..) {
            low_level::unregister(handler);
        }
    }
}
