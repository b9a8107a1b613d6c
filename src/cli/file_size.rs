//! Limits on the size of files (`ulimit -f`).

/// Prevents the signal of a file that grows beyond the limit from ending the program. The write
/// fails instead, and is reported like a write to a full disk.
#[cfg(unix)]
pub fn report_as_errors() {
    use signal_hook::consts::SIGXFSZ;
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;
    // A handler replaces the default action; its flag is not read. If it cannot be set, the
    // default action remains.
    let _ = signal_hook::flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
}

/// Does nothing, since other systems have no such signal.
#[cfg(not(unix))]
pub fn report_as_errors() {}
