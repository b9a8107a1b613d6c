//! Resolving clamps, loads and planes.

use super::Context;
use super::movement::{TypedMovement, movement};
use crate::scenario::section::{FINITE, NON_NEGATIVE, Section};
use crate::scenario::resolved::{Clamp, Hold, Load, LoadKind, Place, Plane};
use crate::scenario::typed;

/// Resolves all clamps.
pub fn clamps(context: &Context<'_>, top: &Section<'_>, typed: &[typed::Clamp]) -> Vec<Clamp> {
    let clamps = top.elements("clamps", typed);
    clamps
        .map(|(section, typed)| clamp(context, &section, typed))
        .collect()
}

fn clamp(context: &Context<'_>, section: &Section<'_>, typed: &typed::Clamp) -> Clamp {
    Clamp {
        rod: rod(section, &typed.rod),
        at: place(section, typed.at),
        hold: typed.hold.unwrap_or(Hold::Both),
        movement: movement(
            context,
            section,
            &TypedMovement {
                translation: &typed.translation,
                angle: &typed.angle,
                angular_velocity: &typed.angular_velocity,
                axis: &typed.axis,
                pivot: &typed.pivot,
                follow: &typed.follow,
                poses: &typed.poses,
            },
        ),
    }
}

/// Resolves all loads.
pub fn loads(top: &Section<'_>, typed: &[typed::Load]) -> Vec<Load> {
    let loads = top.elements("loads", typed);
    loads
        .map(|(section, typed)| load(&section, typed))
        .collect()
}

fn load(section: &Section<'_>, typed: &typed::Load) -> Load {
    let (kind, schedule) = match typed {
        typed::Load::Gravity {
            acceleration,
            schedule,
        } => {
            let acceleration = section.required_vector("acceleration", acceleration);
            (LoadKind::Gravity { acceleration }, schedule)
        }
        typed::Load::Force {
            rod: typed,
            at,
            force,
            frame,
            schedule,
        } => {
            let kind = LoadKind::Force {
                rod: rod(section, typed),
                at: place(section, *at),
                force: section.required_vector("force", force),
                frame: frame.unwrap_or_default(),
            };
            (kind, schedule)
        }
        typed::Load::Moment {
            rod: typed,
            at,
            moment,
            frame,
            schedule,
        } => {
            let kind = LoadKind::Moment {
                rod: rod(section, typed),
                at: place(section, *at),
                moment: section.required_vector("moment", moment),
                frame: frame.unwrap_or_default(),
            };
            (kind, schedule)
        }
        typed::Load::Distributed {
            rod,
            force_per_length,
            frame,
            schedule,
        } => {
            let kind = LoadKind::Distributed {
                rod: rod.clone(),
                force_per_length: section.required_vector("force_per_length", force_per_length),
                frame: frame.unwrap_or_default(),
            };
            (kind, schedule)
        }
        typed::Load::Drag {
            rod,
            translation,
            rotation,
            schedule,
        } => {
            if translation.is_none() && rotation.is_none() {
                section.missing(
                    "translation",
                    "a drag coefficient of `translation` or `rotation`",
                );
            }
            let kind = LoadKind::Drag {
                rod: rod.clone(),
                translation: section.with_default("translation", translation, NON_NEGATIVE, 0.0),
                rotation: section.with_default("rotation", rotation, NON_NEGATIVE, 0.0),
            };
            (kind, schedule)
        }
    };
    Load {
        kind,
        schedule: section.corners("schedule", schedule, |corner, factor| {
            corner.number("1", factor, FINITE)
        }),
    }
}

/// Resolves all planes.
pub fn planes(top: &Section<'_>, typed: &[typed::Plane]) -> Vec<Plane> {
    let plane = |(section, typed): (Section<'_>, &typed::Plane)| Plane {
        point: section.vector("point", &typed.point).unwrap_or_default(),
        normal: section
            .direction("normal", &typed.normal)
            .unwrap_or([0.0, 0.0, 1.0]),
        friction: section.optional("friction", &typed.friction, NON_NEGATIVE),
        wall: typed.wall,
    };
    top.elements("planes", typed).map(plane).collect()
}

/// The rod that the key `rod` names.
pub fn rod(section: &Section<'_>, typed: &Option<String>) -> String {
    section
        .needed("rod", typed.clone(), "the name of a rod")
        .unwrap_or_default()
}

/// Resolves a place along a rod, the key `at`.
pub fn place(section: &Section<'_>, typed: Option<typed::TypedPlace>) -> Place {
    let help = "\"start\", \"end\", or a number counted from zero";
    let typed = section.needed("at", typed, help);
    typed.map_or(Place::Start, |typed| section.place("at", typed))
}
