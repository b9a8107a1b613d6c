//! `rodlab fold`.

use super::fold_arguments::FoldArguments;
use super::fold_simulation::fold_in_simulation;
use super::in_cell::InCell;
use super::prelude::*;

/// Folds a sheet in a cell or in simulation.
pub fn fold(command: &InCell<FoldArguments>, common: &Common) -> Result<(), Failure> {
    let arguments = &command.what;
    let sheet = arguments.sheet()?;
    match arguments.simulate {
        true => fold_in_simulation(arguments, &sheet.file.title, sheet.friction, common),
        false => command.run(common),
    }
}
