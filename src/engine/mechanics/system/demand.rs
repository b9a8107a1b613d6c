//! Demands on a scene, which some of its forces may not support.

/// Demand on a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Demand {
    /// Starting from the final state of another run.
    Start,
    /// Contact forces by complementarity.
    RigidContact,
    /// Time steps of a scheme.
    ImplicitEuler,
    ImplicitMidpoint,
    BackwardDifferences,
    /// A stable equilibrium.
    Equilibrium,
    /// The nearest equilibrium, stable or not, judged by its energy.
    NearbyEquilibrium,
    /// A path of equilibria.
    Path,
}
