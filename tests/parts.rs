//! Programs outside Rust that some tests need: a browser, Slurm, ROS 1, Fast DDS and Cyclone DDS,
//! simavr, pinocchio, MuJoCo, VTK. This file alone reports what is installed and why, installs one
//! program at a time, and reports skipped tests.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, Once};

/// If this variable is `0`, nothing is installed, and tests with missing programs are skipped.
const VARIABLE: &str = "RODLAB_TESTS_INSTALL";

/// Whether a program is available. Installs it if it is missing and installation is allowed;
/// `purpose` is for the message.
pub fn have(
    part: &str,
    purpose: &str,
    is_there: impl Fn() -> bool,
    install: impl FnOnce() -> bool,
) -> bool {
    announce();
    if is_there() {
        return true;
    }
    if std::env::var(VARIABLE).is_ok_and(|value| value == "0") {
        skipped(&format!(
            "no {part}, and {VARIABLE}=0 forbids to install it"
        ));
        return false;
    }
    // Package managers do not wait for each other: allow only one installation at a time, in this
    // process and in others.
    static ALONE: Mutex<()> = Mutex::new(());
    let _alone = ALONE
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    let lock = File::create(in_build("install.lock")).expect("a file beside the build");
    lock.lock().expect("a lock");
    if is_there() {
        return true;
    }
    say(&format!(
        "INSTALLING {part}, {purpose}; {VARIABLE}=0 forbids it"
    ));
    let done = install() && is_there();
    if !done {
        skipped(&format!("no {part}, and it could not be installed"));
    }
    done
}

/// Prints once what may be installed, before anything is installed.
fn announce() {
    static ANNOUNCED: Once = Once::new();
    ANNOUNCED.call_once(|| {
        let declined = std::env::var(VARIABLE).is_ok_and(|value| value == "0");
        let user = Command::new("id").arg("-u").output();
        let is_root = user.is_ok_and(|user| user.stdout == b"0\n");
        if declined || !is_root {
            return;
        }
        let scripts = INSTALLERS.iter().flat_map(|script| packages_of(script));
        let missing = |package: &String| !is_installed(package);
        let missing: Vec<String> = scripts.filter(missing).collect();
        if !missing.is_empty() {
            say(&format!(
                "These tests may install the Debian packages {}; {VARIABLE}=0 forbids it",
                missing.join(" ")
            ));
        }
    });
}

/// Programs that install packages.
const INSTALLERS: [&str; 6] = [
    include_str!("../scripts/install-chromium"),
    include_str!("../scripts/install-fast-dds"),
    include_str!("../scripts/install-mujoco"),
    include_str!("../scripts/install-simavr"),
    include_str!("../scripts/ros1"),
    include_str!("../scripts/slurm"),
];

/// The Debian packages that a script installs.
fn packages_of(script: &str) -> Vec<String> {
    let script = script.replace("\\\n", " ");
    let lists = script
        .lines()
        .filter_map(|line| line.split_once("--no-install-recommends "));
    let words = |list: &str| -> Vec<String> {
        let words = list.split_whitespace();
        words
            .take_while(|word| *word != ">")
            .map(str::to_owned)
            .collect()
    };
    lists.flat_map(|(_, list)| words(list)).collect()
}

fn is_installed(package: &str) -> bool {
    let mut query = Command::new("dpkg-query");
    query.args(["--show", "--showformat=${db:Status-Status}", package]);
    query
        .output()
        .is_ok_and(|output| output.stdout == b"installed")
}

#[test]
fn every_installer_names_its_packages() {
    for script in INSTALLERS {
        let packages = packages_of(script);
        assert!(!packages.is_empty(), "{script}");
        let is_name = |name: &String| {
            name.chars()
                .all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
        };
        assert!(packages.iter().all(is_name), "{packages:?}");
    }
    let two_lines = "apt-get install --no-install-recommends \\\n    a b > log\n";
    assert_eq!(packages_of(two_lines), ["a", "b"]);
}

/// Reports that a test is skipped, now and in the list at the end of `scripts/ci`.
pub fn skipped(reason: &str) {
    say(&format!("SKIPPED: {reason}"));
    let list = OpenOptions::new()
        .create(true)
        .append(true)
        .open(in_build("skipped.txt"));
    let _ = writeln!(list.expect("a file beside the build"), "{reason}");
}

/// Whether a command succeeds; its output is not shown.
pub fn succeeds(command: &mut Command) -> bool {
    command.output().is_ok_and(|output| output.status.success())
}

/// A Python environment in the build directory, in which `package` is installed by pip and
/// `module` can be imported.
pub fn python_with(module: &str, package: &str, purpose: &str) -> Option<PathBuf> {
    let folder = in_build(module);
    let python = folder.join("bin/python");
    let is_there = || succeeds(Command::new(&python).args(["-c", &format!("import {module}")]));
    let install = || {
        succeeds(Command::new("python3").args(["-m", "venv"]).arg(&folder))
            && succeeds(Command::new(&python).args(["-m", "pip", "install", "--quiet", package]))
    };
    have(
        &format!("Python module {module}"),
        purpose,
        is_there,
        install,
    )
    .then_some(python)
}

/// A file or folder in the build directory.
pub fn in_build(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// The test harness would capture the output of `eprintln!`.
fn say(what: &str) {
    let _ = writeln!(std::io::stderr(), "{what}");
}
