//! Motions over serial lines with a faulty board. Each must end with the right error, and none may
//! be reported as finished.

use super::super::PartTrajectory;
use super::frame;
use super::*;
use crate::chain::JointKind;
use crate::stream::{Ending, Part, StreamBounds, StreamLog, stream};
use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::sync::{Arc, Mutex};

/// Fault of a board.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    /// The board accepts moves, but its motor does not move.
    Stuck,
    /// The board stops answering after a while.
    Mute,
    /// The board sends bytes endlessly.
    Garbage,
    /// The board answers with the number of another frame.
    OldAnswers,
    /// The board reports a position that does not follow from the moves.
    Jump,
    /// The board accepts stop requests, but its motor continues.
    Deaf,
    /// The queue of the board is always full.
    Full,
}

struct Board {
    fault: Fault,
    /// Accepted moves: time of acceptance, steps, and duration, s.
    moves: Vec<(Instant, i32, f64)>,
    answers: VecDeque<u8>,
    received: Vec<u8>,
    frames: usize,
    holds: usize,
}

impl Board {
    /// Present position in steps.
    fn count(&self) -> i32 {
        let mut count = 0.0;
        for (begin, steps, seconds) in &self.moves {
            let part = begin.elapsed().as_secs_f64() / seconds;
            count += f64::from(*steps) * part.clamp(0.0, 1.0);
        }
        match self.fault {
            Fault::Stuck => 0,
            Fault::Jump if self.frames > 20 => count.round() as i32 + 5000,
            _ => count.round() as i32,
        }
    }

    fn take(&mut self, bytes: &[u8]) {
        self.received.extend(bytes);
        while let Some(end) = self.received.iter().position(|byte| *byte == 0) {
            let stuffed: Vec<u8> = self.received.drain(..=end).collect();
            let Some(frame) = frame::decode(&stuffed[..end]).filter(|_| end > 0) else {
                continue;
            };
            self.frames += 1;
            let mut status = 0;
            match (frame.kind, self.fault) {
                (2, Fault::Full) => status = 1,
                (2, _) => {
                    let number =
                        |at: usize| i32::from_le_bytes(frame.data[at..at + 4].try_into().unwrap());
                    let seconds = f64::from(number(4)) * 1e-6;
                    let last = self.moves.last();
                    let end =
                        last.map(|(begin, _, lasts)| *begin + Duration::from_secs_f64(*lasts));
                    let begin = end.map_or_else(Instant::now, |end| end.max(Instant::now()));
                    self.moves.push((begin, number(0), seconds));
                }
                (4, Fault::Deaf) => self.holds += 1,
                (4, _) => {
                    self.holds += 1;
                    let count = self.count();
                    let long_ago = Instant::now() - Duration::from_millis(1);
                    self.moves = vec![(long_ago, count, 1e-6)];
                }
                _ => {}
            }
            let is_late = self.frames > 15;
            let number = match self.fault {
                Fault::Mute if is_late => continue,
                Fault::OldAnswers if is_late => frame.sequence.wrapping_sub(1),
                _ => frame.sequence,
            };
            let count = self.count().to_le_bytes();
            let data = [&[status, 16][..], &count, &[0]].concat();
            self.answers.extend(frame::encode(number, 0x81, &data));
        }
    }
}

struct Line(Arc<Mutex<Board>>);

impl Read for Line {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut board = self.0.lock().unwrap();
        if board.fault == Fault::Garbage && board.frames > 15 {
            buffer.fill(7);
            return Ok(buffer.len());
        }
        let count = board.answers.len().min(buffer.len());
        if count == 0 {
            return Err(ErrorKind::WouldBlock.into());
        }
        for (place, byte) in buffer.iter_mut().zip(board.answers.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }
}

impl Write for Line {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().take(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Commands half a turn of the motor in 0.8 s, with an interruption after 0.4 s if requested.
fn turn(fault: Fault, interrupts: bool) -> (Ending, usize) {
    let board = Arc::new(Mutex::new(Board {
        fault,
        moves: Vec::new(),
        answers: VecDeque::new(),
        received: Vec::new(),
        frames: 0,
        holds: 0,
    }));
    let line = Arc::clone(&board);
    let open = move || -> io::Result<Box<dyn SerialLine>> { Ok(Box::new(Line(Arc::clone(&line)))) };
    let mut parts = [Part {
        name: "motor".into(),
        driver: Box::new(StepperDriver::over(Box::new(open), "line", 3200)),
        trajectory: PartTrajectory::smooth(&[("motor", 3.0)], 0.8, 80),
        kinds: vec![JointKind::Revolute],
        limits: Vec::new(),
    }];
    let begin = Instant::now();
    let is_interrupted = || interrupts && begin.elapsed() > Duration::from_millis(400);
    let bounds = StreamBounds::default();
    let ending = stream(&mut parts, &bounds, &is_interrupted, &mut StreamLog::none());
    let holds = board.lock().unwrap().holds;
    (ending, holds)
}

#[test]
fn a_sound_board_finishes_and_holds() {
    assert_eq!(turn(Fault::None, false).0, Ending::Finished);
    let (ending, holds) = turn(Fault::None, true);
    assert_eq!(ending, Ending::Interrupted);
    assert!(holds > 0);
}

#[test]
fn a_faulty_board_is_commanded_to_stop_and_named() {
    const UNANSWERED: &str = "no answer within 0.25 s";
    let faults = [
        (Fault::Stuck, false, "do not begin to move"),
        (Fault::Mute, false, UNANSWERED),
        (Fault::Garbage, false, UNANSWERED),
        (Fault::OldAnswers, false, UNANSWERED),
        (Fault::Jump, false, "from its trajectory"),
        (Fault::Deaf, true, "watch the arm"),
        (Fault::Full, false, "do not begin to move"),
    ];
    let tests = faults.map(|(fault, interrupts, words)| {
        std::thread::spawn(move || {
            let (ending, holds) = turn(fault, interrupts);
            match &ending {
                Ending::Failed(reason) => assert!(reason.contains(words), "{fault:?}: {reason}"),
                // The last moves may end before the wait for a silent board times out.
                Ending::Interrupted if fault == Fault::Deaf => {}
                _ => panic!("{fault:?}: {ending:?}"),
            }
            assert!(holds > 0 || ending != Ending::Interrupted, "{fault:?}");
        })
    });
    for test in tests {
        test.join().unwrap();
    }
}
