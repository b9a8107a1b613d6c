//! The experiment `fold-samples`.

use super::figure::samples_figure;
use super::files::FILES;
use super::keys::{FoldSamples, SampleTables, TABLES, resolve};
use super::lifted_sheet::lifted_sheet;
use super::samples::Samples;
use crate::experiment::data_set::{DataSet, SAMPLES, SAMPLES_FIGURE};
use crate::experiment::kind::{Page, SampleColumns};
use crate::experiment::load;
use crate::scenario::{Experiment, Issue, KeyPath, Scenario};
use rodlab_files::results::SCENARIO;
use rodlab_planning::plan::fold::NeuralFolds;
use std::sync::Arc;

/// Folds of a sheet at many positions of the gripper.
pub static FOLD_SAMPLES: DataSet = DataSet {
    name: NeuralFolds::SAMPLES,
    summary: "Folds of a sheet at many places of the gripper, for a network to learn from.",
    tables: &TABLES,
    refusals: [
        "folds are dimensionless: L_gb = 1 and EI = 1; [fold_samples] defines everything",
        "folds are solved for in equilibrium and in a vacuum; leave the table out",
    ],
    resolve: |request| Some(Experiment::new(NeuralFolds::SAMPLES, resolve(request)?)),
    template: include_str!("template.toml"),
    scene: |scenario| {
        lifted_sheet(plan(scenario)).ok_or_else(|| {
            let key = KeyPath::from("fold_samples.suspended_length");
            Issue::new(
                key,
                "no sheet of the longest suspended length can be lifted",
            )
        })
    },
    job: |scenario| Arc::new(Samples::new(plan(scenario).clone())),
    files: &FILES,
    figures: |directory| {
        let scenario = load(&directory.join(SCENARIO), &[])?.scenario;
        let figure = samples_figure(directory, plan(&scenario))?;
        Ok(vec![(SAMPLES_FIGURE, figure)])
    },
    page: |_| Ok(Page::Nothing("samples of folds; rodlab plot draws them")),
    columns: Some(SampleColumns {
        file: SAMPLES,
        inputs: &NeuralFolds::INPUTS,
        outputs: &NeuralFolds::OUTPUTS,
        weights: &NeuralFolds::WEIGHTS,
        compared: &NeuralFolds::COMPARED,
    }),
};

fn plan(scenario: &Scenario) -> &FoldSamples {
    let tables: &SampleTables = scenario.experiment.own();
    &tables.fold_samples
}
