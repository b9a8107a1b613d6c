//! Work in progress in this process, and whether it has received a request to stop.
//!
//! Runs poll from time to time for requests to stop. A step of an enormous system may take minutes in between: this module reports to the
//! code that asked a run to stop that the run has not received the request.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// For each piece of work, whether it has received a request to stop.
static AT_WORK: Mutex<Vec<Arc<AtomicBool>>> = Mutex::new(Vec::new());

/// A piece of work, until it is dropped.
pub(super) struct Work {
    told: Arc<AtomicBool>,
}

impl Work {
    /// Work begins.
    pub fn begin() -> Self {
        let told = Arc::new(AtomicBool::new(false));
        at_work().push(Arc::clone(&told));
        Self { told }
    }

    /// Records that it received the request; it will stop after saving its state.
    pub fn is_told(&self) {
        self.told.store(true, Ordering::Relaxed);
    }
}

impl Drop for Work {
    fn drop(&mut self) {
        at_work().retain(|told| !Arc::ptr_eq(told, &self.told));
    }
}

/// A list of pointers stays valid after a panic of the thread that held it.
fn at_work() -> MutexGuard<'static, Vec<Arc<AtomicBool>>> {
    AT_WORK.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Whether there is work that has not received the request to stop, and no other work is being saved.
pub fn is_deaf() -> bool {
    let at_work = at_work();
    !at_work.is_empty() && at_work.iter().all(|told| !told.load(Ordering::Relaxed))
}
