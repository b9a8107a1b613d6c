//! Writing to standard output.

use super::failure::Failure;
use std::io::{ErrorKind, Write};

/// Writes text to standard output. A reader that has gone away, as `head` does, is no fault.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    match stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
    {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::System(format!(
            "standard output cannot be written: {error}"
        ))),
        _ => Ok(()),
    }
}
