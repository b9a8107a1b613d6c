//! What can be reproduced: one value for each table and figure, with its runs and what is made of them.

use super::cases::{Case, Run, run_all};
use super::page::{Heading, Page, PageFigure};
use super::{
    ReproduceOptions, Result, auto_steps, cell_correction, cost, deployment_correction,
    deployment_errors, drag_steps, figure_2_5, figure_2_6, figure_2_7, figure_2_8, figure_3_4,
    figure_3_9, figure_4_5, figure_4_9, figure_4_10, figure_4_11, figure_4_11_cell, figure_5_4,
    figure_5_5, figure_5_6, figure_5_8, figure_6_2, figure_6_5, figure_6_6_robot,
    inversion_factors, knot_convergence, laid_patterns, simplified_inversion, table_2_1, table_2_2,
    table_4_1, table_5_2, table_5_2_cell, table_5_3, table_5_4, table_5_4_cell,
};
use std::fmt;
use std::path::{Path, PathBuf};

/// A table or figure of the thesis, or one about this engine itself; each is declared beside what its page is made of.
pub struct Artifact {
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    pub(super) recipe: &'static dyn AnyRecipe,
}

/// All tables and figures.
pub static ARTIFACTS: [Artifact; 41] = [
    table_2_1::ARTIFACT,
    table_2_2::ARTIFACT,
    figure_2_5::ARTIFACT,
    figure_2_6::ARTIFACT,
    figure_2_7::ARTIFACT,
    figure_2_8::ARTIFACT,
    figure_3_4::ARTIFACT,
    inversion_factors::FIGURE_3_5,
    inversion_factors::FIGURE_3_6,
    inversion_factors::FIGURE_3_7,
    figure_3_9::ARTIFACT,
    simplified_inversion::FIGURE_3_10,
    simplified_inversion::FIGURE_3_11,
    figure_4_5::ARTIFACT,
    figure_4_9::ARTIFACT,
    figure_4_10::ARTIFACT,
    figure_4_11::ARTIFACT,
    figure_4_11_cell::ARTIFACT,
    table_4_1::ARTIFACT,
    figure_5_4::ARTIFACT,
    figure_5_5::ARTIFACT,
    figure_5_6::ARTIFACT,
    figure_5_8::ARTIFACT,
    laid_patterns::FIGURE_5_10,
    laid_patterns::FIGURE_5_11,
    table_5_2::ARTIFACT,
    table_5_2_cell::ARTIFACT,
    table_5_3::ARTIFACT,
    table_5_4::ARTIFACT,
    table_5_4_cell::ARTIFACT,
    figure_6_2::FIGURE_6_2,
    figure_6_5::ARTIFACT,
    figure_6_2::FIGURE_6_6,
    figure_6_6_robot::ARTIFACT,
    knot_convergence::ARTIFACT,
    deployment_errors::ARTIFACT,
    deployment_correction::ARTIFACT,
    cell_correction::ARTIFACT,
    cost::ARTIFACT,
    drag_steps::ARTIFACT,
    auto_steps::ARTIFACT,
];

impl Artifact {
    /// The artefact of a name.
    pub fn named(name: &str) -> Option<&'static Self> {
        ARTIFACTS.iter().find(|artifact| artifact.name == name)
    }

    /// What the command line and directories call it.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// What it shows, with its number.
    pub fn title(&self) -> &'static str {
        self.title
    }

    /// What its page is called.
    pub(super) fn heading(&self) -> Heading {
        Heading {
            name: self.name,
            title: self.title,
        }
    }

    /// Rough cost of all its runs on one core, s.
    pub fn cost(&self, quick: bool) -> f64 {
        self.recipe.cost(quick)
    }
}

impl PartialEq for Artifact {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl fmt::Debug for Artifact {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name)
    }
}

/// How an artefact is made: its runs, and the page that is written of them.
pub(super) trait Recipe: Sync {
    /// What is run.
    type Run: Run;

    /// The runs, quick ones or all of their time.
    fn runs(&self, quick: bool) -> Vec<Self::Run>;

    /// Writes the page.
    fn write(&self, page: &mut Page, cases: &[Case<Self::Run>]) -> Result<()>;

    /// The figures from the table alone, where they hold no more.
    fn figures_of_table(&self, _: &Path) -> Option<Result<Vec<PageFigure>>> {
        None
    }
}

/// A page whose figures show more than a table holds.
pub(super) struct Free<R> {
    runs: fn(quick: bool) -> Vec<R>,
    write: fn(&mut Page, &[Case<R>]) -> Result<()>,
}

impl<R> Free<R> {
    /// Runs and what writes their page.
    pub const fn new(
        runs: fn(quick: bool) -> Vec<R>,
        write: fn(&mut Page, &[Case<R>]) -> Result<()>,
    ) -> Self {
        Self { runs, write }
    }
}

impl<R: Run> Recipe for Free<R> {
    type Run = R;

    fn runs(&self, quick: bool) -> Vec<R> {
        (self.runs)(quick)
    }

    fn write(&self, page: &mut Page, cases: &[Case<R>]) -> Result<()> {
        (self.write)(page, cases)
    }
}

/// A [`Recipe`] of whatever runs.
pub(super) trait AnyRecipe: Sync {
    /// Rough cost of all runs on one core, s.
    fn cost(&self, quick: bool) -> f64;

    /// The figures from the table alone, where they hold no more.
    fn redrawn(&self, table: &Path) -> Option<Result<Vec<PageFigure>>>;

    /// Makes the runs and writes the page; returns the files written.
    fn make(
        &self,
        artifact: &'static Artifact,
        options: &ReproduceOptions,
        report: &(dyn Fn(&str) + Sync),
    ) -> Result<Vec<PathBuf>>;

    /// The same with a few steps of the first `count` runs.
    #[cfg(test)]
    fn make_shortened(
        &self,
        artifact: &'static Artifact,
        count: usize,
        options: &ReproduceOptions,
        report: &(dyn Fn(&str) + Sync),
    ) -> Result<Vec<PathBuf>>;

    /// The ids of the runs.
    #[cfg(test)]
    fn ids(&self, quick: bool) -> Vec<String>;

    /// The type of the runs.
    #[cfg(test)]
    fn kind(&self) -> &'static str;

    /// Prepares so many of the runs, each of which has a rod.
    #[cfg(test)]
    fn check_scenarios(&self, quick: bool, count: usize);
}

/// Makes the runs of an artefact and writes its page; returns the files written.
fn make<R: Recipe + ?Sized>(
    recipe: &R,
    artifact: &Artifact,
    runs: &[R::Run],
    options: &ReproduceOptions,
    report: &(dyn Fn(&str) + Sync),
) -> Result<Vec<PathBuf>> {
    let cases = run_all(runs, options, report)?;
    let mut page = Page::begin(artifact.heading(), options, &cases)?;
    recipe.write(&mut page, &cases)?;
    Ok(page.finish()?)
}

impl<R: Recipe> AnyRecipe for R {
    fn cost(&self, quick: bool) -> f64 {
        self.runs(quick).iter().map(Run::cost).sum()
    }

    fn redrawn(&self, table: &Path) -> Option<Result<Vec<PageFigure>>> {
        self.figures_of_table(table)
    }

    fn make(
        &self,
        artifact: &'static Artifact,
        options: &ReproduceOptions,
        report: &(dyn Fn(&str) + Sync),
    ) -> Result<Vec<PathBuf>> {
        make(self, artifact, &self.runs(options.quick), options, report)
    }

    #[cfg(test)]
    fn make_shortened(
        &self,
        artifact: &'static Artifact,
        count: usize,
        options: &ReproduceOptions,
        report: &(dyn Fn(&str) + Sync),
    ) -> Result<Vec<PathBuf>> {
        let runs = self.runs(options.quick);
        let runs: Vec<R::Run> = runs.iter().take(count).map(Run::shortened).collect();
        make(self, artifact, &runs, options, report)
    }

    #[cfg(test)]
    fn ids(&self, quick: bool) -> Vec<String> {
        self.runs(quick).iter().map(Run::id).collect()
    }

    #[cfg(test)]
    fn kind(&self) -> &'static str {
        std::any::type_name::<R::Run>()
    }

    #[cfg(test)]
    fn check_scenarios(&self, quick: bool, count: usize) {
        for run in self.runs(quick).iter().take(count) {
            assert!(!run.prepare().scene.rods.is_empty(), "{}", run.id());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn artefacts_are_found_by_their_names() {
        for artifact in &ARTIFACTS {
            let found = Artifact::named(artifact.name()).unwrap();
            assert_eq!(found.title(), artifact.title());
        }
        assert_eq!(Artifact::named("tab9.9"), None);
    }

    #[test]
    fn runs_of_an_artefact_have_different_ids() {
        for artifact in &ARTIFACTS {
            for quick in [false, true] {
                let ids = artifact.recipe.ids(quick);
                let different: BTreeSet<&String> = ids.iter().collect();
                assert_eq!(different.len(), ids.len(), "{artifact:?}");
            }
        }
    }

    /// One of each kind; the test of the pages prepares more.
    #[test]
    fn runs_of_an_artefact_are_scenarios() {
        let is_full = crate::reproduce::tests_are_full();
        let mut kinds = BTreeSet::new();
        for artifact in &ARTIFACTS {
            let is_new = kinds.insert(artifact.recipe.kind());
            if is_full {
                artifact.recipe.check_scenarios(false, usize::MAX);
                artifact.recipe.check_scenarios(true, usize::MAX);
            } else if is_new {
                artifact.recipe.check_scenarios(true, 1);
            }
        }
    }
}
