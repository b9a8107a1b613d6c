//! Joints and bodies as resolved.

use crate::scenario::place::Place;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Two nodes that are one point, of which one slides along the rod of the other, or that a spring ties.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Joint {
    /// Name by which messages call it.
    pub name: String,
    /// Names of the two rods.
    pub rods: [String; 2],
    /// Node along each.
    pub at: [Place; 2],
    /// Largest force that it bears, N.
    pub break_at: Option<f64>,
    /// Largest moment that it bears, N m.
    pub break_at_moment: Option<f64>,
    /// What it leaves free.
    #[serde(flatten)]
    pub kind: JointKind,
}

impl Joint {
    /// Whether there is a force or moment under which it breaks.
    pub fn may_break(&self) -> bool {
        self.break_at.is_some() || self.break_at_moment.is_some()
    }
}

/// What a joint leaves free.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum JointKind {
    /// Every rotation.
    Ball,
    /// None.
    Rigid,
    /// Rotation of the second rod about an axis that turns with the first.
    Hinge {
        /// Unit vector, as placed.
        axis: [f64; 3],
        /// Moment per angle of a spring about it, N m/rad.
        stiffness: Option<f64>,
        /// Angle at which that exerts no moment, rad; `None` is as placed.
        rest_angle: Option<f64>,
    },
    /// Every rotation, and moves along the second rod.
    Slide,
    /// Everything, against a force or a moment.
    Spring {
        /// Force per lengthening, N/m.
        stiffness: Option<f64>,
        /// Length without force, m; `None` is the distance as placed.
        rest_length: Option<f64>,
        /// Moment per angle between the material frames, N m/rad.
        turning_stiffness: Option<f64>,
        /// Rotation vector of the second frame against the first without moment, rad; `None` is as placed.
        rest_rotation: Option<[f64; 3]>,
    },
}

impl JointKind {
    /// Whether rods are clamped to a frame that turns with it.
    pub fn turns(&self) -> bool {
        let springs_turn =
            matches!(self, Self::Spring { turning_stiffness, .. } if turning_stiffness.is_some());
        springs_turn || matches!(self, Self::Rigid | Self::Hinge { .. })
    }
}

/// A mass or rigid body at a node.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Body {
    /// Name by which messages call it.
    pub name: String,
    /// Name of the rod.
    pub rod: String,
    /// Node along it.
    pub at: Place,
    /// Mass, kg.
    pub mass: f64,
    /// Its shape, of uniform density.
    pub shape: Option<BodyShape>,
    /// From the node to its centre of mass along the two material directors and the tangent, m; `None` is at the node.
    pub offset: Option<[f64; 3]>,
    /// Instead of a shape, principal moments of inertia about the centre of mass, and axes along the two material directors
    /// and the tangent, kg m².
    pub inertia: Option<[f64; 3]>,
}

impl Body {
    /// Principal moments of inertia about the centre of mass, and axes along the two material directors and the tangent, kg m²;
    /// `None` for a point mass at the node.
    pub fn moments_of_inertia(&self) -> Option<[f64; 3]> {
        let of_shape = self.shape.map(|shape| shape.moments_of_inertia(self.mass));
        let off_node = self.offset.map(|_| [0.0; 3]);
        of_shape.or(self.inertia).or(off_node)
    }

    /// Radius of the ball around the node that it is for contact, m; `None` for a body that touches nothing.
    pub fn ball(&self) -> Option<f64> {
        match self.shape {
            Some(BodyShape::Sphere { radius }) if self.offset.is_none() => Some(radius),
            _ => None,
        }
    }
}

/// Shape of a body, around its centre of mass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum BodyShape {
    /// A sphere.
    Sphere {
        /// Its radius, m.
        radius: f64,
    },
    /// A disk or cylinder about the tangent of the rod.
    Disk {
        /// Its radius, m.
        radius: f64,
        /// Its length along the tangent, m.
        thickness: f64,
    },
    /// A box.
    Box {
        /// Lengths of its sides along the two material directors and the tangent, m.
        size: [f64; 3],
    },
}

impl BodyShape {
    /// Principal moments of inertia of a uniform body of a mass (kg), kg m².
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

/// What joins the rods of a network.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum NetworkJoint {
    /// Balls.
    #[default]
    Ball,
    /// Welds.
    Rigid,
}

/// Which ends of the rods of a network are held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum HeldEnds {
    /// All.
    #[default]
    All,
    /// Those at which ends of two rods meet.
    Corners,
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
