//! Friction coefficients that rods have of their own.

use super::continuation::{NO_FRICTION, is_at_rest};
use crate::scenario::quantity::Quantity;
use crate::scenario::resolved::{Contact, Plane, Time};
use crate::scenario::section::Section;
use crate::scenario::typed::{Rod, ScenarioFile};
use crate::scenario::units::Dimensionless;

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
    let fault = |section: &Section<'_>, typed: &Option<Quantity<Dimensionless>>| {
        // A value that is not valid has its fault where the rod is resolved.
        let Some(friction) = typed.as_ref().and_then(|own| own.si().ok()) else {
            return;
        };
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
        fault(section, &rod.friction);
        for (below, one) in section.elements("sections", &rod.sections) {
            fault(&below, &one.friction);
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
