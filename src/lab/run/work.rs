//! Registry of the work in progress in this process, and whether it has received a request to
//! stop.
//!
//! Runs poll for requests to stop. A step of a very large system may take minutes between two
//! polls. This module then reports that the run has not yet received the request.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Whether each piece of work has received a request to stop.
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

    /// Records that the work has received the request; it will stop after saving its state.
    pub fn is_told(&self) {
        self.told.store(true, Ordering::Relaxed);
    }
}

impl Drop for Work {
    fn drop(&mut self) {
        at_work().retain(|told| !Arc::ptr_eq(told, &self.told));
    }
}

/// A list of pointers stays valid after a panic of the thread that locked it.
fn at_work() -> MutexGuard<'static, Vec<Arc<AtomicBool>>> {
    AT_WORK.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Whether there is work in progress, and none of it has received the request to stop.
pub fn is_deaf() -> bool {
    let at_work = at_work();
    !at_work.is_empty() && at_work.iter().all(|told| !told.load(Ordering::Relaxed))
}
