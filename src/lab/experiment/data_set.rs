//! Experiments that fill a table with one row per point, each solved independently, such as
//! training samples for a network.

use super::kind::{
    FigureError, Figures, Kind, Page, SCENE_TABLES, SampleColumns, refuse_surroundings,
};
use crate::run::{PreparedRun, TableRun};
use crate::scenario::keys::{CommonTables, ExperimentKeys, OwnTable, Request, Section};
use crate::scenario::{Experiment, Issue, Scenario, Time};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{Clamp, Load, LoadKind, Motion, RodDescription, Scene};
use rodlab_files::results::{FileDescription, ResultsError};
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;

/// Samples, a row per point.
pub const SAMPLES: &str = "samples.csv";

/// The same as a figure.
pub const SAMPLES_FIGURE: &str = "samples.svg";

/// Range of a number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Span {
    /// Smallest value of the range.
    pub from: f64,
    /// Largest value of the range.
    pub to: f64,
}

/// A kind of experiment that fills a table.
pub struct DataSet {
    /// Name of the data set in scenario files.
    pub name: &'static str,
    /// A sentence about it.
    pub summary: &'static str,
    /// Table of keys of the data set.
    pub tables: &'static [OwnTable],
    /// Reasons why a scenario has no scene, and why it has no time, contact and fluid.
    pub refusals: [&'static str; 2],
    /// Resolves the table of keys; `None` after a fault, which is reported.
    pub resolve: fn(&Request<'_>) -> Option<Experiment>,
    /// The scenario file that `rodlab init` writes.
    pub template: &'static str,
    /// The scene that represents all rows.
    pub scene: fn(&Scenario) -> Result<Scene, Issue>,
    /// The job that computes the rows.
    pub job: fn(&Scenario) -> Arc<dyn TableRun>,
    /// The files of the experiment; the table is the first.
    pub files: &'static [FileDescription],
    /// The figures of the rows in a results directory, by file name.
    pub figures: fn(&Path) -> Result<Figures, FigureError>,
    /// The page of `rodlab view` for the rows in a results directory.
    pub page: fn(&Path) -> Result<Page, ResultsError>,
    /// Columns for the training of a network, if any.
    pub columns: Option<SampleColumns>,
}

impl DataSet {
    fn is_in(&self, directory: &Path) -> bool {
        directory.join(self.files[0].names[0]).exists()
    }
}

impl ExperimentKeys for DataSet {
    fn name(&self) -> &'static str {
        self.name
    }

    fn summary(&self) -> &'static str {
        self.summary
    }

    fn tables(&self) -> &'static [OwnTable] {
        self.tables
    }

    /// All rows are equilibria.
    fn usual_time(&self) -> Option<Time> {
        Some(Time::Static)
    }

    fn resolve(&self, request: &Request<'_>) -> Option<Experiment> {
        request.refuse(&SCENE_TABLES, self.refusals[0]);
        (self.resolve)(request)
    }

    fn judge(&self, top: &Section<'_>, common: &CommonTables<'_>) {
        refuse_surroundings(top, common, self.refusals[1]);
    }
}

impl Kind for DataSet {
    fn template(&self) -> &'static str {
        self.template
    }

    fn build(&self, scenario: &Scenario, scene: &mut Scene) -> Result<(), Issue> {
        *scene = (self.scene)(scenario)?;
        Ok(())
    }

    fn attach(&self, scenario: &Scenario, run: &mut PreparedRun) -> Result<(), Issue> {
        run.table = Some((self.job)(scenario));
        Ok(())
    }

    fn files(&self) -> &'static [FileDescription] {
        self.files
    }

    fn figures(&self, directory: &Path) -> Result<Figures, FigureError> {
        if !self.is_in(directory) {
            return Ok(Vec::new());
        }
        (self.figures)(directory)
    }

    fn page(&self, directory: &Path) -> Result<Page, ResultsError> {
        if !self.is_in(directory) {
            return Ok(Page::RodsInMotion);
        }
        (self.page)(directory)
    }

    fn samples(&self) -> Option<SampleColumns> {
        self.columns
    }
}

/// A rod that hangs under its weight between its ends. The first end is clamped; the last is held
/// with or without its frame.
pub fn hanging(rod: RodDescription, holds_last_frame: bool) -> Scene {
    let clamp = |node, holds_frame| Clamp {
        rod: 0,
        node,
        holds_position: true,
        holds_frame,
        motion: Motion::default(),
    };
    Scene {
        clamps: vec![
            clamp(0, true),
            clamp(rod.centreline.len() - 1, holds_last_frame),
        ],
        rods: vec![rod],
        loads: vec![Load {
            kind: LoadKind::Gravity {
                acceleration: -Vector3::z(),
            },
            schedule: Vec::new(),
        }],
        ..Scene::default()
    }
}
