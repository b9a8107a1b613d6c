//! Interface between a kind of experiment and the rest of the program.

use crate::run::PreparedRun;
use crate::scenario::keys::{CommonTables, ExperimentKeys, Section};
use crate::scenario::{Contact, Fluid, Issue, Scenario, ScenarioError, Time};
use rodlab_engine::mechanics::scene::Scene;
use rodlab_files::figure::Figure;
use rodlab_files::results::{FileDescription, ResultsError};
use rodlab_planning::learn::Compared;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use std::fmt;
use std::path::Path;

/// Figures of a run, each with its file name as SVG.
pub type Figures = Vec<(&'static str, Figure)>;

/// A kind of experiment.
///
/// [`ExperimentKeys`] defines its name, its keys and how they are resolved; this trait defines
/// their use. A new kind needs a folder beside this file and an entry in [`KINDS`](super::KINDS).
pub trait Kind: ExperimentKeys {
    /// The scenario file that `rodlab init` writes. Lines that begin with `#: ` are optional keys.
    fn template(&self) -> &'static str;

    /// Adds the kind's rods, clamps and loads to an empty scene; those listed in the scenario
    /// follow.
    ///
    /// # Errors
    /// Parts that cannot be built, with their keys.
    fn build(&self, _scenario: &Scenario, _scene: &mut Scene) -> Result<(), Issue> {
        Ok(())
    }

    /// Adds the observers and controllers of the run, whose scene is complete.
    ///
    /// # Errors
    /// Parts that cannot be run, with their keys.
    fn attach(&self, _scenario: &Scenario, _run: &mut PreparedRun) -> Result<(), Issue> {
        Ok(())
    }

    /// Numbers for `rodlab check` in addition to those of any scene.
    fn derived(&self, _run: &PreparedRun) -> Option<OwnNumbers> {
        None
    }

    /// Files of the experiment in a results directory, and its columns in the common files, for
    /// `rodlab explain`.
    fn files(&self) -> &'static [FileDescription] {
        &[]
    }

    /// Columns for the training of a network, if the run is a table of samples.
    fn samples(&self) -> Option<SampleColumns> {
        None
    }

    /// Figures of a run that only this experiment draws; empty if the run wrote no data for them.
    ///
    /// # Errors
    /// [`FigureError`] if files of the run cannot be read.
    fn figures(&self, _directory: &Path) -> Result<Figures, FigureError> {
        Ok(Vec::new())
    }

    /// Whether its rods lie on a table, the plane z = 0, which pictures should show.
    fn has_table(&self) -> bool {
        false
    }

    /// The page of `rodlab view`, if it does not show rods in motion.
    ///
    /// # Errors
    /// Where files of the run cannot be read.
    fn page(&self, _directory: &Path) -> Result<Page, ResultsError> {
        Ok(Page::RodsInMotion)
    }
}

impl fmt::Debug for dyn Kind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// Tables with the contents of a scene. Dimensionless kinds do not use them.
pub(super) const SCENE_TABLES: [&str; 11] = [
    "material",
    "rod",
    "rods",
    "clamps",
    "joints",
    "bodies",
    "networks",
    "loads",
    "actuation",
    "planes",
    "obstacles",
];

/// Rejects time, contact and fluid for kinds without them; `why` is the reason for the user.
pub(super) fn refuse_surroundings(top: &Section<'_>, common: &CommonTables<'_>, why: &str) {
    let keys = [
        ("time", *common.time != Time::Static),
        ("contact", *common.contact != Contact::None),
        ("fluid", *common.fluid != Fluid::None),
    ];
    top.refuse(&keys, why);
}

/// Numbers derived from the scenario by one kind of experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnNumbers {
    key: &'static str,
    json: serde_json::Value,
    lines: Vec<(String, String)>,
}

impl OwnNumbers {
    /// Numbers with the JSON key `key`, and as lines of text, each with a name and a value.
    pub fn new<'a>(
        key: &'static str,
        numbers: &impl Serialize,
        lines: impl IntoIterator<Item = (&'a str, String)>,
    ) -> Self {
        let json = serde_json::to_value(numbers);
        let lines = lines.into_iter();
        Self {
            key,
            json: json.expect("numbers and names are JSON values"),
            lines: lines
                .map(|(name, value)| (name.to_owned(), value))
                .collect(),
        }
    }

    /// Name and value of each line.
    pub fn lines(&self) -> &[(String, String)] {
        &self.lines
    }
}

impl Serialize for OwnNumbers {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut table = serializer.serialize_map(Some(1))?;
        table.serialize_entry(self.key, &self.json)?;
        table.end()
    }
}

/// Columns of a table of samples.
#[derive(Clone, Copy, Debug)]
pub struct SampleColumns {
    /// The table.
    pub file: &'static str,
    /// Columns from which a network predicts.
    pub inputs: &'static [&'static str],
    /// Columns that it predicts; rows with empty values are left out.
    pub outputs: &'static [&'static str],
    /// Weights of the errors of these columns; empty for equal weights.
    pub weights: &'static [f64],
    /// Quantities whose errors are reported.
    pub compared: &'static [Compared],
}

/// Page that `rodlab view` shows of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Page {
    /// Rods in motion, as in any run.
    RodsInMotion,
    /// A page of its own.
    Own(String),
    /// Nothing, and why.
    Nothing(&'static str),
}

/// Reason why a figure of an experiment is not drawn.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// The scenario of the results could not be read.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A file could not be read.
    #[error(transparent)]
    Results(#[from] ResultsError),
}
