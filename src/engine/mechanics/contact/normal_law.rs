//! Normal force law of one contact: the law of the contact model at the size of the contact and
//! the present stiffness.

use super::normal_response::NormalResponse;
use super::parameters::{ContactModel, ContactParameters};
use super::{barrier, potential};

/// Panic message: complementarity never evaluates a law.
const RIGID: &str = "the forces of rigid contact are constraints, not functions of the gap";

/// Iterations of [`NormalLaw::resolved`], which mostly takes one or two.
const RESOLVING_ITERATIONS: usize = 30;
/// Largest change of the logarithm of the force in one iteration.
const LARGEST_CHANGE: f64 = 4.0;
/// Change of the logarithm of the force at which the iterations end: its square is negligible.
const RESOLVED_CHANGE: f64 = 1e-3;
/// Threshold below which a force counts as zero, in units of k δ/h̄²: far below any force of
/// interest, and far from where the inverse of the law overflows.
const LEAST_PART: f64 = 1e-30;

/// A normal force law N(g).
#[derive(Clone, Copy, Debug)]
pub(super) struct NormalLaw {
    model: ContactModel,
    /// Mean radius h̄ of the two surfaces, m.
    scale: f64,
    /// Distance tolerance δ, m.
    tolerance: f64,
    /// Contact stiffness k, J.
    stiffness: f64,
}

impl NormalLaw {
    /// The law between surfaces of mean radius `scale` (m).
    pub(crate) fn new(parameters: &ContactParameters, scale: f64, stiffness: f64) -> Self {
        Self {
            model: parameters.model,
            scale,
            tolerance: parameters.distance_tolerance,
            stiffness,
        }
    }

    /// Force (N) below which a force counts as zero.
    pub(crate) fn least_force(&self) -> f64 {
        LEAST_PART * self.stiffness * self.tolerance / (self.scale * self.scale)
    }

    /// Energy and force at a surface gap, m.
    pub(crate) fn response(&self, gap: f64) -> NormalResponse {
        let (scale, tolerance, stiffness) = (self.scale, self.tolerance, self.stiffness);
        match self.model {
            ContactModel::ImplicitContact => {
                potential::normal_response(gap, scale, tolerance, stiffness)
            }
            ContactModel::IncrementalPotential => {
                barrier::normal_response(gap, scale, tolerance, stiffness)
            }
            ContactModel::Complementarity => unreachable!("{RIGID}"),
        }
    }

    /// The surface gap (m) at which the force is `force` (N), positive.
    pub(crate) fn gap_of_force(&self, force: f64) -> f64 {
        let (scale, tolerance, stiffness) = (self.scale, self.tolerance, self.stiffness);
        match self.model {
            ContactModel::ImplicitContact => {
                potential::gap_of_force(force, scale, tolerance, stiffness)
            }
            ContactModel::IncrementalPotential => {
                barrier::gap_of_force(force, scale, tolerance, stiffness)
            }
            ContactModel::Complementarity => unreachable!("{RIGID}"),
        }
    }

    /// The force λ* (N) and the gap g* (m) with λ* = N(g*) and λ* − ρ g* = `force` − ρ `gap`, for
    /// ρ = `inertia` (N/m); the force is 0 if it cannot be distinguished from zero.
    pub(crate) fn resolved(&self, force: f64, gap: f64, inertia: f64) -> (f64, f64) {
        let sum = force - inertia * gap;
        let least = self.least_force();
        // The equation is convex in the logarithm of λ: Newton's method is monotone from above,
        // and fast from a start of the right size.
        let mut found = force.max(sum);
        if found <= 0.0 {
            let open = -sum / inertia;
            found = if open > 0.0 {
                self.response(open).force
            } else {
                0.0
            };
            if found <= least {
                return (0.0, open);
            }
        }
        let mut at = self.gap_of_force(found);
        for _ in 0..RESOLVING_ITERATIONS {
            let slope = self.response(at).force_slope;
            let excess = found - inertia * at - sum;
            let change = -excess / (found * (1.0 - inertia / slope));
            found *= libm::exp(change.clamp(-LARGEST_CHANGE, LARGEST_CHANGE));
            if !(found > least) {
                return (0.0, at);
            }
            at = self.gap_of_force(found);
            if change.abs() < RESOLVED_CHANGE {
                break;
            }
        }
        (found, at)
    }
}
