//! The experiment `grasp-samples`.

use super::figure::samples_figure;
use super::files::FILES;
use super::hanging_rod::hanging_rod;
use super::keys::{GraspSamples, SampleTables, TABLES, resolve};
use super::samples::Samples;
use crate::experiment::data_set::{DataSet, SAMPLES, SAMPLES_FIGURE};
use crate::experiment::kind::{Page, SampleColumns};
use crate::scenario::{Experiment, Issue, KeyPath, Scenario};
use rodlab_planning::plan::grasp::NeuralGrasps;
use std::sync::Arc;

/// Optimal grasps at many points.
pub static GRASP_SAMPLES: DataSet = DataSet {
    name: NeuralGrasps::SAMPLES,
    summary: "Optimal grasps at many points, for a network to learn from.",
    tables: &TABLES,
    refusals: [
        "grasps are dimensionless: L_gb = 1 and EI = 1; [grasp_samples] defines everything",
        "grasps are solved for in equilibrium and in a vacuum; leave the table out",
    ],
    resolve: |request| Some(Experiment::new(NeuralGrasps::SAMPLES, resolve(request)?)),
    template: include_str!("template.toml"),
    scene: |scenario| {
        hanging_rod(plan(scenario))
            .map_err(|error| Issue::new(KeyPath::from("grasp_samples.points"), error.to_string()))
    },
    job: |scenario| {
        Arc::new(Samples {
            plan: plan(scenario).clone(),
        })
    },
    files: &FILES,
    figures: |directory| Ok(vec![(SAMPLES_FIGURE, samples_figure(directory)?)]),
    page: |_| Ok(Page::Nothing("samples of grasps; rodlab plot draws them")),
    columns: Some(SampleColumns {
        file: SAMPLES,
        inputs: &NeuralGrasps::INPUTS,
        outputs: &NeuralGrasps::OUTPUTS,
        weights: &[],
        compared: &NeuralGrasps::COMPARED,
    }),
};

fn plan(scenario: &Scenario) -> &GraspSamples {
    let tables: &SampleTables = scenario.experiment.own();
    &tables.grasp_samples
}
