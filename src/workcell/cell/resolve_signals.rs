//! Reads `[[safety.signals]]`.

use super::resolver::Resolver;
use super::signal_rule::{Bounds, SignalRule};
use super::typed;
use rodlab_lab::scenario::KeyPath;
use rodlab_robot::{SignalMessage, SignalShape, TopicName};
use std::time::Duration;

/// Topic in messages about names.
const EXAMPLE: &str = "emergency_stop";
/// Shortest and longest allowed `silence`, s.
const SILENCE: [f64; 2] = [0.01, 3600.0];

/// The rules of the signals; faulty ones are left out.
pub(super) fn signals(
    resolver: &Resolver<'_>,
    path: &KeyPath,
    typed: &[typed::Signal],
) -> Vec<SignalRule> {
    let rules = typed.iter().enumerate();
    rules
        .filter_map(|(index, typed)| rule(resolver, &path.index(index), typed))
        .collect()
}

fn rule(resolver: &Resolver<'_>, path: &KeyPath, typed: &typed::Signal) -> Option<SignalRule> {
    let topic = match TopicName::parse(&typed.topic, EXAMPLE) {
        Some(Ok(topic)) => Some(topic),
        Some(Err(message)) => {
            resolver.fault(&path.key("topic"), message);
            None
        }
        None => {
            let message = format!(
                "{:?} is not a topic; needed: ros1://host:port/topic, rosbridge://host:port/topic or ros2://domain/topic",
                typed.topic
            );
            resolver.fault(&path.key("topic"), message);
            None
        }
    };
    let message = SignalMessage::named(&typed.message);
    if message.is_none() {
        let known: Vec<_> = SignalMessage::names().collect();
        let known = known.join(", ");
        resolver.fault(
            &path.key("message"),
            format!("{:?} is not read; allowed: {known}", typed.message),
        );
    }
    let silence = typed.silence.as_ref().map(|silence| {
        let seconds = resolver.si(&path.key("silence"), silence);
        let [least, most] = SILENCE;
        if !(least..=most).contains(&seconds) {
            let message = format!("{seconds} s; allowed: {least} s to {most} s");
            resolver.fault(&path.key("silence"), message);
        }
        Duration::from_secs_f64(seconds.clamp(least, most))
    });
    let bounds = bounds(resolver, path, typed, message?)?;
    if bounds == Bounds::Any && silence.is_none() {
        resolver.fault(path, "no message and no silence would end a motion");
    }
    Some(SignalRule {
        name: typed.name.clone(),
        topic: topic?,
        message: message?,
        bounds,
        silence,
    })
}

/// Which messages are allowed; the keys must fit the type of the messages.
fn bounds(
    resolver: &Resolver<'_>,
    path: &KeyPath,
    typed: &typed::Signal,
    message: SignalMessage,
) -> Option<Bounds> {
    let (bounds, keys): (Bounds, &[&str]) = match message.shape {
        SignalShape::Flag => (typed.stop_at.map_or(Bounds::Any, Bounds::Not), &["stop_at"]),
        SignalShape::Text => (texts(resolver, path, typed)?, &["allowed"]),
        SignalShape::Wrench => (wrench(resolver, path, typed), &["force", "torque"]),
        SignalShape::Empty => (Bounds::Any, &[]),
        SignalShape::Signed(_) | SignalShape::Unsigned(_) | SignalShape::Float(_) => (
            numbers(resolver, path, typed)?,
            &["allowed", "lower", "upper", "full_speed"],
        ),
    };
    let given = [
        ("stop_at", typed.stop_at.is_some()),
        ("allowed", typed.allowed.is_some()),
        ("lower", typed.lower.is_some()),
        ("upper", typed.upper.is_some()),
        ("force", typed.force.is_some()),
        ("torque", typed.torque.is_some()),
        ("full_speed", typed.full_speed.is_some()),
    ];
    for (key, _) in given
        .iter()
        .filter(|(key, given)| *given && !keys.contains(key))
    {
        let message = match keys {
            [] => format!("{} has no content to compare", message.name),
            keys => format!(
                "messages {} are compared by {}",
                message.name,
                keys.join(", ")
            ),
        };
        resolver.fault(&path.key(key), message);
    }
    Some(bounds)
}

fn texts(resolver: &Resolver<'_>, path: &KeyPath, typed: &typed::Signal) -> Option<Bounds> {
    let Some(allowed) = &typed.allowed else {
        return Some(Bounds::Any);
    };
    let texts = allowed.iter().map(|value| match value {
        typed::Allowed::Text(text) => Some(text.clone()),
        typed::Allowed::Number(_) => None,
    });
    let texts: Option<Vec<_>> = texts.collect();
    if texts.is_none() {
        resolver.fault(&path.key("allowed"), "texts are needed");
    }
    texts.map(Bounds::Texts)
}

fn numbers(resolver: &Resolver<'_>, path: &KeyPath, typed: &typed::Signal) -> Option<Bounds> {
    let is_range = typed.lower.is_some() || typed.upper.is_some();
    if let Some(full) = typed.full_speed {
        let path = path.key("full_speed");
        if is_range || typed.allowed.is_some() {
            let message = "a signal that sets the speed ends no motion: `allowed`, `lower` and `upper` must be absent";
            resolver.fault(&path, message);
        }
        if !(full > 0.0 && full.is_finite()) {
            resolver.fault(&path, format!("{full}; allowed: above 0"));
        }
        let streaming = resolver.file.typed.streaming.as_ref();
        if streaming.is_none_or(|streaming| streaming.horizon.is_none()) {
            let message = "`streaming.horizon` is needed: without it a controller receives the whole motion at once";
            resolver.fault(&path, message);
        }
        return Some(Bounds::Speed(full));
    }
    let Some(allowed) = &typed.allowed else {
        let [lower, upper] = [
            typed.lower.unwrap_or(f64::NEG_INFINITY),
            typed.upper.unwrap_or(f64::INFINITY),
        ];
        if !(lower < upper) {
            let message = format!("{lower} must be below `upper`, {upper}");
            resolver.fault(&path.key("lower"), message);
        }
        return Some(match is_range {
            true => Bounds::Range([lower, upper]),
            false => Bounds::Any,
        });
    };
    if is_range {
        resolver.fault(
            &path.key("allowed"),
            "either `allowed`, or `lower` and `upper` may be given",
        );
    }
    let numbers = allowed.iter().map(|value| match value {
        typed::Allowed::Number(number) => Some(*number),
        typed::Allowed::Text(_) => None,
    });
    let numbers: Option<Vec<_>> = numbers.collect();
    if numbers.is_none() {
        resolver.fault(&path.key("allowed"), "numbers are needed");
    }
    numbers.map(Bounds::Numbers)
}

fn wrench(resolver: &Resolver<'_>, path: &KeyPath, typed: &typed::Signal) -> Bounds {
    let force = typed.force.as_ref();
    let torque = typed.torque.as_ref();
    if force.is_none() && torque.is_none() {
        return Bounds::Any;
    }
    Bounds::Wrench {
        force: force.map_or(f64::INFINITY, |force| {
            resolver.positive_si(&path.key("force"), force)
        }),
        torque: torque.map_or(f64::INFINITY, |torque| {
            resolver.positive_si(&path.key("torque"), torque)
        }),
    }
}
