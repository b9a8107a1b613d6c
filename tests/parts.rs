//! Parts beside Rust that some tests need: a browser, Slurm, ROS 1, Fast DDS and Cyclone DDS, simavr, pinocchio, MuJoCo,
//! VTK. One place says what is installed and why, installs one after the other, and says what was skipped.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

/// Set to `0`, nothing is installed: tests whose parts are missing are skipped.
const VARIABLE: &str = "RODLAB_TESTS_INSTALL";

/// Whether a part is there, installed where it is missing and that is not declined. `purpose` says what for.
pub fn have(
    part: &str,
    purpose: &str,
    is_there: impl Fn() -> bool,
    install: impl FnOnce() -> bool,
) -> bool {
    if is_there() {
        return true;
    }
    if std::env::var(VARIABLE).is_ok_and(|value| value == "0") {
        skipped(&format!(
            "no {part}, and {VARIABLE}=0 forbids to install it"
        ));
        return false;
    }
    // Package managers wait for nobody: one installation at a time, here and in other processes.
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

/// Says that a test is skipped, now and in the list that `scripts/ci` shows at its end.
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

/// A Python environment beside the build in which `module` can be imported, with `package` installed by pip.
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

/// A file or folder beside the build.
pub fn in_build(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// Not by `eprintln!`, which the test harness swallows.
fn say(what: &str) {
    let _ = writeln!(std::io::stderr(), "{what}");
}
