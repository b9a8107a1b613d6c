//! Resolving clamps.

use super::Context;
use super::movement::{TypedMovement, movement};
use crate::scenario::resolved::{Clamp, Hold, Place};
use crate::scenario::section::Section;
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
