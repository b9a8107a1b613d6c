//! Resolved parts of a scene with tables of their own.

use serde::Serialize;
use std::any::Any;
use std::fmt;
use std::sync::Arc;

/// The arrays of all kinds of parts.
#[derive(Clone, Default, Serialize)]
#[serde(transparent)]
pub struct Parts {
    /// The arrays in the canonical form.
    tables: toml::Table,
    #[serde(skip)]
    typed: Vec<Arc<dyn Any + Send + Sync>>,
    /// Largest curvature of a surface in contact, 1/m.
    #[serde(skip)]
    curvature: f64,
}

impl Parts {
    /// Adds the parts of one kind; without parts no table is added.
    pub fn insert<P: Serialize + Any + Send + Sync>(&mut self, key: &str, parts: Vec<P>) {
        if !parts.is_empty() {
            let written = toml::Value::try_from(&parts).expect("numbers and words are TOML");
            self.tables.insert(key.to_owned(), written);
            self.typed.push(Arc::new(parts));
        }
    }

    /// Takes a radius of a surface in contact, m, into the smallest one.
    pub fn note_radius(&mut self, radius: f64) {
        self.curvature = self.curvature.max(1.0 / radius);
    }

    /// Smallest radius of a surface in contact, m; infinite without such parts.
    pub fn smallest_radius(&self) -> f64 {
        1.0 / self.curvature
    }

    /// The parts of one kind.
    pub fn all<P: Any>(&self) -> &[P] {
        let mut kinds = self.typed.iter();
        let parts = kinds.find_map(|kind| kind.downcast_ref::<Vec<P>>());
        parts.map_or(&[], Vec::as_slice)
    }
}

/// Compares the canonical text. Numbers are written so that they read back exactly: equal text
/// means equal numbers.
impl PartialEq for Parts {
    fn eq(&self, other: &Self) -> bool {
        self.tables == other.tables
    }
}

impl fmt::Debug for Parts {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.tables.fmt(formatter)
    }
}
