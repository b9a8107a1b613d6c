//! Cost of a computation of the drag.

/// Cost of a computation of the drag.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FluidReport {
    /// Krylov iterations; zero for resistive force theory, which needs no solver.
    pub iterations: usize,
    /// Relative residual of the velocities, ‖u − A f/(8πη)‖/‖u‖.
    pub residual: f64,
}
