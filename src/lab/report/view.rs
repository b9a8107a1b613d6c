//! The interactive page of a results directory: a run, or the cases of a sweep.

use crate::experiment::{Page, kind_named};
use crate::report::case_folders::case_folders;
use crate::report::motion::CaseMotion;
use rayon::prelude::*;
use rodlab_files::figure::{Movie, MovieCase, is_page, movie_page};
use rodlab_files::results::{Manifest, ResultsError, replace_own};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Failure to make a page.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// The directory holds no results.
    #[error("`{}` is not a results directory: it has no manifest.json; give the directory that `rodlab run` prints", .0.display())]
    NotResults(PathBuf),
    /// The runs wrote no positions.
    #[error(
        "`{}` has no nodes.csv with a whole output, so there is nothing to show; set `nodes = true` under [output] and run again",
        .0.display()
    )]
    NoNodes(PathBuf),
    /// The experiment has a page of its own, but these results do not.
    #[error("`{}` has {reason}", directory.display())]
    NoPage {
        /// The directory.
        directory: PathBuf,
        /// Contents of the directory, and why they make no page.
        reason: &'static str,
    },
    /// A file could not be read or written.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

/// Summary of a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrittenPage {
    /// Cases that it shows.
    pub cases: usize,
    /// Size of the file.
    pub bytes: usize,
    /// Whether outputs were left out to keep the page small.
    pub thinned: bool,
}

/// Writes the page of a results directory to the file `to`, which is self-contained.
///
/// At most `largest_count` outputs of each case are shown, evenly spaced. Cases without positions
/// are left out. `done` is called after each case with the number of cases done and the total
/// number.
///
/// # Errors
/// [`ViewError`]. The file is written completely or not at all.
pub fn write_page(
    directory: &Path,
    to: &Path,
    largest_count: usize,
    done: &(dyn Fn(usize, usize) + Sync),
) -> Result<WrittenPage, ViewError> {
    write_page_that_reloads(directory, to, largest_count, None, done)
}

/// Writes the page of a run in progress, see [`write_page`]. `reload`: seconds after which the
/// page reloads itself, if it does.
///
/// # Errors
/// As [`write_page`].
pub fn write_page_that_reloads(
    directory: &Path,
    to: &Path,
    largest_count: usize,
    reload: Option<f64>,
    done: &(dyn Fn(usize, usize) + Sync),
) -> Result<WrittenPage, ViewError> {
    let (manifest, page) = page_of(directory)?;
    match page {
        Page::RodsInMotion => {}
        Page::Nothing(reason) => return Err(no_page(directory, reason)),
        Page::Own(page) => {
            replace_own(to, page.as_bytes(), is_page)?;
            return Ok(WrittenPage {
                cases: 1,
                bytes: page.len(),
                thinned: false,
            });
        }
    }
    let folders = case_folders(directory)?;
    let count = AtomicUsize::new(0);
    let read: Result<Vec<_>, ViewError> = folders
        .par_iter()
        .map(|folder| {
            let motion = CaseMotion::read(folder, &manifest, largest_count)?;
            let case = motion.map(|motion| Ok((motion.with_numbers()?, motion.thinned)));
            done(1 + count.fetch_add(1, Ordering::Relaxed), folders.len());
            case.transpose()
        })
        .collect();
    let cases: Vec<(MovieCase, bool)> = read?.into_iter().flatten().collect();
    if cases.is_empty() {
        return Err(ViewError::NoNodes(directory.to_owned()));
    }
    let thinned = cases.iter().any(|(_, thinned)| *thinned);
    let cases: Vec<MovieCase> = cases.into_iter().map(|(case, _)| case).collect();
    let movie = Movie {
        title: if manifest.title.is_empty() {
            manifest.name.clone()
        } else {
            manifest.title.clone()
        },
        subtitle: format!("{} · rodlab {}", manifest.experiment, manifest.version),
        cases,
        reload,
    };
    let page = movie_page(&movie);
    replace_own(to, page.as_bytes(), is_page)?;
    Ok(WrittenPage {
        cases: movie.cases.len(),
        bytes: page.len(),
        thinned,
    })
}

fn page_of(directory: &Path) -> Result<(Manifest, Page), ViewError> {
    let Some(manifest) = Manifest::read_checked(directory)? else {
        return Err(ViewError::NotResults(directory.to_owned()));
    };
    let kind = kind_named(&manifest.experiment);
    let page = kind.map_or(Ok(Page::RodsInMotion), |kind| kind.page(directory))?;
    Ok((manifest, page))
}

fn no_page(directory: &Path, reason: &'static str) -> ViewError {
    ViewError::NoPage {
        directory: directory.to_owned(),
        reason,
    }
}

/// The manifest of a directory with rods in motion.
///
/// # Errors
/// [`ViewError`] if it holds anything else, or nothing.
pub(super) fn rods_in_motion(directory: &Path) -> Result<Manifest, ViewError> {
    let (manifest, page) = page_of(directory)?;
    match page {
        Page::RodsInMotion => Ok(manifest),
        Page::Nothing(reason) => Err(no_page(directory, reason)),
        Page::Own(_) => Err(no_page(
            directory,
            "no rods in motion to film; `rodlab view` shows its page",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_directory_without_results_is_refused_by_name() {
        let directory = tempfile::tempdir().unwrap();
        let to = directory.path().join("view.html");
        let error = write_page(directory.path(), &to, 10, &|_, _| ()).unwrap_err();
        assert!(matches!(error, ViewError::NotResults(_)), "{error}");
        assert!(error.to_string().contains("manifest.json"), "{error}");
        assert!(!to.exists());
    }
}
