//! The time of the cell that a client has seen.
//!
//! A client on a busy machine reads late. The server sends pings that carry the time of the cell.
//! A WebSocket client answers a ping after it has read all earlier messages, so that the last
//! answer contains a time up to which the client has read. The clock of the cell waits for it.

use std::time::{Duration, Instant};

/// Times of the cell's clock, s, that were sent to a client and returned by it.
pub struct Pace {
    sent: f64,
    answered: f64,
    /// Time since which an answer is due, if one is.
    since: Instant,
}

impl Pace {
    /// Creates the state of a client that has seen the time `now`, s.
    pub fn new(now: f64) -> Self {
        Self {
            sent: now,
            answered: now,
            since: Instant::now(),
        }
    }

    /// Payload of a ping at the time `now`, s; `None` if that time was sent before.
    pub fn ping(&mut self, now: f64) -> Option<[u8; 8]> {
        if now <= self.sent {
            return None;
        }
        if self.answered == self.sent {
            self.since = Instant::now();
        }
        self.sent = now;
        Some(now.to_le_bytes())
    }

    /// Reads an answer. Times that were never sent are ignored.
    pub fn pong(&mut self, payload: &[u8]) {
        let time = payload.try_into().map(f64::from_le_bytes);
        if let Ok(time) = time
            && time > self.answered
            && time <= self.sent
        {
            self.answered = time;
            self.since = Instant::now();
        }
    }

    /// The last time that the client has seen, s, unless an answer is late by more than `patience`.
    pub fn seen(&self, patience: Duration) -> Option<f64> {
        let is_late = self.answered < self.sent && self.since.elapsed() > patience;
        (!is_late).then_some(self.answered)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATIENCE: Duration = Duration::from_secs(1);

    #[test]
    fn the_last_answer_counts_and_unknown_times_are_ignored() {
        let mut pace = Pace::new(1.0);
        assert_eq!(pace.ping(1.0), None);
        let [first, second] = [2.0, 3.0].map(|now| pace.ping(now).unwrap());
        assert_eq!(pace.seen(PATIENCE), Some(1.0));
        pace.pong(&second);
        pace.pong(&first);
        assert_eq!(pace.seen(PATIENCE), Some(3.0));
        let [later, none] = [4.0, f64::NAN].map(f64::to_le_bytes);
        for payload in [&later[..], &none, b"", b"pong"] {
            pace.pong(payload);
            assert_eq!(pace.seen(PATIENCE), Some(3.0));
        }
    }

    #[test]
    fn a_client_that_does_not_answer_is_not_waited_for_until_it_does() {
        let mut pace = Pace::new(0.0);
        let ping = pace.ping(1.0).unwrap();
        pace.since -= 2 * PATIENCE;
        assert_eq!(pace.seen(PATIENCE), None);
        pace.ping(2.0);
        assert_eq!(pace.seen(PATIENCE), None);
        pace.pong(&ping);
        assert_eq!(pace.seen(PATIENCE), Some(1.0));
    }
}
