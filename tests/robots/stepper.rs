//! The stepper's real firmware on a simulated ATmega328P, which the test installs on Debian as
//! root.

use super::{rodlab, said};
use crate::parts::{have, succeeds};
use rodlab::robot::{SerialLine, StepperLink, StepperRequest};
use std::fs;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Output, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tempfile::TempDir;

/// Delay of a real-time board by which the machine is too busy for the host's limit of 0.25 s.
const TOO_LATE: f64 = 0.1;
/// Attempts at a motion in real time.
const ATTEMPTS: usize = 5;

/// A running board; stopped when dropped.
pub(super) struct Board {
    process: Child,
    pub port: String,
    folder: TempDir,
    /// Of a board that runs only on request.
    clock: Option<Arc<Mutex<Clock>>>,
}

/// The time of a board, which passes only on request, so that a busy machine changes nothing.
struct Clock {
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Clock {
    fn pass(&mut self, milliseconds: usize) {
        let mut line = String::new();
        for _ in 0..milliseconds {
            self.input.write_all(b".").unwrap();
            while line.trim() != "ms" {
                line.clear();
                assert!(
                    self.output.read_line(&mut line).unwrap() > 0,
                    "the board has ended"
                );
            }
            line.clear();
        }
    }
}

/// A serial line on which each read lets a millisecond of the board pass.
struct Stepped {
    line: Box<dyn SerialLine>,
    clock: Arc<Mutex<Clock>>,
}

impl Read for Stepped {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.clock.lock().unwrap().pass(1);
        self.line.read(buffer)
    }
}

impl Write for Stepped {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.line.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.line.flush()
    }
}

fn run(command: &mut Command) {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
}

impl Board {
    /// A board in real time; `None` if simavr is missing.
    fn in_real_time() -> Option<Self> {
        Self::start(&[])
    }

    /// A board whose time passes only on request.
    fn stepped() -> Option<Self> {
        Self::start(&["stepped"])
    }

    /// The output of a motion on a board in real time, and the board. Repeated if the motion fails
    /// while the machine is too busy to simulate the board in real time.
    pub fn moved(motion: impl Fn(&Self) -> Output) -> Option<(Self, Output)> {
        let mut attempt = 0;
        loop {
            attempt += 1;
            let board = Self::in_real_time()?;
            let output = motion(&board);
            let late = 1e-3 * board.numbers()[2] as f64;
            if output.status.success() || late < TOO_LATE || attempt == ATTEMPTS {
                return Some((board, output));
            }
            println!("repeated: the machine delayed the board by {late:.2} s");
        }
    }

    fn start(mode: &[&str]) -> Option<Self> {
        let is_there = || {
            let compiles = |compiler: &str| succeeds(Command::new(compiler).arg("--version"));
            Path::new("/usr/include/simavr").exists() && compiles("avr-gcc") && compiles("cc")
        };
        let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
        let install = || succeeds(&mut Command::new(root.join("scripts/install-simavr")));
        let purpose = "to run the firmware of the stepper on a simulated board";
        if !have("simavr", purpose, is_there, install) {
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        run(Command::new("avr-gcc")
            .args([
                "-mmcu=atmega328p",
                "-DF_CPU=16000000UL",
                "-Os",
                "-Wall",
                "-Wextra",
                "-Werror",
                "-o",
            ])
            .arg(at("stepper.elf"))
            .arg(root.join("scripts/firmware/stepper.c")));
        run(Command::new("cc")
            .args(["-O2", "-o"])
            .arg(at("board"))
            .arg(root.join("tests/robots/simulated_board.c"))
            .args(["-lsimavr", "-lelf", "-lutil"]));
        let mut process = Command::new(at("board"))
            .args([at("stepper.elf"), at("counts")])
            .args(mode)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut output = BufReader::new(process.stdout.take().unwrap());
        let mut port = String::new();
        while !port.starts_with("/dev/") {
            port.clear();
            assert!(
                output.read_line(&mut port).unwrap() > 0,
                "the board does not start"
            );
        }
        let clock = if mode.is_empty() {
            // The output of the simulator must be read, since it stops if the pipe is full.
            std::thread::spawn(move || io::copy(&mut output, &mut io::sink()));
            None
        } else {
            let input = process.stdin.take().unwrap();
            Some(Arc::new(Mutex::new(Clock { input, output })))
        };
        Some(Self {
            process,
            port: port.trim().to_owned(),
            folder,
            clock,
        })
    }

    fn clock(&self) -> &Arc<Mutex<Clock>> {
        self.clock.as_ref().expect("a stepped board")
    }

    fn open(&self) -> Box<dyn SerialLine> {
        let port = serialport::new(&self.port, 115_200).timeout(Duration::from_millis(1));
        Box::new(Stepped {
            line: Box::new(port.open().unwrap()),
            clock: Arc::clone(self.clock()),
        })
    }

    /// Lets time of a stepped board pass.
    fn pass(&self, milliseconds: usize) {
        self.clock().lock().unwrap().pass(milliseconds);
    }

    /// Number of rising edges of STEP, forward minus backward steps, and the largest delay behind
    /// the wall clock, ms.
    fn numbers(&self) -> [i64; 3] {
        if self.clock.is_none() {
            std::thread::sleep(Duration::from_millis(50));
        }
        let text = fs::read_to_string(self.folder.path().join("counts")).unwrap();
        let numbers: Vec<i64> = text
            .split_whitespace()
            .map(|word| word.parse().unwrap())
            .collect();
        numbers.try_into().unwrap()
    }

    /// Number of rising edges of STEP, and forward minus backward steps.
    pub fn counts(&self) -> (i64, i64) {
        let [edges, position, _] = self.numbers();
        (edges, position)
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
}

/// A line that corrupts, loses and repeats one byte in a hundred in each direction.
struct Noisy {
    line: Box<dyn SerialLine>,
    random: Random,
    hits: Arc<AtomicU64>,
}

impl Noisy {
    fn spoil(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut spoilt = Vec::new();
        for byte in bytes {
            let (what, bits) = (self.random.next() % 300, self.random.next() as u8);
            if what < 3 {
                self.hits.fetch_add(1, Ordering::Relaxed);
            }
            match what {
                0 => spoilt.push(byte ^ bits.max(1)),
                1 => {}
                2 => spoilt.extend([*byte, *byte]),
                _ => spoilt.push(*byte),
            }
        }
        spoilt
    }
}

impl Read for Noisy {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut raw = vec![0; buffer.len() / 2];
        let count = self.line.read(&mut raw)?;
        let spoilt = self.spoil(&raw[..count]);
        if spoilt.is_empty() {
            return Err(io::ErrorKind::WouldBlock.into());
        }
        buffer[..spoilt.len()].copy_from_slice(&spoilt);
        Ok(spoilt.len())
    }
}

impl Write for Noisy {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let spoilt = self.spoil(bytes);
        self.line.write_all(&spoilt)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.line.flush()
    }
}

#[test]
fn a_thousand_moves_over_a_noisy_line_are_counted_to_the_step() {
    let Some(board) = Board::stepped() else {
        return;
    };
    let hits = Arc::default();
    let noisy = Noisy {
        line: board.open(),
        random: Random(1),
        hits: Arc::clone(&hits),
    };
    let mut random = Random(2);
    let mut link = StepperLink::new(Box::new(noisy));
    link.ask(StepperRequest::Hello).unwrap();
    let (mut edges, mut position) = (0_i64, 0_i64);
    for _ in 0..1000 {
        let steps = (random.next() % 101) as i32 - 50;
        let microseconds = 10_000 + (random.next() % 5_000) as u32;
        while link
            .ask(StepperRequest::Move {
                steps,
                microseconds,
            })
            .unwrap()
            .full
        {
            board.pass(5);
        }
        edges += i64::from(steps.abs());
        position += i64::from(steps);
    }
    // The queue holds less than a second.
    for _ in 0..40 {
        let answer = link.ask(StepperRequest::Status).unwrap();
        assert!(!answer.watchdog);
        if i64::from(answer.position) == position {
            break;
        }
        board.pass(25);
    }
    board.pass(25);
    assert_eq!(board.counts(), (edges, position));
    let hits = hits.load(Ordering::Relaxed);
    assert!(hits > 200, "the line spoilt only {hits} bytes");
}

#[test]
fn silence_stops_the_motor() {
    let Some(board) = Board::stepped() else {
        return;
    };
    let mut link = StepperLink::new(board.open());
    link.ask(StepperRequest::Hello).unwrap();
    let long = StepperRequest::Move {
        steps: 10_000,
        microseconds: 4_000_000,
    };
    link.ask(long).unwrap();
    board.pass(400);
    // At 2,500 steps per second, the motor stops after 0.3 s.
    let (edges, _) = board.counts();
    assert!((700..800).contains(&edges), "{edges}");
    board.pass(200);
    assert_eq!(board.counts().0, edges);
    // The motor stands still until the next hello.
    assert!(link.ask(long).unwrap().watchdog);
    board.pass(100);
    assert_eq!(board.counts().0, edges);
    assert!(!link.ask(StepperRequest::Hello).unwrap().watchdog);
    let back = StepperRequest::Move {
        steps: -100,
        microseconds: 100_000,
    };
    link.ask(back).unwrap();
    board.pass(120);
    assert_eq!(board.counts(), (edges + 100, edges - 100));
}

#[test]
fn a_streamed_turn_rotates_the_motor_once() {
    let folder = tempfile::tempdir().unwrap();
    // The simulated board may be a second late on a busy machine.
    let cell = |port: &str| {
        format!(
            "[streaming]\ntracking_tolerance = 7.0\n\n[[axes]]\nname = \"twister\"\nvelocity = \"60 rpm\"\nacceleration = 20.0\n\
         driver = {{ kind = \"stepper\", port = \"{port}\", steps_per_turn = 3200 }}\n",
        )
    };
    let mut table = "time_s,twister_rad\n".to_owned();
    for k in 0..=200 {
        let part = f64::from(k) / 200.0;
        let rise = part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part);
        table.push_str(&format!(
            "{},{}\n",
            0.01 * f64::from(k),
            std::f64::consts::TAU * rise
        ));
    }
    fs::write(folder.path().join("turn.csv"), table).unwrap();
    let stream = ["stream", "turn.csv", "--cell", "cell.toml", "--out", "log"];
    let moved = Board::moved(|board| {
        fs::write(folder.path().join("cell.toml"), cell(&board.port)).unwrap();
        let _ = fs::remove_dir_all(folder.path().join("log"));
        rodlab(folder.path(), &stream)
    });
    let Some((board, output)) = moved else { return };
    assert!(output.status.success(), "{}", said(&output));
    assert_eq!(board.counts(), (3200, 3200));
    let events = fs::read_to_string(folder.path().join("log/events.csv")).unwrap();
    assert!(
        events.contains("started") && events.contains("finished"),
        "{events}"
    );
    let state = fs::read_to_string(folder.path().join("log/state.csv")).unwrap();
    assert!(state.lines().count() > 50, "{state}");
}
