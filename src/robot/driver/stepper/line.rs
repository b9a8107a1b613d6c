//! Requests and answers over an unreliable line.

use super::frame::{self, Frame};
use std::io::{self, ErrorKind, Read, Write};
use std::time::{Duration, Instant};

/// Time after which a request is repeated.
const PATIENCE: Duration = Duration::from_millis(25);
/// Number of attempts; all of them together take less time than the watchdog of the motor allows.
const ATTEMPTS: u32 = 10;

const HELLO: u8 = 0x01;
const MOVE: u8 = 0x02;
const STATUS: u8 = 0x03;
const HOLD: u8 = 0x04;
const ACKNOWLEDGED: u8 = 0x81;

const TAKEN: u8 = 0;
const FULL: u8 = 1;
const REFUSED: u8 = 2;
const WATCHDOG: u8 = 3;
const OUT_OF_SEQUENCE: u8 = 4;

/// A line to a microcontroller. Reads must return within milliseconds if nothing arrives.
pub trait SerialLine: Read + Write + Send {}

impl<Line: Read + Write + Send> SerialLine for Line {}

/// A request of the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Restart: empties the queue and resets the watchdog.
    Hello,
    /// A number of steps, evenly spread over a time.
    Move {
        /// Number of steps; negative for backward motion.
        steps: i32,
        /// Duration of the move.
        microseconds: u32,
    },
    /// Request for the current position.
    Status,
    /// Stop and empty the queue.
    Hold,
}

/// Answer of the microcontroller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Acknowledgement {
    /// Steps since the motor was switched on.
    pub position: i32,
    /// Whether the queue was full and the move was rejected.
    pub full: bool,
    /// Whether the watchdog has stopped the motor.
    pub watchdog: bool,
}

/// The host's end of the line.
pub struct Link {
    line: Box<dyn SerialLine>,
    sequence: u8,
    received: Vec<u8>,
}

impl Request {
    fn encode(self, sequence: u8) -> Vec<u8> {
        match self {
            Self::Hello => frame::encode(sequence, HELLO, &[]),
            Self::Status => frame::encode(sequence, STATUS, &[]),
            Self::Hold => frame::encode(sequence, HOLD, &[]),
            Self::Move {
                steps,
                microseconds,
            } => {
                let mut data = steps.to_le_bytes().to_vec();
                data.extend(microseconds.to_le_bytes());
                frame::encode(sequence, MOVE, &data)
            }
        }
    }
}

impl Link {
    /// A link over an open line.
    pub fn new(line: Box<dyn SerialLine>) -> Self {
        Self {
            line,
            sequence: 0,
            received: Vec::new(),
        }
    }

    /// Repeats a request until an answer arrives. A repeated request keeps its number, so that it
    /// is executed once.
    ///
    /// # Errors
    /// No answer arrives to ten requests, each within 25 ms, or the request is rejected.
    pub fn ask(&mut self, request: Request) -> io::Result<Acknowledgement> {
        self.sequence = self.sequence.wrapping_add(1);
        // A leading zero ends any noise on the line.
        let mut bytes = vec![0];
        bytes.extend(request.encode(self.sequence));
        for _ in 0..ATTEMPTS {
            self.line.write_all(&bytes)?;
            self.line.flush()?;
            if let Some((status, answer)) = self.answer()? {
                return match status {
                    TAKEN | WATCHDOG | FULL => Ok(answer),
                    REFUSED => Err(io::Error::other(
                        "the motor rejected the move: too many steps in too short a time",
                    )),
                    OUT_OF_SEQUENCE => Err(io::Error::other(
                        "the motor expects another sequence number: another program uses the line, \
                         or the motor was restarted",
                    )),
                    other => Err(io::Error::other(format!("unknown kind of answer: {other}"))),
                };
            }
        }
        Err(io::Error::new(
            ErrorKind::TimedOut,
            "no answer within 0.25 s; is the firmware of scripts/firmware installed?",
        ))
    }

    /// The answer to the last request, if it arrives in time.
    fn answer(&mut self) -> io::Result<Option<(u8, Acknowledgement)>> {
        let begin = Instant::now();
        let mut buffer = [0; 64];
        while begin.elapsed() < PATIENCE {
            match self.line.read(&mut buffer) {
                Ok(0) => {
                    return Err(io::Error::new(
                        ErrorKind::UnexpectedEof,
                        "the serial line is closed",
                    ));
                }
                Ok(count) => self.received.extend(&buffer[..count]),
                Err(error)
                    if matches!(
                        error.kind(),
                        ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted
                    ) =>
                {
                    std::thread::sleep(Duration::from_micros(200));
                }
                Err(error) => return Err(error),
            }
            while let Some(end) = self.received.iter().position(|byte| *byte == 0) {
                let stuffed: Vec<u8> = self.received.drain(..=end).collect();
                let answer = frame::decode(&stuffed[..end]).and_then(|frame| self.ours(&frame));
                if answer.is_some() {
                    return Ok(answer);
                }
            }
            // The line sends endless noise.
            if self.received.len() > 4 * frame::LONGEST {
                self.received.clear();
            }
        }
        Ok(None)
    }

    /// The answer in a frame; `None` if it belongs to an earlier request.
    fn ours(&self, frame: &Frame) -> Option<(u8, Acknowledgement)> {
        let [status, _free, a, b, c, d, flags] = *frame.data.as_slice() else {
            return None;
        };
        let fits = frame.kind == ACKNOWLEDGED && frame.sequence == self.sequence;
        fits.then_some((
            status,
            Acknowledgement {
                position: i32::from_le_bytes([a, b, c, d]),
                full: status == FULL,
                watchdog: status == WATCHDOG || flags & 1 != 0,
            },
        ))
    }
}
