//! Rigid half spaces.

use crate::scenario::declaration::keys;
use crate::scenario::section::{NON_NEGATIVE, Section};
use crate::scenario::units::{Dimensionless, Length};

keys! {
    /// A rigid half space that rods may touch.
    table PlaneKeys "plane" => Plane() {
        /// Any point of the surface. Default: the origin.
        point: vector(Length) default([0.0; 3]),
        /// Direction out of the surface into the free side.
        normal: direction() default([0.0, 0.0, 1.0]),
        /// Friction coefficient between plane and rods. Default: `contact.friction`.
        friction: number(Dimensionless, NON_NEGATIVE) optional,
        /// Friction coefficients between plane and rods by the direction of sliding relative to the
        /// rod, instead of `friction`. For the models "imc" and "ipc". Default: the same in all
        /// directions.
        #[serde(skip_serializing_if = "Option::is_none")]
        directed_friction: table(DirectedFrictionKeys => DirectedFriction) optional,
        /// Whether the plane is a no-slip wall of the flow, at which the fluid of the model "rss"
        /// is at rest. At most one plane can be a wall. With false the flow passes through the
        /// plane. Default: true with the model "rss", otherwise false.
        wall: flag() optional,
    }
}

keys! {
    /// Friction coefficients by the direction in which a rod slides.
    table DirectedFrictionKeys "directed_friction" => #[derive(Copy)] DirectedFriction() {
        /// Coefficient along the rod, towards its end: the direction of increasing node numbers.
        forwards: number(Dimensionless, NON_NEGATIVE) required,
        /// Coefficient along the rod, towards its start.
        backwards: number(Dimensionless, NON_NEGATIVE) required,
        /// Coefficient across the rod.
        sideways: number(Dimensionless, NON_NEGATIVE) required,
    }
}

impl DirectedFriction {
    /// Whether there is friction in any direction.
    pub fn rubs(&self) -> bool {
        [self.forwards, self.backwards, self.sideways]
            .iter()
            .any(|coefficient| *coefficient > 0.0)
    }
}

/// Resolves all planes.
pub fn planes(top: &Section<'_>, typed: &[PlaneKeys]) -> Vec<Plane> {
    let planes = top.elements("planes", typed);
    planes
        .map(|(section, typed)| {
            let plane = typed.resolve(&section);
            if plane.friction.is_some() && plane.directed_friction.is_some() {
                section.fault(
                    "directed_friction",
                    "this table and `friction` exclude each other; leave one of them out",
                );
            }
            plane
        })
        .collect()
}
