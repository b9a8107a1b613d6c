//! The experiment of a resolved scenario.

use serde::Serialize;
use std::any::Any;
use std::fmt;
use std::sync::Arc;

/// Rods built by a builder.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BuilderRod {
    /// Radius of each rod, m.
    pub radius: f64,
    /// Nodes of each rod.
    pub nodes: usize,
}

/// The experiment that builds the scene, and its own tables.
#[derive(Clone, Serialize)]
pub struct Experiment {
    #[serde(rename = "experiment")]
    name: &'static str,
    /// The tables as written in the canonical form.
    #[serde(flatten)]
    tables: toml::Table,
    #[serde(skip)]
    typed: Arc<dyn Any + Send + Sync>,
    #[serde(skip)]
    smallest_radius: f64,
}

impl Experiment {
    /// The experiment called `name` with its resolved tables: `tables` is a struct with a field
    /// for each table.
    pub fn new<T: Serialize + Any + Send + Sync>(name: &'static str, tables: T) -> Self {
        let table = toml::Table::try_from(&tables);
        Self {
            name,
            tables: table.expect("tables of numbers and words are TOML"),
            typed: Arc::new(tables),
            smallest_radius: f64::INFINITY,
        }
    }

    /// Sets the smallest radius of its rods (m).
    #[must_use]
    pub fn with_radius(self, smallest_radius: f64) -> Self {
        Self {
            smallest_radius,
            ..self
        }
    }

    /// Name of the experiment in scenario files.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Smallest radius of the rods that it builds, m; infinite if it builds none.
    pub fn smallest_radius(&self) -> f64 {
        self.smallest_radius
    }

    /// Tables of the experiment, with the type in which its kind resolved them.
    pub fn own<T: Any>(&self) -> &T {
        let tables = self.tables();
        tables.expect("the tables of this experiment")
    }

    /// Tables of the experiment; `None` if they are of another type.
    pub fn tables<T: Any>(&self) -> Option<&T> {
        self.typed.downcast_ref()
    }
}

/// Compares the canonical text. Numbers are written so that they read back exactly: equal text
/// means equal numbers.
impl PartialEq for Experiment {
    fn eq(&self, other: &Self) -> bool {
        (self.name, &self.tables) == (other.name, &other.tables)
    }
}

impl fmt::Debug for Experiment {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut experiment = formatter.debug_struct("Experiment");
        experiment.field("name", &self.name);
        experiment.field("tables", &self.tables).finish()
    }
}
