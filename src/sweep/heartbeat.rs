//! Signs of life of the claims of this process.

use crate::results::{Claim, HEARTBEAT};
use std::collections::BTreeMap;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

/// The claims that this process holds, by case.
pub(super) type Claimed = Arc<Mutex<BTreeMap<String, Claim>>>;

/// Touches the claims from time to time until it is dropped.
pub(super) struct Heartbeat {
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Heartbeat {
    /// Starts it.
    pub fn start(claimed: Claimed) -> Self {
        let (stop, stopped) = mpsc::channel::<()>();
        let beat = move || {
            while let Err(RecvTimeoutError::Timeout) = stopped.recv_timeout(HEARTBEAT) {
                let claimed = claimed.lock().expect("no thread panics with this lock");
                claimed.values().for_each(Claim::touch);
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
            // It panics only after another thread did, which is reported there.
            let _ = thread.join();
        }
    }
}
