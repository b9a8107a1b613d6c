//! Demands on a scene, which its forces may refuse.

/// Demand on a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Demand {
    /// Start at the end of another run.
    Start,
    /// Contact forces by complementarity.
    RigidContact,
    /// Time steps of a scheme.
    ImplicitEuler,
    ImplicitMidpoint,
    BackwardDifferences,
    /// A stable equilibrium.
    Equilibrium,
    /// The nearest equilibrium, stable or not, of which the energy is judged.
    NearbyEquilibrium,
    /// A path of equilibria.
    Path,
}
