//! Writing to standard error.

use super::terminal::printable;
use std::io::Write;

/// Writes text to standard error. Where that is closed or full, nobody can be reached: the exit code says what happened,
/// and stays what it is. Control characters are replaced, see [`printable`].
pub fn report(text: &str) {
    let mut stderr = std::io::stderr().lock();
    let _ = stderr
        .write_all(printable(text).as_bytes())
        .and_then(|()| stderr.flush());
}
