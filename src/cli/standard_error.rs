//! Writing to standard error.

use super::terminal::printable;
use std::io::Write;

/// Writes text to standard error. If standard error is closed or full, only the unchanged exit
/// code reports the failure. Control characters are replaced, see [`printable`].
pub fn report(text: &str) {
    let mut stderr = std::io::stderr().lock();
    let _ = stderr
        .write_all(printable(text).as_bytes())
        .and_then(|()| stderr.flush());
}
