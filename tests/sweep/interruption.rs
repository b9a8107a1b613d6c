//! Kills, time limits, damaged checkpoints and full disks must not change the final results.

use super::{
    SWINGS, assert_same, begin, directory, manifest, outcome, succeed, tables, undisturbed,
};
use crate::parts::skipped;
use std::fs;
use std::hash::{BuildHasher, RandomState};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};
use tempfile::TempDir;

#[test]
#[cfg(unix)]
fn a_sweep_that_is_killed_at_a_random_time_resumes_to_the_same_bytes() {
    let directory = directory(SWINGS);
    let start = Instant::now();
    let expected = undisturbed(&directory);
    let whole = start.elapsed();
    for attempt in 0..10 {
        let name = format!("killed_{attempt}");
        let run = ["run", "swings.toml", "--out", &name, "--jobs", "2"];
        let moment = whole.mul_f64(random_part());
        let mut child = begin(&directory, &run);
        std::thread::sleep(moment);
        child.kill().unwrap();
        child.wait().unwrap();
        succeed(&directory, &run);
        println!("killed after {moment:?} of {whole:?}");
        assert_same(&tables(&directory.path().join(&name)), &expected);
    }
}

/// A random number from 0 to 1.
fn random_part() -> f64 {
    RandomState::new().hash_one(0) as f64 / u64::MAX as f64
}

#[test]
#[cfg(unix)]
fn a_sweep_that_is_killed_repeatedly_resumes_to_the_same_bytes() {
    let directory = directory(SWINGS);
    let start = Instant::now();
    let expected = undisturbed(&directory);
    let whole = start.elapsed();
    let run = ["run", "swings.toml", "--out", "killed", "--jobs", "2"];
    for part in 0..10 {
        let mut child = begin(&directory, &run);
        // Kill at increasingly late times, each in another stage of a case.
        std::thread::sleep(whole * (2 * part + 1) / 60);
        child.kill().unwrap();
        child.wait().unwrap();
    }
    succeed(&directory, &run);
    assert_same(&tables(&directory.path().join("killed")), &expected);
    let leases = fs::read_dir(directory.path().join("killed/leases")).unwrap();
    // A lease without its owner, from a kill within microseconds, is removed by a much later run.
    let left = leases.filter(|lease| lease.as_ref().unwrap().metadata().unwrap().len() > 0);
    assert_eq!(left.count(), 0);
}

#[test]
#[cfg(target_os = "linux")]
fn files_lost_with_the_power_are_made_again_and_altered_ones_are_reported() {
    let directory = directory(SWINGS);
    let expected = undisturbed(&directory);
    let run = ["run", "swings.toml", "--out", "lost"];
    succeed(&directory, &run);
    let place = directory.path().join("lost");
    let leases = place.join("leases");
    assert_eq!(fs::read_dir(&leases).unwrap().count(), 0);
    let case = fs::read_dir(place.join("cases")).unwrap().next().unwrap();
    let case = case.unwrap();
    fs::write(case.path().join("series.csv"), "").unwrap();
    let (code, _, stderr) = outcome(&directory, &run);
    assert_eq!(code, 1, "{stderr}");
    assert!(stderr.contains("series.csv"), "{stderr}");
    // The process that finished the case died with the machine before it released the case.
    let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap();
    let owner = serde_json::json!({
        "host": host.trim(), "boot": "an earlier boot", "process": 1, "started": 1
    });
    let lease = format!("{}.0", case.file_name().to_str().unwrap());
    fs::write(leases.join(lease), owner.to_string()).unwrap();
    let (code, _, stderr) = outcome(&directory, &run);
    assert_eq!(code, 0, "{stderr}");
    assert!(stderr.contains("runs again"), "{stderr}");
    assert_same(&tables(&place), &expected);
    assert_eq!(fs::read_dir(&leases).unwrap().count(), 0);
}

#[test]
#[cfg(unix)]
fn two_processes_share_a_sweep_and_one_takes_over_from_the_other() {
    let directory = directory(SWINGS);
    let expected = undisturbed(&directory);
    let run = ["run", "swings.toml", "--out", "shared", "--jobs", "1"];
    let mut first = begin(&directory, &run);
    let mut second = begin(&directory, &run);
    let cases = directory.path().join("shared/cases");
    while fs::read_dir(&cases).map_or(0, Iterator::count) < 3 {
        std::thread::sleep(Duration::from_millis(1));
    }
    first.kill().unwrap();
    first.wait().unwrap();
    assert!(second.wait().unwrap().success());
    assert_same(&tables(&directory.path().join("shared")), &expected);
}

#[test]
fn a_time_limit_stops_the_sweep_and_the_same_command_continues() {
    let directory = directory(SWINGS);
    let expected = undisturbed(&directory);
    let run = ["run", "swings.toml", "--out", "pieces", "--jobs", "2"];
    let limited: Vec<&str> = run.iter().copied().chain(["--timeout", "20 ms"]).collect();
    let pieces = (1..1000)
        .find(|_| {
            let (code, _, stderr) = outcome(&directory, &limited);
            assert!(code == 0 || code == 5, "{stderr}");
            code == 0
        })
        .expect("the sweep comes to its end");
    assert!(pieces > 1, "the sweep was never stopped");
    assert_same(&tables(&directory.path().join("pieces")), &expected);
}

#[test]
fn a_damaged_checkpoint_is_reported_and_its_case_starts_again() {
    // The run is long enough to be stopped: a call runs for at least 20 ms, however short its time
    // limit is.
    let directory = directory(&SWINGS.replace("0.5 s", "10 s"));
    let expected = undisturbed(&directory);
    let run = ["run", "swings.toml", "--out", "damaged", "--jobs", "1"];
    let checkpoints = || -> Vec<PathBuf> {
        let cases = fs::read_dir(directory.path().join("damaged/cases")).unwrap();
        cases
            .flat_map(|case| fs::read_dir(case.unwrap().path()).unwrap())
            .map(|file| file.unwrap().path())
            .filter(|file| {
                file.file_name()
                    .unwrap()
                    .to_string_lossy()
                    .starts_with("checkpoint")
            })
            .collect()
    };
    let stopped = (1..100).find(|part| {
        let timeout = format!("{} ms", 3 * part);
        let limited: Vec<&str> = run.iter().copied().chain(["--timeout", &timeout]).collect();
        outcome(&directory, &limited);
        !checkpoints().is_empty()
    });
    assert!(stopped.is_some(), "no case was stopped on the way");
    for checkpoint in checkpoints() {
        let mut bytes = fs::read(&checkpoint).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        fs::write(checkpoint, bytes).unwrap();
    }
    let (code, _, stderr) = outcome(&directory, &run);
    assert_eq!(code, 0, "{stderr}");
    assert!(
        stderr.contains("checksum") && stderr.contains("starting again"),
        "{stderr}"
    );
    assert_same(&tables(&directory.path().join("damaged")), &expected);
}

/// A small file system in memory, unmounted when dropped; `None` if this user may not mount one.
struct SmallDisk(TempDir);

impl SmallDisk {
    fn mount(size: &str) -> Option<Self> {
        let place = tempfile::tempdir().unwrap();
        let mounted = std::process::Command::new("mount")
            .args(["-t", "tmpfs", "-o", &format!("size={size}"), "tmpfs"])
            .arg(place.path())
            .stderr(Stdio::null())
            .status();
        mounted
            .is_ok_and(|status| status.success())
            .then_some(Self(place))
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let unmounted = std::process::Command::new("umount")
            .arg(self.0.path())
            .status();
        assert!(unmounted.is_ok_and(|status| status.success()));
    }
}

#[test]
fn a_sweep_ends_with_1_on_a_full_disk_and_resumes_when_there_is_space() {
    let Some(disk) = SmallDisk::mount("400k") else {
        skipped("a full disk needs a small file system, and only root can mount one");
        return;
    };
    let directory = directory(SWINGS);
    let expected = undisturbed(&directory);
    let out = disk.0.path().join("results");
    let run = [
        "run",
        "swings.toml",
        "--jobs",
        "1",
        "--out",
        out.to_str().unwrap(),
    ];
    // A file that fills the disk and is removed later.
    let ballast = disk.0.path().join("ballast");
    fs::write(&ballast, vec![1; 200 << 10]).unwrap();
    let (code, _, stderr) = outcome(&directory, &run);
    assert_eq!(code, 1, "{stderr}");
    assert!(stderr.contains("No space left on device"), "{stderr}");
    // Every finished case is complete.
    let mut finished = 0;
    for case in fs::read_dir(out.join("cases")).unwrap() {
        let case = case.unwrap().path();
        if case.join("manifest.json").exists()
            && manifest(&case)["cases"]["main"]["status"] == "finished"
        {
            let name = Path::new("cases")
                .join(case.file_name().unwrap())
                .join("series.csv");
            assert!(fs::read(case.join("series.csv")).unwrap() == expected[&name]);
            finished += 1;
        }
    }
    assert!(finished > 0, "the disk was full too early to show anything");
    fs::remove_file(ballast).unwrap();
    let grown = std::process::Command::new("mount")
        .args(["-o", "remount,size=20m"])
        .arg(disk.0.path())
        .status();
    assert!(grown.unwrap().success());
    succeed(&directory, &run);
    assert_same(&tables(&out), &expected);
}
