//! The end of a motion that is not finished: every part is commanded to stop, and watched until its joints are at rest.

use super::cycles::CYCLE;
use super::reports::Reports;
use super::timer::Timer;
use super::{Part, StreamLog};
use crate::driver::DriverError;
use std::time::{Duration, Instant};

/// Longest time for joints to come to rest.
const PATIENCE: Duration = Duration::from_secs(2);
/// Longest time without a report of joints: their state is then unknown.
const SILENCE: Duration = Duration::from_millis(500);
/// Time between stop requests, because one may be lost.
const REPEAT: Duration = Duration::from_millis(200);

/// Final state of a part.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Left {
    /// The joints of the arm were observed at rest, or it reports no joints and receives no further points.
    Still,
    /// The joints of the arm still move.
    Moving,
    /// No report has arrived since the stop request.
    Unseen,
}

/// A part that is being stopped.
struct Stopping {
    reports: Reports,
    /// Error of the last request.
    fault: Option<DriverError>,
    reconnected: bool,
    left: Option<Left>,
    heard: Instant,
}

/// Stops all parts. All requests are sent before any wait. Returns messages about the parts that
/// were not observed at rest.
pub(super) fn stop(parts: &mut [Part], timer: &dyn Timer, log: &mut StreamLog) -> Vec<String> {
    let begin = timer.now();
    let mut stopping: Vec<Stopping> = parts
        .iter()
        .map(|part| Stopping {
            reports: Reports::new(&part.kinds),
            fault: None,
            reconnected: false,
            left: None,
            heard: begin,
        })
        .collect();
    // Motors without a sensor are last, since an unanswered request takes a while.
    for is_measured in [true, false] {
        for (part, stopping) in parts.iter_mut().zip(&mut stopping) {
            if part.driver.knows_position() == is_measured {
                stopping.fault = part.driver.stop().err();
            }
        }
    }
    let mut repeated = begin;
    while stopping.iter().any(|part| part.left.is_none()) {
        let now = timer.now();
        let repeats = now.duration_since(repeated) >= REPEAT;
        if repeats {
            repeated = now;
        }
        for (part, stopping) in parts.iter_mut().zip(&mut stopping) {
            if stopping.left.is_none() {
                stopping.watch(part, repeats, timer);
                let waited = timer.now().duration_since(begin);
                stopping.judge(part, waited, timer.now());
            }
        }
        timer.sleep(CYCLE);
    }
    let all = parts.iter().zip(&stopping);
    let left = all.filter_map(|(part, stopping)| {
        let (is_still, words) = stopping.in_words(part);
        log.event(&words);
        (!is_still).then_some(words)
    });
    left.collect()
}

impl Stopping {
    /// Reads the reports of a part, and repeats the stop request when due. A lost connection is
    /// reopened once.
    fn watch(&mut self, part: &mut Part, repeats: bool, timer: &dyn Timer) {
        if let Some(DriverError::Lost(_)) = self.fault
            && !self.reconnected
        {
            self.reconnected = true;
            let connected = part.driver.connect(&part.trajectory.joints);
            self.fault = connected.and_then(|()| part.driver.stop()).err();
            self.heard = timer.now();
        } else if repeats {
            self.fault = part.driver.stop().err();
        }
        if let Ok(Some(state)) = part.driver.state()
            && self.reports.add(&state, 0.0)
        {
            self.heard = self.heard.max(state.received);
        }
    }

    fn judge(&mut self, part: &Part, waited: Duration, now: Instant) {
        let silence = now.duration_since(self.heard);
        self.left = if !part.driver.reports_state() || self.reports.have_come_to_rest(now) {
            Some(Left::Still)
        } else if silence > SILENCE {
            Some(Left::Unseen)
        } else if waited > PATIENCE {
            Some(Left::Moving)
        } else {
            None
        };
    }

    /// Whether the part is at rest permanently, and a message about it.
    fn in_words(&self, part: &Part) -> (bool, String) {
        let name = &part.name;
        let request = match &self.fault {
            None => "was commanded to hold".to_owned(),
            Some(error) => format!("could not be commanded to hold ({error})"),
        };
        match self.left.as_ref().unwrap_or(&Left::Unseen) {
            Left::Still if self.fault.is_none() && part.driver.reports_state() => {
                (true, format!("{name} holds: its joints are at rest"))
            }
            Left::Still if self.fault.is_none() => {
                (true, format!("no further points are sent to {name}"))
            }
            Left::Still => (
                false,
                format!("{name} {request}; its joints are at rest now: watch the arm"),
            ),
            Left::Moving => (
                false,
                format!("{name} {request}, and still moves: watch the arm"),
            ),
            Left::Unseen => (
                false,
                format!("{name} {request}; no report of its joints has come since: watch the arm"),
            ),
        }
    }
}
