//! A headless Chromium, controlled through its DevTools protocol.

use crate::parts;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use std::fs;
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;
use tungstenite::{Message, WebSocket};

/// Longest time for the browser to start or to answer.
const PATIENCE: Duration = Duration::from_secs(180);

/// Time after which a request is sent again, since a page that was reloaded may never answer.
const LOST: Duration = Duration::from_secs(15);

/// The browser with one page.
pub struct Browser {
    process: Child,
    socket: WebSocket<TcpStream>,
    calls: u64,
    /// Console messages of the page, and uncaught errors.
    complaints: Vec<String>,
    _profile: TempDir,
}

impl Browser {
    /// Starts a browser; `None`, with a message on standard error, if there is none and none can
    /// be installed.
    pub fn start() -> Option<Self> {
        let purpose = "to look at pages of `rodlab view`";
        if !parts::have("Chromium", purpose, || installed().is_some(), install) {
            return None;
        }
        let program = installed()?;
        let profile = tempfile::tempdir().unwrap();
        let process = Command::new(program)
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-dev-shm-usage",
                "--use-gl=angle",
                "--use-angle=swiftshader",
                "--enable-unsafe-swiftshader",
                "--disable-background-networking",
                "--hide-scrollbars",
                "--window-size=1280,800",
                "--remote-debugging-port=0",
            ])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the browser starts");
        let port = port(profile.path());
        let stream = TcpStream::connect(("127.0.0.1", port)).expect("the browser listens");
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let page = page_target(port);
        let (socket, _) = tungstenite::client(page, stream).expect("the browser talks");
        let stream = socket.get_ref();
        stream.set_read_timeout(Some(LOST)).unwrap();
        let mut browser = Self {
            process,
            socket,
            calls: 0,
            complaints: Vec::new(),
            _profile: profile,
        };
        for domain in ["Page", "Runtime", "Log"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        Some(browser)
    }

    /// Runs a script in every page before the scripts of the page.
    pub fn prepare(&mut self, script: &str) {
        self.call(
            "Page.addScriptToEvaluateOnNewDocument",
            json!({ "source": script }),
        );
    }

    /// Opens a file and waits until it has drawn.
    pub fn open(&mut self, file: &Path) {
        let address = format!("file://{}", file.canonicalize().unwrap().display());
        self.call("Page.navigate", json!({ "url": address }));
        let start = Instant::now();
        while self.evaluate("document.readyState + location.protocol") != "completefile:" {
            assert!(start.elapsed() < PATIENCE, "the page does not load");
            std::thread::sleep(Duration::from_millis(20));
        }
        self.settle();
    }

    /// Waits until the page has drawn the requested state.
    pub fn settle(&mut self) {
        self.evaluate(
            "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(0))))",
        );
    }

    /// The value of an expression of JavaScript in the page.
    pub fn evaluate(&mut self, expression: &str) -> Value {
        let arguments =
            json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let answer = self.call("Runtime.evaluate", arguments);
        assert!(
            answer["exceptionDetails"].is_null(),
            "{expression}: {answer}"
        );
        answer["result"]["value"].clone()
    }

    /// Sets an input or a choice as a user does, and waits until it is drawn.
    pub fn set(&mut self, id: &str, value: &str) {
        self.evaluate(&format!(
            "{{ const one = document.getElementById('{id}'); one.value = '{value}';
               for (const kind of ['input', 'change']) one.dispatchEvent(new Event(kind, {{ bubbles: true }})); }}"
        ));
        self.settle();
    }

    /// Clicks an element, and waits until the effect is drawn.
    pub fn click(&mut self, id: &str) {
        self.evaluate(&format!("document.getElementById('{id}').click()"));
        self.settle();
    }

    /// Drags the left mouse button over the page, pixels.
    pub fn drag(&mut self, from: [f64; 2], to: [f64; 2]) {
        for (kind, [x, y], buttons) in [
            ("mousePressed", from, 1),
            ("mouseMoved", to, 1),
            ("mouseReleased", to, 0),
        ] {
            self.call(
                "Input.dispatchMouseEvent",
                json!({ "type": kind, "x": x, "y": y, "button": "left", "buttons": buttons, "clickCount": 1 }),
            );
        }
        self.settle();
    }

    /// Sets the size of the window, pixels.
    pub fn resize(&mut self, width: u32, height: u32) {
        let size =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", size);
        self.settle();
    }

    /// Presses a key.
    pub fn press(&mut self, key: &str) {
        for kind in ["keyDown", "keyUp"] {
            self.call(
                "Input.dispatchKeyEvent",
                json!({ "type": kind, "key": key }),
            );
        }
        self.settle();
    }

    /// A picture of the page, as PNG.
    pub fn screenshot(&mut self) -> Vec<u8> {
        let answer = self.call("Page.captureScreenshot", json!({ "format": "png" }));
        let data = answer["data"].as_str().expect("a picture");
        STANDARD.decode(data).expect("base64")
    }

    /// Errors and warnings of the page so far.
    pub fn complaints(&self) -> &[String] {
        &self.complaints
    }

    /// Calls a method of the protocol and returns its result; records errors and warnings of the
    /// page meanwhile. If the page reloads during the call, it reports this or never answers, and
    /// the request is repeated. A late answer to an earlier request counts, too.
    fn call(&mut self, method: &str, parameters: Value) -> Value {
        let start = Instant::now();
        let first = self.calls + 1;
        loop {
            assert!(start.elapsed() < PATIENCE, "{method}: no answer in time");
            self.ask(method, &parameters);
            let Some(mut answer) = self.answer(first) else {
                continue;
            };
            let error = answer["error"]["message"].as_str().unwrap_or_default();
            if error.contains("navigated") {
                continue;
            }
            assert!(answer["error"].is_null(), "{method}: {answer}");
            return answer["result"].take();
        }
    }

    fn ask(&mut self, method: &str, parameters: &Value) {
        self.calls += 1;
        let message = json!({ "id": self.calls, "method": method, "params": parameters });
        self.socket
            .send(Message::text(message.to_string()))
            .expect("the browser listens");
    }

    /// The next answer to the request `first` or to a later one; `None` if none arrives for long.
    fn answer(&mut self, first: u64) -> Option<Value> {
        let start = Instant::now();
        while start.elapsed() < LOST {
            let text = match self.socket.read() {
                Ok(Message::Text(text)) => text,
                Ok(_) => continue,
                Err(tungstenite::Error::Io(error)) if is_timeout(&error) => continue,
                Err(error) => panic!("the browser talks: {error}"),
            };
            let answer: Value = serde_json::from_str(&text).expect("JSON");
            if answer["id"].as_u64().is_some_and(|id| id >= first) {
                return Some(answer);
            }
            self.note(&answer);
        }
        None
    }

    fn note(&mut self, event: &Value) {
        let parameters = &event["params"];
        let complains =
            match event["method"].as_str() {
                Some("Runtime.exceptionThrown") => true,
                Some("Runtime.consoleAPICalled") => ["error", "warning", "assert"]
                    .contains(&parameters["type"].as_str().unwrap_or("")),
                Some("Log.entryAdded") => ["error", "warning"]
                    .contains(&parameters["entry"]["level"].as_str().unwrap_or("")),
                _ => false,
            };
        if complains {
            self.complaints.push(parameters.to_string());
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn is_timeout(error: &std::io::Error) -> bool {
    use std::io::ErrorKind::{TimedOut, WouldBlock};
    matches!(error.kind(), TimedOut | WouldBlock)
}

fn installed() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome"];
    std::env::split_paths(&path)
        .flat_map(|folder| names.map(|name| folder.join(name)))
        .find(|program| program.is_file())
}

fn install() -> bool {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/install-chromium");
    Command::new(script).status().is_ok_and(|end| end.success())
}

/// The port on which the browser listens, which it writes into its profile.
fn port(profile: &Path) -> u16 {
    let start = Instant::now();
    loop {
        let text = fs::read_to_string(profile.join("DevToolsActivePort")).unwrap_or_default();
        if let Some(port) = text.lines().next().and_then(|line| line.parse().ok()) {
            return port;
        }
        assert!(start.elapsed() < PATIENCE, "the browser does not start");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// The address for the connection to the page, from the list of targets of the browser.
fn page_target(port: u16) -> String {
    use std::io::{Read, Write};
    let start = Instant::now();
    loop {
        let mut stream = TcpStream::connect(("127.0.0.1", port)).expect("the browser listens");
        stream
            .set_read_timeout(Some(Duration::from_secs(2)))
            .unwrap();
        let request = format!(
            "GET /json/list HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n"
        );
        stream.write_all(request.as_bytes()).unwrap();
        let mut bytes = Vec::new();
        // The browser may keep the connection open, so that only the bytes until the timeout are
        // read.
        let _ = stream.read_to_end(&mut bytes);
        let text = String::from_utf8_lossy(&bytes);
        let key = "\"webSocketDebuggerUrl\": \"";
        let pages = text
            .split('{')
            .filter(|target| target.contains("\"type\": \"page\""));
        let addresses = pages.filter_map(|target| target.split(key).nth(1)?.split('"').next());
        if let Some(address) = addresses.map(str::to_owned).next() {
            return address;
        }
        assert!(start.elapsed() < PATIENCE, "the browser has no page");
        std::thread::sleep(Duration::from_millis(50));
    }
}
