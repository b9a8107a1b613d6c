//! A driver that sends motions as goals of an action over any connection: the current goal, its
//! progress and its cancellation.

use super::clocked_reports::ClockedReports;
use super::{Driver, DriverError, Interpolant, JointState, Progress};
use crate::unix_time::unix_time;
use std::fmt::Display;
use std::time::{Duration, Instant};

/// Longest time for the first report about a goal.
const PATIENCE: Duration = Duration::from_secs(3);
/// Longest server message that is quoted, characters.
const LONGEST_COMPLAINT: usize = 300;

/// A unique name, for servers that identify goals by text.
pub(super) fn unique_name() -> String {
    format!("rodlab-{}", unix_time().as_nanos())
}

/// A goal that was sent.
pub struct Goal<Id> {
    id: Id,
    sent: Instant,
    acknowledged: bool,
    outcome: Option<Result<(), DriverError>>,
    /// Name of the replaced goal.
    former: Option<Id>,
    /// The last error that the server reported without a goal.
    complaint: Option<String>,
}

impl<Id: Clone> Goal<Id> {
    /// A goal with an identifier, sent now, that replaces an earlier goal.
    pub(super) fn after(former: Option<&Self>, id: Id) -> Self {
        Self {
            id,
            sent: Instant::now(),
            acknowledged: false,
            outcome: None,
            former: former.map(|goal| goal.id.clone()),
            complaint: None,
        }
    }

    /// Id of the goal.
    pub(super) fn id(&self) -> &Id {
        &self.id
    }

    /// Keeps an error of the server that may or may not concern this goal.
    pub(super) fn note_complaint(&mut self, words: &str) {
        self.complaint = Some(words.chars().take(LONGEST_COMPLAINT).collect());
    }

    /// Records that the server has accepted the goal.
    pub(super) fn acknowledge(&mut self) {
        self.acknowledged = true;
    }

    /// Records that the server has ended the goal.
    pub(super) fn end(&mut self, outcome: Result<(), DriverError>) {
        self.acknowledged = true;
        self.outcome = Some(outcome);
    }
}

/// Reports received from a robot and about the last goal.
pub struct News<Id> {
    /// The joints of the motion.
    pub(super) joints: Vec<String>,
    reports: ClockedReports,
    setpoint: Option<JointState>,
    /// The last goal.
    pub(super) goal: Option<Goal<Id>>,
}

impl<Id> News<Id> {
    /// No reports yet from the given joints.
    pub(super) fn of(joints: Vec<String>) -> Self {
        Self {
            joints,
            reports: ClockedReports::default(),
            setpoint: None,
            goal: None,
        }
    }

    /// Stores a report of joints, valid at `stamp`, s, on the robot's clock if the message has one.
    pub(super) fn add_state<Name: PartialEq<str>>(
        &mut self,
        names: &[Name],
        position: impl Fn(usize) -> Option<f64>,
        effort: impl Fn(usize) -> Option<f64>,
        stamp: Option<f64>,
    ) {
        let heard = JointState::heard(&self.joints, names, position, effort);
        self.reports.add(heard, stamp);
    }

    /// Stores a setpoint of the goal.
    pub(super) fn add_setpoint<Name: PartialEq<str>>(
        &mut self,
        names: &[Name],
        position: impl Fn(usize) -> Option<f64>,
    ) {
        let heard = JointState::heard(&self.joints, names, position, |_| None);
        self.setpoint = heard.or(self.setpoint.take());
    }

    /// Stores the time of the robot's clock, s.
    pub(super) fn set_time(&mut self, time: f64) {
        self.reports.set_time(time);
    }
}

/// A connection to an action server and to the robot behind it.
pub trait ActionLink: Send {
    /// Identifier of a goal.
    type Id: Clone + Send;

    /// A unique name for a goal.
    fn unique() -> Self::Id;

    /// Name of the action.
    fn action(&self) -> &str;

    /// An error of the connection, with the address of the other end.
    fn lost(&self, reason: &dyn Display) -> DriverError;

    /// Advice for the user if no server accepts a goal.
    fn advice(&self) -> String {
        "is its controller started?".into()
    }

    /// Connects; again after a lost connection.
    ///
    /// # Errors
    /// No answer from the server within a few seconds.
    fn open(&mut self) -> Result<(), DriverError>;

    /// Reads the messages that have arrived.
    ///
    /// # Errors
    /// The connection is lost.
    fn listen(&mut self, news: &mut News<Self::Id>) -> Result<(), DriverError>;

    /// Sends a goal.
    ///
    /// # Errors
    /// The connection is lost.
    fn send_goal(
        &mut self,
        joints: &[String],
        motion: &Interpolant,
        id: &Self::Id,
    ) -> Result<(), DriverError>;

    /// Requests the cancellation of a goal.
    ///
    /// # Errors
    /// The connection is lost.
    fn cancel(&mut self, id: &Self::Id) -> Result<(), DriverError>;
}

/// A driver for an action server.
pub struct ActionDriver<Link: ActionLink> {
    link: Link,
    news: News<Link::Id>,
}

impl<Link: ActionLink> ActionDriver<Link> {
    /// A driver that is not connected yet.
    pub(super) fn over(link: Link) -> Self {
        Self {
            link,
            news: News::of(Vec::new()),
        }
    }
}

impl<Link: ActionLink> Driver for ActionDriver<Link> {
    fn connect(&mut self, joints: &[String]) -> Result<(), DriverError> {
        self.news.joints = joints.to_vec();
        self.link.open()?;
        self.news.reports.open();
        Ok(())
    }

    fn reports_state(&self) -> bool {
        true
    }

    fn state(&mut self) -> Result<Option<JointState>, DriverError> {
        self.link.listen(&mut self.news)?;
        Ok(self.news.reports.state())
    }

    fn setpoint(&self) -> Option<&JointState> {
        self.news.setpoint.as_ref()
    }

    fn clock(&self) -> Option<(f64, Instant)> {
        self.news.reports.clock()
    }

    fn sends_goals(&self) -> bool {
        true
    }

    fn start(&mut self, motion: &Interpolant) -> Result<(), DriverError> {
        self.news.setpoint = None;
        let goal = Goal::after(self.news.goal.as_ref(), Link::unique());
        self.link.send_goal(&self.news.joints, motion, &goal.id)?;
        self.news.goal = Some(goal);
        Ok(())
    }

    fn is_accepted(&self) -> bool {
        self.news
            .goal
            .as_ref()
            .is_some_and(|goal| goal.acknowledged)
    }

    fn advance(&mut self, _: f64) -> Result<Progress, DriverError> {
        self.link.listen(&mut self.news)?;
        let Some(goal) = &self.news.goal else {
            return Ok(Progress::Done);
        };
        match &goal.outcome {
            Some(Ok(())) => Ok(Progress::Done),
            Some(Err(error)) => Err(error.clone()),
            // A server that is silent altogether is late with its answer, too: its silence is an error
            // of its own.
            None if !goal.acknowledged && self.news.reports.is_past(goal.sent + PATIENCE) => {
                let complaint = goal.complaint.as_ref();
                let quoted = complaint.map(|words| format!(" (the server reported: {words})"));
                Err(self.link.lost(&format_args!(
                    "no answer to the goal of {} within {} s; {}{}",
                    self.link.action(),
                    PATIENCE.as_secs(),
                    self.link.advice(),
                    quoted.unwrap_or_default()
                )))
            }
            None => Ok(Progress::Running),
        }
    }

    /// Cancels the last goal and the one that it replaced, since the last one may not have arrived
    /// yet. A goal with a reported end is cancelled, too, since the report may be wrong.
    fn stop(&mut self) -> Result<(), DriverError> {
        let Some(goal) = &self.news.goal else {
            return Ok(());
        };
        let mut ids = goal.former.iter().chain([&goal.id]);
        ids.try_for_each(|id| self.link.cancel(id))
    }
}
