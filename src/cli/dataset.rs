//! `rodlab dataset`.

use super::demonstrations::{DemonstrationArguments, Demonstrations, scenario_or_task};
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
  rodlab dataset CableShape --format lerobot --count 100 --out results/laying

The samples are the results of a run, which resumes after an interruption, and can be swept and
submitted to a cluster. With --format the planners demonstrate a task in an environment instead.")]
#[command(mut_arg("scenario", |scenario| scenario
    .value_parser(scenario_or_task())
    .help("The scenario file, or with --format an environment: CableShape or Folding")))]
pub struct DatasetArguments {
    /// Scenario, and options of the run
    #[command(flatten)]
    pub run: RunArguments,
    /// Demonstrations of the planners
    #[command(flatten)]
    pub demonstrations: DemonstrationArguments,
}

impl DatasetArguments {
    /// The requested demonstrations, if any.
    pub(super) fn demonstrations(
        &self,
        common: &Common,
    ) -> Result<Option<Demonstrations>, Failure> {
        (self.demonstrations).of(&self.run.scenario, self.run.out.as_deref(), common)
    }
}

/// Generates a data set.
pub fn dataset(arguments: &DatasetArguments, common: &Common) -> Result<(), Failure> {
    if arguments.demonstrations(common)?.is_some() {
        return Err(Failure::Input(
            "--format: demonstrations are part of the Python package: pip install rodlab".into(),
        ));
    }
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
