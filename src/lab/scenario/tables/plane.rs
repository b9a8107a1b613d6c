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
        /// Whether the plane is a no-slip wall of the flow, at which the fluid of the model "rss"
        /// is at rest. At most one plane can be a wall. With false the flow passes through the
        /// plane. Default: true with the model "rss", otherwise false.
        wall: flag() optional,
    }
}

/// Resolves all planes.
pub fn planes(top: &Section<'_>, typed: &[PlaneKeys]) -> Vec<Plane> {
    let planes = top.elements("planes", typed);
    planes
        .map(|(section, typed)| typed.resolve(&section))
        .collect()
}
