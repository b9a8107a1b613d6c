//! A results directory: recognising, locking and cleaning it.

use super::atomic::TEMPORARY_PREFIX;
use super::checkpoint::SLOTS;
use super::difference::{difference, holds, without_remarks};
use super::files::{LOCK, MANIFEST, VTK_COLLECTION, VTK_FOLDER, files_of_runs, is_frame_name};
use super::mark::{check_files, check_whole_files};
use super::{Manifest, ResultsError};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// State of a results directory.
pub enum Opened {
    /// The same scenario has finished here; there is nothing to do and nothing was changed.
    Finished(Manifest),
    /// The directory is ready for writing.
    Ready(ResultsDirectory),
}

/// A results directory with the write lock of this process.
pub struct ResultsDirectory {
    path: PathBuf,
    unfinished: Option<Manifest>,
    // Lock, released when the directory is dropped or the process dies.
    _lock: File,
}

impl ResultsDirectory {
    /// Opens a directory for the resolved `scenario` of the given hash, and creates it if missing.
    ///
    /// With `force`, old results are removed, but no other files.
    ///
    /// # Errors
    /// [`ResultsError::NotResults`] for a directory with other files and no manifest, even with
    /// `force`; [`ResultsError::AnotherScenario`]; [`ResultsError::Locked`] if another process is
    /// writing; [`ResultsError::NotWritable`]; [`ResultsError::Damaged`] if the manifest is
    /// invalid; [`ResultsError::Altered`] if files of an earlier call were changed.
    pub fn open(
        path: &Path,
        scenario_hash: &str,
        scenario: &str,
        own_files: &[&str],
        force: bool,
    ) -> Result<Opened, ResultsError> {
        let asked = Asked {
            hash: scenario_hash,
            scenario,
            reads_files: false,
        };
        // Check first without a lock, so that a finished directory may be read-only and a foreign
        // one stays unchanged.
        if let Some(manifest) = recognise(path, &asked, force)?
            && manifest.is_finished()
        {
            check_files(path, &manifest.files)?;
            return Ok(Opened::Finished(manifest));
        }
        fs::create_dir_all(path).map_err(not_writable(path))?;
        let lock = lock(path)?;
        let unfinished = match recognise(path, &asked, force)? {
            Some(manifest) if manifest.is_finished() => {
                check_files(path, &manifest.files)?;
                return Ok(Opened::Finished(manifest));
            }
            found => found,
        };
        let is_empty = sweep_temporary_files(path).map_err(not_writable(path))?;
        match &unfinished {
            Some(manifest) => check_whole_files(path, &manifest.files)?,
            None if is_empty => {}
            None => remove_results(path, own_files)?,
        }
        Ok(Opened::Ready(Self {
            path: path.to_owned(),
            unfinished,
            _lock: lock,
        }))
    }

    /// Path of the directory.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The manifest of an unfinished run of the same scenario that was found in the directory.
    pub fn unfinished(&self) -> Option<&Manifest> {
        self.unfinished.as_ref()
    }

    /// Path of a file in it.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }
}

/// The scenario whose results a directory is requested to hold.
pub(super) struct Asked<'a> {
    /// Hash of the scenario, including that of the files that it reads.
    pub hash: &'a str,
    /// Resolved scenario as TOML.
    pub scenario: &'a str,
    /// Whether it reads files, whose contents are covered by the hash only.
    pub reads_files: bool,
}

impl Asked<'_> {
    /// Whether results belong to this scenario, or contain everything that it requests.
    fn is_that_of(&self, manifest: &Manifest) -> bool {
        let known = &manifest.scenario;
        manifest.scenario_hash == self.hash
            || !self.reads_files
                && (without_remarks(known) == without_remarks(self.scenario)
                    || manifest.is_finished() && holds(known, self.scenario))
    }
}

/// The manifest of earlier work on the same scenario; `None` for a fresh start.
pub(super) fn recognise(
    path: &Path,
    asked: &Asked<'_>,
    force: bool,
) -> Result<Option<Manifest>, ResultsError> {
    let foreign = |found: String| ResultsError::NotResults {
        directory: path.to_owned(),
        found,
    };
    if !path.join(MANIFEST).exists() {
        return match first_foreign_entry(path)? {
            Some(found) => Err(foreign(found)),
            None => Ok(None),
        };
    }
    match Manifest::read(path) {
        Err(ResultsError::Damaged { .. }) if let Some(command) = task_in(path) => {
            Err(ResultsError::AnotherCommand {
                directory: path.to_owned(),
                command,
            })
        }
        // A file of this name is not a rodlab manifest: the files next to it must not be removed.
        Err(ResultsError::Damaged { .. }) if force => Err(foreign(MANIFEST.to_owned())),
        Ok(_) | Err(ResultsError::Altered { .. }) if force => Ok(None),
        Ok(Some(manifest)) if !asked.is_that_of(&manifest) => {
            let [held, wanted] = [&manifest.scenario, asked.scenario].map(kind_in_words);
            if let (Some(held), Some(wanted)) = (held, wanted)
                && held != wanted
            {
                return Err(ResultsError::AnotherKind {
                    directory: path.to_owned(),
                    held,
                    asked: wanted,
                });
            }
            let mut keys = difference(&manifest.scenario, asked.scenario);
            if keys.is_empty() {
                keys.push("a file that it reads has changed".to_owned());
            }
            Err(ResultsError::AnotherScenario {
                directory: path.to_owned(),
                keys,
            })
        }
        found => found,
    }
}

/// Description of a resolved scenario: a run or a sweep of an experiment; `None` if it names none.
fn kind_in_words(scenario: &str) -> Option<String> {
    let table: toml::Table = scenario.parse().ok()?;
    let experiment = table.get("experiment")?.as_str()?;
    let what = match table.contains_key("sweep") {
        true => "a sweep",
        false => "a run",
    };
    Some(format!("{what} of the experiment `{experiment}`"))
}

/// The command in the manifest of a directory, if it is that of a task of a robot cell.
fn task_in(path: &Path) -> Option<String> {
    let text = fs::read(path.join(MANIFEST)).ok()?;
    let manifest: serde_json::Value = serde_json::from_slice(&text).ok()?;
    let command = manifest["command_line"].as_array()?.get(1)?.as_str()?;
    Some(format!("rodlab {command}"))
}

/// The first entry, by name, that a run cannot have created before its manifest.
fn first_foreign_entry(path: &Path) -> Result<Option<String>, ResultsError> {
    let entries = match fs::read_dir(path) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(not_writable(path)(error)),
    };
    let mut foreign = None;
    for entry in entries {
        let name = entry
            .map_err(not_writable(path))?
            .file_name()
            .to_string_lossy()
            .into_owned();
        let ours = name == LOCK || name.starts_with(TEMPORARY_PREFIX);
        if !ours && foreign.as_ref().is_none_or(|first| name < *first) {
            foreign = Some(name);
        }
    }
    Ok(foreign)
}

fn lock(path: &Path) -> Result<File, ResultsError> {
    let file = OpenOptions::new()
        .create(true)
        .truncate(false)
        .write(true)
        .open(path.join(LOCK))
        .map_err(not_writable(path))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(ResultsError::Locked {
            directory: path.to_owned(),
        }),
        // Some cluster file systems do not support locks; a run there must still be possible.
        Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {
            tracing::warn!(
                "the file system of `{}` has no locks; run only one process there",
                path.display()
            );
            Ok(file)
        }
        Err(TryLockError::Error(error)) => Err(not_writable(path)(error)),
    }
}

/// Removes temporary files of killed processes. Returns whether only the lock is left.
pub(super) fn sweep_temporary_files(path: &Path) -> io::Result<bool> {
    let mut is_empty = true;
    for entry in fs::read_dir(path)? {
        let entry = entry?;
        let name = entry.file_name();
        if name.to_string_lossy().starts_with(TEMPORARY_PREFIX) && entry.file_type()?.is_file() {
            fs::remove_file(entry.path())?;
        } else {
            is_empty &= name == LOCK;
        }
    }
    Ok(is_empty)
}

/// Removes the files of runs, the manifest last: after an interruption the directory is still
/// recognised. Links are not followed; files that are not regular are kept.
pub(super) fn remove_results(path: &Path, own_files: &[&str]) -> Result<(), ResultsError> {
    let slots = SLOTS.iter().map(|&name| name.to_owned());
    for name in slots.chain(files_of_runs(own_files)) {
        remove_own(&path.join(&name))?;
        if name == VTK_COLLECTION {
            remove_frames(&path.join(VTK_FOLDER))?;
        }
    }
    Ok(())
}

/// Removes a regular file, if there is one.
pub(super) fn remove_own(file: &Path) -> Result<(), ResultsError> {
    match fs::symlink_metadata(file) {
        Ok(found) if found.is_file() => {
            fs::remove_file(file).map_err(ResultsError::io("remove", file))
        }
        _ => Ok(()),
    }
}

/// Whether a path is a folder and not a link.
pub(super) fn is_own_folder(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|found| found.is_dir())
}

fn remove_frames(folder: &Path) -> Result<(), ResultsError> {
    if !is_own_folder(folder) {
        return Ok(());
    }
    let entries = fs::read_dir(folder).map_err(ResultsError::io("read", folder))?;
    for entry in entries {
        let entry = entry.map_err(ResultsError::io("read", folder))?;
        if is_frame_name(&entry.file_name().to_string_lossy()) {
            remove_own(&entry.path())?;
        }
    }
    // Kept if it contains foreign files.
    let _ = fs::remove_dir(folder);
    Ok(())
}

pub(super) fn not_writable(path: &Path) -> impl FnOnce(io::Error) -> ResultsError {
    let directory = path.to_owned();
    move |source| ResultsError::NotWritable { directory, source }
}

#[cfg(test)]
mod tests {
    use super::super::CaseStatus;
    use super::super::files::{PAGE, SCENARIO, SERIES};
    use super::super::manifest::tests::example;
    use super::*;

    fn names(path: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(path)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    fn open(path: &Path, hash: &str, force: bool) -> Result<ResultsDirectory, ResultsError> {
        // Any text that depends on the hash is sufficient.
        ResultsDirectory::open(
            path,
            hash,
            &format!("seed = \"{hash}\""),
            &["own.svg"],
            force,
        )
        .map(|opened| match opened {
            Opened::Ready(directory) => directory,
            Opened::Finished(_) => panic!("taken for finished"),
        })
    }

    #[test]
    fn results_of_another_kind_are_named_in_the_first_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        let open = |text: &str| ResultsDirectory::open(path, text, text, &[], false).map(drop);
        fs::write(
            path.join(MANIFEST),
            r#"{"command_line": ["rodlab", "deploy", "--pattern", "A"], "status": "finished"}"#,
        )
        .unwrap();
        let error = open("experiment = \"scene\"").unwrap_err().to_string();
        assert!(error.contains("the output of `rodlab deploy`"), "{error}");
        let scene = "experiment = \"scene\"\n";
        let mut manifest = example("ab", CaseStatus::Running);
        manifest.scenario = scene.into();
        manifest.write(path).unwrap();
        let sweep = open("experiment = \"scene\"\n[sweep]\na = [1, 2]\n")
            .unwrap_err()
            .to_string();
        assert!(
            sweep.contains("a run of the experiment `scene`, but this is a sweep"),
            "{sweep}"
        );
        let kind = open("experiment = \"flagella\"").unwrap_err().to_string();
        assert!(
            kind.contains("this is a run of the experiment `flagella`"),
            "{kind}"
        );
        let value = open("experiment = \"scene\"\nseed = 1").unwrap_err();
        assert!(
            matches!(value, ResultsError::AnotherScenario { .. }),
            "{value}"
        );
    }

    #[test]
    fn a_missing_directory_is_created_with_its_parents() {
        let parent = tempfile::tempdir().unwrap();
        let path = parent.path().join("results/beam");
        let directory = open(&path, "ab", false).unwrap();
        assert!(directory.unfinished().is_none());
        assert!(path.is_dir());
    }

    #[test]
    fn a_directory_with_other_files_is_refused_and_untouched_even_with_force() {
        let foreign = tempfile::tempdir().unwrap();
        fs::write(foreign.path().join("thesis.tex"), "years of work").unwrap();
        fs::write(foreign.path().join(SERIES), "mine").unwrap();
        for force in [false, true] {
            let error = open(foreign.path(), "ab", force).err().unwrap();
            assert!(matches!(error, ResultsError::NotResults { .. }), "{error}");
        }
        assert_eq!(names(foreign.path()), [SERIES, "thesis.tex"]);
    }

    #[test]
    fn starting_over_removes_the_files_that_a_kind_of_experiment_adds() {
        let directory = tempfile::tempdir().unwrap();
        example("ab", CaseStatus::Running)
            .write(directory.path())
            .unwrap();
        for name in ["own.svg", "own.png", "own.pdf", "rods.pdf", "other.svg"] {
            fs::write(directory.path().join(name), "old").unwrap();
        }
        drop(open(directory.path(), "ab", true).unwrap());
        assert_eq!(names(directory.path()), [LOCK, "other.svg"]);
    }

    #[test]
    fn another_scenario_is_refused_unless_forced() {
        let directory = tempfile::tempdir().unwrap();
        example("ab", CaseStatus::Finished)
            .write(directory.path())
            .unwrap();
        let error = open(directory.path(), "cd", false).err().unwrap();
        assert!(
            matches!(error, ResultsError::AnotherScenario { .. }),
            "{error}"
        );
        let message = error.to_string();
        assert!(message.contains("--force"), "{message}");
        let key = "\n  seed: absent, now \"cd\"\n";
        assert!(message.contains(key), "{message}");
        assert!(
            open(directory.path(), "cd", true)
                .unwrap()
                .unfinished()
                .is_none()
        );
    }

    #[test]
    fn the_same_scenario_is_finished_or_continued() {
        let directory = tempfile::tempdir().unwrap();
        example("ab", CaseStatus::Interrupted)
            .write(directory.path())
            .unwrap();
        fs::write(directory.path().join(SERIES), "time_s\n").unwrap();
        let opened = open(directory.path(), "ab", false).unwrap();
        assert_eq!(opened.unfinished().unwrap().scenario_hash, "ab");
        assert!(directory.path().join(SERIES).exists());
        drop(opened);
        example("ab", CaseStatus::Finished)
            .write(directory.path())
            .unwrap();
        let opened = ResultsDirectory::open(directory.path(), "ab", "", &[], false).unwrap();
        assert!(matches!(opened, Opened::Finished(_)));
    }

    #[test]
    fn force_refuses_a_directory_whose_manifest_is_of_another_program() {
        let foreign = tempfile::tempdir().unwrap();
        fs::create_dir(foreign.path().join(VTK_FOLDER)).unwrap();
        let precious = [
            MANIFEST,
            SERIES,
            PAGE,
            "vtk/brain_scan.vtp",
            "vtk/rods_000000.vtp",
            ".rodlab-notes",
            "checkpoint.0",
        ];
        for name in precious {
            fs::write(foreign.path().join(name), "{\"name\":\"my web app\"}").unwrap();
        }
        let error = open(foreign.path(), "ab", true).err().unwrap();
        assert!(matches!(error, ResultsError::NotResults { .. }), "{error}");
        assert!(error.to_string().contains(MANIFEST), "{error}");
        for name in precious {
            assert!(foreign.path().join(name).exists(), "{name}");
        }
    }

    #[test]
    #[cfg(unix)]
    fn force_does_not_remove_through_links() {
        let folder = tempfile::tempdir().unwrap();
        let [directory, elsewhere] = ["results", "mine"].map(|name| folder.path().join(name));
        for path in [&directory, &elsewhere] {
            fs::create_dir(path).unwrap();
        }
        let manifest = example("ab", CaseStatus::Finished);
        manifest.write(&directory).unwrap();
        let frame = elsewhere.join("rods_000000.vtp");
        fs::write(&frame, "precious").unwrap();
        std::os::unix::fs::symlink(&elsewhere, directory.join(VTK_FOLDER)).unwrap();
        std::os::unix::fs::symlink(&frame, directory.join(SERIES)).unwrap();
        open(&directory, "cd", true).unwrap();
        assert_eq!(fs::read_to_string(frame).unwrap(), "precious");
        assert!(!directory.join(MANIFEST).exists());
    }

    #[test]
    fn force_removes_results_and_nothing_else() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path();
        example("ab", CaseStatus::Interrupted).write(path).unwrap();
        fs::create_dir(path.join(VTK_FOLDER)).unwrap();
        for name in [
            "notes.txt",
            SERIES,
            SCENARIO,
            SLOTS[0],
            SLOTS[1],
            "vtk/rods_000000.vtp",
            ".rodlab-unfinished-x",
            "vtk/brain_scan.vtp",
            ".rodlab-notes",
        ] {
            fs::write(path.join(name), "x").unwrap();
        }
        open(path, "ab", true).unwrap();
        assert_eq!(
            names(path),
            [LOCK, ".rodlab-notes", "notes.txt", VTK_FOLDER]
        );
        assert_eq!(names(&path.join(VTK_FOLDER)), ["brain_scan.vtp"]);
    }

    #[test]
    fn a_second_writer_is_refused_until_the_first_is_gone() {
        let directory = tempfile::tempdir().unwrap();
        let first = open(directory.path(), "ab", false).unwrap();
        let error = open(directory.path(), "ab", true).err().unwrap();
        assert!(matches!(error, ResultsError::Locked { .. }), "{error}");
        drop(first);
        open(directory.path(), "ab", false).unwrap();
    }

    #[test]
    fn a_file_in_the_way_is_an_error_with_exit_code_2() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("file");
        fs::write(&path, "x").unwrap();
        for place in [path.clone(), path.join("below")] {
            let error = open(&place, "ab", false).err().unwrap();
            assert!(matches!(error, ResultsError::NotWritable { .. }), "{error}");
        }
    }
}
