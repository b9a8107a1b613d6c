//! Tables and figures of the thesis, reproduced with this engine.
//!
//! An [`Artifact`] is a set of runs and their page; all are in [`ARTIFACTS`]. Each run is an
//! ordinary run with its own results directory, so that an interrupted [`reproduce`] resumes, and
//! artefacts share runs.

mod applications;
mod artifact;
mod artifacts;
mod auto_steps;
mod bundling;
mod cases;
mod cell_correction;
mod cost;
mod deployment_correction;
mod deployment_errors;
mod difference;
mod drag_steps;
mod explored_helices;
mod figure_2_5;
mod figure_2_6;
mod figure_2_7;
mod figure_2_8;
mod figure_3_4;
mod figure_3_9;
mod figure_4_10;
mod figure_4_11;
mod figure_4_11_cell;
mod figure_4_5;
mod figure_4_9;
mod figure_5_4;
mod figure_5_5;
mod figure_5_6;
mod figure_5_8;
mod figure_6_2;
mod figure_6_5;
mod figure_6_6_robot;
mod folds;
mod folds_in_cell;
mod grasp_grid;
mod hanging_strips;
mod heavy_loops;
mod helices;
mod inversion;
mod inversion_factors;
mod inversion_page;
mod inversion_pictures;
mod knot_convergence;
mod laid_outlines;
mod laid_patterns;
mod laying;
mod manipulated_helix;
mod measured_deployments;
mod overhand_law;
mod page;
mod prelude;
mod prose;
mod redraw;
mod sideways_push;
mod simplified_inversion;
mod table;
mod table_2_1;
mod table_2_2;
mod table_4_1;
mod table_5_2;
mod table_5_2_cell;
mod table_5_3;
mod table_5_4;
mod table_5_4_cell;
mod tightening;
mod validation;
mod virtual_laying;
mod virtual_tying;

pub use artifact::Artifact;
pub use artifacts::ARTIFACTS;
pub use redraw::redraw;

use rodlab_files::figure::FigureOptions;
use rodlab_files::results::ResultsError;
use rodlab_lab::run::RunError;
use std::path::PathBuf;

/// Options of a reproduction.
#[derive(Clone, Debug)]
pub struct ReproduceOptions {
    /// The output folder. This directory has a directory for each artefact, and `cases` for the
    /// runs.
    pub directory: PathBuf,
    /// Whether only a short time is simulated.
    pub quick: bool,
    /// Number of simultaneous runs, at least 1; they share the threads of the program.
    pub jobs: usize,
    /// The command line, for the manifests.
    pub command_line: Vec<String>,
    /// Size and formats of figures.
    pub figures: FigureOptions,
}

/// Result of reproducing an artefact.
type Result<T, E = ReproduceError> = std::result::Result<T, E>;

/// Reason why reproducing an artefact failed.
#[derive(Debug, thiserror::Error)]
pub enum ReproduceError {
    /// A run did not start, or was stopped. A run that the mechanics ended is a result, not an
    /// error.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Results could not be written or read.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// A quick version would replace the complete page.
    #[error(
        "`{}` holds the page of the whole artefact, which --quick does not replace; choose another folder with --out",
        page.display()
    )]
    WouldReplace {
        /// The folder of the page.
        page: PathBuf,
    },
    /// The operating system could not start the threads of a run.
    #[error("cannot start the threads of a run: {0}")]
    Threads(String),
    /// The table for the figures is missing.
    #[error("there is no `{}`; make it by `rodlab reproduce {artifact}`", table.display())]
    NoTable {
        /// The artefact.
        artifact: &'static str,
        /// Missing table.
        table: PathBuf,
    },
    /// The figures need more data than the table contains.
    #[error(
        "the figures of {artifact} show more than its table holds; `rodlab reproduce {artifact}` draws them from its runs"
    )]
    NotRedrawn {
        /// The artefact.
        artifact: &'static str,
    },
}

/// Reproduces an artefact, after those in its folder, and returns the written files; `report` is
/// called for each run that ended.
///
/// # Errors
/// See [`ReproduceError`].
pub fn reproduce(
    artifact: &'static Artifact,
    options: &ReproduceOptions,
    report: &(dyn Fn(&str) + Sync),
) -> Result<Vec<PathBuf>, ReproduceError> {
    let mut written = Vec::new();
    for artifact in artifact.parts().chain([artifact]) {
        let page = options.directory.join(artifact.name());
        if options.quick && page::is_whole(&page) {
            return Err(ReproduceError::WouldReplace { page });
        }
        page::check_place(&page, &artifact.heading())?;
        written.extend(artifact.recipe.make(artifact, options, report)?);
    }
    Ok(written)
}

/// Whether tests run at full scale: `RODLAB_TESTS_FULL=1`, as `scripts/ci --full` sets it.
#[cfg(test)]
fn tests_are_full() -> bool {
    std::env::var("RODLAB_TESTS_FULL").is_ok_and(|value| value == "1")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;
    use std::collections::BTreeMap;
    use std::fs;
    use std::sync::Mutex;

    #[test]
    fn pages_of_others_are_not_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let artifact = Artifact::named("tab2.1").unwrap();
        let page = directory.path().join(artifact.name());
        fs::create_dir_all(&page).unwrap();
        for (name, own) in [
            ("README.md", format!("# {}\n\nMade by", artifact.title())),
            (
                "manifest.json",
                format!("{{\n  \"artifact\": \"{}\",\n", artifact.name()),
            ),
        ] {
            fs::write(page.join(name), "precious").unwrap();
            let error = reproduce(artifact, &options(directory.path(), 1), &|_| {}).unwrap_err();
            assert!(error.to_string().contains(name), "{error}");
            fs::write(page.join(name), own).unwrap();
            assert!(page::check_place(&page, &artifact.heading()).is_ok());
        }
    }

    fn options(directory: &std::path::Path, jobs: usize) -> ReproduceOptions {
        ReproduceOptions {
            directory: directory.to_owned(),
            quick: true,
            jobs,
            command_line: vec!["rodlab".into(), "reproduce".into()],
            figures: FigureOptions {
                formats: vec![rodlab_files::figure::Format::Svg],
                ..FigureOptions::default()
            },
        }
    }

    /// Number of runs of an artefact for the test of its page. Some are slow to prepare, and a
    /// page needs only a few of them.
    fn runs_of_page(name: &str) -> usize {
        match name {
            _ if tests_are_full() => usize::MAX,
            "tab2.1" | "tab2.2" => 4,
            "fig4.9" | "fig4.10" | "fig4.11" | "fig2.7" | "fig2.8" | "fig3.4" | "fig3.5"
            | "fig3.6" | "fig3.7" | "fig3.10" | "fig3.11" | "fig4.11-cell" | "tab4.1"
            | "tab5.4-cell" | "cell-correction" => 2,
            _ => usize::MAX,
        }
    }

    #[test]
    fn every_artefact_has_its_page_its_table_and_its_figures() {
        let directory = tempfile::tempdir().unwrap();
        // Artefacts of a folder have runs in common, so one thread makes them one after the other.
        // The others are tested separately, so that none waits for the longest case of another.
        let mut folders: BTreeMap<&str, Vec<&Artifact>> = BTreeMap::new();
        for artifact in ARTIFACTS.iter() {
            let name = artifact.name();
            let folder = name.split_once('/').map_or(name, |(folder, _)| folder);
            folders.entry(folder).or_default().push(artifact);
        }
        let folders: Vec<Vec<&Artifact>> = folders.into_values().collect();
        folders
            .par_iter()
            .flat_map_iter(|folder| folder)
            .for_each(|artifact| {
                let options = options(directory.path(), 1);
                let written = artifact
                    .recipe
                    .make_shortened(artifact, runs_of_page(artifact.name()), &options, &|_| {})
                    .unwrap();
                let page = directory.path().join(artifact.name());
                assert!(written.iter().all(|file| file.starts_with(&page)));
                let text = fs::read_to_string(page.join("README.md")).unwrap();
                assert!(
                    text.starts_with(&format!("# {}", artifact.title())),
                    "{text}"
                );
                assert!(
                    ["0.0", "60 d", "1 d", "rods of"]
                        .iter()
                        .any(|what| text.contains(&format!("**Quick version: only {what}"))),
                    "{text}"
                );
                let figures: Vec<&str> =
                    text.lines().filter(|line| line.starts_with("![")).collect();
                assert!(!figures.is_empty());
                for figure in figures {
                    let (_, name) = figure.split_once("](").unwrap();
                    let svg = fs::read_to_string(page.join(name.trim_end_matches(')'))).unwrap();
                    assert!(svg.starts_with("<svg"));
                }
                let table =
                    fs::read_to_string(page.join(format!("{}.csv", page::stem(artifact.name()))))
                        .unwrap();
                assert!(table.lines().count() > 1);
            });
    }

    #[test]
    fn a_quick_look_does_not_replace_the_published_page() {
        let directory = tempfile::tempdir().unwrap();
        let artifact = Artifact::named("fig2.6").unwrap();
        let options = options(directory.path(), 1);
        let whole = ReproduceOptions {
            quick: false,
            ..options.clone()
        };
        let page = directory.path().join("fig2.6/README.md");
        let shortened = |options: &ReproduceOptions| {
            let made = artifact
                .recipe
                .make_shortened(artifact, 2, options, &|_| {});
            made.unwrap();
            fs::read_to_string(&page).unwrap()
        };
        let published = shortened(&whole);
        let error = reproduce(artifact, &options, &|_| {}).unwrap_err();
        assert!(
            matches!(error, ReproduceError::WouldReplace { .. }),
            "{error}"
        );
        assert_eq!(fs::read_to_string(&page).unwrap(), published);
        // A quick page may be replaced by a complete one, or by another quick one.
        fs::remove_dir_all(directory.path().join("fig2.6")).unwrap();
        shortened(&options);
        assert!(!page::is_whole(&directory.path().join("fig2.6")));
    }

    #[test]
    fn shared_runs_are_made_once() {
        let directory = tempfile::tempdir().unwrap();
        let reports = Mutex::new(Vec::new());
        let report = |line: &str| reports.lock().unwrap().push(line.to_owned());
        let artifact = Artifact::named("fig2.6").unwrap();
        let options = options(directory.path(), 1);
        let make = |count: usize| {
            let recipe = artifact.recipe;
            let made = recipe.make_shortened(artifact, count, &options, &report);
            made.unwrap();
            fs::read(directory.path().join("fig2.6/fig2.6.csv")).unwrap()
        };
        let first = make(3);
        assert_ne!(make(2), first);
        assert_eq!(make(3), first);
        let reports = reports.into_inner().unwrap();
        let again = reports
            .iter()
            .filter(|line| line.contains("had been run before"));
        assert_eq!((reports.len(), again.count()), (8, 5));
    }
}
