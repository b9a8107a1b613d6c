//! Resolved rods: material, cross-section, shape.

use super::section::{CrossSection, RodSection};
use crate::scenario::tables::Stiffness;
use schemars::JsonSchema;
use serde::ser::SerializeMap;
use serde::{Deserialize, Serialize, Serializer};

/// One rod.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rod {
    /// Name for clamps, loads and results.
    pub name: String,
    /// Radius of the contact and fluid surface, m.
    pub radius: f64,
    /// Number of edges.
    pub edges: usize,
    /// Whether the last node is joined to the first.
    pub closed: bool,
    /// Whether the rod is a rigid obstacle.
    pub held: bool,
    /// The placed shape.
    pub shape: Shape,
    /// The shape without stress.
    pub natural_shape: NaturalShape,
    /// Total twist put into the placed rod, rad.
    pub twist: f64,
    /// Tension in the placed rod, N.
    #[serde(skip_serializing_if = "is_zero")]
    pub pretension: f64,
    /// Direction of the first material director on the first edge.
    pub director: Option<[f64; 3]>,
    /// Material.
    pub material: Material,
    /// Shape of the cross-section.
    pub cross_section: CrossSection,
    /// Stiffness of the cross-section, derived or given.
    pub stiffness: Stiffness,
    /// Parts with their own sections.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sections: Vec<RodSection>,
    /// Own friction coefficient; `None`: that of the bodies that it touches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<f64>,
    /// How the inertia of edges is assigned to nodes.
    pub inertia: Inertia,
    /// Velocity at time zero, m/s.
    pub velocity: [f64; 3],
    /// Angular velocity about the centroid at time zero, rad/s.
    pub angular_velocity: [f64; 3],
}

impl Rod {
    /// Smallest radius, m.
    pub fn least_radius(&self) -> f64 {
        let sections = self.sections.iter();
        let radii = sections.flat_map(|section| [section.radius, section.end_radius]);
        radii.fold(self.radius, f64::min)
    }
}

/// How the inertia of edges is assigned to nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Inertia {
    /// Half of an edge at each of its nodes.
    Lumped,
    /// Edges whose velocity is linear from node to node.
    Consistent,
}

/// An elastic material, which may be viscous or yield.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Material {
    /// Young's modulus E, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio ν.
    pub poissons_ratio: f64,
    /// Density ρ, kg/m³.
    pub density: f64,
    /// Viscosity η of stretching, Pa s.
    #[serde(skip_serializing_if = "is_zero")]
    pub viscosity: f64,
    /// Modulus that relaxes, Pa.
    #[serde(skip_serializing_if = "is_zero")]
    pub relaxing_modulus: f64,
    /// Relaxation time, s; 0 without relaxation.
    #[serde(skip_serializing_if = "is_zero")]
    pub relaxation_time: f64,
    /// Yield stress, Pa; 0 if the material does not yield.
    #[serde(skip_serializing_if = "is_zero")]
    pub yield_stress: f64,
    /// Tangent modulus beyond it, Pa.
    #[serde(skip_serializing_if = "is_zero")]
    pub tangent_modulus: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

impl Material {
    /// Retardation time η/E, s.
    pub fn retardation_time(&self) -> f64 {
        self.viscosity / self.youngs_modulus
    }
}

/// Sense of a helix.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Handedness {
    /// Like an ordinary screw.
    #[default]
    Right,
    /// Mirror image of a right-handed helix.
    Left,
}

/// A curve in space.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Shape {
    /// A straight line.
    Straight {
        /// First point, m.
        start: [f64; 3],
        /// Last point, m.
        end: [f64; 3],
    },
    /// A helix about the line through `centre` along `axis`.
    Helix {
        /// Point of the axis nearest to the first point of the helix, m.
        centre: [f64; 3],
        /// Direction of the axis, a unit vector.
        axis: [f64; 3],
        /// Radius of the helix, m.
        radius: f64,
        /// Advance along the axis per turn, m.
        pitch: f64,
        /// Length along the axis, m.
        length: f64,
        /// Sense of the helix.
        handedness: Handedness,
        /// Angle of the first point about the axis, rad, from the direction of x (of y about an axis along x).
        phase: f64,
    },
    /// A chain that hangs between two points.
    Catenary {
        /// First point, m.
        start: [f64; 3],
        /// Last point, m.
        end: [f64; 3],
        /// Length, m.
        length: f64,
        /// Direction in which it hangs, a unit vector.
        down: [f64; 3],
    },
    /// A slack rod between two points, in a circular arc.
    Slack {
        /// First point, m.
        start: [f64; 3],
        /// Last point, m.
        end: [f64; 3],
        /// Total length of its edges, m.
        length: f64,
        /// Direction from the line between the ends to the middle of the rod, a unit vector normal
        /// to that line.
        towards: [f64; 3],
    },
    /// A rod coiled flat, from its inner end outwards.
    Coil {
        /// Middle of the coil, m.
        centre: [f64; 3],
        /// Unit vector about which the rod winds.
        normal: [f64; 3],
        /// Distance of its inner end from the centre, m.
        inner_radius: f64,
        /// Distance of adjacent turns, m.
        spacing: f64,
        /// Total length of its edges, m.
        length: f64,
        /// Angle of the inner end about the normal, rad, from the direction of x (of y about a normal along x).
        phase: f64,
    },
    /// An arc of a circle.
    Arc {
        /// First point, m.
        start: [f64; 3],
        /// Direction at the first point, a unit vector.
        tangent: [f64; 3],
        /// Unit vector about which the arc turns, normal to `tangent`.
        normal: [f64; 3],
        /// Radius, m.
        radius: f64,
        /// Angle turned, rad.
        angle: f64,
    },
    /// A closed circle.
    Ring {
        /// Centre, m.
        centre: [f64; 3],
        /// Unit normal of the plane of the ring, which runs counter-clockwise about it.
        normal: [f64; 3],
        /// Radius, m.
        radius: f64,
    },
    /// A polyline, resampled to equal arc lengths if the number of edges differs.
    Points {
        /// The corners, m.
        points: Vec<[f64; 3]>,
    },
}

impl Shape {
    /// Two unit vectors that form a right-handed basis with the unit vector `axis`. Angles about
    /// the axis count from the first one, which is the component of x normal to the axis, or of y
    /// if the axis is along x.
    pub fn normal_plane(axis: [f64; 3]) -> [[f64; 3]; 2] {
        let towards = if axis[0].abs() > 1.0 - 1e-9 { 1 } else { 0 };
        let along = axis[towards];
        let mut first = axis.map(|component| -along * component);
        first[towards] += 1.0;
        let norm = first.iter().map(|c| c * c).sum::<f64>().sqrt();
        let first = first.map(|component| component / norm);
        let cross = |i: usize, j: usize| axis[i] * first[j] - axis[j] * first[i];
        [first, [cross(1, 2), cross(2, 0), cross(0, 1)]]
    }
}

/// The shape without stress.
#[derive(Clone, Debug, PartialEq)]
pub enum NaturalShape {
    /// Curvature, twist and lengths of the placed rod.
    AsPlaced,
    /// Straight and untwisted, with the placed edge lengths.
    Straight,
    /// Constant material curvatures and twist, with the placed edge lengths.
    Curved {
        /// Natural curvatures κ̃¹, κ̃², 1/m.
        curvature: [f64; 2],
        /// Natural twist, rad/m.
        twist: f64,
    },
    /// Curvature, twist and lengths of another curve.
    Curve(Shape),
    /// Curvature and twist over the natural arc length.
    Strains(Strains),
}

/// Natural curvature and twist over the natural arc length, in rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Strains {
    /// Natural arc lengths, starting at 0, m.
    pub arc_length: Vec<f64>,
    /// Natural curvatures about the first material director, 1/m.
    pub curvature_1: Vec<f64>,
    /// Natural curvatures about the second material director, 1/m.
    pub curvature_2: Vec<f64>,
    /// Natural twist, rad/m.
    pub twist: Vec<f64>,
}

impl Serialize for NaturalShape {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::AsPlaced => serializer.serialize_str("as-placed"),
            Self::Straight => serializer.serialize_str("straight"),
            Self::Curved { curvature, twist } => {
                let mut table = serializer.serialize_map(Some(3))?;
                table.serialize_entry("kind", "curved")?;
                table.serialize_entry("curvature", curvature)?;
                table.serialize_entry("twist", twist)?;
                table.end()
            }
            Self::Curve(shape) => shape.serialize(serializer),
            Self::Strains(strains) => {
                let mut table = serializer.serialize_map(Some(5))?;
                table.serialize_entry("kind", "strains")?;
                table.serialize_entry("arc_length", &strains.arc_length)?;
                table.serialize_entry("curvature_1", &strains.curvature_1)?;
                table.serialize_entry("curvature_2", &strains.curvature_2)?;
                table.serialize_entry("twist", &strains.twist)?;
                table.end()
            }
        }
    }
}
