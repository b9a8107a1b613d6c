//! The virtual cell from the view of its clients: the real server in its own process, and the
//! commands that move a real arm.

mod deploy;
mod ends;
mod identify;
mod live;
mod place;
mod server;

use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead, BufReader};
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
        // The server may already have ended.
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

/// Serves a cell from its file with some arguments. `client.toml` in its folder is the cell file
/// for its clients, with the path of the server if there is one.
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
        // On a busy machine the server may be silent for longer than an arm.
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
        if ["deploy", "place", "tie", "fold", "identify"].contains(&arguments[0]) {
            command.arg("--yes");
        }
        // Use a separate folder for the marks of tasks that did not finish.
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

    /// Waits until a task has started to move the arm.
    fn wait_for_motion(&self) {
        let begin = Instant::now();
        while !self.read("laid/approach/events.csv").contains("started") {
            assert!(begin.elapsed() < Duration::from_secs(20));
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Whether the arm is at rest half a second from now.
    pub fn stands_soon(&self) -> bool {
        std::thread::sleep(Duration::from_millis(500));
        self.stands("/joint_states")
    }

    /// Whether the arm whose joints are published on a topic is at rest.
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

    /// Checks that the next task, with results in `again`, is rejected until the user confirms
    /// that the cell was inspected.
    pub fn asks_for_a_look_before(&self, task: &[&str]) {
        let refused = self.run(task);
        assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
        assert!(said(&refused).contains("--checked"), "{}", said(&refused));
        assert!(!self.folder.path().join("again").exists());
    }

    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.folder.path().join(name)).unwrap_or_default()
    }

    /// Writes a table in which the gantry moves along x by a distance within a time, from rest to
    /// rest.
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

/// Arguments to lay the rod again, with results in another directory.
fn again() -> [&'static str; 9] {
    let mut again = DEPLOY;
    again[DEPLOY.len() - 1] = "again";
    again
}

/// Runs a task in a folder with a file, without a cell file; returns its record and the folder.
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
