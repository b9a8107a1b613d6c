//! Waiting for the disk, at once or later for many files together.
//!
//! A file survives a loss of power only after it is synced, and a sync takes longer than many
//! cases of a sweep. A short case therefore does not wait ([`LaterSync`]); the sweep syncs the file
//! system for all cases of a second ([`sync_file_system`]), and keeps their leases until then.

use super::ResultsError;
use std::cell::Cell;
use std::io;
use std::marker::PhantomData;
use std::path::Path;
use std::time::{Duration, Instant};

/// Time after which a thread waits for the disk again. The syncs of a longer case take a small
/// part of its time.
const LONGEST: Duration = Duration::from_secs(1);

/// What a thread does instead of syncing.
#[derive(Clone, Copy)]
struct Later {
    since: Instant,
    is_needed: bool,
}

thread_local! {
    static LATER: Cell<Option<Later>> = const { Cell::new(None) };
}

/// While it lives, up to a second, this thread does not wait for the disk where a whole file system
/// can be synced; elsewhere it has no effect.
pub struct LaterSync {
    // It belongs to its thread.
    _thread: PhantomData<*const ()>,
}

impl LaterSync {
    /// Begins now.
    pub fn begin() -> Self {
        if cfg!(target_os = "linux") {
            LATER.set(Some(Later {
                since: Instant::now(),
                is_needed: false,
            }));
        }
        Self {
            _thread: PhantomData,
        }
    }

    /// Whether files of this thread must be synced later.
    pub fn is_needed(&self) -> bool {
        LATER.get().is_some_and(|later| later.is_needed)
    }
}

impl Drop for LaterSync {
    fn drop(&mut self) {
        LATER.set(None);
    }
}

/// Syncs a file or a directory, unless this is done later.
pub(super) fn sync_now_or_later(sync: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
    match LATER.get() {
        Some(later) if later.since.elapsed() < LONGEST => {
            LATER.set(Some(Later {
                is_needed: true,
                ..later
            }));
            Ok(())
        }
        _ => sync(),
    }
}

/// Waits until everything that was written to the file system of a directory would survive a loss
/// of power.
///
/// # Errors
/// [`ResultsError::Io`] naming `directory`.
pub fn sync_file_system(directory: &Path) -> Result<(), ResultsError> {
    #[cfg(target_os = "linux")]
    let synced =
        std::fs::File::open(directory).and_then(|directory| Ok(rustix::fs::syncfs(&directory)?));
    #[cfg(not(target_os = "linux"))]
    let synced = Ok(());
    synced.map_err(ResultsError::io("sync the file system of", directory))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn a_thread_syncs_later_while_it_is_asked_to() {
        let synced = Cell::new(0);
        let sync = || {
            sync_now_or_later(|| {
                synced.set(synced.get() + 1);
                Ok(())
            })
        };
        sync().unwrap();
        let later = LaterSync::begin();
        assert!(!later.is_needed());
        sync().unwrap();
        assert!(later.is_needed());
        assert_eq!(synced.get(), 1);
        // Another thread is not affected.
        let elsewhere = std::thread::spawn(|| LATER.get().is_none()).join().unwrap();
        assert!(elsewhere);
        drop(later);
        sync().unwrap();
        assert_eq!(synced.get(), 2);
        let folder = tempfile::tempdir().unwrap();
        sync_file_system(folder.path()).unwrap();
        assert!(sync_file_system(&folder.path().join("missing")).is_err());
    }
}
