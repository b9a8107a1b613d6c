//! The equilibrium nearest to a configuration, stable or not, and the inertia of its Hessian.

use crate::linalg::Inertia;
use crate::mechanics::system::{Divergence, System};

/// Most iterations. From a configuration within the error of the mesh it takes three to six.
const ITERATIONS: usize = 30;

/// Finds the equilibrium near `unknowns` by plain Newton steps, which converge to saddle points as
/// well as to minima. Returns the inertia of the Hessian there; `None` if the Jacobian is not
/// symmetric. The equilibrium is stable if no pivot is negative. `tolerance` is the final residual
/// as a multiple of the forces of each rod ([`System::set_tolerances`]).
///
/// # Errors
/// [`Divergence`] if the start was too far away or the Hessian is singular.
pub(crate) fn nearby_equilibrium(
    system: &mut System,
    unknowns: &mut [f64],
    tolerance: f64,
) -> Result<Option<Inertia>, Divergence> {
    let time = system.time;
    system.drive(time, unknowns);
    let mut direction = vec![0.0; unknowns.len()];
    system.set_tolerances(tolerance, unknowns, None);
    for iterations in 0..=ITERATIONS {
        system.update_candidates(unknowns);
        system.linearize(unknowns, None);
        let imbalance = system.imbalance();
        let failed = Divergence {
            iterations,
            residual: imbalance.residual,
            unknown: imbalance.unknown,
        };
        if !imbalance.residual.is_finite() {
            return Err(failed);
        }
        let inertia = system.factor().map_err(|_| failed)?;
        if imbalance.is_balanced()
            && (iterations > 0 || system.is_balanced_as_predicted(unknowns, None))
        {
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
        system.complete(unknowns);
        system.update_geometry(unknowns);
        system.commit_frames();
    }
    unreachable!("the last iteration returns")
}
