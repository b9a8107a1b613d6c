//! Experiments whose results are samples for a network to learn from: a table with a row per point, and its figure.

use super::kind::{FigureError, Kind, Page, SCENE_TABLES, SampleColumns, refuse_surroundings};
use crate::run::{PreparedRun, TableRun};
use crate::scenario::keys::{CommonTables, ExperimentKeys, OwnTable, Request, Section};
use crate::scenario::{Experiment, Issue, Scenario, Time};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{Clamp, Load, LoadKind, Motion, RodDescription, Scene};
use rodlab_files::figure::Figure;
use rodlab_files::results::{FileDescription, ResultsError};
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;

/// The samples, a row per point.
pub const SAMPLES: &str = "samples.csv";

/// The same as a figure.
pub const SAMPLES_FIGURE: &str = "samples.svg";

/// From one number to another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Span {
    /// The least.
    pub from: f64,
    /// The largest.
    pub to: f64,
}

/// A kind of data set.
pub struct DataSet {
    /// Its name in scenario files.
    pub name: &'static str,
    /// A sentence about it.
    pub summary: &'static str,
    /// Its table.
    pub tables: &'static [OwnTable],
    /// Why a scenario has no scene, and why it has no time, contact and fluid.
    pub refusals: [&'static str; 2],
    /// Resolves the table; `None` if something is at fault, which is reported.
    pub resolve: fn(&Request<'_>) -> Option<Experiment>,
    /// The scenario file that `rodlab init` writes.
    pub template: &'static str,
    /// The scene that stands for all samples.
    pub scene: fn(&Scenario) -> Result<Scene, Issue>,
    /// The computation of the samples.
    pub job: fn(&Scenario) -> Arc<dyn TableRun>,
    /// Its files.
    pub files: &'static [FileDescription],
    /// The figure of the samples in a results directory.
    pub figure: fn(&Path) -> Result<Figure, FigureError>,
    /// What `rodlab view` shows of it.
    pub page: &'static str,
    /// What a network learns.
    pub columns: SampleColumns,
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

    /// All samples are equilibria.
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

    fn figures(&self, directory: &Path) -> Result<Vec<(&'static str, Figure)>, FigureError> {
        if !directory.join(SAMPLES).exists() {
            return Ok(Vec::new());
        }
        Ok(vec![(SAMPLES_FIGURE, (self.figure)(directory)?)])
    }

    fn page(&self, directory: &Path) -> Result<Page, ResultsError> {
        Ok(if directory.join(SAMPLES).exists() {
            Page::Nothing(self.page)
        } else {
            Page::RodsInMotion
        })
    }

    fn samples(&self) -> Option<SampleColumns> {
        Some(self.columns)
    }
}

/// A rod that hangs under its weight between its ends, of which the first is clamped, and the last held with or without its frame.
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
