//! The safety signals of a cell and its diagnostics, for commands that move arms.

use super::prelude::*;
use rodlab_files::results::write_whole;
use rodlab_workcell::cell::{Cell, Signals};
use rodlab_workcell::task::Diagnostics;

/// Subscribes to the safety signals of a cell.
///
/// # Errors
/// A topic cannot be subscribed to, or sends nothing.
pub fn open_signals(cell: &Cell) -> Result<Signals, Failure> {
    Signals::open(&cell.safety.signals).map_err(|error| Failure::System(error.to_string()))
}

/// Advertises the topic of the diagnostics of a cell, if its file names one.
///
/// # Errors
/// The master does not answer, or there is no such network.
pub fn open_diagnostics(cell: &Cell) -> Result<Option<Diagnostics>, Failure> {
    Diagnostics::open(cell).map_err(|error| Failure::System(format!("diagnostics: {error}")))
}

/// Writes what the signals have sent into `signals.csv`, if there are some.
///
/// # Errors
/// The file cannot be written.
pub fn write_signals(signals: &Signals, directory: &Path) -> Result<(), Failure> {
    match signals.log() {
        Some(table) => Ok(write_whole(
            &directory.join("signals.csv"),
            table.as_bytes(),
        )?),
        None => Ok(()),
    }
}
