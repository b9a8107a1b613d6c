//! The server of the live page: the page, its data, pictures of the results, and two commands.

use super::state::Shared;
use std::fs;
use std::io::{self, Read};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::JoinHandle;
use tiny_http::{Header, Method, Request, Response};

const PAGE: &str = include_str!("page.html");
/// Longest content of a request, bytes.
const LONGEST: u64 = 64;

/// The thread that answers requests.
pub(super) struct Server {
    server: Arc<tiny_http::Server>,
    port: u16,
    thread: Option<JoinHandle<()>>,
}

/// An answer: status, type and content.
type Answer = (u16, &'static str, Vec<u8>);

impl Server {
    /// Listens on a port of this computer; zero selects a free one.
    pub(super) fn start(port: u16, shared: Arc<Shared>) -> io::Result<Self> {
        let server = tiny_http::Server::http(("127.0.0.1", port)).map_err(io::Error::other)?;
        let server = Arc::new(server);
        let port = server.server_addr().to_ip().map_or(port, |at| at.port());
        let thread = {
            let server = Arc::clone(&server);
            std::thread::spawn(move || {
                while let Ok(request) = server.recv() {
                    respond(request, &shared, port);
                }
            })
        };
        Ok(Self {
            server,
            port,
            thread: Some(thread),
        })
    }

    pub(super) fn port(&self) -> u16 {
        self.port
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.server.unblock();
        if let Some(thread) = self.thread.take() {
            // A panic of the server was reported when it occurred.
            let _ = thread.join();
        }
    }
}

fn respond(mut request: Request, shared: &Shared, port: u16) {
    let (status, kind, content) = answer(&mut request, shared, port);
    let mut response = Response::from_data(content).with_status_code(status);
    for (name, value) in [("Content-Type", kind), ("Cache-Control", "no-store")] {
        if let Ok(header) = Header::from_bytes(name, value) {
            response.add_header(header);
        }
    }
    // A browser that has closed the connection needs no answer.
    let _ = request.respond(response);
}

fn answer(request: &mut Request, shared: &Shared, port: u16) -> Answer {
    let text = |status, words: &str| (status, "text/plain; charset=utf-8", words.into());
    // A page of another origin that reaches this server under its own name.
    let host = request.headers().iter().find(|one| one.field.equiv("Host"));
    let host = host.map_or("", |host| host.value.as_str());
    let is_own = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{port}"));
    let path = request.url().strip_prefix('/').map(str::to_owned);
    let path = path.as_deref().and_then(|path| {
        let path = path.strip_prefix(shared.token.as_str())?;
        path.strip_prefix('/')
    });
    let Some(path) = path.filter(|_| is_own.iter().any(|own| own == host)) else {
        return text(404, "not found");
    };
    match (request.method(), path.split('?').next().unwrap_or(path)) {
        (Method::Get, "") => (200, "text/html; charset=utf-8", PAGE.into()),
        (Method::Get, "scene") => (200, "application/json", shared.scene_text().into()),
        (Method::Get, "state") => (200, "application/json", shared.state_text().into()),
        (Method::Get, "picture") => match picture(shared) {
            Some(bytes) => (200, "image/png", bytes),
            None => text(404, "no picture yet"),
        },
        (Method::Post, "speed") => match speed(request) {
            Some(speed) if shared.is_adjustable() => {
                shared.speed.set(speed);
                text(200, "")
            }
            Some(_) => text(409, "the speed cannot change"),
            None => text(400, "a number from 0 to 1 is needed"),
        },
        (Method::Post, "stop") => {
            shared.is_stopped.store(true, Ordering::Relaxed);
            text(200, "")
        }
        _ => text(404, "not found"),
    }
}

fn speed(request: &mut Request) -> Option<f64> {
    let mut words = String::new();
    let read = request.as_reader().take(LONGEST).read_to_string(&mut words);
    let speed: f64 = read.ok().and_then(|_| words.trim().parse().ok())?;
    (0.0..=1.0).contains(&speed).then_some(speed)
}

fn picture(shared: &Shared) -> Option<Vec<u8>> {
    let file = shared.state().picture.as_ref()?.file.clone();
    fs::read(file).ok()
}
