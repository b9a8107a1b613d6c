//! How a page is made, whatever it is made of.

use super::page::Heading;
use super::table::FiguresOfTable;
use super::{ReproduceError, ReproduceOptions};
use std::path::PathBuf;

/// How an artefact is made.
pub(super) trait AnyRecipe: Sync {
    /// Rough cost of all runs on one core, s.
    fn cost(&self, quick: bool) -> f64;

    /// The figures from the table alone.
    fn figures_of_table(&self) -> Option<FiguresOfTable>;

    /// Makes the runs and writes the page; returns the files written.
    fn make(
        &self,
        heading: Heading,
        options: &ReproduceOptions,
        report: &(dyn Fn(&str) + Sync),
    ) -> Result<Vec<PathBuf>, ReproduceError>;

    /// The same with a few steps of the first `count` runs.
    #[cfg(test)]
    fn make_shortened(
        &self,
        heading: Heading,
        count: usize,
        options: &ReproduceOptions,
        report: &(dyn Fn(&str) + Sync),
    ) -> Result<Vec<PathBuf>, ReproduceError>;

    /// The ids of the runs, each of which is prepared.
    #[cfg(test)]
    fn ids(&self, quick: bool) -> Vec<String>;
}
