//! Hostile clients: for any message, the server keeps running, serves other clients, and sends
//! short answers.

use super::VirtualCell;
use crate::test_cells::{gantry, settings};
use serde_json::{Value, json};
use std::io::Write;
use std::net::{SocketAddr, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

type Client = WebSocket<MaybeTlsStream<TcpStream>>;

/// Longest wait for an answer: the machine may be busy.
const PATIENCE: Duration = Duration::from_secs(20);
const ACTION: &str = "/gantry/follow_joint_trajectory";

/// Runs an attack against a gantry; checks that a well-behaved client is served afterwards, and
/// that the server has not failed.
fn attacked(attack: impl FnOnce(SocketAddr)) {
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let (sender, address) = channel();
        let is_over = &is_over;
        let server = scope.spawn(move || {
            let mut cell = VirtualCell::new(&gantry(), settings()).unwrap();
            sender.send(cell.address().unwrap()).unwrap();
            cell.serve(&|| is_over.load(Ordering::Relaxed)).unwrap();
        });
        let address = address.recv().unwrap();
        // The server must end even if the attack panics.
        let attacked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            attack(address);
            is_served(address);
        }));
        is_over.store(true, Ordering::Relaxed);
        server.join().expect("the server has not panicked");
        attacked.unwrap();
    });
}

fn connect(address: SocketAddr) -> Client {
    let stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    let stream = MaybeTlsStream::Plain(stream);
    let (client, _) = tungstenite::client(format!("ws://{address}"), stream).expect("a handshake");
    client
}

fn send(client: &mut Client, message: &Value) {
    client.send(Message::text(message.to_string())).unwrap();
}

fn subscribe(client: &mut Client, topic: &str) {
    send(client, &json!({ "op": "subscribe", "topic": topic }));
}

/// The text of the next complaint.
fn refused(client: &mut Client) -> String {
    let message = wait_for(client, complaint);
    message["msg"].as_str().unwrap().to_owned()
}

/// The next message for which `what` returns a value.
fn wait_for(client: &mut Client, what: impl Fn(&Value) -> bool) -> Value {
    let begin = Instant::now();
    while begin.elapsed() < PATIENCE {
        if let Message::Text(text) = client.read().unwrap() {
            assert!(text.len() < 100_000, "an answer of {} bytes", text.len());
            let message = serde_json::from_str(&text).unwrap();
            if what(&message) {
                return message;
            }
        }
    }
    panic!("no answer");
}

/// Checks that a new client receives the clock.
fn is_served(address: SocketAddr) {
    let mut client = connect(address);
    subscribe(&mut client, "/clock");
    wait_for(&mut client, |message| message["topic"] == "/clock");
}

fn complaint(message: &Value) -> bool {
    message["op"] == "status" && message["level"] == "error"
}

fn goal(id: &str, times: &[f64], x: &[f64]) -> Value {
    let points = times.iter().zip(x).map(|(time, x)| {
        json!({ "positions": [x, 0, 0.5, 0, 0, 0], "time_from_start": { "secs": time, "nsecs": 0 } })
    });
    let names = ["x", "y", "z", "yaw", "roll", "pitch"];
    let trajectory = json!({ "joint_names": names, "points": points.collect::<Vec<_>>() });
    json!({ "op": "publish", "topic": format!("{ACTION}/goal"),
        "msg": { "goal_id": { "id": id }, "goal": { "trajectory": trajectory } } })
}

fn result_of(id: &str) -> impl Fn(&Value) -> bool {
    move |message| {
        message["topic"] == format!("{ACTION}/result")
            && message["msg"]["status"]["goal_id"]["id"] == id
    }
}

#[test]
fn unused_connections_do_not_block_other_clients() {
    attacked(|address| {
        // Incomplete handshakes and random bytes.
        let starts: [&[u8]; 2] = [b"GET / HTTP/1.1\r\nHost: x", &[0xff; 64]];
        let half = |start: &&[u8]| {
            let mut stream = TcpStream::connect(address).unwrap();
            let _ = stream.write_all(start);
            stream
        };
        let halves: Vec<TcpStream> = starts.repeat(20).iter().map(half).collect();
        is_served(address);
        drop(halves);
        // Silent clients.
        let silent: Vec<Client> = (0..16).map(|_| connect(address)).collect();
        is_served(address);
        drop(silent);
        (0..100).for_each(|_| drop(TcpStream::connect(address)));
    });
}

#[test]
fn floods_and_invalid_messages_do_not_block_other_clients() {
    attacked(|address| {
        let is_over = AtomicBool::new(false);
        std::thread::scope(|scope| {
            for kind in [0, 1, 2] {
                let is_over = &is_over;
                scope.spawn(move || {
                    let mut client = connect(address);
                    while !is_over.load(Ordering::Relaxed) {
                        let message = match kind {
                            0 => Message::Ping(vec![0; 100].into()),
                            1 => Message::Binary(vec![0; 1000].into()),
                            _ => Message::text("{"),
                        };
                        // A client that does not read its answers is disconnected.
                        if client.send(message).is_err() {
                            break;
                        }
                    }
                });
            }
            std::thread::sleep(Duration::from_millis(300));
            is_served(address);
            is_over.store(true, Ordering::Relaxed);
        });
        let mut client = connect(address);
        for text in [
            "[".repeat(100_000),
            format!("[{}0]", "0,".repeat(2_100_000)),
            json!({ "op": "x".repeat(1 << 20) }).to_string(),
            json!({ "op": "subscribe", "topic": ["/clock"] }).to_string(),
            json!({ "op": "subscribe", "topic": "/clock", "throttle_rate": "often" }).to_string(),
            json!({ "op": "publish", "topic": format!("{ACTION}/goal"), "msg": 7 }).to_string(),
        ] {
            client.send(Message::text(text)).unwrap();
            let answer = wait_for(&mut client, complaint);
            assert!(answer.to_string().len() < 2000);
        }
        // A frame that announces a terabyte ends only its own connection.
        let mut stream = TcpStream::connect(address).unwrap();
        let handshake = format!(
            "GET / HTTP/1.1\r\nHost: {address}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
             Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
        );
        stream.write_all(handshake.as_bytes()).unwrap();
        std::thread::sleep(Duration::from_millis(100));
        stream
            .write_all(&[0x81, 0xff, 0, 0, 1, 0, 0, 0, 0, 0, 1, 2, 3, 4])
            .unwrap();
    });
}

#[test]
fn goals_and_subscriptions_without_end_are_answered_and_bounded() {
    attacked(|address| {
        let mut client = connect(address);
        for (id, times, x) in [
            ("backwards", &[0.0, 2.0, 1.0][..], &[0.0, 0.01, 0.02][..]),
            ("negative", &[-1.0, 1.0], &[0.0, 0.01]),
            ("empty", &[], &[]),
            ("far", &[0.0, 1.0], &[0.0, 1e300]),
            ("fast", &[0.0, 1e-300], &[0.0, 0.1]),
        ] {
            send(&mut client, &goal(id, times, x));
            let result = wait_for(&mut client, result_of(id));
            assert_eq!(result["msg"]["status"]["status"], 4, "{id}: {result}");
        }
        let infinite = goal("infinite", &[0.0, 1.0], &[0.0, 0.125]).to_string();
        client
            .send(Message::text(infinite.replace("0.125", "1e999")))
            .unwrap();
        wait_for(&mut client, complaint);
        let cancel =
            json!({ "op": "publish", "topic": format!("{ACTION}/cancel"), "msg": { "id": "" } });
        for k in 0..1000 {
            let goal = goal(&format!("goal {k}"), &[0.0, 60.0], &[0.0, 0.1]);
            send(&mut client, &goal);
            (0..3).for_each(|_| send(&mut client, &cancel));
        }
        wait_for(&mut client, result_of("goal 999"));
        let status = format!("{ACTION}/status");
        subscribe(&mut client, &status);
        let listed = wait_for(&mut client, |message| message["topic"] == status);
        let listed = listed["msg"]["status_list"].as_array().unwrap();
        assert_eq!(listed.len(), 20);
        for k in 0..100 {
            let more = json!({ "op": "subscribe", "topic": "/clock", "id": format!("s{k}"),
                "throttle_rate": 3_600_000, "queue_length": u64::MAX });
            send(&mut client, &more);
        }
        let words = refused(&mut client);
        assert!(words.contains("at most 64"), "{words}");
        // A client that never reads.
        subscribe(&mut client, "/camera/image_raw");
        is_served(address);
    });
}

#[test]
fn a_gripper_is_not_opened_by_another_client_while_its_arm_moves() {
    attacked(|address| {
        let (mut leader, mut other) = (connect(address), connect(address));
        send(&mut leader, &goal("led", &[0.0, 60.0], &[0.0, 0.1]));
        let feedback = format!("{ACTION}/feedback");
        wait_for(&mut leader, |message| message["topic"] == feedback);
        let open = json!({ "op": "publish", "topic": "/gantry/gripper/goal",
            "msg": { "goal_id": { "id": "open" }, "goal": { "command": { "position": 0.04 } } } });
        send(&mut other, &open);
        let words = refused(&mut other);
        assert!(words.contains("led by another"), "{words}");
    });
}
