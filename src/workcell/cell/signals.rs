//! Safety signals: a thread reads their topics while a task lasts.
//!
//! The first message that is not allowed, the first silence that is too long, or a lost connection
//! forbids motions for the rest of the task, even if the next message would allow them.

use super::signal_rule::SignalRule;
use rodlab_robot::{DriverError, Reading, SignalTopic, open_signal, unix_time};
use std::fmt::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Time between two looks at the topics.
const CYCLE: Duration = Duration::from_millis(2);
/// Longest wait for the first messages.
const FIRST: Duration = Duration::from_secs(3);
/// Shortest time between two logged messages of a signal.
const LOGGED: Duration = Duration::from_millis(50);
/// Largest number of logged messages.
const MOST_LOGGED: usize = 100_000;

/// The safety signals of a cell, which are watched until this value is dropped.
#[derive(Debug)]
pub struct Signals {
    state: Arc<Mutex<State>>,
    is_over: Arc<AtomicBool>,
    watcher: Option<JoinHandle<()>>,
}

#[derive(Debug)]
struct State {
    begin: Instant,
    /// Time of the begin since 1970.
    opened: Duration,
    signals: Vec<Heard>,
    /// The reason why nothing may move.
    fault: Option<String>,
    /// Times after the begin, s, index of the signal, and content.
    log: Vec<(f64, usize, String)>,
}

/// State of a signal.
#[derive(Debug)]
struct Heard {
    rule: SignalRule,
    last: Option<Instant>,
    logged: Option<(Instant, String)>,
    /// The last speed that it has set.
    speed: Option<f64>,
}

impl Signals {
    /// Subscribes to the topics, and waits until each signal has sent a message, for three seconds
    /// at most.
    ///
    /// # Errors
    /// A topic cannot be subscribed to, or a signal that must not be silent sends nothing.
    pub fn open(rules: &[SignalRule]) -> Result<Self, DriverError> {
        let topics = rules
            .iter()
            .map(|rule| open_signal(&rule.topic, rule.message));
        let topics = topics.collect::<Result<Vec<_>, _>>()?;
        let signals = Self::watching(rules, topics);
        let begin = Instant::now();
        while signals.state().silent().next().is_some() && begin.elapsed() < FIRST {
            std::thread::sleep(CYCLE);
        }
        let state = signals.state();
        for heard in state.silent() {
            let topic = heard.rule.topic.topic();
            let message = format!(
                "safety signal `{}`: no message on {topic} in {} s",
                heard.rule.name,
                FIRST.as_secs()
            );
            match heard.rule.silence {
                Some(_) => {
                    return Err(DriverError::Lost(format!(
                        "{message}; is its publisher started, and is `message` its type?"
                    )));
                }
                None => tracing::warn!("{message}; it is watched from now on"),
            }
        }
        drop(state);
        Ok(signals)
    }

    fn watching(rules: &[SignalRule], mut topics: Vec<Box<dyn SignalTopic>>) -> Self {
        let (begin, opened) = (Instant::now(), unix_time());
        let heard = rules.iter().map(|rule| Heard {
            rule: rule.clone(),
            last: None,
            logged: None,
            speed: None,
        });
        let state = Arc::new(Mutex::new(State {
            begin,
            opened,
            signals: heard.collect(),
            fault: None,
            log: Vec::new(),
        }));
        let is_over = Arc::new(AtomicBool::new(false));
        let watcher = (!topics.is_empty()).then(|| {
            let (state, is_over) = (Arc::clone(&state), Arc::clone(&is_over));
            std::thread::spawn(move || {
                while !is_over.load(Ordering::Relaxed) {
                    for (index, topic) in topics.iter_mut().enumerate() {
                        let readings = topic.readings();
                        lock(&state).hear(index, readings, Instant::now());
                    }
                    std::thread::sleep(CYCLE);
                }
            })
        });
        Self {
            state,
            is_over,
            watcher,
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        lock(&self.state)
    }

    /// The reason why nothing may move.
    pub fn fault(&self) -> Option<String> {
        self.state().fault.clone()
    }

    /// The speed of motions relative to the planned one, from 0 to 1: the lowest that a signal has
    /// set with its last message.
    pub fn speed(&self) -> f64 {
        let state = self.state();
        let speeds = state.signals.iter().filter_map(|heard| heard.speed);
        speeds.fold(1.0, f64::min)
    }

    /// The messages as a table with the columns `time_s`, seconds since 1970, `signal` and
    /// `message`; `None` without signals. Repeated and frequent messages are left out.
    pub fn log(&self) -> Option<String> {
        let state = self.state();
        if state.signals.is_empty() {
            return None;
        }
        let begin = state.opened.as_secs_f64();
        let mut table = "time_s,signal,message\n".to_owned();
        for (time, index, content) in &state.log {
            let quoted =
                [&state.signals[*index].rule.name, content].map(|text| text.replace('"', "\"\""));
            let _ = writeln!(
                table,
                "{:.4},\"{}\",\"{}\"",
                begin + time,
                quoted[0],
                quoted[1]
            );
        }
        Some(table)
    }
}

impl Drop for Signals {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        if let Some(watcher) = self.watcher.take() {
            // A panic of the watcher was reported when it occurred.
            let _ = watcher.join();
        }
    }
}

fn lock(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

impl State {
    /// Signals that have sent nothing yet.
    fn silent(&self) -> impl Iterator<Item = &Heard> {
        self.signals.iter().filter(|heard| heard.last.is_none())
    }

    /// Reads what a signal has sent until `now`.
    fn hear(&mut self, index: usize, readings: Result<Vec<Reading>, DriverError>, now: Instant) {
        let heard = &mut self.signals[index];
        let name = &heard.rule.name;
        let fault = match &readings {
            Err(error) => Some(format!("safety signal `{name}`: {error}")),
            Ok(readings) if readings.is_empty() => {
                let quiet = heard.last.map(|last| now.saturating_duration_since(last));
                quiet.zip(heard.rule.silence).and_then(|(quiet, allowed)| {
                    (quiet > allowed).then(|| {
                        format!(
                            "safety signal `{name}` is silent for {:.0} ms; allowed: {:.0} ms",
                            quiet.as_secs_f64() * 1e3,
                            allowed.as_secs_f64() * 1e3
                        )
                    })
                })
            }
            Ok(readings) => {
                heard.last = Some(now);
                let set = readings.last().and_then(|last| heard.rule.speed(last));
                heard.speed = set.or(heard.speed);
                readings
                    .iter()
                    .find_map(|reading| heard.rule.refuses(reading))
            }
        };
        let is_first = fault.is_some() && self.fault.is_none();
        if is_first {
            self.fault.clone_from(&fault);
        }
        let seen = match (is_first, fault, readings.as_deref()) {
            (true, Some(fault), _) => fault,
            (_, _, Ok([.., last])) => last.to_string(),
            _ => return,
        };
        let is_due = is_first
            || heard.logged.as_ref().is_none_or(|(at, before)| {
                *before != seen && now.saturating_duration_since(*at) >= LOGGED
            });
        if is_due && self.log.len() < MOST_LOGGED {
            let time = now.saturating_duration_since(self.begin).as_secs_f64();
            self.log.push((time, index, seen.clone()));
            heard.logged = Some((now, seen));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::signal_rule::Bounds;
    use super::*;
    use rodlab_robot::{SignalMessage, TopicName};

    fn state(bounds: Bounds, silence: Option<u64>) -> State {
        let rule = SignalRule {
            name: "stop".into(),
            topic: TopicName::parse("ros1://h:1/stop", "").unwrap().unwrap(),
            message: SignalMessage::named("std_msgs/Bool").unwrap(),
            bounds,
            silence: silence.map(Duration::from_millis),
        };
        State {
            begin: Instant::now(),
            opened: Duration::ZERO,
            signals: vec![Heard {
                rule,
                last: None,
                logged: None,
                speed: None,
            }],
            fault: None,
            log: Vec::new(),
        }
    }

    #[test]
    fn a_short_press_forbids_motions_for_the_rest_of_the_task() {
        let mut state = state(Bounds::Not(true), None);
        let now = state.begin;
        state.hear(0, Ok(vec![Reading::Flag(false)]), now);
        assert_eq!(state.fault, None);
        // Pressed and released between two looks.
        state.hear(0, Ok(vec![Reading::Flag(true), Reading::Flag(false)]), now);
        state.hear(0, Ok(vec![Reading::Flag(false)]), now);
        let fault = state.fault.unwrap();
        assert_eq!(fault, "safety signal `stop` is true; allowed: false");
        assert_eq!(state.log[1].2, fault);
    }

    #[test]
    fn silence_counts_from_the_last_message() {
        let mut state = state(Bounds::Any, Some(100));
        let at = |ms: u64| state.begin + Duration::from_millis(ms);
        let times = [0, 90, 180, 281].map(at);
        state.hear(0, Ok(Vec::new()), times[1]);
        assert_eq!(state.fault, None, "it has not begun");
        state.hear(0, Ok(vec![Reading::Beat]), times[1]);
        state.hear(0, Ok(Vec::new()), times[2]);
        assert_eq!(state.fault, None);
        state.hear(0, Ok(Vec::new()), times[3]);
        let fault = state.fault.unwrap();
        assert!(
            fault.contains("silent for 191 ms; allowed: 100 ms"),
            "{fault}"
        );
    }

    #[test]
    fn the_last_message_sets_the_speed() {
        let mut state = state(Bounds::Speed(100.0), None);
        let now = state.begin;
        assert_eq!(state.signals[0].speed, None);
        for (sent, speed) in [(vec![0.0, 40.0], 0.4), (vec![], 0.4), (vec![0.0], 0.0)] {
            let readings = sent.into_iter().map(Reading::Number).collect();
            state.hear(0, Ok(readings), now);
            assert_eq!(state.signals[0].speed, Some(speed));
        }
        assert_eq!(state.fault, None);
    }

    #[test]
    fn a_lost_connection_forbids_motions() {
        let mut state = state(Bounds::Any, None);
        let now = state.begin;
        state.hear(0, Err(DriverError::Lost("gone".into())), now);
        assert_eq!(state.fault.as_deref(), Some("safety signal `stop`: gone"));
    }

    #[test]
    fn the_log_has_changes_and_few_of_them() {
        let mut state = state(Bounds::Range([0.0, 1e3]), None);
        for k in 0..100 {
            let now = state.begin + Duration::from_millis(10 * k);
            state.hear(
                0,
                Ok(vec![Reading::Number(if k < 50 { 7.0 } else { k as f64 })]),
                now,
            );
        }
        // The first, and one each 50 ms from 0.5 s on.
        assert_eq!(state.log.len(), 11);
        assert!((state.log[1].0 - 0.5).abs() < 1e-9);
    }
}
