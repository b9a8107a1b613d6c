//! Leases: assignment of cases to processes.
//!
//! A lease is a small file `<case>.<generation>`, created only if it does not exist. The highest
//! generation owns the case. A process that takes over a dead process's lease creates the next
//! generation, so that only one of several succeeds, and no valid lease is removed. A lease names
//! its process and machine; its modification time is updated while that process lives.
//!
//! A process of this machine is dead once it no longer runs. A process of another machine is dead
//! if its leases have not been updated for [`Leases::patience`] while observed. Clocks are never
//! compared.

use super::ResultsError;
use super::atomic::{TEMPORARY_PREFIX, create_whole};
use super::directory::remove_own;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant, SystemTime};

/// Time between two updates of a lease.
pub const HEARTBEAT: Duration = Duration::from_secs(5);
/// Time without an update after which a lease of another machine is taken over. File systems of
/// clusters may show a change a minute late.
const PATIENCE: Duration = Duration::from_secs(90);

/// Number of generations among which the oldest lease on a case is searched.
const FIRST_GENERATIONS: u32 = 8;

/// The leases of a sweep in this process.
pub struct Leases {
    folder: PathBuf,
    owner: Owner,
    patience: Duration,
    /// For leases of other machines, the last modification time and when it was first seen.
    seen: Mutex<BTreeMap<PathBuf, (SystemTime, Instant)>>,
}

/// A process.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Owner {
    /// Name of the machine.
    pub host: String,
    /// Identifier of the boot of the machine, if available.
    pub boot: Option<String>,
    /// Number of the process.
    pub process: u32,
    /// Start time of the process, in ticks since the start of the machine, if available.
    pub started: Option<u64>,
}

/// Result of the attempt to lease a case.
#[derive(Debug)]
pub enum LeaseAttempt {
    /// This process has it now.
    Granted(Lease),
    /// Another process, which seems to be alive, has it.
    Held(Option<Owner>),
}

/// A case leased by this process. Dropping it frees the case.
#[derive(Debug)]
pub struct Lease {
    /// The file of this lease and those that it supersedes, oldest first.
    files: Vec<PathBuf>,
}

impl Leases {
    /// The leases in a folder, which must exist.
    pub fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            owner: Owner::this_process(),
            patience: PATIENCE,
            seen: Mutex::new(BTreeMap::new()),
        }
    }

    /// Time without an update after which a process of another machine counts as dead.
    pub fn patience(&self) -> Duration {
        self.patience
    }

    /// Leases a case, unless a living process has it.
    ///
    /// # Errors
    /// [`ResultsError::Io`] if the folder cannot be read or written.
    pub fn acquire(&self, case: &str) -> Result<LeaseAttempt, ResultsError> {
        let mut files = self.files_of(case);
        let overruled = files.last().map(|(_, newest)| newest.clone());
        let mut former = None;
        if let Some(newest) = &overruled {
            let owner = read_owner(newest);
            if self.is_alive(newest, owner.as_ref()) {
                return Ok(LeaseAttempt::Held(owner));
            }
            if let Some(owner) = &owner {
                tracing::info!(
                    "taking over `{case}` from process {} of {}",
                    owner.process,
                    owner.host
                );
            }
            former = owner;
        }
        let generation = files.last().map_or(0, |(generation, _)| generation + 1);
        let name = format!("{case}.{generation}");
        let path = self.folder.join(&name);
        match self.create(&name) {
            Ok(()) if overruled.is_some_and(|newest| read_owner(&newest) != former) => {
                // Meanwhile another process took over the case, finished it and released it.
                let _ = fs::remove_file(path);
                Ok(LeaseAttempt::Held(None))
            }
            Ok(()) => {
                files.push((generation, path));
                Ok(LeaseAttempt::Granted(Lease {
                    files: files.into_iter().map(|(_, path)| path).collect(),
                }))
            }
            // Another process was faster.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => Ok(LeaseAttempt::Held(None)),
            Err(error) => Err(ResultsError::io("create", path)(error)),
        }
    }

    /// Whether any living process has a lease.
    ///
    /// # Errors
    /// [`ResultsError::Io`] if the folder cannot be read.
    pub fn any_alive(&self) -> Result<bool, ResultsError> {
        Ok(self.all_files()?.iter().any(|path| {
            let owner = read_owner(path);
            owner.as_ref() != Some(&self.owner) && self.is_alive(path, owner.as_ref())
        }))
    }

    /// Whether a dead process left its lease on a case. Its files may not have been on the disk
    /// when the machine lost its power.
    pub fn is_left_by_dead(&self, case: &str) -> bool {
        let mut files = self.files_of(case).into_iter();
        files.any(|(_, path)| !self.is_alive(&path, read_owner(&path).as_ref()))
    }

    /// Removes the leases of dead processes. Call it only when no case is left to lease: otherwise
    /// two processes could take over the same case.
    ///
    /// # Errors
    /// [`ResultsError::Io`] if the folder cannot be read.
    pub fn remove_dead(&self) -> Result<(), ResultsError> {
        // All paths include leases that were being written.
        for path in self.all_paths()? {
            if !self.is_alive(&path, read_owner(&path).as_ref()) {
                // Files that cannot be removed do no harm.
                let _ = fs::remove_file(path);
            }
        }
        Ok(())
    }

    /// Creates a lease together with its owner: an empty lease would look like that of an unknown
    /// process.
    fn create(&self, name: &str) -> io::Result<()> {
        let text = serde_json::to_vec(&self.owner).expect("an owner has string keys only");
        create_whole(&self.folder, name, &text)
    }

    fn is_alive(&self, path: &Path, owner: Option<&Owner>) -> bool {
        if let Some(owner) = owner
            && owner.host == self.owner.host
            && let Some(lives) = owner.lives_here(&self.owner)
        {
            return lives;
        }
        // Opening the file makes network file systems refresh its attributes.
        let Ok(touched) = File::open(path).and_then(|file| file.metadata()?.modified()) else {
            return true;
        };
        let mut seen = self.seen.lock().expect("no thread panics with this lock");
        let (last, since) = seen
            .entry(path.to_owned())
            .or_insert_with(|| (touched, Instant::now()));
        if *last != touched {
            (*last, *since) = (touched, Instant::now());
        }
        since.elapsed() < self.patience
    }

    /// The leases on a case by generation, the newest last. Generations follow each other: a lease is
    /// released from the oldest generation on.
    fn files_of(&self, case: &str) -> Vec<(u32, PathBuf)> {
        let numbered = |generation| (generation, self.folder.join(format!("{case}.{generation}")));
        let is_there = |(_, path): &(u32, PathBuf)| path.exists();
        let oldest = (0..FIRST_GENERATIONS)
            .map(numbered)
            .position(|file| is_there(&file));
        let generations = oldest.into_iter().flat_map(|oldest| oldest as u32..);
        generations.map(numbered).take_while(is_there).collect()
    }

    fn all_files(&self) -> Result<Vec<PathBuf>, ResultsError> {
        let mut paths = self.all_paths()?;
        paths.retain(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            !name.starts_with(TEMPORARY_PREFIX)
        });
        Ok(paths)
    }

    /// Removes all leases of all processes.
    ///
    /// # Errors
    /// [`ResultsError::Io`] if the folder cannot be read.
    pub(super) fn remove_all(&self) -> Result<(), ResultsError> {
        self.all_paths()?
            .iter()
            .try_for_each(|path| remove_own(path))
    }

    /// Leases and their temporary files; other files in the folder are foreign.
    fn all_paths(&self) -> Result<Vec<PathBuf>, ResultsError> {
        let entries = fs::read_dir(&self.folder)
            .and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect());
        let mut paths: Vec<PathBuf> = entries.map_err(ResultsError::io("read", &self.folder))?;
        paths.retain(|path| is_lease_name(&path.file_name().unwrap_or_default().to_string_lossy()));
        Ok(paths)
    }
}

/// Whether a file has the name of a lease, `<case>.<generation>`, or of its temporary file.
fn is_lease_name(name: &str) -> bool {
    let generation = name.rsplit_once('.').map(|(_, generation)| generation);
    name.starts_with(TEMPORARY_PREFIX)
        || generation.is_some_and(|number| number.parse::<u32>().is_ok())
}

impl Lease {
    /// Updates the lease.
    pub fn touch(&self) {
        if let Some(path) = self.files.last() {
            // An update needs no space on a full disk; if it fails, the next one may succeed.
            let _ = File::open(path).and_then(|file| file.set_modified(SystemTime::now()));
        }
    }
}

impl Drop for Lease {
    fn drop(&mut self) {
        // Removes the oldest first: a crash in between leaves a lease of a dead process.
        for path in &self.files {
            let _ = fs::remove_file(path);
        }
    }
}

impl Owner {
    /// This process.
    pub fn this_process() -> Self {
        let process = std::process::id();
        let boot = fs::read_to_string("/proc/sys/kernel/random/boot_id");
        Self {
            host: host_name().unwrap_or_default(),
            boot: boot.ok().map(|boot| boot.trim().to_owned()),
            process,
            started: start_of(process),
        }
    }

    /// Whether this process on the machine of `observer` still runs; `None` if the system does not
    /// report it.
    fn lives_here(&self, observer: &Self) -> Option<bool> {
        observer.started?;
        Some(self.boot == observer.boot && self.started == start_of(self.process))
    }
}

fn read_owner(path: &Path) -> Option<Owner> {
    serde_json::from_slice(&fs::read(path).ok()?).ok()
}

/// Start time of a process in ticks since the start of the machine: field 22 of proc(5).
fn start_of(process: u32) -> Option<u64> {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // Field 2, the program's name in parentheses, may contain blanks; field 3 is the first one
    // after it.
    let (_, after_name) = stat.rsplit_once(')')?;
    let mut fields = after_name.split_whitespace();
    // A process that has ended but was not waited for (a zombie) no longer works.
    if fields.next()? == "Z" {
        return None;
    }
    fields.nth(22 - 4)?.parse().ok()
}

/// Name of the machine, from a file or the environment, if available.
pub fn host_name() -> Option<String> {
    let from_file = fs::read_to_string("/proc/sys/kernel/hostname").ok();
    from_file
        .map(|name| name.trim().to_owned())
        .or_else(|| std::env::var("HOSTNAME").ok())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn leased(leases: &Leases, case: &str) -> Option<Lease> {
        match leases.acquire(case).unwrap() {
            LeaseAttempt::Granted(lease) => Some(lease),
            LeaseAttempt::Held(_) => None,
        }
    }

    /// Leases of another process with the given owner.
    fn of_another(folder: &Path, owner: Owner) -> Leases {
        Leases {
            owner,
            ..Leases::new(folder)
        }
    }

    fn elsewhere() -> Owner {
        Owner {
            host: "another machine".into(),
            boot: None,
            process: 1,
            started: None,
        }
    }

    #[test]
    fn a_case_is_leased_once_and_is_free_when_the_lease_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let leases = Leases::new(folder.path());
        let first = leased(&leases, "a").unwrap();
        assert!(leased(&leases, "a").is_none());
        assert!(leased(&leases, "b").is_some());
        drop(first);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        assert!(leased(&leases, "a").is_some());
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_lease_of_a_dead_process_of_this_machine_is_taken_over_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let mut child = std::process::Command::new("true").spawn().unwrap();
        child.wait().unwrap();
        for dead in [
            Owner {
                process: child.id(),
                ..Owner::this_process()
            },
            // Another process has the same process id.
            Owner {
                started: Some(1),
                ..Owner::this_process()
            },
            Owner {
                boot: Some("before".into()),
                ..Owner::this_process()
            },
        ] {
            std::mem::forget(leased(&of_another(folder.path(), dead), "a").unwrap());
            let leases = Leases::new(folder.path());
            assert!(!leases.any_alive().unwrap());
            drop(leased(&leases, "a").expect("taken over"));
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        }
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn leases_of_dead_processes_are_removed_with_what_they_were_writing_and_living_ones_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let dead = Owner {
            boot: Some("before".into()),
            ..Owner::this_process()
        };
        let leases = Leases::new(folder.path());
        let _mine = leased(&leases, "a").unwrap();
        std::mem::forget(leased(&of_another(folder.path(), dead.clone()), "b").unwrap());
        let half_way = folder.path().join(format!("{TEMPORARY_PREFIX}c"));
        fs::write(&half_way, serde_json::to_vec(&dead).unwrap()).unwrap();
        let begun = folder.path().join(format!("{TEMPORARY_PREFIX}d"));
        fs::write(&begun, serde_json::to_vec(&leases.owner).unwrap()).unwrap();
        leases.remove_dead().unwrap();
        assert_eq!(leases.all_files().unwrap(), [folder.path().join("a.0")]);
        assert!(!half_way.exists() && begun.exists());
    }

    #[test]
    fn a_lease_of_another_machine_holds_while_it_is_touched() {
        let folder = tempfile::tempdir().unwrap();
        let other = leased(&of_another(folder.path(), elsewhere()), "a").unwrap();
        let leases = Leases {
            patience: Duration::from_millis(60),
            ..Leases::new(folder.path())
        };
        for _ in 0..5 {
            assert!(leased(&leases, "a").is_none());
            std::thread::sleep(Duration::from_millis(20));
            other.touch();
        }
        assert!(leased(&leases, "a").is_none());
        std::thread::sleep(Duration::from_millis(80));
        assert!(leased(&leases, "a").is_some());
        std::mem::forget(other);
    }

    #[test]
    fn of_many_that_take_over_one_succeeds() {
        let folder = tempfile::tempdir().unwrap();
        for _ in 0..20 {
            std::mem::forget(leased(&of_another(folder.path(), elsewhere()), "a").unwrap());
            let taken = AtomicUsize::new(0);
            let barrier = std::sync::Barrier::new(4);
            std::thread::scope(|scope| {
                for _ in 0..4 {
                    scope.spawn(|| {
                        let leases = Leases {
                            patience: Duration::ZERO,
                            ..Leases::new(folder.path())
                        };
                        barrier.wait();
                        let lease = leased(&leases, "a");
                        taken.fetch_add(usize::from(lease.is_some()), Ordering::Relaxed);
                        // No process releases its lease before all have tried.
                        barrier.wait();
                    });
                }
            });
            assert_eq!(taken.into_inner(), 1);
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        }
    }
}
