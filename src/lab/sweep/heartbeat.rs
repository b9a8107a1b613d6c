//! Heartbeat of the leases of this process.

use rodlab_files::results::{HEARTBEAT, Lease};
use std::collections::BTreeMap;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

/// The leases that this process holds, by case.
pub(super) type HeldLeases = Arc<Mutex<BTreeMap<String, Lease>>>;

/// Touches the leases periodically until it is dropped.
pub(super) struct Heartbeat {
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Heartbeat {
    /// Starts it.
    pub fn start(leased: HeldLeases) -> Self {
        let (stop, stopped) = mpsc::channel::<()>();
        let beat = move || {
            while let Err(RecvTimeoutError::Timeout) = stopped.recv_timeout(HEARTBEAT) {
                let leased = leased.lock().expect("no thread panics with this lock");
                leased.values().for_each(Lease::touch);
            }
        };
        Self {
            stop: Some(stop),
            thread: Some(std::thread::spawn(beat)),
        }
    }
}

impl Drop for Heartbeat {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            // The thread panics only after another thread panicked, which is reported there.
            let _ = thread.join();
        }
    }
}
