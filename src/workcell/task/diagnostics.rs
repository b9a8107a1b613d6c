//! Diagnostics of a task for the monitors of ROS (`rqt_robot_monitor`, `diagnostic_aggregator`).
//!
//! A thread publishes the status of the task and of each arm once a second, and whenever a step
//! begins or the task ends, so that a slow subscriber cannot delay a motion.

use super::display::{Display, described};
use super::stage::Stage;
use super::stopped::LaidLength;
use crate::cell::Cell;
use rodlab_robot::{
    DiagnosticLevel, DiagnosticStatus, DiagnosticTopic, DriverError, StreamState, open_diagnostics,
    unix_time,
};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Time between two messages.
const INTERVAL: Duration = Duration::from_secs(1);
/// Time for the last message to leave this computer.
const LAST: Duration = Duration::from_millis(200);
/// Lag of a motion above which a person should look, s.
const NOTICED_LAG: f64 = 1.0;

/// Diagnostics of a task, published until this value is dropped.
pub struct Diagnostics {
    shared: Arc<Shared>,
    publisher: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    task: DiagnosticStatus,
    /// The step in words.
    step: String,
    arms: Vec<Arm>,
    /// Whether the thread has something to publish at once.
    is_new: bool,
    is_over: bool,
}

/// The last report of an arm or an axis.
struct Arm {
    name: String,
    joints: Vec<f64>,
    received: Option<Instant>,
}

impl Diagnostics {
    /// Advertises the topic of a cell; `None` if its file names none.
    ///
    /// # Errors
    /// See [`open_diagnostics`].
    pub fn open(cell: &Cell) -> Result<Option<Self>, DriverError> {
        let topic = cell
            .diagnostics
            .as_ref()
            .map(open_diagnostics)
            .transpose()?;
        let names = || {
            let arms = cell.arms.iter().map(|arm| arm.name.clone());
            arms.chain(cell.axes.iter().map(|axis| axis.name.clone()))
        };
        Ok(topic.map(|topic| Self::at(topic, names())))
    }

    fn at(mut topic: Box<dyn DiagnosticTopic>, names: impl Iterator<Item = String>) -> Self {
        let shared = Arc::new(Shared::default());
        let arm = |name| Arm {
            name,
            joints: Vec::new(),
            received: None,
        };
        let mut state = shared.state();
        state.arms = names.map(arm).collect();
        state.task.name = "rodlab: task".into();
        state.task.message = "waiting".into();
        drop(state);
        let seen = Arc::clone(&shared);
        let publisher = std::thread::spawn(move || {
            let mut has_failed = false;
            loop {
                let (statuses, is_over) = seen.next();
                let sent = topic.publish(unix_time(), &statuses);
                if let Err(error) = sent
                    && !std::mem::replace(&mut has_failed, true)
                {
                    tracing::warn!("diagnostics: {error}");
                }
                if is_over {
                    std::thread::sleep(LAST);
                    return;
                }
            }
        });
        Self {
            shared,
            publisher: Some(publisher),
        }
    }

    /// Publishes the end of the task: what it has reached, or why it failed.
    pub fn end(&self, outcome: Result<&str, &str>) {
        let mut state = self.shared.state();
        (state.task.level, state.task.message) = match outcome {
            Ok(words) => (DiagnosticLevel::Ok, words.into()),
            Err(words) => (DiagnosticLevel::Error, words.into()),
        };
        self.shared.announce(state);
    }
}

impl Drop for Diagnostics {
    fn drop(&mut self) {
        let mut state = self.shared.state();
        state.is_over = true;
        self.shared.announce(state);
        if let Some(publisher) = self.publisher.take() {
            // A panic of the thread was reported when it occurred.
            let _ = publisher.join();
        }
    }
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn announce(&self, mut state: MutexGuard<'_, State>) {
        state.is_new = true;
        drop(state);
        self.changed.notify_all();
    }

    /// Waits until statuses are due, and whether they are the last ones.
    fn next(&self) -> (Vec<DiagnosticStatus>, bool) {
        let waited =
            (self.changed).wait_timeout_while(self.state(), INTERVAL, |state| !state.is_new);
        let (mut state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        state.is_new = false;
        (state.statuses(Instant::now()), state.is_over)
    }
}

impl State {
    fn statuses(&self, now: Instant) -> Vec<DiagnosticStatus> {
        let arms = self.arms.iter().map(|arm| arm.status(now));
        std::iter::once(self.task.clone()).chain(arms).collect()
    }
}

impl Arm {
    fn status(&self, now: Instant) -> DiagnosticStatus {
        let joints = self.joints.iter().map(|joint| format!("{joint:.4}"));
        let (message, values) = match self.received {
            None => ("no report of its joints yet", Vec::new()),
            Some(received) => {
                let age = now.saturating_duration_since(received).as_secs_f64();
                let values = vec![
                    ("joints in rad or m", joints.collect::<Vec<_>>().join(" ")),
                    ("age of the last report in s", format!("{age:.2}")),
                ];
                ("joints as reported", values)
            }
        };
        DiagnosticStatus {
            level: DiagnosticLevel::Ok,
            name: format!("rodlab: {}", self.name),
            message: message.into(),
            hardware: self.name.clone(),
            values,
        }
    }
}

impl Display for Diagnostics {
    fn step(&self, number: usize, of: usize, stage: &Stage) {
        let mut state = self.shared.state();
        state.step = format!("{number} of {of}: {}", stage.words);
        state.task.level = DiagnosticLevel::Ok;
        state.task.message = state.step.clone();
        state.task.values.clear();
        self.shared.announce(state);
    }

    fn motion(&self, motion: &StreamState, laid: Option<LaidLength>) {
        let is_held = motion.pace.is_some_and(|pace| pace < 1e-3);
        let mut state = self.shared.state();
        state.task.level = match is_held || motion.lag > NOTICED_LAG {
            true => DiagnosticLevel::Warn,
            false => DiagnosticLevel::Ok,
        };
        let words = described(motion, laid);
        state.task.message = match state.step.as_str() {
            "" => words,
            step => format!("{step}, {words}"),
        };
        let tracking = motion.tracking;
        state.task.values = vec![
            ("time in s", format!("{:.2}", motion.time)),
            ("duration in s", format!("{:.2}", motion.duration)),
            ("lag in s", format!("{:.2}", motion.lag)),
            ("tracking error in rad", format!("{:.5}", tracking.revolute)),
            ("tracking error in m", format!("{:.5}", tracking.prismatic)),
        ];
        if let Some(pace) = motion.pace {
            (state.task.values).push(("speed relative to the plan", format!("{pace:.3}")));
        }
    }

    fn joints(&self, arm: &str, joints: &[f64]) {
        let mut state = self.shared.state();
        if let Some(known) = state.arms.iter_mut().find(|known| known.name == arm) {
            known.joints.clear();
            known.joints.extend(joints);
            known.received = Some(Instant::now());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_robot::Tolerance;
    use std::sync::mpsc::{Sender, channel};

    struct Sent(Sender<Vec<DiagnosticStatus>>);

    impl DiagnosticTopic for Sent {
        fn publish(
            &mut self,
            _: Duration,
            statuses: &[DiagnosticStatus],
        ) -> Result<(), DriverError> {
            let sent = self.0.send(statuses.to_vec());
            sent.map_err(|_| DriverError::Lost("no receiver".into()))
        }
    }

    #[test]
    fn steps_motions_and_the_end_are_published() {
        let (sender, sent) = channel();
        let diagnostics = Diagnostics::at(Box::new(Sent(sender)), ["left".to_owned()].into_iter());
        const STAGE: Stage = Stage::new("go", "going there", "");
        diagnostics.step(1, 2, &STAGE);
        let next = |is_wanted: &dyn Fn(&[DiagnosticStatus]) -> bool| loop {
            let statuses: Vec<DiagnosticStatus> =
                sent.recv_timeout(Duration::from_secs(60)).unwrap();
            if is_wanted(&statuses) {
                break statuses;
            }
        };
        let [task, left] = &next(&|all| all[0].message == "1 of 2: going there")[..] else {
            panic!("one status for the task, one for the arm");
        };
        assert_eq!(
            (task.name.as_str(), left.name.as_str()),
            ("rodlab: task", "rodlab: left")
        );
        assert_eq!(left.message, "no report of its joints yet");
        diagnostics.joints("left", &[0.5, -1.0]);
        diagnostics.motion(
            &StreamState {
                time: 3.0,
                lag: 0.0,
                duration: 8.0,
                tracking: Tolerance::default(),
                pace: Some(0.0),
            },
            None,
        );
        // The state of a motion is sent at the next interval.
        let held = next(&|all| all[0].level == DiagnosticLevel::Warn);
        assert_eq!(held[0].message, "1 of 2: going there, 3.0 of 8.0 s, held");
        assert_eq!(held[1].values[0].1, "0.5000 -1.0000");
        diagnostics.end(Err("left: too far from its trajectory"));
        drop(diagnostics);
        let last = sent.iter().last().unwrap();
        assert_eq!(last[0].level, DiagnosticLevel::Error);
        assert_eq!(last[0].message, "left: too far from its trajectory");
    }
}
