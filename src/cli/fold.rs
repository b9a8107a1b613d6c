//! `rodlab fold`.

use super::fold_arguments::FoldArguments;
use super::fold_in_cell::fold_in_cell;
use super::fold_simulation::fold_in_simulation;
use super::prelude::*;
use rodlab_lab::experiment::PaperFile;

/// Folds a sheet in a cell or in simulation.
pub fn fold(arguments: &FoldArguments, common: &Common) -> Result<(), Failure> {
    let file = PaperFile::read(&arguments.paper)?;
    let target = file.paper.target(arguments.crease).at("--crease")?;
    if arguments.feedback.is_some() && !arguments.algorithm().is_planned_anew() {
        let message = "--feedback: this way of folding is not planned anew: use `held`, `optimal` or `least-friction`";
        return Err(Failure::Input(message.into()));
    }
    let Some(friction) = arguments.friction.or(file.paper.friction) else {
        let message =
            "the friction of the table is needed: --friction, or `folding.paper.friction`";
        return Err(Failure::Input(message.into()));
    };
    if arguments.simulate {
        return fold_in_simulation(arguments, &file.title, friction, common);
    }
    fold_in_cell(arguments, &file, target, friction)
}
