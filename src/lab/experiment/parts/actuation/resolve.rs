//! Resolves natural strains that change over time.

use super::keys::ActuationKeys;
use super::resolved::{Actuation, ActuationKind, Course};
use crate::scenario::Time;
use crate::scenario::quantity::Quantity;
use crate::scenario::section::{FINITE, NON_NEGATIVE, POSITIVE, Section};
use crate::scenario::units::{self, Angle, Dimension, Dimensionless, Frequency, Length};

/// Largest fraction of its length that a rod may lose.
const LARGEST_LOSS: f64 = 0.9;

/// The keys of one actuation that do not depend on its kind, except for the unit `D` of the
/// strain.
struct Keys<'a, D> {
    rod: &'a Option<String>,
    values: &'a Option<Vec<(Quantity<units::Time>, Quantity<D>)>>,
    amplitude: &'a Option<Quantity<D>>,
    wavelength: &'a Option<Quantity<Length>>,
    frequency: &'a Option<Quantity<Frequency>>,
    phase: &'a Option<Quantity<Angle>>,
    schedule: &'a Option<Vec<(Quantity<units::Time>, Quantity<Dimensionless>)>>,
    from: &'a Option<Quantity<Length>>,
    to: &'a Option<Quantity<Length>>,
}

/// The [`Keys`] of a kind.
macro_rules! keys {
    ($typed:expr, $kind:ident) => {{
        let ActuationKeys::$kind {
            rod,
            values,
            amplitude,
            wavelength,
            frequency,
            phase,
            schedule,
            from,
            to,
            ..
        } = $typed
        else {
            unreachable!("the kind has been matched")
        };
        Keys {
            rod,
            values,
            amplitude,
            wavelength,
            frequency,
            phase,
            schedule,
            from,
            to,
        }
    }};
}

/// Resolves an actuation.
pub fn actuation(section: &Section<'_>, typed: &ActuationKeys) -> Actuation {
    match typed {
        ActuationKeys::Curvature { direction, .. } => {
            let direction = section.count("direction", direction.or(Some(1)), 1..=2);
            let kind = ActuationKind::Curvature {
                direction: direction.unwrap_or(1),
            };
            of_kind(section, kind, &keys!(typed, Curvature))
        }
        ActuationKeys::Twist { .. } => of_kind(section, ActuationKind::Twist, &keys!(typed, Twist)),
        ActuationKeys::Length { .. } => {
            of_kind(section, ActuationKind::Length, &keys!(typed, Length))
        }
    }
}

/// Rejects changes in a run without time, and rods that would lose almost all their length.
pub fn judge(array: &Section<'_>, actuations: &[Actuation], time: &Time) {
    if *time == Time::Static {
        for (index, actuation) in actuations.iter().enumerate() {
            if actuation.course.changes() {
                refuse_motion(&array.below(&index.to_string()), &actuation.course);
            }
        }
    }
    refuse_vanishing_lengths(array, actuations);
}

fn of_kind<D: Dimension>(
    section: &Section<'_>,
    kind: ActuationKind,
    keys: &Keys<'_, D>,
) -> Actuation {
    let from = section.with_default("from", keys.from, NON_NEGATIVE, 0.0);
    let to = section.optional("to", keys.to, POSITIVE);
    if let Some(to) = to
        && to <= from
    {
        let allowed = format_args!("greater than `from` = {from:?} m");
        section.out_of_range("to", format_args!("{to:?} m"), allowed);
    }
    let rod = section.needed("rod", keys.rod.clone(), "the name of a rod");
    Actuation {
        kind,
        rod: rod.unwrap_or_default(),
        course: course(section, keys),
        from,
        to,
    }
}

fn course<D: Dimension>(section: &Section<'_>, keys: &Keys<'_, D>) -> Course {
    let Some(typed) = keys.values else {
        if keys.amplitude.is_none() {
            let help = "[[time, strain], ...], or the `amplitude` of a wave";
            section.missing("values", help);
        }
        return Course::Wave {
            amplitude: section.with_default("amplitude", keys.amplitude, FINITE, 0.0),
            wavelength: section.optional("wavelength", keys.wavelength, POSITIVE),
            frequency: section.with_default("frequency", keys.frequency, FINITE, 0.0),
            phase: section.with_default("phase", keys.phase, FINITE, 0.0),
            schedule: section.corners(
                "schedule",
                keys.schedule.as_deref().unwrap_or_default(),
                |corner, factor| corner.number("1", factor, FINITE),
            ),
        };
    };
    for (key, given) in [
        ("amplitude", keys.amplitude.is_some()),
        ("wavelength", keys.wavelength.is_some()),
        ("frequency", keys.frequency.is_some()),
        ("phase", keys.phase.is_some()),
        ("schedule", keys.schedule.is_some()),
    ] {
        if given {
            section.fault(key, "this key is for waves; give it or `values`, not both");
        }
    }
    if typed.is_empty() {
        section.fault("values", "no values; give [[time, strain], ...]");
    }
    Course::Uniform {
        values: section.corners("values", typed, |corner, value| {
            corner.number("1", value, FINITE)
        }),
    }
}

/// Rejects changes over time in a run without time.
fn refuse_motion(section: &Section<'_>, course: &Course) {
    let key = match course {
        Course::Uniform { .. } => "values",
        Course::Wave { schedule, .. } if !schedule.is_empty() => "schedule",
        Course::Wave { .. } => "frequency",
    };
    section.fault_with_help(
        key,
        "a static run has no time, so nothing changes in it",
        Some(
            "give one value, such as values = [[0, 5]]; or follow the equilibria with time.mode = \"continuation\", \
             whose parameter replaces the time; or run dynamically"
                .into(),
        ),
    );
}

/// Rejects rods that would lose almost all their length.
fn refuse_vanishing_lengths(section: &Section<'_>, actuations: &[Actuation]) {
    let lengths = actuations.iter().enumerate();
    let lengths = lengths.filter(|(_, actuation)| actuation.kind == ActuationKind::Length);
    let mut losses: Vec<(&str, f64)> = Vec::new();
    for (index, actuation) in lengths {
        let [_, low] = actuation.course.extremes();
        let loss = (-low).max(0.0);
        let found = losses.iter().position(|(rod, _)| *rod == actuation.rod);
        let place = found.unwrap_or_else(|| {
            losses.push((&actuation.rod, 0.0));
            losses.len() - 1
        });
        let before = losses[place].1;
        losses[place].1 += loss;
        if before <= LARGEST_LOSS && before + loss > LARGEST_LOSS {
            let key = match actuation.course {
                Course::Uniform { .. } => "values",
                Course::Wave { .. } => "amplitude",
            };
            section.below(&index.to_string()).fault(
                key,
                format!(
                    "the rod would be shorter by {:?} of its length at once; allowed: at most {LARGEST_LOSS:?}",
                    before + loss
                ),
            );
        }
    }
}
