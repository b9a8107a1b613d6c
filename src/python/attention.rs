//! Ctrl-C during long calls.

use pyo3::prelude::*;
use std::cell::{Cell, RefCell};
use std::time::{Duration, Instant};

/// Time between two looks at the signals.
pub const BETWEEN: Duration = Duration::from_millis(20);

/// Looks at the signals of the program from time to time.
pub struct Attention {
    last: Cell<Instant>,
    /// The exception of a signal, such as `KeyboardInterrupt`.
    raised: RefCell<Option<PyErr>>,
}

impl Attention {
    /// Begins to look.
    pub fn new() -> Self {
        Self {
            last: Cell::new(Instant::now()),
            raised: RefCell::new(None),
        }
    }

    /// Whether no signal has asked to stop. It is called without the lock of the interpreter.
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

    /// The exception to raise, if a signal came.
    pub fn finish(self) -> PyResult<()> {
        self.raised.into_inner().map_or(Ok(()), Err)
    }
}
