//! The directory of a sweep: a results directory for each case, and tables of all cases.

use super::directory::{
    Asked, is_own_folder, not_writable, recognise, remove_own, remove_results,
    sweep_temporary_files,
};
use super::files::LOCK;
use super::{Leases, Manifest, ResultsError, SCENARIO, write_whole};
use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Folder of the results of the cases.
pub const CASES: &str = "cases";
/// Folder of the leases.
const LEASES: &str = "leases";

/// The directory of a sweep. Several processes may have it open: the process that leased a case
/// writes its files, and files of the whole sweep are written under a lock.
pub struct SweepDirectory {
    path: PathBuf,
    /// Leases of the cases.
    pub leases: Leases,
}

impl SweepDirectory {
    /// Opens the directory of a sweep and writes `manifest` if there is none; the hash in the
    /// manifest identifies the sweep of an old directory. With `force`, old results are removed,
    /// and with them the files that the kind of experiment lists.
    ///
    /// # Errors
    /// Those of [`ResultsDirectory::open`](super::ResultsDirectory::open); with `force` also
    /// [`ResultsError::Locked`] while other processes work on its cases.
    pub fn open(
        path: &Path,
        manifest: &Manifest,
        own_files: &[&str],
        force: bool,
    ) -> Result<Self, ResultsError> {
        let asked = Asked {
            hash: &manifest.scenario_hash,
            scenario: &manifest.scenario,
            reads_files: true,
        };
        recognise(path, &asked, force)?;
        fs::create_dir_all(path).map_err(not_writable(path))?;
        let _lock = lock(path)?;
        let known = recognise(path, &asked, force)?;
        sweep_temporary_files(path).map_err(not_writable(path))?;
        let leases = path.join(LEASES);
        if known.is_none() {
            let old = Leases::new(&leases);
            let are_there = is_own_folder(&leases);
            if are_there && old.any_alive()? {
                return Err(ResultsError::Locked {
                    directory: path.to_owned(),
                });
            }
            remove_cases(&path.join(CASES), own_files)?;
            if are_there {
                old.remove_all()?;
            }
            remove_results(path, own_files)?;
            // The manifest is written first, because it identifies the directory.
            manifest.write(path)?;
        }
        write_whole(&path.join(SCENARIO), manifest.scenario.as_bytes())?;
        for folder in [&path.join(CASES), &leases] {
            if folder.is_symlink() {
                return Err(ResultsError::Link {
                    path: folder.clone(),
                });
            }
            fs::create_dir_all(folder).map_err(not_writable(folder))?;
        }
        Ok(Self {
            path: path.to_owned(),
            leases: Leases::new(&leases),
        })
    }

    /// Stores copies of files in a folder of the directory. Files are given by name (path
    /// components joined by `/`) and contents. Links are not followed.
    ///
    /// # Errors
    /// [`ResultsError::Link`], [`ResultsError::NotWritable`].
    pub fn keep_inputs<'a>(
        &self,
        folder: &str,
        inputs: impl Iterator<Item = (&'a str, &'a [u8])>,
    ) -> Result<(), ResultsError> {
        let _lock = lock(&self.path)?;
        for (name, contents) in inputs {
            let file = self.path.join(folder).join(name);
            let mut on_the_way = self.path.clone();
            let below = Path::new(folder).join(name);
            for step in below.parent().into_iter().flat_map(Path::components) {
                on_the_way.push(step);
                if on_the_way.is_symlink() {
                    return Err(ResultsError::Link { path: on_the_way });
                }
            }
            fs::create_dir_all(&on_the_way).map_err(not_writable(&on_the_way))?;
            // Existing files are kept, because other processes may be reading them.
            if fs::read(&file).is_ok_and(|found| found == contents) {
                continue;
            }
            write_whole(&file, contents)?;
        }
        Ok(())
    }

    /// Renames the directories of cases of earlier versions; the pairs hold earlier and present
    /// names.
    ///
    /// # Errors
    /// [`ResultsError::Io`].
    pub fn rename_cases<'a>(
        &self,
        names: impl Iterator<Item = (&'a str, &'a str)>,
    ) -> Result<(), ResultsError> {
        let _lock = lock(&self.path)?;
        let folders: BTreeSet<PathBuf> = entries(&self.path.join(CASES))?.into_iter().collect();
        if folders.is_empty() {
            return Ok(());
        }
        for (earlier, present) in names {
            let (from, to) = (self.case(earlier), self.case(present));
            if folders.contains(&from) && !folders.contains(&to) && is_own_folder(&from) {
                fs::rename(&from, to).map_err(ResultsError::io("rename", from))?;
            }
        }
        Ok(())
    }

    /// Path of the directory.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The results directory of a case.
    pub fn case(&self, id: &str) -> PathBuf {
        self.path.join(CASES).join(id)
    }

    /// Writes files of the whole sweep under its lock.
    ///
    /// # Errors
    /// Those of `write`, and [`ResultsError::NotWritable`].
    pub fn write_alone(
        &self,
        write: impl FnOnce(&Path) -> Result<(), ResultsError>,
    ) -> Result<(), ResultsError> {
        let _lock = lock(&self.path)?;
        write(&self.path)
    }
}

/// Waits for the lock; it is released when the file is dropped or the process dies.
fn lock(path: &Path) -> Result<File, ResultsError> {
    let file = OpenOptions::new()
        .create(true)
        .truncate(false)
        .write(true)
        .open(path.join(LOCK))
        .map_err(not_writable(path))?;
    match file.lock() {
        // Without locks, two processes may write a table at the same time; each one is complete,
        // and the last one is kept.
        Err(error) if error.kind() != ErrorKind::Unsupported => Err(not_writable(path)(error)),
        _ => Ok(file),
    }
}

/// Removes the results of all cases, and nothing else.
fn remove_cases(folder: &Path, own_files: &[&str]) -> Result<(), ResultsError> {
    for case in entries(folder)? {
        if !is_own_folder(&case) {
            continue;
        }
        sweep_temporary_files(&case).map_err(not_writable(&case))?;
        remove_results(&case, own_files)?;
        remove_own(&case.join(LOCK))?;
        // Kept if it contains foreign files.
        let _ = fs::remove_dir(&case);
    }
    let _ = fs::remove_dir(folder);
    Ok(())
}

/// The contents of a folder; empty if it does not exist or is a link.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, ResultsError> {
    if !is_own_folder(folder) {
        return Ok(Vec::new());
    }
    fs::read_dir(folder)
        .map_err(ResultsError::io("read", folder))?
        .map(|entry| Ok(entry.map_err(ResultsError::io("read", folder))?.path()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::manifest::tests::example;
    use super::super::{CaseStatus, LeaseAttempt, SERIES};
    use super::*;

    #[test]
    fn force_removes_the_cases_but_not_under_the_hands_of_another_process() {
        let parent = tempfile::tempdir().unwrap();
        let path = parent.path().join("sweep");
        let manifest = example("ab", CaseStatus::Running);
        let directory = SweepDirectory::open(&path, &manifest, &[], false).unwrap();
        let case = directory.case("a");
        fs::create_dir(&case).unwrap();
        fs::write(case.join(SERIES), "time_s\n").unwrap();
        fs::write(case.join("notes.txt"), "mine").unwrap();
        SweepDirectory::open(&path, &manifest, &[], false).unwrap();
        assert!(case.join(SERIES).exists());

        // An unreadable lease may belong to another process.
        fs::write(path.join(LEASES).join("a.0"), "").unwrap();
        let error = SweepDirectory::open(&path, &manifest, &[], true)
            .err()
            .unwrap();
        assert!(matches!(error, ResultsError::Locked { .. }), "{error}");
        fs::remove_file(path.join(LEASES).join("a.0")).unwrap();
        SweepDirectory::open(&path, &manifest, &[], true).unwrap();
        assert!(!case.join(SERIES).exists());
        assert!(case.join("notes.txt").exists());
    }

    #[test]
    fn directories_of_others_are_refused() {
        let parent = tempfile::tempdir().unwrap();
        let path = parent.path().join("sweep");
        SweepDirectory::open(&path, &example("ab", CaseStatus::Running), &[], false).unwrap();
        let other = example("cd", CaseStatus::Running);
        let error = SweepDirectory::open(&path, &other, &[], false)
            .err()
            .unwrap();
        assert!(
            matches!(error, ResultsError::AnotherScenario { .. }),
            "{error}"
        );
        let error = SweepDirectory::open(parent.path(), &other, &[], true)
            .err()
            .unwrap();
        assert!(matches!(error, ResultsError::NotResults { .. }), "{error}");
    }

    #[test]
    fn processes_share_a_directory_case_by_case() {
        let directory = tempfile::tempdir().unwrap();
        let manifest = example("ab", CaseStatus::Running);
        let [one, other] = [(); 2]
            .map(|()| SweepDirectory::open(directory.path(), &manifest, &[], false).unwrap());
        let leased = one.leases.acquire("a").unwrap();
        assert!(matches!(leased, LeaseAttempt::Granted(_)));
        assert!(matches!(
            other.leases.acquire("a").unwrap(),
            LeaseAttempt::Held(_)
        ));
        assert!(matches!(
            other.leases.acquire("b").unwrap(),
            LeaseAttempt::Granted(_)
        ));
    }
}
