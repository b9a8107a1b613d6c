//! Parts of a scene with tables of their own, as resolved.

use serde::Serialize;
use std::any::Any;
use std::fmt;
use std::sync::Arc;

/// The arrays of all kinds of parts.
#[derive(Clone, Default, Serialize)]
#[serde(transparent)]
pub struct Parts {
    /// As written in the canonical form.
    tables: toml::Table,
    #[serde(skip)]
    typed: Vec<Arc<dyn Any + Send + Sync>>,
}

impl Parts {
    /// Adds the parts of one kind; none leave no table.
    pub fn insert<P: Serialize + Any + Send + Sync>(&mut self, key: &str, parts: Vec<P>) {
        if !parts.is_empty() {
            let written = toml::Value::try_from(&parts).expect("numbers and words are TOML");
            self.tables.insert(key.to_owned(), written);
            self.typed.push(Arc::new(parts));
        }
    }

    /// The parts of one kind.
    pub fn all<P: Any>(&self) -> &[P] {
        let mut kinds = self.typed.iter();
        let parts = kinds.find_map(|kind| kind.downcast_ref::<Vec<P>>());
        parts.map_or(&[], Vec::as_slice)
    }
}

/// Numbers are written so that they read back exactly: equal text means equal numbers.
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
