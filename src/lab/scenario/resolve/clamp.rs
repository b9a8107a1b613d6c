//! Resolving clamps.

use super::movement::movement;
use crate::scenario::resolved::{Clamp, Hold};
use crate::scenario::section::Section;
use crate::scenario::typed;

/// Resolves all clamps.
pub fn clamps(top: &Section<'_>, typed: &[typed::Clamp]) -> Vec<Clamp> {
    let clamp = |(section, typed): (Section<'_>, &typed::Clamp)| {
        let clamp = Clamp {
            rod: typed.rod(&section),
            at: typed.at(&section),
            hold: typed.hold(&section),
            offset: typed.offset(&section),
            rotation: typed.rotation(&section),
            movement: movement(&section, &typed.movement(&section)),
        };
        refuse_free(&section, &clamp);
        clamp
    };
    top.elements("clamps", typed).map(clamp).collect()
}

/// Rejects a displacement or rotation of a degree of freedom that the clamp does not hold.
fn refuse_free(section: &Section<'_>, clamp: &Clamp) {
    let places = [
        ("offset", clamp.offset, Hold::Frame, "no position"),
        ("rotation", clamp.rotation, Hold::Position, "no frame"),
    ];
    for (key, vector, hold, what) in places {
        if clamp.hold == hold && vector != [0.0; 3] {
            section.fault(key, format!("the clamp holds {what}; leave the key out"));
        }
    }
}
