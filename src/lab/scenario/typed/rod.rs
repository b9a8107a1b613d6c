//! Rods as typed.

use super::section::{CrossSection, Profile, RodSection};
use super::shape::{NaturalShape, Shape};
use crate::scenario::declaration::keys;
use crate::scenario::section::{FINITE, NON_NEGATIVE, POISSONS_RATIO, POSITIVE};
use crate::scenario::tables::StiffnessKeys;
use crate::scenario::units::{
    Angle, AngularVelocity, Curvature, Density, Dimensionless, Force, Frequency, Length, Pressure,
    Time, Twist, Velocity, Viscosity,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

keys! {
    /// An elastic material, which may be viscous or yield.
    table Material "material" {
        /// Young's modulus E, greater than 0.
        youngs_modulus: number(Pressure, POSITIVE) required,
        /// Poisson's ratio ν, greater than −1 and at most 0.5 (incompressible).
        poissons_ratio: number(Dimensionless, POISSONS_RATIO) required,
        /// Density ρ, greater than 0.
        density: number(Density, POSITIVE) required,
        /// Viscosity η of stretching: the stress is E ε + η dε/dt (Kelvin and Voigt), and moments of bending and twisting are
        /// damped in the same proportion η/E. Not with the scheme "implicit-midpoint". Default: 0.
        viscosity: number(Viscosity, NON_NEGATIVE) optional,
        /// Instead of the viscosity, the loss factor tan δ = 2π f η/E at the frequency `loss_frequency`.
        loss_factor: number(Dimensionless, NON_NEGATIVE) optional,
        /// Frequency f at which the material has its `loss_factor`.
        loss_frequency: number(Frequency, POSITIVE) optional,
        /// Relaxing modulus E₁ of a standard linear solid: under sudden strain the material has
        /// the modulus E + E₁, after relaxation E. Bending and twisting relax in the same
        /// proportion. Needs `relaxation_time`; not with the scheme "implicit-midpoint". Default:
        /// 0.
        relaxing_modulus: number(Pressure, POSITIVE) optional,
        /// Relaxation time τ in which the stress of `relaxing_modulus` falls to 1/e at constant strain, greater than 0.
        relaxation_time: number(Time, POSITIVE) optional,
        /// Yield stress σ_y, greater than 0: bending and twisting beyond it are plastic, so that a wire keeps its bend. Not
        /// with viscosity, relaxation, `sections`, actuation, rigid joints, and the scheme "implicit-midpoint". Default: no yielding.
        yield_stress: number(Pressure, POSITIVE) optional,
        /// Tangent modulus E_t beyond the yield stress (linear kinematic hardening), less than Young's modulus. Default: 0,
        /// perfectly plastic.
        tangent_modulus: number(Pressure, NON_NEGATIVE) optional,
    }
}

keys! {
    /// One rod of a scene.
    table Rod "rod" {
        /// Name of the rod for clamps, loads and results: letters, digits, `_` and `-`. Default:
        /// "rod_1", "rod_2", ...
        name: raw(String) raw,
        /// Radius of the surface that touches other rods and the fluid, and of a circular cross-section.
        /// Default for a rectangle: half its smaller side.
        radius: number(Length, POSITIVE) required,
        /// Number of edges of the rod. Default for points: as many as their polyline has.
        edges: raw(i64) raw,
        /// Whether the last node is joined to the first. Default: true for a ring, else false.
        closed: raw(bool) raw,
        /// Whether the rod is a rigid obstacle that stays where it is placed.
        held: flag() default(false),
        /// The placed shape of the rod.
        shape: raw(Shape) raw,
        /// The natural shape, without stress: "as-placed" (the default), "straight", or a table
        /// with a `kind`.
        natural_shape: raw(NaturalShape) raw,
        /// Natural curvatures [a, b] about the first and the second material director, m₁ and m₂;
        /// the natural shape is then an arc or helix, independent of the placed shape. Along it
        /// the tangent t turns by dt/ds = (a m₁ + b m₂) × t = b m₁ − a m₂: a positive b bends the
        /// rod towards m₁, a positive a away from m₂. `explain rods.director` has a drawing.
        /// Default: the curvatures of `natural_shape`.
        natural_curvature: numbers(Curvature, 2, FINITE) optional,
        /// Natural twist of the material frame per length. Default: 0 with a natural curvature,
        /// else the twist of `natural_shape`.
        natural_twist: number(Twist, FINITE) optional,
        /// Total twist put into the placed rod from its first to its last edge.
        twist: number(Angle, FINITE) default(0.0),
        /// Tension T in the placed rod. The rod begins stretched by the strain T/EA, so its
        /// natural length is the placed length over 1 + T/EA, and it pulls on the clamps that hold
        /// its ends. A negative T compresses the rod. Density, section, natural curvature and
        /// twist are those without stress.
        pretension: number(Force, FINITE) default(0.0),
        /// Direction of the first material director m₁ on the first edge; only the component
        /// normal to the edge is used. Matters for rectangles, natural curvature and unequal
        /// bending stiffnesses. Default: any normal.
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
        director: direction() optional,
        /// Material of this rod; its keys override those of the common [material].
        #[serde(default)]
        material: tables(Material) raw,
        /// Shape of the cross-section: "circle" (the default) or a table with a `kind`.
        cross_section: raw(CrossSection) raw,
        /// Stiffnesses that replace the values derived from material and cross-section.
        #[serde(default)]
        stiffness: tables(StiffnessKeys) raw,
        /// Parts of the rod with their own cross-section, material or natural curvature, in the
        /// order of the arc length: steps, tapers, hollow parts. Where sections meet, the stiffness
        /// is right to second order in the edge length; joints need no nodes. Not with
        /// inertia = "consistent", hollow tubes around the rod and, where the radius varies,
        /// regularized Stokeslets.
        #[serde(default)]
        sections: tables(Vec<RodSection>) raw,
        /// Radius over the arc length, instead of `sections`.
        profile: raw(Profile) raw,
        /// Friction coefficient of the rod with all that it touches; with a body that has a
        /// coefficient of its own, the geometric mean of both. Needs [contact]. Default: that of
        /// the plane or obstacle, or `contact.friction`.
        friction: number(Dimensionless, NON_NEGATIVE) optional,
        /// How the inertia of edges is assigned to nodes. "lumped": half to each node, with errors
        /// of vibrations of second order in the edge length. "consistent": the velocity is linear
        /// along each edge, with errors of fourth order for straight rods. "consistent" also
        /// changes strains and the weights of vertices beside clamps, even in equilibria; the
        /// guide's page `accuracy` has the numbers. "auto" (the default): "consistent" for
        /// naturally straight rods of a `scene` without sections, sheaths, contact and fluid, else
        /// "lumped".
        inertia: word(InertiaChoice) default(InertiaChoice::Auto),
        /// Velocity of the rod at time zero. Default: at rest.
        velocity: vector(Velocity) default([0.0; 3]),
        /// Angular velocity about the rod's centroid at time zero. This velocity moves the nodes;
        /// the rod does not spin about its own centreline.
        angular_velocity: vector(AngularVelocity) default([0.0; 3]),
    }
}

/// How the inertia of edges is assigned to nodes, with an automatic choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum InertiaChoice {
    #[default]
    /// Chosen by the rod and the contents of the scene.
    Auto,
    /// Half of the inertia of an edge at each of its nodes.
    Lumped,
    /// Velocity that is linear along each edge.
    Consistent,
}
