//! What the clients of an action server share, whichever way they reach it: the goal that is under way, how far it has
//! come, and its cancellation.

use super::{DriverError, Progress};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Longest time for the first word about a goal.
const PATIENCE: Duration = Duration::from_secs(3);
/// Longest time for the confirmation of a cancellation.
const HOLD_PATIENCE: Duration = Duration::from_millis(500);

/// A goal that was sent.
pub(super) struct Goal {
    id: String,
    sent: Instant,
    acknowledged: bool,
    outcome: Option<Result<(), DriverError>>,
}

impl Goal {
    /// A goal with a name of its own, sent now.
    pub(super) fn new() -> Self {
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        Self {
            id: format!("rodlab-{}", now.map_or(0, |now| now.as_nanos())),
            sent: Instant::now(),
            acknowledged: false,
            outcome: None,
        }
    }

    /// Its name.
    pub(super) fn id(&self) -> &str {
        &self.id
    }

    /// The server has taken it.
    pub(super) fn acknowledge(&mut self) {
        self.acknowledged = true;
    }

    /// The server has ended it.
    pub(super) fn end(&mut self, outcome: Result<(), DriverError>) {
        self.acknowledged = true;
        self.outcome = Some(outcome);
    }

    fn is_under_way(&self) -> bool {
        self.outcome.is_none()
    }
}

/// A client of an action server, which knows at most one goal.
pub(super) trait ActionClient {
    /// The last goal.
    fn goal(&self) -> Option<&Goal>;

    /// Name of the action.
    fn action(&self) -> &str;

    /// Hears what has arrived.
    ///
    /// # Errors
    /// If the connection is lost.
    fn listen(&mut self) -> Result<(), DriverError>;

    /// Asks the server to cancel a goal.
    ///
    /// # Errors
    /// If the connection is lost.
    fn cancel(&mut self, id: &str) -> Result<(), DriverError>;

    /// An error of the connection, with the address of the other end.
    fn lost(&self, reason: std::fmt::Arguments<'_>) -> DriverError;

    /// How far the goal has come.
    ///
    /// # Errors
    /// If the connection is lost, nobody takes the goal, or it did not succeed.
    fn progress(&mut self) -> Result<Progress, DriverError> {
        self.listen()?;
        let Some(goal) = self.goal() else {
            return Ok(Progress::Done);
        };
        match &goal.outcome {
            Some(Ok(())) => Ok(Progress::Done),
            Some(Err(error)) => Err(error.clone()),
            None if !goal.acknowledged && goal.sent.elapsed() > PATIENCE => {
                Err(self.lost(format_args!(
                    "nobody has taken the goal of {} within {} s; is its controller started?",
                    self.action(),
                    PATIENCE.as_secs()
                )))
            }
            None => Ok(Progress::Running),
        }
    }

    /// Cancels the goal that is under way, if there is one, and waits for the confirmation.
    ///
    /// # Errors
    /// If it does not come.
    fn cancel_and_wait(&mut self) -> Result<(), DriverError> {
        let Some(id) = self
            .goal()
            .filter(|goal| goal.is_under_way())
            .map(|goal| goal.id.clone())
        else {
            return Ok(());
        };
        self.cancel(&id)?;
        let begin = Instant::now();
        while begin.elapsed() < HOLD_PATIENCE {
            match self.listen() {
                // Without its master a server of ROS 1 still hears us.
                Ok(()) | Err(DriverError::Lost(_)) => {}
                Err(error) => return Err(error),
            }
            if !self.goal().is_some_and(Goal::is_under_way) {
                return Ok(());
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        Err(self.lost(format_args!(
            "the cancellation of the motion was not confirmed within 0.5 s: watch the arm"
        )))
    }
}
