//! The equilibrium next to a configuration, stable or not, and the inertia of its Hessian.

use crate::linalg::Inertia;
use crate::mechanics::system::{Divergence, System};

/// Most iterations. From a configuration within the error of the mesh it takes three to six.
const ITERATIONS: usize = 30;

/// Goes to the equilibrium near `unknowns` by plain Newton steps, which converge to saddle points as well
/// as to minima; returns the inertia of the Hessian there, `None` where the Jacobian is not symmetric. The
/// equilibrium is stable where no pivot is negative. `force` is the largest residual left, N.
///
/// # Errors
/// [`Divergence`] where the start was too far away, or the Hessian is singular.
pub fn nearby_equilibrium(
    system: &mut System,
    unknowns: &mut [f64],
    force: f64,
) -> Result<Option<Inertia>, Divergence> {
    let time = system.time;
    system.drive(time, unknowns);
    let mut direction = vec![0.0; unknowns.len()];
    for iterations in 0..=ITERATIONS {
        system.update_candidates(unknowns);
        system.linearize(unknowns, None);
        let (residual, unknown) = system.worst_residual();
        let failed = Divergence {
            iterations,
            residual,
            unknown,
        };
        if !residual.is_finite() {
            return Err(failed);
        }
        let inertia = system.factor().map_err(|_| failed)?;
        if residual <= force {
            system.commit_frames();
            return Ok(inertia);
        }
        if iterations == ITERATIONS {
            return Err(failed);
        }
        system.direction(&mut direction).map_err(|_| failed)?;
        for (unknown, step) in unknowns.iter_mut().zip(&direction) {
            *unknown += step;
        }
        system.update_geometry(unknowns);
        system.commit_frames();
    }
    unreachable!("the last iteration returns")
}
