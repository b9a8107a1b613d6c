//! Friction coefficients of rods of their own.

use super::continuation::{NO_FRICTION, is_at_rest};
use crate::scenario::resolved::{Contact, Plane, Time};
use crate::scenario::section::Section;
use crate::scenario::typed::{Rod, ScenarioFile};

/// Rejects friction of rods without contact, in equilibria, and on planes with friction by
/// direction.
pub fn refuse(
    top: &Section<'_>,
    file: &ScenarioFile,
    contact: &Contact,
    time: &Time,
    planes: &[Plane],
) {
    let is_directed = planes.iter().any(|plane| plane.directed_friction.is_some());
    let fault = |section: &Section<'_>, friction: f64| {
        if *contact == Contact::None {
            let message =
                "without a [contact] table rods pass through everything; add one, or leave it out";
            section.fault("friction", message);
        } else if is_at_rest(time) && friction > 0.0 {
            section.fault("friction", NO_FRICTION);
        } else if is_directed {
            let message = "a plane has `directed_friction`, which needs rods without friction of their own; leave one of both out";
            section.fault("friction", message);
        }
    };
    let judge = |section: &Section<'_>, rod: &Rod| {
        if let Some(friction) = rod.friction(section) {
            fault(section, friction);
        }
        for (below, one) in section.elements("sections", &rod.sections) {
            if let Some(friction) = one.friction(&below) {
                fault(&below, friction);
            }
        }
    };
    for (section, rod) in top.elements("rods", &file.rods) {
        judge(&section, rod);
    }
    for (section, network) in top.elements("networks", &file.networks) {
        if let Some(rod) = &network.rod {
            judge(&section.below("rod"), rod);
        }
    }
}
