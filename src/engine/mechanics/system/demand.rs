//! What a scene may be asked to do, and its forces may refuse.

/// What a scene is asked to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Demand {
    /// To begin where another run ended.
    Start,
    /// To find contact forces by complementarity.
    RigidContact,
    /// To move, with time steps of a scheme.
    ImplicitEuler,
    ImplicitMidpoint,
    BackwardDifferences,
    /// To come to an equilibrium.
    Equilibrium,
    /// To come to the nearest equilibrium, stable or not, of which the energy is judged.
    NearbyEquilibrium,
    /// To follow a path of equilibria.
    Path,
}
