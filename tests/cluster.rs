//! A sweep on a real Slurm, which the test starts on this machine: Debian, as root. Elsewhere the
//! tests report that they are skipped.

use crate::parts::{have, skipped, succeeds};
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};
use std::sync::{Mutex, MutexGuard};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Swings of a rope, which take a few tenths of a second each.
const SWINGS: &str = r#"
experiment = "scene"
material = { youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }
time = { step = "0.1 ms", end = "3 s" }
output = { interval = "0.1 s" }

[[rods]]
name = "rope"
radius = "5 mm"
edges = 12
shape = { kind = "straight", start = [0, 0, 0], end = [0.2, 0, 0] }

[[clamps]]
rod = "rope"
at = "start"

[[loads]]
kind = "gravity"
acceleration = [0, 0, -9.81]

[sweep]
rods.rope.radius = ["4 mm", "5 mm"]
material.density = [800.0, 900.0, 1000.0, 1100.0]
"#;

/// Number of cases.
const CASES: usize = 8;

fn program(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let candidates = std::env::split_paths(&path).map(|folder| folder.join(name));
    candidates.into_iter().find(|candidate| candidate.is_file())
}

fn said(output: &Output) -> String {
    let [stdout, stderr] =
        [&output.stdout, &output.stderr].map(|said| String::from_utf8_lossy(said));
    format!("{stdout}{stderr}")
}

/// A separate Slurm; stopped when dropped.
struct Slurm {
    folder: TempDir,
    /// Free ports are searched one after another, so that only one instance may start at a time.
    _alone: MutexGuard<'static, ()>,
}

static ALONE: Mutex<()> = Mutex::new(());

impl Slurm {
    fn start() -> Option<Self> {
        let user = Command::new("id").arg("-u").output();
        if !user.is_ok_and(|user| said(&user).trim() == "0") {
            skipped("only root can start a Slurm of its own");
            return None;
        }
        let alone = ALONE
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner());
        let folder = tempfile::tempdir().unwrap();
        let needed = ["slurmctld", "slurmd", "munged"];
        let is_there = || needed.iter().all(|name| program(name).is_some());
        let install = || {
            let script = concat!(env!("CARGO_MANIFEST_DIR"), "/scripts/slurm");
            let place = folder.path().join("slurm");
            succeeds(Command::new(script).arg("install").arg(place))
        };
        if !have("Slurm", "to run job arrays", is_there, install) {
            return None;
        }
        let slurm = Self {
            folder,
            _alone: alone,
        };
        let started = slurm.script("start");
        assert!(started.status.success(), "{}", said(&started));
        Some(slurm)
    }

    fn script(&self, what: &str) -> Output {
        Command::new(concat!(env!("CARGO_MANIFEST_DIR"), "/scripts/slurm"))
            .arg(what)
            .arg(self.folder.path().join("slurm"))
            .output()
            .unwrap()
    }

    fn command(&self, program: &str, arguments: &[&str]) -> Output {
        Command::new(program)
            .args(arguments)
            .env("SLURM_CONF", self.folder.path().join("slurm/slurm.conf"))
            .current_dir(self.folder.path())
            .output()
            .unwrap()
    }

    fn succeed(&self, program: &str, arguments: &[&str]) -> String {
        let output = self.command(program, arguments);
        assert!(
            output.status.success(),
            "{program} {arguments:?}: {}",
            said(&output)
        );
        said(&output)
    }

    fn rodlab(&self, arguments: &[&str]) -> String {
        self.succeed(env!("CARGO_BIN_EXE_rodlab"), arguments)
    }

    /// Status of the sweep.
    fn status(&self) -> serde_json::Value {
        serde_json::from_str(&self.rodlab(&["status", "results/swings", "--json"])).unwrap()
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
}

impl Drop for Slurm {
    fn drop(&mut self) {
        self.script("stop");
    }
}

fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(
            start.elapsed() < Duration::from_secs(120),
            "waited in vain for: {what}"
        );
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// The job number printed by `rodlab submit`.
fn job(printed: &str) -> String {
    let line = printed
        .lines()
        .find(|line| line.starts_with("job "))
        .expect("a job");
    line.split_whitespace().last().unwrap().to_owned()
}

fn task(status: &serde_json::Value, number: usize) -> serde_json::Value {
    status["tasks"][number - 1]["slurm"].clone()
}

/// Waits until a task has started a case.
fn wait_for_work(slurm: &Slurm, number: usize) {
    wait_until("a task at work", || {
        let leases = fs::read_dir(slurm.path("results/swings/leases"))
            .unwrap()
            .count();
        task(&slurm.status(), number)["state"] == "running" && leases > 0
    });
}

#[test]
fn killed_and_warned_tasks_resume_to_the_summary_of_a_local_run() {
    let Some(slurm) = Slurm::start() else { return };
    fs::write(slurm.path("swings.toml"), SWINGS).unwrap();
    slurm.rodlab(&["run", "swings.toml", "--out", "local", "--jobs", "2"]);
    let submit = [
        "submit",
        "swings.toml",
        "--tasks",
        "2",
        "--array-limit",
        "1",
        "--time",
        "10",
    ];
    let first = job(&slurm.rodlab(&submit));

    // Kill the task in the middle of its share, including its script.
    wait_for_work(&slurm, 1);
    slurm.succeed(
        "scancel",
        &["--full", "--signal=KILL", &format!("{first}_1")],
    );
    wait_until("the end of the killed task", || {
        task(&slurm.status(), 1)["state"] == "ended"
    });
    assert_ne!(slurm.status()["counts"]["finished"], CASES);

    // Warn the other task that its time limit is near: it writes checkpoints and is queued again.
    wait_for_work(&slurm, 2);
    slurm.succeed(
        "scancel",
        &["--batch", "--signal=USR1", &format!("{first}_2")],
    );
    wait_until("the warned task in the queue again", || {
        let task = task(&slurm.status(), 2);
        task["state"] == "waiting" && task["restarts"] == 1
    });

    // The same command submits what is neither finished nor in the queue.
    let printed = slurm.rodlab(&submit);
    assert!(printed.contains("1 of 2"), "{printed}");
    // Slurm delays a task that is queued again by two minutes; release it earlier.
    std::thread::sleep(Duration::from_millis(2500));
    slurm.succeed(
        "scontrol",
        &["update", &format!("jobid={first}_2"), "StartTime=now"],
    );
    wait_until("the end of all cases", || {
        slurm.status()["counts"]["finished"] == CASES
    });
    assert!(slurm.rodlab(&submit).contains("nothing to submit"));

    let gathered = slurm.rodlab(&["gather", "results/swings"]);
    assert!(gathered.starts_with("8 of 8 cases finished"), "{gathered}");
    let mut tables = vec!["summary.csv".to_owned(), "scenario.toml".to_owned()];
    for case in fs::read_dir(slurm.path("local/cases")).unwrap() {
        let case = case.unwrap().file_name().into_string().unwrap();
        tables.extend(["series.csv", "nodes.csv"].map(|name| format!("cases/{case}/{name}")));
    }
    for table in tables {
        let read = |results: &str| fs::read(slurm.path(results).join(&table)).unwrap();
        assert!(read("local") == read("results/swings"), "{table} differs");
    }
}

#[test]
fn the_output_of_sbatch_is_shown() {
    let Some(slurm) = Slurm::start() else { return };
    fs::write(slurm.path("swings.toml"), SWINGS).unwrap();
    let submit = ["submit", "swings.toml", "--partition", "nowhere"];
    let output = slurm.command(env!("CARGO_BIN_EXE_rodlab"), &submit);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        said(&output).contains("invalid partition"),
        "{}",
        said(&output)
    );
    assert!(!slurm.path("results/swings/slurm.json").exists());
}

#[test]
fn without_slurm_the_message_names_sbatch() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("swings.toml"), SWINGS).unwrap();
    let run = |arguments: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_rodlab"))
            .args(arguments)
            .env("PATH", "")
            .current_dir(folder.path())
            .output()
            .unwrap()
    };
    let output = run(&["submit", "swings.toml"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        said(&output).contains("cannot call `sbatch`"),
        "{}",
        said(&output)
    );
    assert!(!folder.path().join("results").join("swings").exists());
    for (tasks, words) in [
        ("3", "#SBATCH --array=1-3\n"),
        ("500", "--tasks 500: the sweep has 8 cases"),
    ] {
        let output = run(&["submit", "swings.toml", "--print", "--tasks", tasks]);
        assert!(said(&output).contains(words), "{}", said(&output));
    }
    for arguments in [["status", "."], ["gather", "."]] {
        let output = run(&arguments);
        assert_eq!(output.status.code(), Some(2));
        assert!(said(&output).contains("does not hold the results of a sweep"));
    }
}
