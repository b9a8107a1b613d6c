//! What the clients of an action server share, whichever way they reach it: the goal that is under way, how far it has
//! come, and its cancellation.

use super::{DriverError, Progress};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Longest time for the first report about a goal.
const PATIENCE: Duration = Duration::from_secs(3);
/// Longest complaint of a server that is quoted, characters.
const LONGEST_COMPLAINT: usize = 300;

/// A goal that was sent.
pub(super) struct Goal {
    id: String,
    sent: Instant,
    acknowledged: bool,
    outcome: Option<Result<(), DriverError>>,
    /// Name of the goal that it replaced.
    former: Option<String>,
    /// The last error that the server reported without naming what it is about.
    complaint: Option<String>,
}

impl Goal {
    /// A goal with a name of its own, sent now.
    pub(super) fn new() -> Self {
        Self::after(None)
    }

    /// A goal with a name of its own, sent now, that replaces another.
    pub(super) fn after(former: Option<&Self>) -> Self {
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        Self {
            id: format!("rodlab-{}", now.map_or(0, |now| now.as_nanos())),
            sent: Instant::now(),
            acknowledged: false,
            outcome: None,
            former: former.map(|goal| goal.id.clone()),
            complaint: None,
        }
    }

    /// Keeps an error of the server that may or may not concern this goal.
    pub(super) fn note_complaint(&mut self, words: &str) {
        self.complaint = Some(words.chars().take(LONGEST_COMPLAINT).collect());
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

    /// Whether the server has accepted it.
    pub(super) fn is_accepted(&self) -> bool {
        self.acknowledged
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

    /// What to look at where nobody takes a goal.
    fn advice(&self) -> String {
        "is its controller started?".into()
    }

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
                let complaint = goal.complaint.as_ref();
                let quoted = complaint.map(|words| format!(" (the server reported: {words})"));
                Err(self.lost(format_args!(
                    "no answer to the goal of {} within {} s; {}{}",
                    self.action(),
                    PATIENCE.as_secs(),
                    self.advice(),
                    quoted.unwrap_or_default()
                )))
            }
            None => Ok(Progress::Running),
        }
    }

    /// Requests the cancellation of the last goal, and of that which it replaced: the last one may not have arrived yet. A goal
    /// whose end was reported is cancelled, too: the report may be wrong.
    ///
    /// # Errors
    /// The connection is lost.
    fn cancel_goal(&mut self) -> Result<(), DriverError> {
        let Some(goal) = self.goal() else {
            return Ok(());
        };
        let ids: Vec<String> = goal.former.iter().chain([&goal.id]).cloned().collect();
        ids.iter().try_for_each(|id| self.cancel(id))
    }
}
