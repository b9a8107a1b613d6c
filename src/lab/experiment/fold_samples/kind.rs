//! The experiment `fold-samples`.

use super::figure::samples_figure;
use super::files::{FILES, SAMPLES, SAMPLES_FIGURE};
use super::keys::{SampleTables, TABLES, resolve};
use super::lifted_sheet::lifted_sheet;
use super::samples::Samples;
use crate::experiment::kind::{
    FigureError, Kind, Page, SCENE_TABLES, SampleColumns, refuse_surroundings,
};
use crate::experiment::load;
use crate::run::PreparedRun;
use crate::scenario::keys::{CommonTables, ExperimentKeys, OwnTable, Request, Section};
use crate::scenario::{Experiment, Issue, KeyPath, Scenario, Time};
use rodlab_engine::mechanics::scene::Scene;
use rodlab_files::figure::Figure;
use rodlab_files::results::{FileDescription, ResultsError, SCENARIO};
use rodlab_planning::plan::fold::NeuralFolds;
use std::path::Path;
use std::sync::Arc;

/// Folds of a sheet at many places of the gripper.
pub struct FoldSamplesKind;

fn tables(scenario: &Scenario) -> &SampleTables {
    let tables = scenario.experiment.tables();
    tables.expect("the tables of this experiment")
}

impl ExperimentKeys for FoldSamplesKind {
    fn name(&self) -> &'static str {
        "fold-samples"
    }

    fn summary(&self) -> &'static str {
        "Folds of a sheet at many places of the gripper, for a network to learn from."
    }

    fn tables(&self) -> &'static [OwnTable] {
        &TABLES
    }

    /// Equilibria all of them; there is no time to speak of.
    fn usual_time(&self) -> Option<Time> {
        Some(Time::Static)
    }

    fn resolve(&self, request: &Request<'_>) -> Option<Experiment> {
        request.refuse(
            &SCENE_TABLES,
            "folds are dimensionless: L_gb = 1 and EI = 1; [fold_samples] says all of it",
        );
        Some(Experiment::new(self.name(), resolve(request)?))
    }

    fn judge(&self, top: &Section<'_>, common: &CommonTables<'_>) {
        refuse_surroundings(
            top,
            common,
            "folds are solved for in equilibrium and in a vacuum; leave the table out",
        );
    }
}

impl Kind for FoldSamplesKind {
    fn template(&self) -> &'static str {
        include_str!("template.toml")
    }

    fn build(&self, scenario: &Scenario, scene: &mut Scene) -> Result<(), Issue> {
        let sheet = lifted_sheet(&tables(scenario).fold_samples);
        *scene = sheet.ok_or_else(|| {
            let key = KeyPath::from("fold_samples.suspended_length");
            Issue::new(
                key,
                "no sheet of the longest suspended length can be lifted",
            )
        })?;
        Ok(())
    }

    fn attach(&self, scenario: &Scenario, run: &mut PreparedRun) -> Result<(), Issue> {
        run.table = Some(Arc::new(Samples::new(
            tables(scenario).fold_samples.clone(),
        )));
        Ok(())
    }

    fn files(&self) -> &'static [FileDescription] {
        &FILES
    }

    fn figures(&self, directory: &Path) -> Result<Vec<(&'static str, Figure)>, FigureError> {
        if !directory.join(SAMPLES).exists() {
            return Ok(Vec::new());
        }
        let scenario = load(&directory.join(SCENARIO), &[])?.scenario;
        let figure = samples_figure(directory, &tables(&scenario).fold_samples)?;
        Ok(vec![(SAMPLES_FIGURE, figure)])
    }

    fn page(&self, directory: &Path) -> Result<Page, ResultsError> {
        Ok(if directory.join(SAMPLES).exists() {
            Page::Nothing("samples of folds; rodlab plot draws them")
        } else {
            Page::RodsInMotion
        })
    }

    fn samples(&self) -> Option<SampleColumns> {
        Some(SampleColumns {
            file: SAMPLES,
            inputs: &NeuralFolds::INPUTS,
            outputs: &NeuralFolds::OUTPUTS,
            weights: &NeuralFolds::WEIGHTS,
            compared: &NeuralFolds::COMPARED,
        })
    }
}
