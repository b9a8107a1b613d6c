//! Bodies that rods carry.

use crate::scenario::declaration::keys;
use crate::scenario::section::{NON_NEGATIVE, POSITIVE, Section};
use crate::scenario::units::{Length, Mass, MomentOfInertia};

keys! {
    /// A point mass at a node of a rod, or a rigid body welded to the rod at the node.
    table BodyKeys "body" => Body(index: usize) {
        /// Name for messages. Default: "body 0", "body 1", ...
        name: text() derived(format!("body {index}")),
        /// Name of the rod.
        rod: text("the name of a rod") required,
        /// "start", "end", or the number of a node.
        at: place() required,
        /// Mass of the body.
        mass: number(Mass, POSITIVE) required,
        /// Shape of a body of uniform density, from which its inertia is computed. With
        /// `[contact]` a sphere without `offset` touches rods, planes, obstacles and other
        /// spheres; other shapes have no contact. Default: a point mass.
        shape: table(BodyShapeKeys => BodyShape) optional,
        /// Vector from the node to the centre of mass, with components along the two material
        /// directors and the tangent of the rod at the node. Default: [0, 0, 0].
        offset: vector(Length) optional,
        /// Principal moments of inertia about the centre of mass, instead of a shape. The
        /// principal axes are the two material directors and the tangent of the rod at the node.
        inertia: numbers(MomentOfInertia, 3, NON_NEGATIVE) optional,
    }
}

keys! {
    /// Shape of a body of uniform density, around its centre of mass.
    kinds BodyShapeKeys "body_shape", "kebab-case" => #[derive(Copy)] BodyShape {
        /// A sphere.
        Sphere {
            /// Radius of the sphere.
            radius: number(Length, POSITIVE) required,
        },
        /// A disk, or cylinder, about the tangent of the rod.
        Disk {
            /// Radius of the disk.
            radius: number(Length, POSITIVE) required,
            /// Length of the disk along the tangent.
            thickness: number(Length, NON_NEGATIVE) default(0.0),
        },
        /// A box with sides along the two material directors and the tangent of the rod.
        Box {
            /// Lengths of these sides.
            size: vector(Length, POSITIVE) required,
        },
    }
}

/// Resolves all bodies.
pub fn bodies(top: &Section<'_>, typed: &[BodyKeys]) -> Vec<Body> {
    let bodies = top.elements("bodies", typed).enumerate();
    bodies
        .map(|(index, (section, typed))| body(&section, typed.resolve(&section, index)))
        .collect()
}

/// Checks a body. A zero offset counts as no offset.
fn body(section: &Section<'_>, body: Body) -> Body {
    if body.shape.is_some() && body.inertia.is_some() {
        section.fault("inertia", "give `shape` or `inertia`, not both");
    }
    let moments = body.inertia.unwrap_or_default();
    let sum: f64 = moments.iter().sum();
    let exceeds = |moment: &f64| *moment > 0.5 * sum * (1.0 + 1e-9);
    if let Some(k) = moments.iter().position(exceeds) {
        let message = format!(
            "{:?} kg m² is more than the other two together, {:?} kg m²; no rigid body has such moments",
            moments[k],
            sum - moments[k]
        );
        section.below("inertia").fault(&k.to_string(), message);
    }
    Body {
        offset: body.offset.filter(|offset| *offset != [0.0; 3]),
        ..body
    }
}

impl Body {
    /// Principal moments of inertia about the centre of mass, with axes along the two material
    /// directors and the tangent, kg m²; `None` for a point mass at the node.
    pub fn moments_of_inertia(&self) -> Option<[f64; 3]> {
        let of_shape = self.shape.map(|shape| shape.moments_of_inertia(self.mass));
        let off_node = self.offset.map(|_| [0.0; 3]);
        of_shape.or(self.inertia).or(off_node)
    }

    /// Radius of the ball around the node for contact, m; `None` for a body without contact.
    pub fn ball(&self) -> Option<f64> {
        match self.shape {
            Some(BodyShape::Sphere { radius }) if self.offset.is_none() => Some(radius),
            _ => None,
        }
    }
}

impl BodyShape {
    /// Principal moments of inertia of a uniform body with a mass (kg), kg m².
    fn moments_of_inertia(&self, mass: f64) -> [f64; 3] {
        match *self {
            Self::Sphere { radius } => [0.4 * mass * radius * radius; 3],
            Self::Disk { radius, thickness } => {
                let across = mass * (0.25 * radius * radius + thickness * thickness / 12.0);
                [across, across, 0.5 * mass * radius * radius]
            }
            Self::Box { size } => {
                let squares: f64 = size.iter().map(|side| side * side).sum();
                size.map(|side| mass * (squares - side * side) / 12.0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_inertia_are_those_of_the_textbooks() {
        let sphere = BodyShape::Sphere { radius: 0.3 };
        assert_eq!(sphere.moments_of_inertia(2.0), [0.4 * 2.0 * 0.3 * 0.3; 3]);
        let sums = |moments: [f64; 3], expected: [f64; 3]| {
            for (found, expected) in moments.into_iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 1e-14, "{moments:?}");
            }
        };
        let (radius, thickness) = (0.3, 0.2);
        let disk = BodyShape::Disk { radius, thickness };
        // m (3 R² + t²)/12 across, m R²/2 about the axis.
        let across = 2.0 * (3.0 * 0.09 + 0.04) / 12.0;
        sums(disk.moments_of_inertia(2.0), [across, across, 0.09]);
        let size = [0.1, 0.2, 0.3];
        let cuboid = BodyShape::Box { size };
        // m (b² + c²)/12 about the side a.
        let expected = [0.04 + 0.09, 0.01 + 0.09, 0.01 + 0.04].map(|squares| squares / 6.0);
        sums(cuboid.moments_of_inertia(2.0), expected);
    }
}
