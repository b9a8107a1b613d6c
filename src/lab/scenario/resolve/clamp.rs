//! Resolving clamps.

use super::Context;
use super::movement::movement;
use crate::scenario::resolved::Clamp;
use crate::scenario::section::Section;
use crate::scenario::typed;

/// Resolves all clamps.
pub fn clamps(context: &Context<'_>, top: &Section<'_>, typed: &[typed::Clamp]) -> Vec<Clamp> {
    let clamp = |(section, typed): (Section<'_>, &typed::Clamp)| Clamp {
        rod: typed.rod(&section),
        at: typed.at(&section),
        hold: typed.hold(&section),
        movement: movement(context, &section, &typed.movement(&section)),
    };
    top.elements("clamps", typed).map(clamp).collect()
}
