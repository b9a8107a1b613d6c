//! The server of the virtual cell: accepted clients, control of arms, and rejected requests.

use super::{gantry, said, serve};
use serde_json::{Value, json};
use std::fs;
use std::io::Write;
use std::net::TcpStream;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tungstenite::Message;

const STREAM: [&str; 6] = [
    "stream",
    "joints.csv",
    "--cell",
    "client.toml",
    "--out",
    "log",
];

#[test]
fn a_camera_that_is_lost_sends_no_pictures() {
    let served = serve(&["--rate", "50", "--fault", "lose-camera@0s"], "");
    let camera = format!("rosbridge://{}/camera/image_raw", served.address);
    served.write_motion(0.1, 1.0);
    // The camera shows the table without a rod.
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
fn one_client_controls_an_arm_which_stops_when_that_client_dies() {
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
    // The arm can be controlled again. Whether it reaches the new path in time does not matter
    // here.
    assert!(
        !said(&third).contains("led by another client"),
        "{}",
        said(&third)
    );
    assert!(served.read("third/events.csv").contains("started"));
    assert!(served.child.try_wait().unwrap().is_none(), "it serves on");
}

#[test]
fn clients_without_a_token_and_invalid_messages_are_rejected() {
    const TOKEN: &str = "0123456789abcdef";
    let served = serve(&["--token", TOKEN], &format!("/{TOKEN}"));
    // Neither random bytes nor a client without the token is accepted.
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
    // A message beyond the size limit ends its own connection only.
    let _ = socket.send(Message::text(" ".repeat(33 << 20)));
    served.write_motion(0.1, 1.0);
    let output = served.run(&STREAM);
    assert!(output.status.success(), "{}", said(&output));
}

#[test]
fn remote_clients_need_a_token() {
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
    assert!(serve(&[]).contains("other machines can reach 192.0.2.1:9090"));
}
