//! Errors of the fluid.

/// Reason why the drag could not be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FluidError {
    /// The description of the fluid or of a filament is wrong.
    #[error("{0}")]
    BadInput(String),
    /// A position or velocity, and therefore a force, is not a finite number.
    #[error("a position or velocity in the fluid is not a finite number")]
    NotFinite,
    /// Neighbouring nodes coincide, or are far closer than the regularisation length, so that velocities do not determine the forces.
    #[error(
        "the flow of the filaments is singular to working precision: neighbouring nodes of a filament coincide, or are far closer than the regularisation length"
    )]
    Singular,
    /// A node that is not held is at the wall of the flow, or behind it.
    #[error(
        "{name} is at the wall of the flow or behind it (height {height:.3e} m); add a [contact] table or use shorter time steps"
    )]
    BehindWall {
        /// Node of the scene.
        node: usize,
        /// Name of the node.
        name: String,
        /// Height of the node over the wall, m.
        height: f64,
    },
    /// The iterative solution did not reach its tolerance.
    #[error(
        "the fluid forces did not converge: relative residual {residual:.3e} after {iterations} iterations; nodes much closer to \
         each other than the regularisation length, by default the radius, make the equations ill-conditioned: use fewer nodes"
    )]
    NoConvergence {
        /// Iterations spent.
        iterations: usize,
        /// Relative residual reached.
        residual: f64,
    },
    /// Two nodes of filaments that are so close to each other that velocities do not determine the
    /// forces.
    #[error(
        "{first} and {second} are {regularizations:.2} regularisation lengths apart, too close for the flow between them to have a \
         solution: join them, or keep the rods apart with a [contact] table"
    )]
    TooClose {
        /// Name of the first node.
        first: String,
        /// Name of the second node.
        second: String,
        /// Distance of the nodes over the smaller regularisation length.
        regularizations: f64,
    },
    /// The logarithm of the slender-body coefficients is not positive.
    #[error("resistive force theory needs slender rods, but length over radius is only {0:.3}")]
    NotSlender(f64),
    /// The memory belongs to another scene.
    #[error("the stored state of the fluid belongs to other filaments")]
    ForeignMemory,
}
