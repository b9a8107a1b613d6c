//! The rosbridge driver against a WebSocket server with an arm, which the test implements since
//! the real server is in no registry.

use super::{
    PROMPTLY, STREAM, assert_failed, assert_moved_without_a_stop, interrupt, log, rename_joint,
    rodlab, said, set_horizon, signal, start_stream, two_joints,
};
use serde_json::{Value, json};
use std::fs;
use std::io::ErrorKind;
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use tungstenite::{Message, WebSocket};

/// Behaviour of the server, and its observations.
#[derive(Default)]
pub(super) struct Script {
    ros: u8,
    /// Rejects every goal with the error for unknown joints.
    refuses: bool,
    /// Ignores cancellations.
    ignores_cancel: bool,
    /// Drops the connection at this time after the goal, s.
    dies_after: Option<f64>,
    /// Sends nothing more from this time after the goal, s.
    silent_after: Option<f64>,
    /// Aborts the motion, as after an emergency stop.
    stops_after: Option<f64>,
    /// Reports a cancellation, but continues.
    only_reports_cancel: bool,
    /// Reports success at this time after the goal, s, and leaves the arm where it is.
    succeeds_after: Option<f64>,
    /// Reports errors that concern no goal.
    complains: bool,
    /// Leaves the arm where it is and sends endless pings from this time after the goal, s.
    floods_after: Option<f64>,
    /// Accepts another client after the first one has disconnected.
    serves_again: bool,
    points: usize,
    feedback: usize,
    pub moved: Vec<f64>,
    cancelled_at: Option<Instant>,
    goal_at: Option<Instant>,
}

pub(super) type Shared = Arc<Mutex<Script>>;

struct Goal {
    id: Value,
    times: Vec<f64>,
    points: Vec<Vec<f64>>,
    begin: Instant,
}

/// A ROS 1 arm that executes its commands.
pub(super) fn willing() -> (String, Shared) {
    serve(Script {
        ros: 1,
        ..Script::default()
    })
}

/// Serves one client until it disconnects.
fn serve(script: Script) -> (String, Shared) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let shared = Arc::new(Mutex::new(script));
    let theirs = Arc::clone(&shared);
    std::thread::spawn(move || {
        // The arm keeps moving while no client is connected.
        let mut goal = None;
        loop {
            let (stream, _) = listener.accept().unwrap();
            let mut socket = tungstenite::accept(stream).unwrap();
            socket.get_ref().set_nonblocking(true).unwrap();
            arm(&mut socket, &theirs, &mut goal);
            if !theirs.lock().unwrap().serves_again {
                return;
            }
            theirs.lock().unwrap().dies_after = None;
        }
    });
    (address, shared)
}

fn send(socket: &mut WebSocket<TcpStream>, message: &Value) -> bool {
    socket.send(Message::text(message.to_string())).is_ok()
}

fn arm(socket: &mut WebSocket<TcpStream>, shared: &Shared, goal: &mut Option<Goal>) {
    let mut subscribed = Vec::new();
    let mut position = vec![0.0, 0.0];
    let mut is_stuck = false;
    loop {
        std::thread::sleep(Duration::from_millis(10));
        loop {
            match socket.read() {
                Ok(Message::Text(text)) => {
                    let message: Value = serde_json::from_str(&text).unwrap();
                    match message["op"].as_str().unwrap() {
                        "subscribe" => {
                            subscribed.push(message["topic"].as_str().unwrap().to_owned())
                        }
                        "advertise" => {}
                        "publish" if message["topic"] == "/arm/goal" => {
                            let goal_id = message["msg"]["goal_id"]["id"].clone();
                            *goal = take(socket, shared, goal_id, &message["msg"]["goal"]);
                        }
                        "send_action_goal" => {
                            *goal = take(socket, shared, message["id"].clone(), &message["args"]);
                        }
                        "publish" | "cancel_action_goal"
                            if shared.lock().unwrap().ignores_cancel => {}
                        "publish" | "cancel_action_goal" => {
                            // Requests are repeated until the arm is at rest.
                            shared
                                .lock()
                                .unwrap()
                                .cancelled_at
                                .get_or_insert_with(Instant::now);
                            let goes_on = shared.lock().unwrap().only_reports_cancel;
                            if let Some(ended) = goal.take() {
                                end(socket, shared, &ended.id, false, 0);
                                *goal = goes_on.then_some(ended);
                            }
                        }
                        other => panic!("{other}"),
                    }
                }
                Ok(_) => {}
                Err(tungstenite::Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => {
                    break;
                }
                Err(_) => return,
            }
        }
        let (dies, silent, stops, succeeds, floods, complains) = {
            let script = shared.lock().unwrap();
            let since = script.goal_at.map_or(0.0, |at| at.elapsed().as_secs_f64());
            let past = |limit: Option<f64>| {
                script.goal_at.is_some() && limit.is_some_and(|limit| since > limit)
            };
            (
                past(script.dies_after),
                past(script.silent_after),
                past(script.stops_after),
                past(script.succeeds_after),
                past(script.floods_after),
                script.complains,
            )
        };
        if let Some(stopped) = goal.take_if(|_| stops) {
            end(socket, shared, &stopped.id, false, -4);
        }
        if let Some(ended) = goal.take_if(|_| succeeds) {
            end(socket, shared, &ended.id, true, 0);
        }
        if complains {
            let message = json!({ "op": "status", "level": "error", "msg": "of another client" });
            send(socket, &message);
        }
        if floods {
            is_stuck = true;
            for _ in 0..1000 {
                let _ = socket.write(Message::Ping(vec![0; 100].into()));
            }
            let _ = socket.flush();
        }
        if dies {
            return;
        }
        if silent {
            continue;
        }
        if let Some(active) = &*goal
            && !is_stuck
        {
            let time = active.begin.elapsed().as_secs_f64();
            let due = active.times.partition_point(|at| *at <= time).max(1);
            position.clone_from(&active.points[due - 1]);
            let message = if shared.lock().unwrap().ros == 1 {
                json!({ "op": "publish", "topic": "/arm/feedback",
                    "msg": { "status": { "goal_id": { "id": active.id }, "status": 1 }, "feedback": {} } })
            } else {
                json!({ "op": "action_feedback", "id": active.id, "action": "/arm", "values": {} })
            };
            shared.lock().unwrap().feedback += 1;
            send(socket, &message);
            if due == active.times.len() {
                end(socket, shared, &active.id, true, 0);
                *goal = None;
            }
        }
        shared.lock().unwrap().moved.clone_from(&position);
        if subscribed.iter().any(|topic| topic == "/joint_states") {
            // The message has more joints than the cell, in another order.
            let states = json!({ "op": "publish", "topic": "/joint_states", "msg": {
                "name": ["head", "right_j1", "right_j0"],
                "position": [0.5, position[1], position[0]], "velocity": [], "effort": [] } });
            send(socket, &states);
        }
    }
}

fn take(
    socket: &mut WebSocket<TcpStream>,
    shared: &Shared,
    id: Value,
    goal: &Value,
) -> Option<Goal> {
    let refuses = {
        let mut script = shared.lock().unwrap();
        script.goal_at = Some(Instant::now());
        script.refuses
    };
    assert_eq!(
        goal["trajectory"]["joint_names"],
        json!(["right_j0", "right_j1"])
    );
    if refuses {
        end(socket, shared, &id, false, -2);
        return None;
    }
    let points = goal["trajectory"]["points"].as_array().unwrap();
    shared.lock().unwrap().points = points.len();
    let (seconds, nanoseconds) = if shared.lock().unwrap().ros == 1 {
        ("secs", "nsecs")
    } else {
        ("sec", "nanosec")
    };
    let time = |point: &Value| {
        let time = &point["time_from_start"];
        time[seconds].as_f64().unwrap() + 1e-9 * time[nanoseconds].as_f64().unwrap()
    };
    let positions = |point: &Value| -> Vec<f64> {
        point["positions"]
            .as_array()
            .unwrap()
            .iter()
            .map(|q| q.as_f64().unwrap())
            .collect()
    };
    Some(Goal {
        id,
        times: points.iter().map(time).collect(),
        points: points.iter().map(positions).collect(),
        begin: Instant::now(),
    })
}

/// Ends a goal: succeeded, cancelled, or aborted with a code.
fn end(socket: &mut WebSocket<TcpStream>, shared: &Shared, id: &Value, well: bool, code: i64) {
    let ros = shared.lock().unwrap().ros;
    let status = match (ros, well, code) {
        (1, true, _) => 3,
        (1, false, 0) => 2,
        (1, false, _) => 4,
        (_, true, _) => 4,
        (_, false, 0) => 5,
        _ => 6,
    };
    let message = if ros == 1 {
        json!({ "op": "publish", "topic": "/arm/result", "msg": {
            "status": { "goal_id": { "id": id }, "status": status, "text": "" },
            "result": { "error_code": code, "error_string": "" } } })
    } else {
        json!({ "op": "action_result", "id": id, "action": "/arm", "status": status, "result": true,
            "values": { "error_code": code, "error_string": "" } })
    };
    send(socket, &message);
}

fn folder(address: &str, ros: u8, seconds: f64) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let driver = format!(
        "kind = \"rosbridge\"\naddress = \"{address}\"\nros = {ros}\naction = \"/arm\"\njoint_states = \"/joint_states\""
    );
    two_joints(folder.path(), &driver, 500, seconds);
    folder
}

#[test]
fn five_hundred_points_are_followed_to_the_end() {
    for ros in [1, 2] {
        let (address, shared) = serve(Script {
            ros,
            ..Script::default()
        });
        let folder = folder(&address, ros, 3.0);
        let output = rodlab(folder.path(), &STREAM);
        assert!(output.status.success(), "{}", said(&output));
        let script = shared.lock().unwrap();
        assert_eq!(script.points, 500);
        assert!(script.feedback > 50);
        assert_eq!(script.moved, [1.0, -0.5]);
        // The log contains every commanded point and every report.
        assert_eq!(
            log(folder.path(), "commanded.csv").lines().count(),
            1 + 2 * 500
        );
        assert!(log(folder.path(), "state.csv").lines().count() > 100);
        let manifest: Value = serde_json::from_str(&log(folder.path(), "manifest.json")).unwrap();
        assert_eq!(manifest["status"], "finished");
    }
}

#[test]
fn the_pieces_of_a_motion_join_without_a_stop() {
    let runs = [1, 2].map(|ros| {
        std::thread::spawn(move || {
            let (address, shared) = serve(Script {
                ros,
                ..Script::default()
            });
            let folder = folder(&address, ros, 4.0);
            set_horizon(folder.path(), "2 s");
            let output = rodlab(folder.path(), &STREAM);
            assert!(output.status.success(), "{}", said(&output));
            let script = shared.lock().unwrap();
            assert!(script.points < 300, "{}", script.points);
            assert_eq!(script.moved, [1.0, -0.5]);
            assert_moved_without_a_stop(folder.path(), 4.0);
        })
    });
    runs.into_iter().for_each(|run| run.join().unwrap());
}

#[test]
fn a_stop_that_exceeds_limits_is_refused_before_anything_moves() {
    let (address, shared) = willing();
    let folder = folder(&address, 1, 1.2);
    set_horizon(folder.path(), "1 s");
    let path = folder.path().join("cell.toml");
    let cell = fs::read_to_string(&path).unwrap();
    fs::write(
        path,
        cell.replace("acceleration = 20.0", "acceleration = 4.5"),
    )
    .unwrap();
    let output = rodlab(folder.path(), &STREAM);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(
        said(&output).contains("longer `streaming.horizon`"),
        "{}",
        said(&output)
    );
    assert!(shared.lock().unwrap().goal_at.is_none());
}

#[test]
fn an_interruption_cancels_the_motion_before_its_end() {
    for ros in [1, 2] {
        let (address, shared) = serve(Script {
            ros,
            ..Script::default()
        });
        let folder = folder(&address, ros, 5.0);
        let child = start_stream(folder.path());
        while shared.lock().unwrap().feedback < 30 {
            std::thread::sleep(Duration::from_millis(5));
        }
        let begin = Instant::now();
        interrupt(&child);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{}", said(&output));
        let cancelled = shared.lock().unwrap().cancelled_at.expect("a cancellation");
        assert!(cancelled - begin < PROMPTLY);
        assert!(log(folder.path(), "events.csv").contains("right holds"));
    }
}

/// Launchers send two signals at once. The motion is cancelled, and the program ends with a
/// complete log.
#[test]
fn two_signals_at_once_cancel_the_motion() {
    for [first, second, pause_ms] in [
        ["INT", "TERM", "0"],
        ["HUP", "INT", "20"],
        ["TSTP", "QUIT", "50"],
    ] {
        let (address, shared) = willing();
        let folder = folder(&address, 1, 5.0);
        let child = start_stream(folder.path());
        wait_for_feedback(&shared);
        let begin = Instant::now();
        signal(&child, first);
        std::thread::sleep(Duration::from_millis(pause_ms.parse().unwrap()));
        signal(&child, second);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{}", said(&output));
        let cancelled = shared.lock().unwrap().cancelled_at.expect("a cancellation");
        assert!(cancelled - begin < PROMPTLY);
        assert!(log(folder.path(), "events.csv").contains("right holds"));
        let manifest: Value = serde_json::from_str(&log(folder.path(), "manifest.json")).unwrap();
        assert_eq!(manifest["interrupted_by"], format!("SIG{first}"));
    }
}

/// The server reports a cancellation, or nothing, while its arm keeps moving.
#[test]
fn an_arm_that_ignores_a_cancellation_is_reported() {
    for script in [
        Script {
            ignores_cancel: true,
            ..Script::default()
        },
        Script {
            only_reports_cancel: true,
            ..Script::default()
        },
    ] {
        let (address, shared) = serve(Script { ros: 1, ..script });
        let folder = folder(&address, 1, 6.0);
        let child = start_stream(folder.path());
        wait_for_feedback(&shared);
        interrupt(&child);
        let output = child.wait_with_output().unwrap();
        assert_failed(&output, "still moves: watch the arm");
    }
}

/// The server reports success at once or during the motion, while its arm stands still.
#[test]
fn a_reported_end_without_arrival_is_an_error() {
    for succeeds_after in [0.0, 1.5] {
        let (address, shared) = serve(Script {
            ros: 1,
            succeeds_after: Some(succeeds_after),
            ..Script::default()
        });
        let folder = folder(&address, 1, 4.0);
        let output = rodlab(folder.path(), &STREAM);
        assert_failed(&output, "its controller has reported the end of the motion");
        assert!(shared.lock().unwrap().cancelled_at.is_some());
    }
}

/// An error that the server reports to all clients does not end the motion.
#[test]
fn an_error_without_a_goal_does_not_end_the_motion() {
    let (address, shared) = serve(Script {
        ros: 1,
        complains: true,
        ..Script::default()
    });
    let folder = folder(&address, 1, 3.0);
    let output = rodlab(folder.path(), &STREAM);
    assert!(output.status.success(), "{}", said(&output));
    assert_eq!(shared.lock().unwrap().moved, [1.0, -0.5]);
}

/// Pings arrive faster than they can be read, while the arm stands still.
#[test]
fn a_flooding_server_does_not_block_the_end_of_a_motion() {
    let (address, shared) = serve(Script {
        ros: 1,
        floods_after: Some(1.5),
        ..Script::default()
    });
    let folder = folder(&address, 1, 5.0);
    let begin = Instant::now();
    let output = rodlab(folder.path(), &STREAM);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(begin.elapsed() < Duration::from_secs(15));
    assert!(shared.lock().unwrap().goal_at.is_some());
}

/// The connection is lost during the motion, and is opened again for the cancellation.
#[test]
fn a_lost_connection_is_opened_again_to_cancel() {
    let (address, shared) = serve(Script {
        ros: 1,
        dies_after: Some(0.5),
        serves_again: true,
        ..Script::default()
    });
    let folder = folder(&address, 1, 5.0);
    let output = rodlab(folder.path(), &STREAM);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(
        shared.lock().unwrap().cancelled_at.is_some(),
        "{}",
        said(&output)
    );
    assert!(
        log(folder.path(), "events.csv").contains("right holds"),
        "{}",
        log(folder.path(), "events.csv")
    );
}

fn wait_for_feedback(shared: &Shared) {
    let wait = Instant::now();
    while shared.lock().unwrap().feedback < 60 {
        assert!(wait.elapsed() < Duration::from_secs(20));
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn faults_of_the_server_end_the_stream_with_a_message_and_exit_code_1() {
    let cases: [(Script, &str); 4] = [
        (
            Script {
                refuses: true,
                ..Script::default()
            },
            "unknown joints; compare",
        ),
        (
            Script {
                dies_after: Some(0.5),
                ..Script::default()
            },
            "connection",
        ),
        (
            Script {
                silent_after: Some(0.5),
                ..Script::default()
            },
            "no report of its joints",
        ),
        (
            Script {
                stops_after: Some(0.5),
                ..Script::default()
            },
            "the arm left the path",
        ),
    ];
    for (script, expected) in cases {
        for ros in [1, 2] {
            let script = Script {
                ros,
                refuses: script.refuses,
                dies_after: script.dies_after,
                silent_after: script.silent_after,
                stops_after: script.stops_after,
                ..Script::default()
            };
            let (address, shared) = serve(script);
            let folder = folder(&address, ros, 5.0);
            let output = rodlab(folder.path(), &STREAM);
            let ended = Instant::now();
            assert_eq!(output.status.code(), Some(1), "{}", said(&output));
            assert!(said(&output).contains(expected), "{}", said(&output));
            let events = log(folder.path(), "events.csv");
            let words: f64 = events
                .lines()
                .find(|line| line.contains("right: "))
                .and_then(|line| line.split(',').next())
                .and_then(|time| time.parse().ok())
                .unwrap();
            let started: f64 = events
                .lines()
                .find(|line| line.contains("\"started\""))
                .and_then(|line| line.split(',').next())
                .and_then(|time| time.parse().ok())
                .unwrap();
            // The fault occurs half a second after the goal; the motion would take 5 s.
            assert!(words - started < 3.5, "{events}");
            assert!(ended - shared.lock().unwrap().goal_at.unwrap() < Duration::from_millis(4500));
            assert!(log(folder.path(), "manifest.json").contains("\"failed\""));
        }
    }
}

#[test]
fn a_robot_with_other_joints_is_not_moved() {
    let (address, shared) = serve(Script {
        ros: 1,
        ..Script::default()
    });
    let folder = folder(&address, 1, 3.0);
    rename_joint(folder.path());
    let output = rodlab(folder.path(), &STREAM);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        said(&output).contains("no report of all of its joints (right_j0, right_k1)"),
        "{}",
        said(&output)
    );
    assert!(shared.lock().unwrap().goal_at.is_none());
}

/// A server with a camera that sends a picture of a rod, as pixels or as a file.
fn serve_pictures(message: Value) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    std::thread::spawn(move || {
        let (stream, _) = listener.accept().unwrap();
        let mut socket = tungstenite::accept(stream).unwrap();
        let request = socket.read().unwrap();
        let request: Value = serde_json::from_str(request.to_text().unwrap()).unwrap();
        let published = json!({ "op": "publish", "topic": request["topic"], "msg": message });
        send(&mut socket, &published);
        // Read until the client disconnects.
        while socket.read().is_ok() {}
    });
    address
}

#[test]
fn a_rod_before_a_camera_behind_rosbridge_is_traced() {
    use base64::Engine;
    use base64::engine::general_purpose::STANDARD;
    let (width, height) = (320, 240);
    let picture = image::RgbImage::from_fn(width, height, |u, v| {
        let is_rod = (60..260).contains(&u) && v.abs_diff(120) < 5;
        image::Rgb(if is_rod { [200, 60, 70] } else { [12; 3] })
    });
    let file = rodlab::vision::encode_picture(&picture);
    let pixels = json!({ "height": height, "width": width, "encoding": "rgb8", "is_bigendian": 0,
        "step": 3 * width, "data": STANDARD.encode(picture.as_raw()) });
    let compressed = json!({ "format": "png", "data": STANDARD.encode(file) });
    let folder = tempfile::tempdir().unwrap();
    for (message, topic) in [
        (pixels, "camera/image_raw"),
        (compressed, "camera/compressed"),
    ] {
        let place = format!("rosbridge://{}/{topic}", serve_pictures(message));
        let output = rodlab(folder.path(), &["trace", &place, "--json"]);
        assert!(output.status.success(), "{}", said(&output));
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        let length = found["strands"][0]["length_px"].as_f64().unwrap();
        assert!((length - 200.0).abs() < 10.0, "{topic}: {found}");
    }
    let output = rodlab(folder.path(), &["trace", "rosbridge://127.0.0.1:1/camera"]);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(
        said(&output).contains("is the server started"),
        "{}",
        said(&output)
    );
}
