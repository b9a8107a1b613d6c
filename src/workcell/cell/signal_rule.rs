//! Rules of safety signals: which messages of a topic, or which silence, end motions, and which set
//! their speed.

use rodlab_robot::{Reading, SignalMessage, TopicName};
use std::time::Duration;

/// A topic that is watched while arms move.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalRule {
    /// Name in messages.
    pub name: String,
    /// The topic.
    pub topic: TopicName,
    /// Type of its messages.
    pub message: SignalMessage,
    /// Which messages end motions.
    pub bounds: Bounds,
    /// Longest time without a message; `None` if the topic may be silent.
    pub silence: Option<Duration>,
}

/// Which messages of a signal allow motions.
#[derive(Clone, Debug, PartialEq)]
pub enum Bounds {
    /// All of them; only silence ends motions.
    Any,
    /// All flags but this one.
    Not(bool),
    /// These numbers.
    Numbers(Vec<f64>),
    /// These texts.
    Texts(Vec<String>),
    /// Numbers between two ends.
    Range([f64; 2]),
    /// Numbers from zero on, which set the speed of motions: zero holds them, and this number or a
    /// larger one means the planned speed.
    Speed(f64),
    /// Wrenches whose force, N, and torque, N m, have at most these sizes.
    Wrench {
        /// N.
        force: f64,
        /// N m.
        torque: f64,
    },
}

impl SignalRule {
    /// The reason why a message ends motions. A number that is not finite ends them.
    pub fn refuses(&self, reading: &Reading) -> Option<String> {
        let is_allowed = match (&self.bounds, reading) {
            (Bounds::Any, _) => true,
            (Bounds::Not(stop), Reading::Flag(flag)) => flag != stop,
            (Bounds::Numbers(allowed), Reading::Number(number)) => allowed.contains(number),
            (Bounds::Texts(allowed), Reading::Text(text)) => allowed.contains(text),
            (Bounds::Range([lower, upper]), Reading::Number(number)) => {
                (lower..=upper).contains(&number)
            }
            (Bounds::Speed(_), Reading::Number(number)) => *number >= 0.0,
            (
                Bounds::Wrench { force, torque },
                Reading::Wrench {
                    force: f,
                    torque: t,
                },
            ) => f.norm() <= *force && t.norm() <= *torque,
            _ => false,
        };
        (!is_allowed).then(|| {
            let allowed = match &self.bounds {
                Bounds::Any => String::new(),
                Bounds::Not(stop) => (!stop).to_string(),
                Bounds::Numbers(allowed) => {
                    let allowed: Vec<_> = allowed.iter().map(f64::to_string).collect();
                    allowed.join(", ")
                }
                Bounds::Texts(allowed) => allowed.join(", "),
                Bounds::Range([lower, upper]) => format!("{lower} to {upper}"),
                Bounds::Speed(_) => "at least 0".into(),
                Bounds::Wrench { force, torque } => format!("{force} N, {torque} N m"),
            };
            format!(
                "safety signal `{}` is {reading}; allowed: {allowed}",
                self.name
            )
        })
    }
}

impl SignalRule {
    /// The speed of motions relative to the planned one that a message sets; `None` if the signal
    /// sets no speed.
    pub fn speed(&self, reading: &Reading) -> Option<f64> {
        match (&self.bounds, reading) {
            (Bounds::Speed(full), Reading::Number(number)) => Some((number / full).clamp(0.0, 1.0)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rule(bounds: Bounds) -> SignalRule {
        SignalRule {
            name: "s".into(),
            topic: TopicName::parse("ros1://h:1/s", "s").unwrap().unwrap(),
            message: SignalMessage::named("std_msgs/msg/Bool").unwrap(),
            bounds,
            silence: None,
        }
    }

    #[test]
    fn only_allowed_messages_let_arms_move() {
        let wrench = |force: f64, torque: f64| Reading::Wrench {
            force: [0.0, -force, 0.0].into(),
            torque: [torque, 0.0, 0.0].into(),
        };
        let limit = Bounds::Wrench {
            force: 20.0,
            torque: f64::INFINITY,
        };
        let modes = Bounds::Numbers(vec![5.0, 7.0]);
        let range = Bounds::Range([-1.0, f64::INFINITY]);
        let texts = Bounds::Texts(vec!["auto".into()]);
        let cases = [
            (Bounds::Not(true), Reading::Flag(false), None),
            (
                Bounds::Not(true),
                Reading::Flag(true),
                Some("is true; allowed: false"),
            ),
            (modes.clone(), Reading::Number(7.0), None),
            (modes, Reading::Number(3.0), Some("is 3; allowed: 5, 7")),
            (range.clone(), Reading::Number(1e9), None),
            (range.clone(), Reading::Number(-2.0), Some("-1 to inf")),
            (range, Reading::Number(f64::NAN), Some("NaN")),
            (Bounds::Speed(100.0), Reading::Number(250.0), None),
            (
                Bounds::Speed(100.0),
                Reading::Number(-1.0),
                Some("is -1; allowed: at least 0"),
            ),
            (
                Bounds::Speed(1.0),
                Reading::Number(f64::NAN),
                Some("is NaN"),
            ),
            (texts.clone(), Reading::Text("auto".into()), None),
            (texts, Reading::Text("manual".into()), Some("\"manual\"")),
            (limit.clone(), wrench(19.9, 1e3), None),
            (limit.clone(), wrench(20.1, 0.0), Some("20.10 N")),
            (limit, wrench(f64::NAN, 0.0), Some("NaN N")),
            (Bounds::Any, Reading::Beat, None),
        ];
        for (bounds, reading, expected) in cases {
            let found = rule(bounds).refuses(&reading);
            match (&found, expected) {
                (None, None) => {}
                (Some(found), Some(expected)) => assert!(found.contains(expected), "{found}"),
                _ => panic!("{reading}: {found:?}"),
            }
        }
    }

    #[test]
    fn a_number_sets_the_speed_relative_to_the_full_one() {
        let percent = rule(Bounds::Speed(100.0));
        let speeds =
            [0.0, 30.0, 100.0, 250.0].map(|number| percent.speed(&Reading::Number(number)));
        assert_eq!(speeds, [0.0, 0.3, 1.0, 1.0].map(Some));
        let range = rule(Bounds::Range([0.0, 1.0]));
        assert_eq!(range.speed(&Reading::Number(0.5)), None);
    }
}
