//! The experiment `grasp-samples`.

use super::figure::samples_figure;
use super::files::{FILES, SAMPLES, SAMPLES_FIGURE};
use super::hanging_rod::hanging_rod;
use super::keys::{SampleTables, TABLES, resolve};
use super::samples::Samples;
use crate::experiment::kind::{
    FigureError, Kind, Page, SCENE_TABLES, SampleColumns, refuse_surroundings,
};
use crate::run::PreparedRun;
use crate::scenario::keys::{CommonTables, ExperimentKeys, OwnTable, Request, Section};
use crate::scenario::{Experiment, Issue, KeyPath, Scenario, Time};
use rodlab_engine::mechanics::scene::Scene;
use rodlab_files::figure::Figure;
use rodlab_files::results::{FileDescription, ResultsError};
use rodlab_planning::plan::grasp::NeuralGrasps;
use std::path::Path;
use std::sync::Arc;

/// Optimal grasps at many points.
pub struct GraspSamplesKind;

fn tables(scenario: &Scenario) -> &SampleTables {
    let tables = scenario.experiment.tables();
    tables.expect("the tables of this experiment")
}

impl ExperimentKeys for GraspSamplesKind {
    fn name(&self) -> &'static str {
        "grasp-samples"
    }

    fn summary(&self) -> &'static str {
        "Optimal grasps at many points, for a network to learn from."
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
            "grasps are dimensionless: L_gb = 1 and EI = 1; [grasp_samples] says all of it",
        );
        Some(Experiment::new(self.name(), resolve(request)?))
    }

    fn judge(&self, top: &Section<'_>, common: &CommonTables<'_>) {
        refuse_surroundings(
            top,
            common,
            "grasps are solved for in equilibrium and in a vacuum; leave the table out",
        );
    }
}

impl Kind for GraspSamplesKind {
    fn template(&self) -> &'static str {
        include_str!("template.toml")
    }

    fn build(&self, scenario: &Scenario, scene: &mut Scene) -> Result<(), Issue> {
        *scene = hanging_rod(&tables(scenario).grasp_samples).map_err(|error| {
            Issue::new(KeyPath::from("grasp_samples.points"), error.to_string())
        })?;
        Ok(())
    }

    fn attach(&self, scenario: &Scenario, run: &mut PreparedRun) -> Result<(), Issue> {
        run.table = Some(Arc::new(Samples {
            plan: tables(scenario).grasp_samples.clone(),
        }));
        Ok(())
    }

    fn files(&self) -> &'static [FileDescription] {
        &FILES
    }

    fn figures(&self, directory: &Path) -> Result<Vec<(&'static str, Figure)>, FigureError> {
        if !directory.join(SAMPLES).exists() {
            return Ok(Vec::new());
        }
        Ok(vec![(SAMPLES_FIGURE, samples_figure(directory)?)])
    }

    fn page(&self, directory: &Path) -> Result<Page, ResultsError> {
        Ok(if directory.join(SAMPLES).exists() {
            Page::Nothing("samples of grasps; rodlab plot draws them")
        } else {
            Page::RodsInMotion
        })
    }

    fn samples(&self) -> Option<SampleColumns> {
        Some(SampleColumns {
            file: SAMPLES,
            inputs: &NeuralGrasps::INPUTS,
            outputs: &NeuralGrasps::OUTPUTS,
            weights: &[],
            compared: &NeuralGrasps::COMPARED,
        })
    }
}
