//! `rodlab dataset`.

use super::prelude::*;
use super::run::{RunArguments, run};
use super::samples::kinds_with_samples;
use rodlab_lab::experiment::{case_set, kind_named};

/// Arguments of `rodlab dataset`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab dataset scenarios/deployment_dataset.toml
  rodlab dataset deployment_dataset --set grasp_samples.points.count=50000 --out results/many
  rodlab train results/deployment_dataset --out results/network
  rodlab dataset scenarios/folding_dataset.toml

The samples are the results of a run: it resumes after an interruption, can be swept, and can be
submitted to a cluster.")]
pub struct DatasetArguments {
    /// Scenario, and options of the run
    #[command(flatten)]
    pub run: RunArguments,
}

/// Makes a data set.
pub fn dataset(arguments: &DatasetArguments, common: &Common) -> Result<(), Failure> {
    let cases = case_set(
        &arguments.run.scenario,
        &arguments.run.overrides,
        &arguments.run.vary,
    )?;
    let first = cases.scenario_of(0)?;
    let experiment = first.scenario.experiment.name();
    if kind_named(experiment).is_none_or(|kind| kind.samples().is_none()) {
        return Err(Failure::Input(format!(
            "{}: `experiment = {experiment:?}` makes no samples; those that do: {}",
            arguments.run.scenario.display(),
            kinds_with_samples()
        )));
    }
    run(&arguments.run, common)
}
