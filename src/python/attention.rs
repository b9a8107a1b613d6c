//! Ctrl-C during long calls.

use pyo3::prelude::*;
use std::cell::{Cell, RefCell};
use std::time::{Duration, Instant};

/// Time between two checks for signals.
pub const BETWEEN: Duration = Duration::from_millis(20);

/// Checks periodically for signals to the program.
pub struct Attention {
    last: Cell<Instant>,
    /// The exception of a signal, such as `KeyboardInterrupt`.
    raised: RefCell<Option<PyErr>>,
}

impl Attention {
    /// Starts to check.
    pub fn new() -> Self {
        Self {
            last: Cell::new(Instant::now()),
            raised: RefCell::new(None),
        }
    }

    /// Whether the call may continue, since no signal requests a stop. Must be called without the
    /// lock of the interpreter.
    pub fn continues(&self) -> bool {
        if self.raised.borrow().is_some() {
            return false;
        }
        if self.last.get().elapsed() >= BETWEEN {
            self.last.set(Instant::now());
            if let Err(error) = Python::attach(|py| py.check_signals()) {
                *self.raised.borrow_mut() = Some(error);
                return false;
            }
        }
        true
    }

    /// The exception to raise, if a signal arrived.
    pub fn finish(self) -> PyResult<()> {
        self.raised.into_inner().map_or(Ok(()), Err)
    }
}
