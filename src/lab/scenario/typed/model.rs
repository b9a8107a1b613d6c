//! Models, time, solver, output and builders as typed.

use crate::scenario::quantity::Quantity;
use crate::scenario::units::{self, Dimensionless, Length, Velocity, Viscosity};
use schemars::JsonSchema;
use serde::Deserialize;

/// Rods that a builder makes.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "builder_rod")]
pub struct BuilderRod {
    /// Radius of each rod.
    pub radius: Option<Quantity<Length>>,
    /// Number of nodes of each rod, the hook's included.
    pub nodes: Option<i64>,
}

/// Contact between rods and with planes.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "contact")]
pub struct Contact {
    /// "imc" (the default here: the implicit contact model, thesis 2.2, a stiff penalty), "ipc" (incremental
    /// potential contact: a barrier that surfaces never pass), "complementarity" (rigid contact that truly
    /// sticks, thesis 3.3; dynamic runs with implicit Euler only) or "none".
    pub model: Option<ContactModel>,
    /// Coulomb friction coefficient. Default: 0.
    pub friction: Option<Quantity<Dimensionless>>,
    /// Distance δ beyond the surfaces at which force begins, at most the smallest radius. Smaller is more
    /// exact and stiffer; "complementarity" only looks so far for contacts. Default: a hundredth of the
    /// smallest radius.
    pub distance_tolerance: Option<Quantity<Length>>,
    /// Sliding slower than this counts as sticking, so that what sticks creeps with a part of it: an eighth where it bears
    /// three quarters of the friction that it could, a fifth at nine tenths. Not with "complementarity". Default:
    /// √(a h)/1000, with the least radius h and the gravity a (without any 10 m/s², and at most 1e-4 m/s), or a tenth of the
    /// fastest straight motion of a clamp where that is less. `rodlab check` prints how far that creeps.
    pub slip_tolerance: Option<Quantity<Velocity>>,
    /// Factor of the adaptive contact stiffness. "imc": stiffness over the largest force near contact, in m, 1e8 times the
    /// radius of the thinnest rod by default: 1e5 for 1 mm. "ipc": force that is borne at a gap of δ/2 over the largest force near contact, 1 by default.
    pub stiffness_factor: Option<Quantity<Dimensionless>>,
    /// Penetration that ends the run, as a fraction of the sum of the two radii, between 0 and 1; not with
    /// "ipc". Default: 0.05.
    pub maximum_penetration: Option<Quantity<Dimensionless>>,
}

/// Contact models.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum ContactModel {
    /// The implicit contact model (thesis 2.2–2.3).
    Imc,
    /// Incremental potential contact (thesis Eq. 2.1).
    Ipc,
    /// Rigid contact by Signorini's and Coulomb's laws (thesis 3.3).
    Complementarity,
    /// Everything passes through.
    None,
}

/// The surrounding fluid, at low Reynolds number.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "fluid")]
pub struct Fluid {
    /// "rss" (the default here: regularized Stokeslet segments, every node feels every edge, and the wall if there is a
    /// plane: see planes.wall), "resistive" (local drag coefficients, cheap, no walls) or "none".
    pub model: Option<FluidModel>,
    /// Dynamic viscosity, greater than 0.
    pub viscosity: Option<Quantity<Viscosity>>,
    /// Regularisation of "rss" as a multiple of the rod radius. 1.02 is that of the thesis; 1.65 gives the drag of a slender
    /// cylinder, and matters near a wall. Default: 1.65 with a plane that is a wall (see planes.wall), otherwise 1.02.
    pub regularization: Option<Quantity<Dimensionless>>,
    /// Relative error allowed in the drag of "rss" from approximating the flow of distant nodes, 1e-6 to
    /// 1e-2, or 0 for none. Scenes of less than a thousand nodes, and those beside a wall (at most 5000 nodes), are exact
    /// whatever it is. Default: 1e-4.
    pub far_field_error: Option<Quantity<Dimensionless>>,
    /// Whether the fluid resists that rods spin about their own axes, by a torque of 4π viscosity radius² spin per length; in
    /// "rss" without a wall what spins also moves the fluid. Default: true, but false for `flagella`, as in the thesis.
    pub spin: Option<bool>,
}

/// Fluid models.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum FluidModel {
    /// Regularized Stokeslet segments (thesis 2.4.1).
    Rss,
    /// Resistive force theory.
    Resistive,
    /// A vacuum.
    None,
}

/// Dynamic, static or along a path of equilibria, and the time steps.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "time")]
pub struct Time {
    /// "dynamic" (the default), "static" (equilibrium by Newton's method without inertia: there is no time, so clamps that
    /// move and loads with a schedule are errors), or
    /// "continuation" (equilibria along a path, with folds, bifurcations and stability; see [continuation]).
    pub mode: Option<Mode>,
    /// "implicit-euler" (first order, damps all oscillations, takes impacts and friction as they are), "implicit-midpoint"
    /// (second order, nearly conserves energy, damps nothing), "backward-differences" (second order, third where drag
    /// rules, damps fast modes), or "auto" (the default): "implicit-euler" where there is contact, otherwise
    /// "backward-differences".
    pub scheme: Option<SchemeChoice>,
    /// Time step, or "auto" to choose it by the local error. Corners of motions and schedules end a step in any case.
    /// Default: a thousandth of the end time.
    pub step: Option<Quantity<units::Time>>,
    /// With step = "auto": local error allowed per step, as a multiple of the rod radius; at most 1. Default: 1e-2.
    pub tolerance: Option<Quantity<Dimensionless>>,
    /// With step = "auto": the largest step. Default: the output interval. Backward differences take at least 200 steps
    /// while a clamp turns once.
    pub maximum_step: Option<Quantity<units::Time>>,
    /// End of the simulated time.
    pub end: Option<Quantity<units::Time>>,
}

/// Time integration schemes, and the choice between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum SchemeChoice {
    /// By what the scene holds.
    Auto,
    /// First order, damps all oscillations.
    ImplicitEuler,
    /// Second order, nearly conserves energy.
    ImplicitMidpoint,
    /// Second order, third where drag rules; damps fast modes.
    BackwardDifferences,
}

/// Modes of a run.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Mode {
    /// Time steps from zero to `end`.
    Dynamic,
    /// Equilibrium, without inertia.
    Static,
    /// Equilibria along a path.
    Continuation,
}

/// Newton's method.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "solver")]
pub struct Solver {
    /// Residual that a correction of Newton's method may leave at any degree of freedom, as a multiple of the largest of
    /// EI/L², loads and contact forces of the same rod; at most 1e-3. Default: 1e-6.
    pub force_tolerance: Option<Quantity<Dimensionless>>,
    /// Last correction allowed, as a multiple of the rod radius; at most 1. Default: 1e-4.
    pub displacement_tolerance: Option<Quantity<Dimensionless>>,
    /// Newton iterations after which a step counts as failed and is halved. Default: 40.
    pub maximum_iterations: Option<i64>,
    /// Smallest step before the run is given up. Default: a millionth of the step; with step = "auto" a millionth of the first
    /// step, which is a thousandth of the largest.
    pub minimum_step: Option<Quantity<units::Time>>,
}

/// What is written, and how often.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "output")]
pub struct Output {
    /// Time between outputs, at least a millionth of the end time. Default: a hundredth of it.
    pub interval: Option<Quantity<units::Time>>,
    /// Whether node positions are written (nodes.csv). Default: true.
    pub nodes: Option<bool>,
    /// Whether velocities, fluid and contact forces of the nodes are written (node_forces.csv). Default:
    /// false.
    pub forces: Option<bool>,
    /// Whether a VTK PolyData series for ParaView is written. Default: false.
    pub vtk: Option<bool>,
}
