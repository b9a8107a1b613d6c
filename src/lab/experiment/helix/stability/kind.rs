//! The experiment `helix-stability`.

use super::boundary::Boundary;
use super::discrete_rod::first_scene;
use super::files::{BOUNDARY, FILES};
use super::keys::{HelixTables, TABLES, resolve};
use super::sections::section_figures;
use super::surface::boundary_page;
use crate::experiment::kind::{FigureError, Kind, Page, SCENE_TABLES, refuse_surroundings};
use crate::run::PreparedRun;
use crate::scenario::keys::{CommonTables, ExperimentKeys, OwnTable, Request, Section};
use crate::scenario::{Experiment, Issue, Scenario, Time};
use rodlab_engine::mechanics::scene::Scene;
use rodlab_files::figure::Figure;
use rodlab_files::results::{FileDescription, ResultsError};
use std::path::Path;
use std::sync::Arc;

/// Where clamped helical rods lose stability.
pub struct HelixStabilityKind;

fn tables(scenario: &Scenario) -> &HelixTables {
    let tables = scenario.experiment.tables();
    tables.expect("the tables of this experiment")
}

impl ExperimentKeys for HelixStabilityKind {
    fn name(&self) -> &'static str {
        "helix-stability"
    }

    fn summary(&self) -> &'static str {
        "Where clamped helical rods lose stability."
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
            "the rod has length 1 and bending stiffness 1; [helix_stability] says all of it",
        );
        Some(Experiment::new(self.name(), resolve(request)?))
    }

    fn judge(&self, top: &Section<'_>, common: &CommonTables<'_>) {
        refuse_surroundings(
            top,
            common,
            "helices are judged in equilibrium and in a vacuum; leave the table out",
        );
    }
}

impl Kind for HelixStabilityKind {
    fn template(&self) -> &'static str {
        include_str!("template.toml")
    }

    fn build(&self, scenario: &Scenario, scene: &mut Scene) -> Result<(), Issue> {
        *scene = first_scene(&tables(scenario).helix_stability);
        Ok(())
    }

    fn attach(&self, scenario: &Scenario, run: &mut PreparedRun) -> Result<(), Issue> {
        let boundary = Boundary::new(tables(scenario).helix_stability.clone());
        run.table = Some(Arc::new(boundary));
        Ok(())
    }

    fn files(&self) -> &'static [FileDescription] {
        &FILES
    }

    fn figures(&self, directory: &Path) -> Result<Vec<(&'static str, Figure)>, FigureError> {
        if !directory.join(BOUNDARY).exists() {
            return Ok(Vec::new());
        }
        Ok(section_figures(directory)?)
    }

    fn page(&self, directory: &Path) -> Result<Page, ResultsError> {
        if !directory.join(BOUNDARY).exists() {
            return Ok(Page::RodsInMotion);
        }
        let page = boundary_page(directory)?;
        Ok(page.map_or(
            Page::Nothing("a boundary, but too few directions for a surface"),
            Page::Own,
        ))
    }
}
