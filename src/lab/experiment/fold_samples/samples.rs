//! All samples of an experiment, each solved independently.

use super::figure::figure;
use super::keys::FoldSamples;
use super::places::places;
use super::row::{Outcome, Sample};
use crate::experiment::data_set::{SAMPLES, SAMPLES_FIGURE};
use crate::run::TableJob;
use rodlab_files::figure::Paper;
use rodlab_files::results::{ResultsError, write_whole};
use rodlab_planning::plan::fold::FoldAtlas;
use std::path::Path;
use std::sync::OnceLock;

/// Folds at the positions of an experiment.
#[derive(Debug)]
pub struct Samples {
    plan: FoldSamples,
    places: OnceLock<Vec<[f64; 2]>>,
    atlas: OnceLock<FoldAtlas>,
}

impl Samples {
    /// The positions are computed on first use.
    pub fn new(plan: FoldSamples) -> Self {
        Self {
            plan,
            places: OnceLock::new(),
            atlas: OnceLock::new(),
        }
    }

    fn places(&self) -> &[[f64; 2]] {
        self.places
            .get_or_init(|| places(&self.plan).unwrap_or_default())
    }
}

impl TableJob for Samples {
    type Row = Sample;

    const TABLE: &'static str = SAMPLES;
    const ROWS: &'static str = "samples";

    fn count(&self) -> usize {
        self.places().len()
    }

    /// No other sample is used, so that rows do not depend on the order in which they are
    /// computed.
    fn row(&self, index: usize, goes_on: &(dyn Fn() -> bool + Sync)) -> Option<Sample> {
        if !goes_on() {
            return None;
        }
        let place = self.places()[index];
        let fold = self.atlas.get_or_init(FoldAtlas::new).solve(place).ok();
        let least = self.plan.least_suspended_length;
        Some(Sample::new(place, fold.as_ref(), least))
    }

    fn conclude(&self, rows: &[Sample], directory: &Path) -> Result<Vec<String>, ResultsError> {
        let svg = figure(rows, &self.plan).svg(&Paper::default());
        write_whole(&directory.join(SAMPLES_FIGURE), svg.as_bytes())?;
        let missing = rows
            .iter()
            .filter(|row| row.outcome == Outcome::OutOfReach)
            .count();
        let penalty = rows.iter().filter(|row| row.penalty == Some(true)).count();
        Ok(vec![format!(
            "{} folds, {penalty} of them in the penalty region; {missing} places without one",
            rows.len() - missing
        )])
    }
}
