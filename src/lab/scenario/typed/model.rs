//! Models, time and builders as typed.

use crate::scenario::declaration::keys;
use crate::scenario::resolved::{FrictionAt, Geometry};
use crate::scenario::section::{
    DISPLACEMENT_TOLERANCE, FAR_FIELD_ERROR, FRACTION, NON_NEGATIVE, POSITIVE,
};
use crate::scenario::tables::{Flow, FlowKeys};
use crate::scenario::units::{self, Density, Dimensionless, Length, Velocity, Viscosity};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

keys! {
    /// Rods built by a builder.
    table BuilderRod "builder_rod" {
        /// Radius of each rod.
        radius: number(Length, POSITIVE) required,
        /// Number of nodes of each rod, including those of the hook.
        nodes: raw(i64) raw,
    }
}

keys! {
    /// Contact between rods and with planes.
    table Contact "contact" {
        /// "imc" (the default here: the implicit contact model, thesis 2.2, a stiff penalty), "ipc" (incremental
        /// potential contact: a barrier that surfaces never pass), "complementarity" (rigid contact that truly
        /// sticks, thesis 3.3; dynamic runs with implicit Euler only) or "none".
        model: word(ContactModel) default(ContactModel::Imc),
        /// Coulomb friction coefficient.
        friction: number(Dimensionless, NON_NEGATIVE) default(0.0),
        /// "centreline" (the default: friction acts on the centrelines, as in the thesis, and rods
        /// do not roll), or "surface" (friction acts where surfaces touch, opposes the velocity of
        /// the surfaces, and turns the rods: they roll, and drive each other like gears; with
        /// "imc" and "ipc").
        friction_at: word(FrictionAt) default(FrictionAt::Centreline),
        /// "polyline" (the default: rods touch as straight edges between their nodes), or "smooth"
        /// (rods touch as smooth curves through their nodes; with "imc" and "ipc", and friction on
        /// the centrelines).
        geometry: word(Geometry) default(Geometry::Polyline),
        /// Distance δ beyond the surfaces at which force begins, at most the smallest radius.
        /// Smaller is more exact and stiffer. With "complementarity" it is only the distance
        /// within which contacts are searched. Default: a hundredth of the smallest radius.
        distance_tolerance: number(Length, POSITIVE) derived,
        /// Sliding speed below which a contact sticks. Sticking contacts creep at a fraction of
        /// it: an eighth if they transmit three quarters of the largest friction, a fifth at nine
        /// tenths. Not with "complementarity". Default: √(a h)/1000, with the least radius h and
        /// the gravity a, or a tenth of the fastest straight motion of a clamp if that is less.
        /// Without gravity a is 10 m/s², and the default at most 1e-4 m/s. `rodlab check` prints
        /// the creep.
        slip_tolerance: number(Velocity, POSITIVE) derived,
        /// Factor of the adaptive contact stiffness. "imc": stiffness over the largest force near
        /// contact, in m; by default 1e8 times the radius of the thinnest rod, 1e5 for 1 mm.
        /// "ipc": contact force at a gap of δ/2 over the largest force near contact; by default 1.
        stiffness_factor: number(Dimensionless, POSITIVE) derived,
        /// Penetration that ends the run, as a fraction of the sum of the two radii, between 0 and 1; not with
        /// "ipc".
        maximum_penetration: number(Dimensionless, FRACTION) default(0.05),
    }
}

/// Contact models.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum ContactModel {
    /// The implicit contact model (thesis 2.2–2.3).
    #[default]
    Imc,
    /// Incremental potential contact (thesis Eq. 2.1).
    Ipc,
    /// Rigid contact by Signorini's and Coulomb's laws (thesis 3.3).
    Complementarity,
    /// No contact: everything passes through.
    None,
}

keys! {
    /// The surrounding fluid: a viscous one at low Reynolds number, or air and water at large ones.
    table Fluid "fluid" {
        /// "rss" (the default here: regularized Stokeslet segments, in which every edge acts on
        /// every node; a plane can be a wall, see planes.wall), "resistive" (local drag
        /// coefficients, cheap, no walls), "quadratic" (drag of air and water at large Reynolds
        /// numbers) or "none".
        model: word(FluidModel) default(FluidModel::Rss),
        /// Dynamic viscosity, greater than 0, of "rss" and "resistive".
        viscosity: number(Viscosity, POSITIVE) required,
        /// Regularisation of "rss" as a multiple of the rod radius. The thesis uses 1.02; 1.65
        /// gives the drag of a slender cylinder, which matters near a wall. Default: 1.65 with a
        /// plane that is a wall (see planes.wall), otherwise 1.02.
        regularization: number(Dimensionless, POSITIVE) derived,
        /// Relative error allowed in the drag of "rss" from approximating the flow of distant nodes, 1e-6 to
        /// 1e-2, or 0 for none. Scenes of less than a thousand nodes, and those beside a wall (at most 5000 nodes), are always
        /// exact.
        far_field_error: number(Dimensionless, FAR_FIELD_ERROR) default(1e-4),
        /// Whether the fluid resists rotation of rods about their own axes, with a torque of 4π
        /// viscosity radius² spin per length. In "rss" without a wall spinning rods also move the
        /// fluid. Default: true, but false for `flagella`, as in the thesis.
        spin: raw(bool) raw,
        /// Density of the fluid of "quadratic".
        density: number(Density, POSITIVE) required,
        /// Coefficient of the "quadratic" drag normal to rods, whose force per length is
        /// ½ density · diameter · normal_drag · (normal velocity)². 1.2 holds for smooth round
        /// rods at Reynolds numbers from 1e3 to 1e5.
        normal_drag: number(Dimensionless, NON_NEGATIVE) default(1.2),
        /// Coefficient of the "quadratic" drag along rods, whose force per length is ½ density ·
        /// π · diameter · tangential_drag · (tangential velocity)².
        tangential_drag: number(Dimensionless, NON_NEGATIVE) default(0.01),
        /// Coefficient of the added mass of "quadratic" normal to rods, over the mass of the
        /// displaced fluid; 1 for round rods.
        added_mass: number(Dimensionless, NON_NEGATIVE) default(1.0),
        /// Flow of the fluid without rods. Default: at rest.
        flow: table(FlowKeys => Flow) optional,
    }
}

/// Fluid models.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum FluidModel {
    /// Regularized Stokeslet segments (thesis 2.4.1).
    #[default]
    Rss,
    /// Resistive force theory.
    Resistive,
    /// Drag quadratic in the velocity.
    Quadratic,
    /// A vacuum.
    None,
}

keys! {
    /// Dynamic, static or along a path of equilibria, and the time steps.
    table Time "time" {
        /// "dynamic" (the default), "static" (equilibrium by Newton's method without inertia: there is no time, so clamps that
        /// move and loads with a schedule are errors), or
        /// "continuation" (equilibria along a path, with folds, bifurcations and stability; see [continuation]).
        mode: word(Mode) default(Mode::Dynamic),
        /// "implicit-euler" (first order, damps all oscillations, handles impacts and friction),
        /// "implicit-midpoint" (second order, nearly conserves energy, damps nothing),
        /// "backward-differences" (second order, third if drag dominates, damps fast modes), or
        /// "auto" (the default): "implicit-euler" with contact, otherwise "backward-differences".
        scheme: word(SchemeChoice) default(SchemeChoice::Auto),
        /// Time step, or "auto" to choose it by the local error. Corners of motions and schedules end a step in any case.
        /// Default: a thousandth of the end time.
        step: number(units::Time, POSITIVE) derived,
        /// With step = "auto": local error allowed per step, as a multiple of the rod radius; at most 1.
        tolerance: number(Dimensionless, DISPLACEMENT_TOLERANCE) default(1e-2),
        /// With step = "auto": the largest step. Default: the output interval. Backward
        /// differences take at least 200 steps per turn of a clamp.
        maximum_step: number(units::Time, POSITIVE) derived,
        /// End of the simulated time.
        end: number(units::Time, POSITIVE) required,
        /// "placed" (the default: the motion begins with the rods as placed), or "equilibrium"
        /// (the rods first come to rest at time zero, without friction, and the motion begins
        /// there).
        begin: word(Begin) default(Begin::Placed),
    }
}

/// Configurations in which a motion can begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Begin {
    /// As placed.
    #[default]
    Placed,
    /// The equilibrium at time zero.
    Equilibrium,
}

/// Time integration schemes, and the choice between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum SchemeChoice {
    /// Chosen by the contents of the scene.
    #[default]
    Auto,
    /// First order, damps all oscillations.
    ImplicitEuler,
    /// Second order, nearly conserves energy.
    ImplicitMidpoint,
    /// Second order, third if drag dominates; damps fast modes.
    BackwardDifferences,
}

/// Modes of a run.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Mode {
    /// Time steps from zero to `end`.
    #[default]
    Dynamic,
    /// Equilibrium, without inertia.
    Static,
    /// Equilibria along a path.
    Continuation,
}
