//! `manifest.json`: what was run, with which program, where, when, and how it ended.

use super::atomic::place_whole;
use super::case_record::{CaseRecord, CaseStatus};
use super::difference::without_remarks;
use super::files::{MANIFEST, SCENARIO};
use super::mark::{FileMark, FileMarks, check_files, check_whole_files, marks_of_whole_files};
use super::{ResultsError, SummaryRow, write_summary, write_timings, write_whole};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

/// Name of the only case of a single run.
pub const MAIN_CASE: &str = "main";

/// Length of a scenario up to which the manifest contains it, bytes.
const LONGEST_SCENARIO: usize = 1 << 16;

/// The manifest of a results directory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of the program.
    pub version: String,
    /// Commit of the program: that of the clone from which it was built, or the value of the
    /// environment variable `RODLAB_COMMIT` at build time.
    pub commit: Option<String>,
    /// The last command line that wrote to the directory.
    pub command_line: Vec<String>,
    /// Short name of the scenario.
    pub name: String,
    /// Experiment of the scenario.
    pub experiment: String,
    /// Title of the scenario.
    pub title: String,
    /// The resolved scenario as TOML. If it is longer than 64 KiB, as with a mesh of many
    /// triangles, the file has only its mark in `files`: it is in `scenario.toml`.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub scenario: String,
    /// Hash of the scenario, see [`scenario_hash`].
    pub scenario_hash: String,
    /// The rods, in the order of the scene.
    pub rods: Vec<RodRecord>,
    /// Name of the machine.
    pub host: Option<String>,
    /// Number of threads that the run could use.
    pub threads: usize,
    /// When the run was first started.
    pub start: jiff::Timestamp,
    /// When the run last ended; `None` while it runs, or if it was killed.
    pub end: Option<jiff::Timestamp>,
    /// Number of times the run was continued from a checkpoint.
    pub continuations: u32,
    /// Seeds of random choices by name; empty if nothing is random.
    pub seeds: BTreeMap<String, u64>,
    /// The cases by id; a single run is the case `main`.
    pub cases: BTreeMap<String, CaseRecord>,
    /// Length and hash of each file as the run left it: those that grow during a run, and those
    /// that are written at once. Results of earlier versions have no marks of the latter, which
    /// are then read unchecked.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub files: FileMarks,
}

/// Data of a rod, or of a free body, for readers of `nodes.csv`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RodRecord {
    /// Name of the rod.
    pub name: String,
    /// Number of nodes.
    pub nodes: usize,
    /// Whether the last node is joined to the first.
    pub closed: bool,
    /// Radius of the surface, m; the largest one if it varies.
    pub radius: f64,
    /// Radius at each node, m, if it varies.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub radii: Vec<f64>,
    /// Whether it is a free body: node 0 is its centre of mass, the others are the vertices of its
    /// shape, whose surface is at the distance of the radius from them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub rigid: bool,
    /// Triangles of a free body, as its nodes. Without any, it is a sphere around its only vertex or
    /// a capsule between two.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faces: Vec<[usize; 3]>,
}

impl RodRecord {
    /// Radius at a node, m.
    pub fn radius_at(&self, node: usize) -> f64 {
        self.radii.get(node).copied().unwrap_or(self.radius)
    }
}

impl Manifest {
    /// Reads the manifest of a directory; `None` if there is none, or an empty one after a loss of
    /// power at the start of the run.
    ///
    /// # Errors
    /// [`ResultsError::Damaged`] if it is not a manifest, [`ResultsError::Altered`] if a scenario
    /// that it does not contain was changed or removed, [`ResultsError::Io`] if a file cannot be
    /// read.
    pub fn read(directory: &Path) -> Result<Option<Self>, ResultsError> {
        let path = directory.join(MANIFEST);
        let bytes = match fs::read(&path) {
            Ok(bytes) if bytes.is_empty() => return Ok(None),
            Ok(bytes) => bytes,
            Err(error)
                if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) =>
            {
                return Ok(None);
            }
            Err(error) => return Err(ResultsError::io("read", path)(error)),
        };
        let mut manifest: Self =
            serde_json::from_slice(&bytes).map_err(|error| ResultsError::Damaged {
                path,
                reason: error.to_string(),
            })?;
        if manifest.scenario.is_empty() {
            manifest.read_scenario(directory)?;
        }
        Ok(Some(manifest))
    }

    /// Reads the scenario of a directory whose manifest contains only its mark.
    fn read_scenario(&mut self, directory: &Path) -> Result<(), ResultsError> {
        let Some(mark) = self.files.get(SCENARIO) else {
            return Err(ResultsError::Damaged {
                path: directory.join(MANIFEST),
                reason: "it has no `scenario`".into(),
            });
        };
        check_files(directory, &[(SCENARIO.into(), mark.clone())].into())?;
        let path = directory.join(SCENARIO);
        self.scenario = fs::read_to_string(&path).map_err(ResultsError::io("read", path))?;
        Ok(())
    }

    /// Writes the manifest of a directory.
    pub fn write(&self, directory: &Path) -> Result<(), ResultsError> {
        write_whole(&directory.join(MANIFEST), &self.to_bytes())
    }

    /// Writes the manifest of a starting run, and its scenario, without waiting for the disk. The
    /// manifest is written first, because it identifies the directory.
    pub fn place(&self, directory: &Path) -> Result<(), ResultsError> {
        place_whole(&directory.join(MANIFEST), &self.to_bytes())?;
        place_whole(&directory.join(SCENARIO), self.scenario.as_bytes())
    }

    /// Writes summary, timings and manifest of an ending run with the marks `files`.
    pub fn conclude(
        &mut self,
        directory: &Path,
        record: CaseRecord,
        files: FileMarks,
    ) -> Result<(), ResultsError> {
        let row = SummaryRow::new(MAIN_CASE, record.status, &record.outcome);
        write_summary(directory, &[row])?;
        write_timings(directory, &[(MAIN_CASE, record.usage())])?;
        self.cases.insert(MAIN_CASE.into(), record);
        self.end = Some(jiff::Timestamp::now());
        self.files = files;
        self.mark_whole_files(directory)?;
        self.write(directory)
    }

    /// Marks the files of the directory that are written at once, such as the summary.
    ///
    /// # Errors
    /// [`ResultsError::Io`].
    pub fn mark_whole_files(&mut self, directory: &Path) -> Result<(), ResultsError> {
        self.files.extend(marks_of_whole_files(directory)?);
        Ok(())
    }

    /// Reads the manifest like [`Manifest::read`], for a reader of the other files. If the results
    /// are finished, checks the files that are written at once, such as the summary.
    ///
    /// # Errors
    /// As [`Manifest::read`]; [`ResultsError::Altered`] if a file was changed.
    pub fn read_checked(directory: &Path) -> Result<Option<Self>, ResultsError> {
        let manifest = Self::read(directory)?;
        if let Some(manifest) = manifest.as_ref().filter(|manifest| manifest.is_finished()) {
            check_whole_files(directory, &manifest.files)?;
        }
        Ok(manifest)
    }

    fn to_bytes(&self) -> Vec<u8> {
        let mut stored = Cow::Borrowed(self);
        if self.scenario.len() > LONGEST_SCENARIO {
            let stored = stored.to_mut();
            (stored.files).insert(SCENARIO.into(), FileMark::of(self.scenario.as_bytes()));
            stored.scenario.clear();
        }
        let mut text =
            serde_json::to_vec_pretty(&*stored).expect("a manifest has string keys only");
        text.push(b'\n');
        text
    }

    /// Whether every case has a final outcome.
    pub fn is_finished(&self) -> bool {
        self.cases
            .values()
            .all(|case| case.status == CaseStatus::Finished)
    }
}

/// Hash that identifies a scenario: BLAKE3 of its resolved TOML without its title, in hexadecimal.
pub fn scenario_hash(scenario_toml: &str) -> String {
    hash(without_remarks(scenario_toml).as_bytes())
}

fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// Hash that identifies a scenario and the files that it reads, given by name and contents;
/// without files it is [`scenario_hash`].
pub fn scenario_hash_with_inputs<'a>(
    scenario_toml: &str,
    inputs: impl Iterator<Item = (&'a str, &'a [u8])>,
) -> String {
    let mut text = without_remarks(scenario_toml);
    for (name, contents) in inputs {
        text += &format!("# {name:?} {}\n", hash(contents));
    }
    hash(text.as_bytes())
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::CaseOutcome;
    use super::*;

    pub(in crate::results) fn example(hash: &str, status: CaseStatus) -> Manifest {
        let outcome = CaseOutcome {
            simulated_time: 0.1 + 0.2,
            steps: 7,
            ..CaseOutcome::default()
        };
        Manifest {
            version: "0.1.0".into(),
            commit: None,
            command_line: vec!["rodlab".into(), "run".into(), "beam \"1\".toml".into()],
            name: "beam".into(),
            experiment: "scene".into(),
            title: "Heavy cantilever — γ = 15.7".into(),
            scenario: "experiment = \"scene\"\n".into(),
            scenario_hash: hash.into(),
            rods: vec![RodRecord {
                name: "beam".into(),
                nodes: 51,
                closed: false,
                radius: 5e-3,
                ..RodRecord::default()
            }],
            host: Some("bench".into()),
            threads: 4,
            start: "2026-01-02T03:04:05.678901234Z".parse().unwrap(),
            end: None,
            continuations: 2,
            seeds: BTreeMap::from([("sobol".into(), u64::MAX)]),
            cases: BTreeMap::from([(
                MAIN_CASE.into(),
                CaseRecord {
                    status,
                    outcome,
                    wall_time: 0.1,
                    wall_time_with_contact: 0.05,
                    cpu_time: Some(0.2),
                    peak_memory: Some(4096),
                    error: None,
                },
            )]),
            files: FileMarks::new(),
        }
    }

    #[test]
    fn a_long_scenario_is_stored_once_and_a_changed_one_is_an_error() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path();
        let mut manifest = example("ab", CaseStatus::Running);
        manifest.scenario += &"# long\n".repeat(LONGEST_SCENARIO / 7);
        manifest.place(path).unwrap();
        assert!(fs::metadata(path.join(MANIFEST)).unwrap().len() < 4000);
        let read = Manifest::read(path).unwrap().unwrap();
        assert_eq!(read.scenario, manifest.scenario);
        let mark = FileMark::of(manifest.scenario.as_bytes());
        manifest.files.insert(SCENARIO.into(), mark);
        assert_eq!(read, manifest);
        let changed = manifest.scenario.replacen("scene", "scenf", 1);
        fs::write(path.join(SCENARIO), changed).unwrap();
        let error = Manifest::read(path).unwrap_err().to_string();
        assert!(
            error.contains(SCENARIO) && error.contains("--force"),
            "{error}"
        );
        fs::remove_file(path.join(SCENARIO)).unwrap();
        let error = Manifest::read(path).unwrap_err().to_string();
        assert!(error.contains(SCENARIO), "{error}");
    }

    #[test]
    fn whole_files_that_were_changed_are_noticed() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path();
        let mut manifest = example("ab", CaseStatus::Finished);
        let record = manifest.cases[MAIN_CASE].clone();
        manifest.place(path).unwrap();
        fs::write(path.join("end_state.csv"), "rod,node\nbeam,0\n").unwrap();
        manifest.conclude(path, record, FileMarks::new()).unwrap();
        assert!(Manifest::read_checked(path).unwrap().is_some());
        for name in ["end_state.csv", "summary.csv", "timings.csv", SCENARIO] {
            let written = fs::read(path.join(name)).unwrap();
            let mut changed = written.clone();
            changed[3] ^= 1;
            fs::write(path.join(name), changed).unwrap();
            let error = Manifest::read_checked(path).unwrap_err();
            assert!(matches!(error, ResultsError::Altered { .. }), "{error}");
            assert!(error.to_string().contains(name), "{error}");
            fs::remove_file(path.join(name)).unwrap();
            assert!(Manifest::read_checked(path).is_err());
            fs::write(path.join(name), written).unwrap();
        }
        assert!(Manifest::read_checked(path).is_ok());
        // A manifest of an earlier version, without marks of these files.
        manifest.files.clear();
        manifest.write(path).unwrap();
        fs::write(path.join("summary.csv"), "changed").unwrap();
        assert!(Manifest::read_checked(path).is_ok());
    }

    #[test]
    fn reads_back_what_was_written() {
        let directory = tempfile::tempdir().unwrap();
        assert_eq!(Manifest::read(directory.path()).unwrap(), None);
        let manifest = example("ab", CaseStatus::NoConvergence);
        manifest.write(directory.path()).unwrap();
        assert_eq!(Manifest::read(directory.path()).unwrap(), Some(manifest));
        let text = fs::read_to_string(directory.path().join(MANIFEST)).unwrap();
        assert!(text.contains("\"no-convergence\""), "{text}");
    }

    #[test]
    fn only_a_manifest_whose_cases_are_all_finished_is_finished() {
        let mut manifest = example("ab", CaseStatus::Finished);
        assert!(manifest.is_finished());
        let mut other = manifest.cases[MAIN_CASE].clone();
        other.status = CaseStatus::TimeLimit;
        manifest.cases.insert("other".into(), other);
        assert!(!manifest.is_finished());
    }

    #[test]
    fn an_empty_manifest_is_that_of_a_run_that_never_began() {
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join(MANIFEST), "").unwrap();
        assert!(Manifest::read(directory.path()).unwrap().is_none());
        example("ab", CaseStatus::Running)
            .place(directory.path())
            .unwrap();
        assert!(Manifest::read(directory.path()).unwrap().is_some());
    }

    #[test]
    fn invalid_durations_are_zero() {
        let directory = tempfile::tempdir().unwrap();
        let mut manifest = example("ab", CaseStatus::Finished);
        let case = manifest.cases.get_mut(MAIN_CASE).unwrap();
        (case.wall_time, case.cpu_time) = (-1.0, Some(1e300));
        manifest.write(directory.path()).unwrap();
        let read = Manifest::read(directory.path()).unwrap().unwrap();
        let usage = read.cases[MAIN_CASE].usage();
        assert!(usage.wall_time.is_zero() && usage.cpu_time.unwrap().is_zero());
    }

    #[test]
    fn a_damaged_manifest_is_named() {
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join(MANIFEST), "{\"version\": 3").unwrap();
        let error = Manifest::read(directory.path()).unwrap_err();
        assert!(matches!(error, ResultsError::Damaged { .. }), "{error}");
        assert!(error.to_string().contains(MANIFEST));
    }
}
