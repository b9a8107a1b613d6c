//! The stepper's real firmware on a simulated ATmega328P, which the test installs on Debian as
//! root.

use super::{rodlab, said};
use crate::parts::{have, succeeds};
use rodlab::robot::{SerialLine, StepperLink, StepperRequest};
use std::fs;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A running board; stopped when dropped.
pub(super) struct Board {
    process: Child,
    pub port: String,
    folder: TempDir,
}

fn run(command: &mut Command) {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
}

impl Board {
    pub fn start() -> Option<Self> {
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
        // The output of the simulator must be read, since it stops if the pipe is full.
        std::thread::spawn(move || io::copy(&mut output, &mut io::sink()));
        Some(Self {
            process,
            port: port.trim().to_owned(),
            folder,
        })
    }

    fn open(&self) -> Box<dyn SerialLine> {
        let port = serialport::new(&self.port, 115_200).timeout(Duration::from_millis(1));
        Box::new(port.open().unwrap())
    }

    /// Number of rising edges of STEP, and forward minus backward steps.
    pub fn counts(&self) -> (i64, i64) {
        std::thread::sleep(Duration::from_millis(50));
        loop {
            let text = fs::read_to_string(self.folder.path().join("counts")).unwrap_or_default();
            let numbers: Vec<i64> = text
                .split_whitespace()
                .filter_map(|word| word.parse().ok())
                .collect();
            if let [edges, position] = *numbers {
                return (edges, position);
            }
        }
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
    let Some(board) = Board::start() else { return };
    let hits = Arc::default();
    let noisy = Noisy {
        line: board.open(),
        random: Random(1),
        hits: Arc::clone(&hits),
    };
    let mut random = Random(2);
    // The board shares the processor with other programs.
    let mut link = StepperLink::new(Box::new(noisy)).waiting(Duration::from_millis(50));
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
            std::thread::sleep(Duration::from_millis(5));
        }
        edges += i64::from(steps.abs());
        position += i64::from(steps);
    }
    let begin = Instant::now();
    loop {
        let answer = link.ask(StepperRequest::Status).unwrap();
        assert!(!answer.watchdog);
        if i64::from(answer.position) == position && board.counts().0 >= edges {
            break;
        }
        assert!(
            begin.elapsed() < Duration::from_secs(5),
            "{answer:?} instead of {position}"
        );
    }
    assert_eq!(board.counts(), (edges, position));
    let hits = hits.load(Ordering::Relaxed);
    assert!(hits > 200, "the line spoilt only {hits} bytes");
}

#[test]
fn silence_stops_the_motor() {
    let Some(board) = Board::start() else { return };
    let mut link = StepperLink::new(board.open());
    link.ask(StepperRequest::Hello).unwrap();
    let long = StepperRequest::Move {
        steps: 10_000,
        microseconds: 4_000_000,
    };
    link.ask(long).unwrap();
    // The simulation may be slower than real time.
    let mut edges = 0;
    loop {
        std::thread::sleep(Duration::from_millis(800));
        let now = board.counts().0;
        if now > 0 && now == edges {
            break;
        }
        edges = now;
    }
    // At 2,500 steps per second, the motor stops after about 0.3 s.
    assert!((600..1000).contains(&edges), "{edges}");
    // The motor stands still until the next hello.
    assert!(link.ask(long).unwrap().watchdog);
    assert_eq!(board.counts().0, edges);
    assert!(!link.ask(StepperRequest::Hello).unwrap().watchdog);
    let back = StepperRequest::Move {
        steps: -100,
        microseconds: 100_000,
    };
    link.ask(back).unwrap();
    let begin = Instant::now();
    while board.counts().0 != edges + 100 {
        assert!(
            begin.elapsed() < Duration::from_secs(5),
            "{:?}",
            board.counts()
        );
    }
}

#[test]
fn a_streamed_turn_rotates_the_motor_once() {
    let Some(board) = Board::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    // The simulated board may be a second late on a busy machine.
    let cell = format!(
        "[streaming]\ntracking_tolerance = 7.0\n\n[[axes]]\nname = \"twister\"\nvelocity = \"60 rpm\"\nacceleration = 20.0\n\
         driver = {{ kind = \"stepper\", port = \"{}\", steps_per_turn = 3200 }}\n",
        board.port
    );
    fs::write(folder.path().join("cell.toml"), cell).unwrap();
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
    let output = rodlab(
        folder.path(),
        &["stream", "turn.csv", "--cell", "cell.toml", "--out", "log"],
    );
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
