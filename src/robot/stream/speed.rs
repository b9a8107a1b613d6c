//! Changes of the speed of a motion in progress, as its supervisor wants them.

use super::log::StreamLog;
use super::pace::Pace;
use super::pieces::{Division, Piece};
use super::{Ending, Part, Watched, failed};
use crate::driver::{DriverError, Interpolant};

/// Time until a change that is not possible now is tried again, s.
const RETRY: f64 = 0.1;

/// The speed of a motion in progress.
pub(super) struct Speed {
    /// The common pace of all parts.
    pub(super) pace: Pace,
    /// Division of the motion; `None` if the pace cannot change.
    division: Option<Division>,
    /// Time of the next attempt, s after the start.
    next: f64,
    /// The change that the limits do not allow at the present place, if it was logged.
    delayed: Option<f64>,
}

impl Speed {
    /// The speed `wanted` at the start. It can change if every part receives its motion in pieces.
    pub(super) fn of(parts: &[Part], division: Option<Division>, wanted: f64) -> Self {
        let division = division.filter(|_| parts.iter().all(|part| part.driver.sends_goals()));
        Self {
            pace: Pace::constant(division.map_or(1.0, |_| limited(wanted))),
            division,
            next: 0.0,
            delayed: None,
        }
    }

    /// Pace at a time since the start; `None` if it cannot change.
    pub(super) fn adjustable(&self, elapsed: f64) -> Option<f64> {
        self.division.map(|_| self.pace.rate(elapsed))
    }

    /// Begins to change the speed to the one that is `wanted`, in all parts at once. A change that
    /// would exceed a limit begins as soon as the place on the path allows it.
    ///
    /// # Errors
    /// A driver could not send the changed motion.
    pub(super) fn follow(
        &mut self,
        wanted: f64,
        parts: &mut [Part],
        watched: &mut [Watched],
        elapsed: f64,
        log: &mut StreamLog,
    ) -> Result<(), Ending> {
        let wanted = limited(wanted);
        let Some(division) = self.division else {
            return Ok(());
        };
        if wanted == self.pace.target() || elapsed < self.next {
            return Ok(());
        }
        self.next = elapsed + RETRY;
        // Parts that have arrived stay there.
        let is_moving = |watched: &&Watched| division.continues(&watched.path, &self.pace, elapsed);
        let mut moving = watched.iter().filter(is_moving);
        let Some(before) = moving.find_map(|watched| watched.piece.as_ref()) else {
            return Ok(());
        };
        let Some(pace) = division.changed(&self.pace, wanted, elapsed, before) else {
            return Ok(());
        };
        let next = |watched: &Watched| -> Option<Option<Piece>> {
            if !is_moving(&watched) {
                return Some(None);
            }
            let before = watched.piece.as_ref()?;
            let piece = division.next(before, &watched.path, &pace, elapsed)?;
            Some(Some(piece))
        };
        let Some(pieces) = watched.iter().map(next).collect::<Option<Vec<_>>>() else {
            return Ok(());
        };
        // Stops were checked before the start.
        if wanted > 0.0 {
            let mut pieces = parts.iter().zip(&pieces);
            let fault = pieces.find_map(|(part, piece)| {
                let fault = piece
                    .as_ref()?
                    .fault(&part.trajectory.joints, &part.limits)?;
                Some(format!("{}.{fault}", part.name))
            });
            if let Some(fault) = fault {
                if self.delayed.replace(wanted) != Some(wanted) {
                    log.event(&format!("the change of speed has to wait: {fault}"));
                }
                return Ok(());
            }
        }
        for ((part, watched), piece) in parts.iter_mut().zip(watched).zip(pieces) {
            let sent = piece.map_or(Ok(()), |piece| watched.send(part, piece));
            sent.map_err(|error| failed(part, &error))?;
        }
        self.pace = pace;
        self.delayed = None;
        log.event(&match wanted > 0.0 {
            true => format!("speed {:.0} % of the planned one", 100.0 * wanted),
            false => "held until the speed is greater than zero".to_owned(),
        });
        Ok(())
    }

    /// Sends the next piece of a part if it is due.
    ///
    /// # Errors
    /// It is too late for the piece, or the driver could not send it.
    pub(super) fn send_next(
        &self,
        part: &mut Part,
        watched: &mut Watched,
        elapsed: f64,
        division: Option<Division>,
    ) -> Result<(), Ending> {
        let Some((division, last)) = division.zip(watched.piece.as_ref()) else {
            return Ok(());
        };
        if !last.is_over(division, elapsed) {
            return Ok(());
        }
        let Some(next) = division.next(last, &watched.path, &self.pace, elapsed) else {
            return Err(Ending::Failed(format!(
                "{}: this program was delayed and could not send the next piece of the motion \
                 in time, so the arm stops by itself; a longer `streaming.horizon` leaves more \
                 time",
                part.name
            )));
        };
        let sent = watched.send(part, next);
        sent.map_err(|error| failed(part, &error))
    }
}

impl Watched {
    /// Sends a piece, and keeps it as the last one.
    fn send(&mut self, part: &mut Part, piece: Piece) -> Result<(), DriverError> {
        let goal: Interpolant = piece.goal();
        self.piece = Some(piece);
        part.driver.start(&goal)
    }
}

/// A speed from zero to the planned one. Anything that is not a number holds the motion.
fn limited(wanted: f64) -> f64 {
    match wanted.is_nan() {
        true => 0.0,
        false => wanted.clamp(0.0, 1.0),
    }
}
