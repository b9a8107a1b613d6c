//! Rods as typed.

use super::kinds::allow_text;
use super::shape::{NaturalShape, Shape};
use crate::scenario::quantity::{Quantity, Vector};
use crate::scenario::units::{
    Angle, AngularVelocity, Curvature, Density, Dimensionless, Force, Frequency, Length, Pressure,
    Rigidity, Time, Twist, Velocity, Viscosity,
};
use schemars::{JsonSchema, Schema};
use serde::Deserialize;

/// A linear elastic material.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "material")]
pub struct Material {
    /// Young's modulus E, greater than 0.
    pub youngs_modulus: Option<Quantity<Pressure>>,
    /// Poisson's ratio ν, greater than −1 and at most 0.5 (incompressible).
    pub poissons_ratio: Option<Quantity<Dimensionless>>,
    /// Density ρ, greater than 0.
    pub density: Option<Quantity<Density>>,
    /// Viscosity η of stretching: the stress is E ε + η dε/dt (Kelvin and Voigt), and moments of bending and twisting are
    /// damped in the same proportion η/E. Not with the scheme "implicit-midpoint". Default: 0.
    pub viscosity: Option<Quantity<Viscosity>>,
    /// Instead of the viscosity, the loss factor tan δ = 2π f η/E at the frequency `loss_frequency`.
    pub loss_factor: Option<Quantity<Dimensionless>>,
    /// Frequency f at which the material has its `loss_factor`.
    pub loss_frequency: Option<Quantity<Frequency>>,
    /// Modulus E₁ that relaxes, of a standard linear solid: strained at once the material has the modulus E + E₁, and after a while
    /// E; bending and twisting relax in the same proportion. Needs `relaxation_time`; not with the scheme "implicit-midpoint".
    /// Default: 0.
    pub relaxing_modulus: Option<Quantity<Pressure>>,
    /// Relaxation time τ in which the stress of `relaxing_modulus` falls to 1/e at constant strain, greater than 0.
    pub relaxation_time: Option<Quantity<Time>>,
}

/// One rod of a scene.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "rod")]
pub struct Rod {
    /// Name by which clamps, loads and results call the rod: letters, digits, `_` and `-`. Default:
    /// "rod_1", "rod_2", ...
    pub name: Option<String>,
    /// Radius of the surface that touches other rods and the fluid, and of a circular cross-section.
    /// Default for a rectangle: half its smaller side.
    pub radius: Option<Quantity<Length>>,
    /// Number of edges into which the rod is cut. Default for points: as many as their polyline has.
    pub edges: Option<i64>,
    /// Whether the last node is joined to the first. Default: true for a ring, else false.
    pub closed: Option<bool>,
    /// Whether the rod is a rigid obstacle that stays where it was placed. Default: false.
    pub held: Option<bool>,
    /// Where the rod is placed.
    pub shape: Option<Shape>,
    /// The shape without stress: "as-placed" (the default), "straight", or a table with a `kind`.
    pub natural_shape: Option<NaturalShape>,
    /// Natural curvatures [a, b] about the first and the second material director, m₁ and m₂; the shape without
    /// stress is then an arc or helix, whatever shape the rod is placed in. Along it the tangent t turns by
    /// dt/ds = (a m₁ + b m₂) × t = b m₁ − a m₂: a positive b bends the rod towards m₁, a positive a away from m₂.
    /// `explain rods.director` has a drawing. Default: that of the natural shape.
    pub natural_curvature: Option<[Quantity<Curvature>; 2]>,
    /// Natural twist of the material frame per length. Default: 0 beside a natural curvature, else that of the natural shape.
    pub natural_twist: Option<Quantity<Twist>>,
    /// Total twist put into the placed rod from its first to its last edge. Default: 0.
    pub twist: Option<Quantity<Angle>>,
    /// Tension T in the placed rod: it begins stretched by the strain T/EA, so that its length without stress is that placed
    /// over 1 + T/EA, and pulls on the clamps that hold its ends; negative where it begins pushed together. Density, section,
    /// natural curvature and twist are those without stress. Default: 0.
    pub pretension: Option<Quantity<Force>>,
    /// Direction of the first material director m₁ on the first edge; its part normal to the edge counts.
    /// Matters for rectangles, natural curvature and unequal bending stiffnesses. Default: any normal.
    ///
    /// ```text
    ///          m₂
    ///          ↑
    ///   ┌──────┼──────┐ ┬
    ///   │      ⊙──────┼─┼─→ m₁    ⊙ the tangent t points at the reader; m₂ = t × m₁
    ///   └─────────────┘ ┴ thickness
    ///   ├─── width ───┤
    ///
    ///   bending about m₁: EI₁ = E · width · thickness³/12, curvature natural_curvature[0]
    ///   bending about m₂: EI₂ = E · thickness · width³/12, curvature natural_curvature[1]
    /// ```
    ///
    /// A strip that lies flat on the ground has its director parallel to the ground: it sags easily, about m₁.
    pub director: Option<Vector<Dimensionless>>,
    /// Material of this rod; its keys go before those of the common [material].
    #[serde(default)]
    pub material: Material,
    /// Shape of the cross-section: "circle" (the default) or a table with a `kind`.
    pub cross_section: Option<CrossSection>,
    /// Stiffnesses that replace those derived from material and cross-section.
    #[serde(default)]
    pub stiffness: Stiffness,
    /// How edges weigh on their nodes: "lumped", half at either node (vibrations of second order in the edge length);
    /// "consistent", as edges that move linearly from node to node (of fourth order for straight rods), with the strains and
    /// the weights of vertices beside clamps that go with it, in equilibria, too; the guide's page `accuracy` has the numbers;
    /// or "auto" (the default): "consistent" for naturally straight rods of a `scene` without contact and fluid, else
    /// "lumped".
    pub inertia: Option<InertiaChoice>,
    /// Velocity of the rod at time zero. Default: at rest.
    pub velocity: Option<Vector<Velocity>>,
    /// Angular velocity about the rod's centroid at time zero. Default: 0.
    pub angular_velocity: Option<Vector<AngularVelocity>>,
}

/// Shape of a cross-section.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(
    tag = "kind",
    deny_unknown_fields,
    rename = "cross_section",
    transform = plain_cross_sections
)]
pub enum CrossSection {
    /// A full circle of the rod's radius: A = πr², I = πr⁴/4, J = πr⁴/2.
    Circle {},
    /// A full rectangle: I₁ = width · thickness³/12 for bending about the first material director m₁ (an axis along the
    /// width), I₂ = thickness · width³/12 for bending about the second one, m₂.
    Rectangle {
        /// Side along the first material director.
        width: Option<Quantity<Length>>,
        /// Side along the second material director.
        thickness: Option<Quantity<Length>>,
    },
}

/// Adds the cross-sections that need no further keys, as text.
fn plain_cross_sections(schema: &mut Schema) {
    allow_text(schema, &["circle"]);
}

/// How edges weigh on their nodes, and the choice between both.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum InertiaChoice {
    /// By what the rod is and what the scene holds.
    Auto,
    /// Half of an edge at either node.
    Lumped,
    /// Edges that move linearly from node to node.
    Consistent,
}

/// Stiffnesses of a cross-section that replace the derived ones.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "stiffness")]
pub struct Stiffness {
    /// Stretching stiffness EA. Default: that of material and cross-section.
    pub stretching: Option<Quantity<Force>>,
    /// Bending stiffness EI₁ about the first material director. Default: that of material and cross-section.
    pub bending_1: Option<Quantity<Rigidity>>,
    /// Bending stiffness EI₂ about the second material director. Default: that of material and cross-section.
    pub bending_2: Option<Quantity<Rigidity>>,
    /// Twisting stiffness GJ. Default: that of material and cross-section.
    pub twisting: Option<Quantity<Rigidity>>,
}
