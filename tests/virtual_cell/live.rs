//! The live page of a task from the view of a browser.

use super::{DEPLOY, Served, said, serve};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, ChildStderr, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for a change on the page.
const PATIENCE: Duration = Duration::from_secs(30);

/// A page that a task serves.
struct Page {
    host: String,
    path: String,
}

impl Page {
    /// The page whose address is in a line of the program.
    fn named(line: &str) -> Option<Self> {
        let (_, address) = line.rsplit_once("http://")?;
        let (host, path) = address.trim().split_once('/')?;
        Some(Self {
            host: host.into(),
            path: format!("/{path}"),
        })
    }

    /// Status and content of an answer.
    fn ask(&self, method: &str, path: &str, host: &str, content: &str) -> (u16, String) {
        let mut socket = TcpStream::connect(&self.host).unwrap();
        let length = content.len();
        write!(
            socket,
            "{method} {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\nContent-Length: {length}\r\n\r\n{content}"
        )
        .unwrap();
        let mut answer = String::new();
        socket.read_to_string(&mut answer).unwrap();
        let status = answer.split(' ').nth(1).unwrap().parse().unwrap();
        let (_, content) = answer.split_once("\r\n\r\n").unwrap();
        (status, content.to_owned())
    }

    fn get(&self, name: &str) -> (u16, String) {
        self.ask("GET", &format!("{}{name}", self.path), &self.host, "")
    }

    fn post(&self, name: &str, content: &str) -> u16 {
        let path = format!("{}{name}", self.path);
        self.ask("POST", &path, &self.host, content).0
    }

    fn state(&self) -> Value {
        let (status, text) = self.get("state");
        assert_eq!(status, 200);
        serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"))
    }

    /// Waits for a state.
    fn wait(&self, what: &str, is_there: impl Fn(&Value) -> bool) -> Value {
        let begin = Instant::now();
        loop {
            let state = self.state();
            if is_there(&state) {
                return state;
            }
            assert!(begin.elapsed() < PATIENCE, "{what}: {state}");
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

/// A task with a page; it ends with the test.
struct Task {
    child: Child,
    said: BufReader<ChildStderr>,
    page: Page,
}

impl Drop for Task {
    fn drop(&mut self) {
        // The task may already have ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Task {
    /// Starts a task, and reads the address of its page.
    fn start(served: &Served, more: &[&str]) -> Self {
        let mut command = served.command(&[&DEPLOY[..], &["--watch"], more].concat());
        // No browser.
        let command = command.env("PATH", "").stdout(Stdio::null());
        let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
        let stderr = child.stderr.take().unwrap();
        let mut task = Self {
            child,
            said: BufReader::new(stderr),
            page: Page {
                host: String::new(),
                path: String::new(),
            },
        };
        let mut line = String::new();
        let page = loop {
            line.clear();
            assert!(task.said.read_line(&mut line).unwrap() > 0);
            if let Some(page) = Page::named(&line) {
                break page;
            }
        };
        task.page = page;
        task
    }
}

#[test]
fn a_task_is_held_resumed_slowed_down_and_stopped_from_its_page() {
    let served = serve(&[], "");
    served.change("[streaming]", "[streaming]\nhorizon = \"2 s\"");
    let mut task = Task::start(&served, &["--speed-override", "0.5"]);
    let page = &task.page;
    assert!(page.get("").1.contains("Stop the task"));
    let scene: Value = serde_json::from_str(&page.get("scene").1).unwrap();
    assert_eq!(scene["title"], "Gantry with a camera");
    assert!(scene["plans"][0].as_array().unwrap().len() > 10 && scene["fixed"].is_null());

    // A page without the token, and one of another origin.
    assert_eq!(page.ask("GET", "/state", &page.host, "").0, 404);
    let stop = format!("{}stop", page.path);
    assert_eq!(page.ask("POST", &stop, "example.org", "").0, 404);
    for wrong in ["", "fast", "-0.1", "1.1", "NaN"] {
        assert_eq!(page.post("speed", wrong), 400, "{wrong}");
    }

    let time = |state: &Value| state["motion"]["time_s"].as_f64().unwrap_or(0.0);
    let speed = |state: &Value| state["motion"]["speed"].as_f64();
    let state = page.wait("it moves", |state| time(state) > 0.5);
    assert_eq!((speed(&state), &state["wanted"]), (Some(0.5), &0.5.into()));
    assert_eq!(state["step"]["words"], "going to the first point");
    assert_eq!(page.post("speed", "0"), 200);
    page.wait("it is held", |state| speed(state) == Some(0.0));
    // The arm comes to rest slightly after its setpoint.
    std::thread::sleep(Duration::from_millis(500));
    let held = page.state();
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(time(&page.state()), time(&held));
    assert_eq!(page.state()["hands"], held["hands"]);
    assert!(served.stands("/joint_states"));
    assert_eq!(page.post("speed", "0.25"), 200);
    page.wait("it moves again", |state| {
        speed(state) == Some(0.25) && time(state) > time(&held)
    });

    assert_eq!(page.post("stop", ""), 200);
    let ended = page.wait("it ends", |state| !state["ended"].is_null());
    let words = ended["ended"].as_str().unwrap();
    assert!(words.contains("interrupted; the arm holds"), "{words}");
    let mut rest = String::new();
    task.said.read_to_string(&mut rest).unwrap();
    let status = task.child.wait().unwrap();
    assert_eq!(status.code(), Some(130), "{rest}");
    assert!(served.stands_soon());
    let events = served.read("laid/approach/events.csv");
    for words in ["held until", "speed 25 % of the planned one", "interrupted"] {
        assert!(events.contains(words), "{words}: {events}");
    }
}

#[test]
fn a_speed_that_cannot_change_is_refused() {
    let served = serve(&[], "");
    let check = |speed: &str, words: &str| {
        let output = served.run(&[&DEPLOY[..], &["--speed-override", speed]].concat());
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        assert!(said(&output).contains(words), "{}", said(&output));
        assert!(!served.folder.path().join("laid").exists());
    };
    check("0.5", "`streaming.horizon`");
    check("0", "`streaming.horizon`");
    served.change("[streaming]", "[streaming]\nhorizon = \"2 s\"");
    check("0", "--watch");
}
