//! The artefacts, one for each table and figure, with its runs and its page.

use super::cases::{Case, Run, run_all};
use super::page::{Heading, Page, PageFigure};
use super::{ReproduceOptions, Result};
use std::fmt;
use std::path::{Path, PathBuf};

/// A table or figure of the thesis, or a table or figure about this engine itself. Each is
/// declared next to the code of its page.
#[derive(Clone)]
pub struct Artifact {
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    pub(super) recipe: &'static dyn AnyRecipe,
}

impl Artifact {
    /// Name on the command line and of directories.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Title with its number.
    pub fn title(&self) -> &'static str {
        self.title
    }

    /// Name and title of the page.
    pub(super) fn heading(&self) -> Heading {
        Heading {
            name: self.name,
            title: self.title,
        }
    }

    /// Rough cost of all runs on one core, s.
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

/// Recipe of an artefact: its runs, and its page.
pub(super) trait Recipe: Sync {
    /// The run.
    type Run: Run;

    /// The runs, quick or complete.
    fn runs(&self, quick: bool) -> Vec<Self::Run>;

    /// Writes the page.
    fn write(&self, page: &mut Page, cases: &[Case<Self::Run>]) -> Result<()>;

    /// Draws the figures from the table alone, if the table is sufficient.
    fn figures_of_table(&self, _: &Path) -> Option<Result<Vec<PageFigure>>> {
        None
    }
}

/// A page whose figures need more data than a table contains.
pub(super) struct Free<R> {
    runs: fn(quick: bool) -> Vec<R>,
    write: fn(&mut Page, &[Case<R>]) -> Result<()>,
}

impl<R> Free<R> {
    /// Combines runs with the writer of their page.
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

/// A [`Recipe`] with any kind of runs.
pub(super) trait AnyRecipe: Sync {
    /// Rough cost of all runs on one core, s.
    fn cost(&self, quick: bool) -> f64;

    /// Draws the figures from the table alone, if the table is sufficient.
    fn redrawn(&self, table: &Path) -> Option<Result<Vec<PageFigure>>>;

    /// Performs the runs and writes the page; returns the written files.
    fn make(
        &self,
        artifact: &'static Artifact,
        options: &ReproduceOptions,
        report: &(dyn Fn(&str) + Sync),
    ) -> Result<Vec<PathBuf>>;

    /// Performs a few steps of the first `count` runs and writes the page.
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

    /// Prepares a number of the runs, and checks that each has a rod.
    #[cfg(test)]
    fn check_scenarios(&self, quick: bool, count: usize);
}

/// Performs the runs of an artefact and writes its page; returns the written files.
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
