//! The virtual cell as its clients find it: the real server in a process of its own, and the commands that move a real arm.

use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use tungstenite::Message;

/// A short and coarse rod.
const ROD: &str = "[deployment.rod]\ngravito_bending_length = \"3 cm\"\nradius = \"2 mm\"\nlength = \"30 cm\"\nedges = 30\n";

/// A server that ends with the test.
pub struct Served {
    child: Child,
    address: String,
    pub folder: tempfile::TempDir,
}

impl Drop for Served {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

pub fn gantry() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/cells/gantry.toml");
    fs::read_to_string(path).unwrap()
}

/// Serves the gantry with a rod, with further arguments.
fn serve(arguments: &[&str], path: &str) -> Served {
    serve_cell(&[&["--rod", "rod.toml"], arguments].concat(), path)
}

/// Serves the gantry with some arguments.
pub fn serve_cell(arguments: &[&str], path: &str) -> Served {
    serve_file(&gantry(), arguments, path)
}

/// Serves a cell by its file with some arguments; `client.toml` in its folder is the cell file for its clients, who name a path where
/// there is one.
pub fn serve_file(cell: &str, arguments: &[&str], path: &str) -> Served {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("rod.toml"), ROD).unwrap();
    fs::write(folder.path().join("cell.toml"), cell).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .args(["cell", "serve", "--cell", "cell.toml"])
        .args(["--listen", "127.0.0.1:0"])
        .args(arguments)
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let mut said = BufReader::new(child.stdout.take().unwrap());
    said.read_line(&mut line).unwrap();
    let address = line
        .trim()
        .strip_prefix("listening on ")
        .expect("an address");
    let address = address.to_owned();
    let of_driver = format!("address = \"{address}{path}\"");
    let client = cell
        .replace("address = \"127.0.0.1:9090\"", &of_driver)
        .replace("127.0.0.1:9090", &address)
        // A machine that is busy with other tests may be silent for longer than an arm.
        .replace("[streaming]", "[streaming]\nwatchdog = \"5 s\"");
    fs::write(folder.path().join("client.toml"), client).unwrap();
    Served {
        child,
        address,
        folder,
    }
}

impl Served {
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
        command.args(arguments).current_dir(self.folder.path());
        if ["deploy", "place", "tie", "fold"].contains(&arguments[0]) {
            command.arg("--yes");
        }
        // Marks of tasks that did not come to their end are those of this test.
        command.env("XDG_STATE_HOME", self.folder.path().join("state"));
        command
    }

    pub fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Lays the rod along a line of 20 cm.
    fn deploy(&self) -> Output {
        self.run(&DEPLOY)
    }

    /// Waits until a task has begun to move the arm.
    fn wait_for_motion(&self) {
        let begin = Instant::now();
        while !self.read("laid/approach/events.csv").contains("started") {
            assert!(begin.elapsed() < Duration::from_secs(20));
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Whether the arm stands half a second from now.
    pub fn stands_soon(&self) -> bool {
        std::thread::sleep(Duration::from_millis(500));
        self.stands("/joint_states")
    }

    /// Whether the arm whose joints are told on a topic stands.
    pub fn stands(&self, topic: &str) -> bool {
        let (mut socket, _) = tungstenite::connect(format!("ws://{}", self.address)).unwrap();
        let subscription = json!({ "op": "subscribe", "topic": topic });
        socket
            .send(Message::text(subscription.to_string()))
            .unwrap();
        let mut joints = || {
            let message = socket.read().unwrap();
            let message: Value = serde_json::from_str(message.to_text().unwrap()).unwrap();
            message["msg"]["position"].clone()
        };
        let first = joints();
        (0..5).all(|_| joints() == first)
    }

    /// The next task, here one whose results would go to `again`, is refused, until somebody says that the cell was looked at.
    pub fn asks_for_a_look_before(&self, task: &[&str]) {
        let refused = self.run(task);
        assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
        assert!(said(&refused).contains("--checked"), "{}", said(&refused));
        assert!(!self.folder.path().join("again").exists());
    }

    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.folder.path().join(name)).unwrap_or_default()
    }

    /// A table in which the gantry moves along x by so much within a time, from rest to rest.
    fn write_motion(&self, way: f64, seconds: f64) {
        let mut text = String::from(
            "time_s,gantry.x_m,gantry.y_m,gantry.z_m,gantry.yaw_rad,gantry.pitch_rad,gantry.roll_rad\n",
        );
        for k in 0..=200 {
            let part = f64::from(k) / 200.0;
            let risen = part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part);
            text.push_str(&format!("{},{},0,0.5,0,0,0\n", seconds * part, way * risen));
        }
        fs::write(self.folder.path().join("joints.csv"), text).unwrap();
    }

    /// Changes the cell file of the clients.
    pub fn change(&self, from: &str, to: &str) {
        let path = self.folder.path().join("client.toml");
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{from}");
        fs::write(path, text.replace(from, to)).unwrap();
    }
}

pub fn said(output: &Output) -> String {
    let [stdout, stderr] =
        [&output.stdout, &output.stderr].map(|said| String::from_utf8_lossy(said));
    format!("{stdout}{stderr}")
}

const DEPLOY: [&str; 9] = [
    "deploy",
    "--pattern",
    "line:0.2",
    "--rod",
    "rod.toml",
    "--cell",
    "client.toml",
    "--out",
    "laid",
];

/// The same into another directory.
fn again() -> [&'static str; 9] {
    let mut again = DEPLOY;
    again[DEPLOY.len() - 1] = "again";
    again
}

/// Ten moments spread over a time, s, five at a time.
fn at_ten_moments(most: f64, check: impl Fn(f64) + Sync) {
    let moments: Vec<f64> = (1..=10)
        .map(|k| most * (f64::from(k) * 0.618_034).fract())
        .collect();
    for moments in moments.chunks(5) {
        std::thread::scope(|scope| {
            for moment in moments {
                scope.spawn(|| check(*moment));
            }
        });
    }
}

/// The log of a task that did not come to its end.
fn log_is_whole(served: &Served, status: &str, moment: f64) {
    let manifest: Value = serde_json::from_str(&served.read("laid/manifest.json")).unwrap();
    assert_eq!(manifest["status"], status, "{moment}");
    assert!(manifest["error"].is_string(), "{moment}");
    assert!(served.read("laid/report.md").contains(status), "{moment}");
    assert!(
        !served.read("laid/approach/state.csv").is_empty(),
        "{moment}"
    );
}

/// The manifest and the report of an interrupted task: what was done, what lies, where the hand is and what to do.
fn says_how_it_left_the_cell(served: &Served) {
    let manifest: Value = serde_json::from_str(&served.read("laid/manifest.json")).unwrap();
    let stopped = &manifest["stopped"];
    let during = stopped["during"].as_str().unwrap();
    let [laid, path] = ["laid_m", "path_m"].map(|key| stopped["laid"][0][key].as_f64().unwrap());
    assert!((0.0..=path).contains(&laid), "{manifest}");
    if ["going to the first point", "taking the rod"].contains(&during) {
        assert_eq!(laid, 0.0, "{manifest}");
    }
    let hand = &stopped["hands"][0];
    assert_eq!(hand["arm"], "gantry", "{manifest}");
    assert_eq!(
        hand["position_m"].as_array().unwrap().len(),
        3,
        "{manifest}"
    );
    let next = stopped["next"].as_str().unwrap();
    let report = served.read("laid/report.md");
    for words in [during, &next.replace('`', r"\`"), "| hand | gantry: at "] {
        assert!(report.contains(words), "{words}: {report}");
    }
}

const STREAM: [&str; 6] = [
    "stream",
    "joints.csv",
    "--cell",
    "client.toml",
    "--out",
    "log",
];

#[test]
fn a_rod_is_laid_along_a_line_seen_and_scored() {
    let served = serve(&["--rate", "50"], "");
    let output = served.deploy();
    assert!(output.status.success(), "{}", said(&output));
    let record: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(record["status"], "finished");
    let error = |name: &str| record["score"][name]["mean_m"].as_f64().unwrap();
    // The camera sees 0.7 mm in a pixel.
    assert!(error("by_nearest_point") < 1e-3, "{record}");
    assert!(error("by_arc_length") < 3e-3, "{record}");
    for name in [
        "plan/trajectory.csv",
        "plan/landing.toml",
        "joints.csv",
        "cell.html",
        "approach/state.csv",
        "laying/commanded.csv",
        "laying/state.csv",
        "rod.csv",
        "score.svg",
        "report.md",
        "manifest.json",
    ] {
        assert!(!served.read(&format!("laid/{name}")).is_empty(), "{name}");
    }
    for name in ["picture.png", "overlay.png"] {
        assert!(
            served.folder.path().join("laid").join(name).is_file(),
            "{name}"
        );
    }
    assert!(served.read("laid/report.md").contains("finished"));
    // A second rod is laid from where the arm stands now; the directory of the first is not touched.
    let refused = served.deploy();
    assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
}

#[test]
fn faults_of_the_cell_end_a_deployment_with_exit_code_1_and_a_whole_log() {
    // How late an arm may be grows with the rate of its clock: a frozen joint shows soon on a slower one.
    for (fault, words, rate) in [
        ("drop-link@9s", "connection", "10"),
        ("freeze-joint@9s", "from where it should be", "3"),
        ("drop-link@0s", "connection", "10"),
    ] {
        let served = serve(&["--rate", rate, "--fault", fault], "");
        let output = served.deploy();
        assert_eq!(output.status.code(), Some(1), "{fault}: {}", said(&output));
        assert!(said(&output).contains(words), "{fault}: {}", said(&output));
        let manifest: Value = serde_json::from_str(&served.read("laid/manifest.json")).unwrap();
        assert_eq!(manifest["status"], "failed", "{fault}");
        assert!(
            manifest["error"].as_str().unwrap().contains(words),
            "{fault}"
        );
        assert!(served.read("laid/report.md").contains("failed"), "{fault}");
        let events =
            ["approach", "laying"].map(|part| served.read(&format!("laid/{part}/events.csv")));
        assert!(events.concat().contains(words), "{fault}: {events:?}");
    }
}

#[test]
fn a_rod_that_is_longer_than_its_pattern_is_laid_to_its_end() {
    let served = serve(&["--rate", "50"], "");
    let mut arguments = DEPLOY;
    arguments[2] = "line:0.12";
    let output = served.run(&arguments);
    assert!(output.status.success(), "{}", said(&output));
    let record: Value = serde_json::from_slice(&output.stdout).unwrap();
    let error = |name: &str| record["score"][name]["largest_m"].as_f64().unwrap();
    assert!(
        error("by_arc_length") < 3e-3 && error("by_nearest_point") < 1.5e-3,
        "{record}"
    );
    // All but 2.5 gravito-bending lengths of 30 cm.
    let pattern = served.read("laid/plan/pattern.csv");
    let last = pattern.lines().last().unwrap().split(',').next().unwrap();
    assert_eq!(last, "0.225000000");
}

#[test]
fn a_rod_of_another_length_than_the_one_that_is_seen_is_not_scored() {
    let served = serve(&["--rate", "50"], "");
    // The cell hands out 30 cm.
    let longer = ROD.replace("30 cm", "32 cm");
    fs::write(served.folder.path().join("longer.toml"), longer).unwrap();
    let mut arguments = DEPLOY;
    arguments[4] = "longer.toml";
    let output = served.run(&arguments);
    assert_eq!(output.status.code(), Some(4), "{}", said(&output));
    assert!(output.stdout.is_empty() && said(&output).contains("not seen whole"));
    let manifest: Value = serde_json::from_str(&served.read("laid/manifest.json")).unwrap();
    assert_eq!(manifest["status"], "not-seen-whole", "{manifest}");
    assert_eq!(manifest["score"], Value::Null, "{manifest}");
    let lengths = &manifest["seen_length"];
    assert_eq!(lengths["rod_m"], 0.32, "{manifest}");
    let seen = lengths["seen_m"].as_f64().unwrap();
    assert!((seen - 0.3).abs() < 3e-3, "{manifest}");
    let report = served.read("laid/report.md");
    assert!(report.contains("320.0 mm"), "{report}");
    // The work of the arm is done: the next task may begin.
    let next = served.run(&again());
    assert!(next.status.success(), "{}", said(&next));
}

#[test]
fn a_cable_is_placed_between_its_pegs_by_the_optimal_grasps_and_not_by_the_intuitive_ones() {
    let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/cable_placement_u.toml");
    let scenario = scenario.to_str().unwrap();
    let served = serve_cell(&["--scene", scenario, "--rate", "50"], "");
    for (scheme, is_placed) in [("optimal", true), ("intuitive", false)] {
        let scheme_key = format!("deployment.scheme={scheme}");
        let set = ["--set", &scheme_key, "--out", scheme];
        let cell = ["--cell", "client.toml", "--approach-speed", "0.4"];
        let placed = served.run(&[&["place", scenario], &cell[..], &set[..]].concat());
        assert!(placed.status.success(), "{}", said(&placed));
        let manifest = served.read(&format!("{scheme}/manifest.json"));
        let manifest: Value = serde_json::from_str(&manifest).unwrap();
        assert_eq!(manifest["pegs"]["count"], 22, "{manifest}");
        let passed = manifest["pegs"]["passed"].as_u64().unwrap();
        assert_eq!(passed == 22, is_placed, "{manifest}");
        let report = served.read(&format!("{scheme}/report.md"));
        assert!(report.contains(&format!("{passed} of 22")), "{report}");
        assert!(
            served
                .read(&format!("{scheme}/pegs.svg"))
                .contains("</svg>")
        );
    }
}

#[test]
fn what_is_no_placement_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (scenario, word) in [
        ("deployment.toml", "deployment.clips"),
        ("trefoil.toml", "deployment"),
        ("nothing.toml", "nothing.toml"),
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("scenarios")
            .join(scenario);
        for command in [&["place"][..], &["cell", "serve", "--scene"]] {
            let refused = Command::new(env!("CARGO_BIN_EXE_rodlab"))
                .args(command)
                .arg(&path)
                .arg("--cell")
                .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/cells/gantry.toml"))
                .current_dir(folder.path())
                .output()
                .unwrap();
            assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
            assert!(said(&refused).contains(word), "{}", said(&refused));
        }
    }
    assert!(fs::read_dir(folder.path()).unwrap().next().is_none());
}

#[test]
fn a_rod_is_laid_anew_from_where_the_camera_sees_it() {
    // The limits below are four to six times the trembling: how far it has come when the arm begins is not fixed.
    let jitter = ["--jitter", "0.5 mm", "--seed", "3"];
    let served = serve(&[&["--rate", "50"], &jitter[..]].concat(), "");
    let mut arguments = DEPLOY.to_vec();
    arguments.push("--correct");
    let output = served.run(&arguments);
    assert!(output.status.success(), "{}", said(&output));
    let record: Value = serde_json::from_slice(&output.stdout).unwrap();
    let error = record["score"]["by_nearest_point"]["largest_m"]
        .as_f64()
        .unwrap();
    assert!(error < 3e-3, "{record}");
    let looks = served.read("laid/corrections.csv");
    let mut rows = looks.lines();
    assert_eq!(
        rows.next().unwrap(),
        "laid_m,seen_m,x_m,y_m,angle_rad,gravito_bending_length_m,processor_time_s"
    );
    let seen: Vec<Vec<f64>> = rows
        .filter_map(|row| row.split(',').map(|text| text.parse().ok()).collect())
        .collect();
    assert!(seen.len() >= 4, "{looks}");
    for row in &seen {
        // Half a gravito-bending length before the gripper's place nothing is believed; the line is along x.
        assert!(
            (row[0] - row[1] - 0.015).abs() < 1e-4 && (row[1] - row[2]).abs() < 2e-3,
            "{looks}"
        );
        assert!(row[3].abs() < 3e-3 && row[4].abs() < 0.1, "{looks}");
    }
}

#[test]
fn a_link_that_drops_at_any_moment_leaves_the_arm_still_and_a_whole_log() {
    at_ten_moments(10.0, |moment| {
        let fault = format!("drop-link@{moment}s");
        let served = serve(&["--rate", "50", "--fault", &fault], "");
        let output = served.deploy();
        assert_eq!(output.status.code(), Some(1), "{fault}: {}", said(&output));
        assert!(served.stands_soon(), "{fault}");
        log_is_whole(&served, "failed", moment);
        served.asks_for_a_look_before(&again());
    });
}

#[test]
fn a_joint_that_freezes_at_any_moment_leaves_the_arm_still_and_a_whole_log() {
    at_ten_moments(10.0, |moment| {
        let fault = format!("freeze-joint@{moment}s");
        let served = serve(&["--rate", "50", "--fault", &fault], "");
        let output = served.deploy();
        assert_eq!(output.status.code(), Some(1), "{fault}: {}", said(&output));
        assert!(served.stands_soon(), "{fault}");
        log_is_whole(&served, "failed", moment);
        served.asks_for_a_look_before(&again());
    });
}

#[test]
fn a_rod_that_slips_out_of_the_gripper_at_any_moment_ends_the_task() {
    at_ten_moments(14.0, |moment| {
        let fault = format!("slip-grasp@{moment}s");
        let served = serve(&["--rate", "50", "--fault", &fault], "");
        let output = served.deploy();
        assert_eq!(output.status.code(), Some(1), "{fault}: {}", said(&output));
        let words = "slipped out of the gripper";
        assert!(said(&output).contains(words), "{fault}: {}", said(&output));
        assert!(served.stands_soon(), "{fault}");
        log_is_whole(&served, "failed", moment);
        served.asks_for_a_look_before(&again());
    });
}

#[test]
fn a_camera_that_is_lost_at_any_moment_ends_the_task() {
    at_ten_moments(14.0, |moment| {
        let fault = format!("lose-camera@{moment}s");
        let served = serve(&["--rate", "50", "--fault", &fault], "");
        let output = served.deploy();
        assert_eq!(output.status.code(), Some(1), "{fault}: {}", said(&output));
        let words = "is the camera started";
        assert!(said(&output).contains(words), "{fault}: {}", said(&output));
        assert!(served.stands_soon(), "{fault}");
        log_is_whole(&served, "failed", moment);
        served.asks_for_a_look_before(&again());
    });
}

#[test]
fn a_task_that_is_interrupted_at_any_moment_holds_the_arm() {
    at_ten_moments(1.0, |moment| {
        let served = serve(&["--rate", "10"], "");
        let mut task = served
            .command(&DEPLOY)
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        served.wait_for_motion();
        std::thread::sleep(Duration::from_secs_f64(moment));
        let told = Command::new("kill")
            .args(["-INT", &task.id().to_string()])
            .status();
        assert!(told.unwrap().success());
        assert_eq!(task.wait().unwrap().code(), Some(130), "{moment}");
        assert!(served.stands_soon(), "{moment}");
        log_is_whole(&served, "interrupted", moment);
        says_how_it_left_the_cell(&served);
        served.asks_for_a_look_before(&again());
    });
}

#[test]
fn a_task_that_is_killed_at_any_moment_leaves_the_arm_still() {
    at_ten_moments(1.0, |moment| {
        let served = serve(&["--rate", "10"], "");
        let mut task = served
            .command(&DEPLOY)
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        served.wait_for_motion();
        std::thread::sleep(Duration::from_secs_f64(moment));
        // As kill -9 does.
        task.kill().unwrap();
        task.wait().unwrap();
        assert!(served.stands_soon(), "{moment}");
        assert!(
            !served.read("laid/approach/state.csv").is_empty(),
            "{moment}"
        );
        served.asks_for_a_look_before(&again());
    });
}

#[test]
fn a_cell_that_is_killed_at_any_moment_ends_the_task() {
    at_ten_moments(1.0, |moment| {
        let mut served = serve(&["--rate", "10"], "");
        let task = served
            .command(&DEPLOY)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        served.wait_for_motion();
        std::thread::sleep(Duration::from_secs_f64(moment));
        served.child.kill().unwrap();
        served.child.wait().unwrap();
        let output = task.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{moment}: {}", said(&output));
        log_is_whole(&served, "failed", moment);
        served.asks_for_a_look_before(&again());
    });
}

#[test]
fn a_task_goes_on_when_somebody_has_looked() {
    let served = serve(&["--rate", "50", "--fault", "drop-link@2s"], "");
    assert_eq!(served.deploy().status.code(), Some(1));
    served.asks_for_a_look_before(&again());
    let mut again = DEPLOY.to_vec();
    again.extend(["--checked"]);
    again[DEPLOY.len() - 1] = "again";
    let output = served.run(&again);
    assert!(output.status.success(), "{}", said(&output));
    // It came to its end: the next one is not asked.
    again.pop();
    again[DEPLOY.len() - 1] = "third";
    let output = served.run(&again);
    assert!(output.status.success(), "{}", said(&output));
}

#[test]
fn a_camera_that_is_lost_sends_no_pictures() {
    let served = serve(&["--rate", "50", "--fault", "lose-camera@0s"], "");
    let camera = format!("rosbridge://{}/camera/image_raw", served.address);
    served.write_motion(0.1, 1.0);
    // The table without a rod is seen, and nothing on it.
    let before = served.run(&["trace", &camera]);
    assert_eq!(before.status.code(), Some(2), "{}", said(&before));
    let output = served.run(&STREAM);
    assert!(output.status.success(), "{}", said(&output));
    let after = served.run(&["trace", &camera]);
    assert_eq!(after.status.code(), Some(1), "{}", said(&after));
    assert!(
        said(&after).contains("is the camera started"),
        "{}",
        said(&after)
    );
}

#[test]
fn an_arm_is_led_by_one_client_and_stops_when_that_dies() {
    let mut served = serve(&[], "");
    served.write_motion(0.4, 8.0);
    served.change(
        "start_tolerance_prismatic = \"2 mm\"",
        "start_tolerance_prismatic = \"1 m\"",
    );
    let mut first = served
        .command(&STREAM)
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let begin = Instant::now();
    while !served.read("log/events.csv").contains("started") {
        assert!(begin.elapsed() < Duration::from_secs(20));
        std::thread::sleep(Duration::from_millis(10));
    }
    let mut arguments = STREAM;
    arguments[5] = "second";
    let second = served.run(&arguments);
    assert_eq!(second.status.code(), Some(1), "{}", said(&second));
    assert!(
        said(&second).contains("led by another client"),
        "{}",
        said(&second)
    );
    // As kill -9 does.
    first.kill().unwrap();
    first.wait().unwrap();
    served.write_motion(0.1, 1.0);
    arguments[5] = "third";
    let third = served.run(&arguments);
    // It is led again: whether it comes from where it stands to the new path in time is another question.
    assert!(
        !said(&third).contains("led by another client"),
        "{}",
        said(&third)
    );
    assert!(served.read("third/events.csv").contains("started"));
    assert!(served.child.try_wait().unwrap().is_none(), "it serves on");
}

#[test]
fn strangers_are_refused_and_nonsense_does_no_harm() {
    const TOKEN: &str = "0123456789abcdef";
    let served = serve(&["--token", TOKEN], &format!("/{TOKEN}"));
    // Neither noise nor a client without the token comes in.
    let mut noise = TcpStream::connect(&served.address).unwrap();
    noise.write_all(&[0xff; 4096]).unwrap();
    assert!(tungstenite::connect(format!("ws://{}/wrong", served.address)).is_err());
    let (mut socket, _) = tungstenite::connect(format!("ws://{}/{TOKEN}", served.address)).unwrap();
    for message in [
        "{".to_owned(),
        json!({ "op": "subscribe", "topic": "/tf" }).to_string(),
        json!({ "op": "send_action_goal", "action": "/walk", "id": "a", "args": {} }).to_string(),
    ] {
        socket.send(Message::text(message)).unwrap();
        let answer = socket.read().unwrap();
        let answer: Value = serde_json::from_str(answer.to_text().unwrap()).unwrap();
        assert_eq!(
            (&answer["op"], &answer["level"]),
            (&json!("status"), &json!("error"))
        );
    }
    // A message that is larger than allowed ends the connection, and no other.
    let _ = socket.send(Message::text(" ".repeat(33 << 20)));
    served.write_motion(0.1, 1.0);
    let output = served.run(&STREAM);
    assert!(output.status.success(), "{}", said(&output));
}

#[test]
fn others_are_let_in_only_with_a_token() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cell.toml"), gantry()).unwrap();
    let serve = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
        command
            .args(["cell", "serve", "--cell", "cell.toml"])
            .args(arguments);
        let output = command.current_dir(folder.path()).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        said(&output)
    };
    assert!(serve(&["--listen", "0.0.0.0:0"]).contains("--token"));
    assert!(serve(&["--listen", "0.0.0.0:0", "--token", "short"]).contains("16 to 128"));
    assert!(serve(&["--fault", "sneeze@3s"]).contains("drop-link"));
    let away = gantry().replace("127.0.0.1:9090\"\naction", "192.0.2.1:9090\"\naction");
    fs::write(folder.path().join("cell.toml"), away).unwrap();
    assert!(serve(&[]).contains("others can reach 192.0.2.1:9090"));
}

#[test]
fn a_dry_run_shows_the_plan_and_moves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("rod.toml"), ROD).unwrap();
    fs::write(folder.path().join("cell.toml"), gantry()).unwrap();
    let deploy = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
        command.args([
            "deploy",
            "--rod",
            "rod.toml",
            "--cell",
            "cell.toml",
            "--yes",
        ]);
        command
            .args(arguments)
            .current_dir(folder.path())
            .output()
            .unwrap()
    };
    let output = deploy(&["--pattern", "line:0.2", "--dry-run", "--out", "shown"]);
    assert!(output.status.success(), "{}", said(&output));
    let record: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(record["status"], "planned");
    for name in [
        "plan/deployment.svg",
        "joints.csv",
        "cell.html",
        "report.md",
        "manifest.json",
    ] {
        assert!(folder.path().join("shown").join(name).is_file(), "{name}");
    }
    assert!(!folder.path().join("shown/approach").exists());
    // Nobody is there: nothing was moved, and it says so.
    let output = deploy(&[
        "--pattern",
        "line:0.2",
        "--out",
        "alone",
        "--place",
        "0,0,0",
    ]);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    let far = deploy(&["--pattern", "line:0.2", "--out", "far", "--place", "3,0,0"]);
    assert_eq!(far.status.code(), Some(3), "{}", said(&far));
}

/// A task in a folder with a file, without a cell file; its record, and the folder.
pub fn alone(name: &str, text: &str, task: &[&str]) -> (Value, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(name), text).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .args(task)
        .env("XDG_CACHE_HOME", folder.path())
        .current_dir(folder.path())
        .output()
        .unwrap();
    let words = said(&output);
    assert!(output.status.success(), "{words}");
    assert!(words.contains("no --cell: the virtual cell"), "{words}");
    (serde_json::from_slice(&output.stdout).unwrap(), folder)
}

#[test]
fn without_a_cell_file_the_rod_is_laid_in_a_cell_of_the_process() {
    let task = ["deploy", "--pattern", "line:0.15", "--rod", "rod.toml"];
    let (record, folder) = alone("rod.toml", ROD, &[&task[..], &["--out", "laid"]].concat());
    assert_eq!(record["status"], "finished");
    let mean = record["score"]["by_arc_length"]["mean_m"].as_f64().unwrap();
    assert!(mean < 2e-3, "{mean}");
    for name in ["picture.png", "score.svg", "report.md", "cell.html"] {
        assert!(folder.path().join("laid").join(name).is_file(), "{name}");
    }
    let page = fs::read_to_string(folder.path().join("laid/report.html")).unwrap();
    assert!(page.contains("src=\"data:image/png;base64,"), "{page}");
}

#[test]
fn the_rod_is_that_of_the_cell_file() {
    let folder = tempfile::tempdir().unwrap();
    let cell = gantry() + "\n[rod]\nfile = \"mine.toml\"\n";
    fs::write(folder.path().join("cell.toml"), cell).unwrap();
    let deploy = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rodlab"));
        command.args(["deploy", "--pattern", "line:0.15", "--cell", "cell.toml"]);
        command.args(["--dry-run", "--out", "shown"]);
        command.current_dir(folder.path()).output().unwrap()
    };
    let output = deploy();
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(
        said(&output).contains("there is no file"),
        "{}",
        said(&output)
    );
    fs::write(folder.path().join("mine.toml"), ROD).unwrap();
    let output = deploy();
    assert!(output.status.success(), "{}", said(&output));
    assert!(
        said(&output).contains("mine.toml of the cell"),
        "{}",
        said(&output)
    );
}

#[test]
fn an_arm_moves_only_after_a_confirmation() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("rod.toml"), ROD).unwrap();
    fs::write(folder.path().join("cell.toml"), gantry()).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_rodlab"))
        .args(["deploy", "--pattern", "line:0.2", "--rod", "rod.toml"])
        .args(["--cell", "cell.toml", "--out", "laid"])
        .stdin(Stdio::null())
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(
        said(&output).contains("--yes is needed"),
        "{}",
        said(&output)
    );
    assert!(!folder.path().join("laid").exists());
}
