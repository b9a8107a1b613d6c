//! The experiment `helix-stability`.

use super::boundary::Boundary;
use super::discrete_rod::first_scene;
use super::files::FILES;
use super::keys::{HelixTables, TABLES, resolve};
use super::sections::section_figures;
use super::surface::boundary_page;
use crate::experiment::data_set::DataSet;
use crate::experiment::kind::Page;
use crate::scenario::Experiment;
use std::sync::Arc;

/// Name of the experiment in scenario files.
const NAME: &str = "helix-stability";

/// Stability limits of clamped helical rods.
pub static HELIX_STABILITY: DataSet = DataSet {
    name: NAME,
    summary: "Stability limits of clamped helical rods.",
    tables: &TABLES,
    refusals: [
        "the rod has length 1 and bending stiffness 1; [helix_stability] defines everything",
        "helices are tested in equilibrium and in a vacuum; leave the table out",
    ],
    resolve: |request| Some(Experiment::new(NAME, resolve(request)?)),
    template: include_str!("template.toml"),
    scene: |scenario| {
        let tables: &HelixTables = scenario.experiment.own();
        Ok(first_scene(&tables.helix_stability))
    },
    job: |scenario| {
        let tables: &HelixTables = scenario.experiment.own();
        Arc::new(Boundary::new(tables.helix_stability.clone()))
    },
    files: &FILES,
    figures: |directory| Ok(section_figures(directory)?),
    page: |directory| {
        Ok(boundary_page(directory)?.map_or(
            Page::Nothing("a boundary, but too few directions for a surface"),
            Page::Own,
        ))
    },
    columns: None,
};
