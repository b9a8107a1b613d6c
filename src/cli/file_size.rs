//! A limit on the size of files (`ulimit -f`).

/// Prevents the signal of a file that grows beyond the limit from ending the program: the write fails instead, and is reported
/// like that to a full disk.
#[cfg(unix)]
pub fn report_as_errors() {
    use signal_hook::consts::SIGXFSZ;
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;
    // A handler in place of the default action; nothing reads its flag. Where it cannot be set, the default stays.
    let _ = signal_hook::flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
}

/// Does nothing: other systems have no such signal.
#[cfg(not(unix))]
pub fn report_as_errors() {}
