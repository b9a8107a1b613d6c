//! Newton's method on the equilibrium bordered by one unknown, the path parameter, and one condition:
//!
//! ```text
//! | J   b | |dq|     |R|        b = ∂R/∂λ
//! | cᵀ  d | |dλ| = − |g|        g = c·(q − q₀) + d (λ − λ₀)
//! ```
//!
//! by block elimination with the factors of J (Keller 1977): J z₁ = −R, J z₂ = −b, then dλ = −(g +
//! c·z₁)/(d + c·z₂), dq = z₁ + dλ z₂. The next iteration, with a fresh residual, corrects rounding
//! errors near a singular J. Rounding errors along motions without stiffness, which nothing would
//! correct, are removed from z₁ and z₂.

use crate::mechanics::rod::STRIDE;
use crate::mechanics::statics::neutral::NeutralModes;
use crate::mechanics::statics::small_motions::{Unstable, small_motions};
use crate::mechanics::system::{Divergence, System};
use serde::{Deserialize, Serialize};

/// Added to the Hessian, in units of EI/L³, so that motions without stiffness neither make it
/// singular nor count as unstable. Bifurcations are corrected for it.
const NEUTRAL: f64 = 1e-6;
/// Lower bound of that addition: this multiple of the rounding error of the stiffest entry.
const ROUNDINGS: f64 = 8.0;
/// Largest expected move of a node in the next iteration, over the extent of the rods, at which a
/// point of the path is accepted. Near a critical point a small residual alone allows large errors
/// along the null vector.
const PRECISION: f64 = 1e-9;
/// Rounding errors may cause larger corrections: iterations end when a correction is at least this
/// fraction of the previous one.
const STAGNATION: f64 = 0.1;
/// Most iterations; a step that needs more is too long.
const ITERATIONS: usize = 12;
/// Step of the parameter, relative to its range, in the difference quotient of ∂R/∂λ.
const DIFFERENCE: f64 = 1e-3;

/// The condition that selects a point of the path: c·(q − q₀) + d (λ − λ₀) = 0.
#[derive(Clone, Debug)]
pub(super) struct Condition {
    /// c and d.
    pub unknowns: Vec<f64>,
    pub parameter: f64,
    /// q₀ and λ₀.
    pub start: Vec<f64>,
    pub start_parameter: f64,
}

impl Condition {
    fn value(&self, unknowns: &[f64], parameter: f64) -> f64 {
        let moved: f64 = (self.unknowns.iter().zip(unknowns).zip(&self.start))
            .map(|((c, q), q0)| c * (q - q0))
            .sum();
        moved + self.parameter * (parameter - self.start_parameter)
    }
}

/// Scratch of the bordered system.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Bordered {
    /// Vectors z₁ and z₂ of the last factorisation; z₂ is the derivative of the unknowns with
    /// respect to the parameter.
    newton: Vec<f64>,
    pub rate: Vec<f64>,
    probe: Vec<f64>,
    /// Side of the box around all rods, m.
    extent: f64,
    /// Range of the parameter.
    range: f64,
    /// Residual allowed, as a multiple of the forces of each rod.
    pub tolerance: f64,
    /// Stiffness that counts as zero and is added to the Hessian, N/m.
    pub shift: f64,
    /// Rounding error of the stiffest entry, N/m.
    pub rounding: f64,
    /// Motions without stiffness near the last point.
    pub neutral: NeutralModes,
}

/// Result of an iteration.
pub(super) struct Converged {
    pub iterations: usize,
    /// Growing small motions at the last point.
    pub unstable: Unstable,
}

impl Bordered {
    /// Scratch for the unknowns of `system`, with rods in a box of side `extent` (m) and a parameter that
    /// changes by `range`.
    pub(crate) fn new(system: &System, extent: f64, range: f64, tolerance: f64) -> Self {
        let assembly = &system.assembly;
        let unknowns = assembly.unknowns.len();
        let unit = assembly.softest_scale / extent;
        Self {
            newton: vec![0.0; unknowns],
            rate: vec![0.0; unknowns],
            probe: vec![0.0; unknowns],
            extent,
            range: range.abs(),
            tolerance,
            shift: (NEUTRAL * unit).max(ROUNDINGS * assembly.rounding_stiffness),
            rounding: assembly.rounding_stiffness,
            neutral: NeutralModes::new(assembly.shortest_edge * assembly.shortest_edge),
        }
    }

    /// Finds the point of the path that satisfies `condition`; `rate` is ∂q/∂λ there.
    pub(crate) fn correct(
        &mut self,
        system: &mut System,
        unknowns: &mut [f64],
        parameter: &mut f64,
        condition: &Condition,
    ) -> Result<Converged, Divergence> {
        let mut last_move = f64::INFINITY;
        for iterations in 0..=ITERATIONS {
            system.drive(*parameter, unknowns);
            system.update_candidates(unknowns);
            self.differentiate(system, unknowns, *parameter);
            let negative = self.linearize(system, unknowns);
            system.set_tolerances(self.tolerance, unknowns, None);
            let imbalance = system.imbalance();
            let failed = Divergence {
                iterations,
                residual: imbalance.residual,
                unknown: imbalance.unknown,
            };
            let negative = negative
                .filter(|_| imbalance.residual.is_finite())
                .ok_or(failed)?;
            self.neutral.refine(system).map_err(|_| failed)?;
            self.newton.copy_from_slice(&system.residual);
            self.newton.iter_mut().for_each(|r| *r = -*r);
            self.rate.iter_mut().for_each(|b| *b = -*b);
            for right_hand_side in [&mut self.newton, &mut self.rate] {
                system.solve(right_hand_side).map_err(|_| failed)?;
                self.neutral.remove_from(right_hand_side);
            }
            let along =
                |z: &[f64]| -> f64 { condition.unknowns.iter().zip(z).map(|(c, z)| c * z).sum() };
            let gap = condition.value(unknowns, *parameter);
            let change = -(gap + along(&self.newton)) / (condition.parameter + along(&self.rate));
            if !change.is_finite() {
                return Err(failed);
            }
            let steps = self.newton.iter().zip(&self.rate).enumerate();
            let next_move = steps
                .filter(|(k, _)| k % STRIDE != 3)
                .map(|(_, (newton, rate))| (newton + change * rate).abs())
                .fold(0.0, f64::max);
            let stationary =
                next_move <= PRECISION * self.extent || next_move >= STAGNATION * last_move;
            if imbalance.is_balanced() && stationary {
                let unstable = if system.is_symmetric() {
                    Unstable {
                        divergent: negative,
                        flutter: 0,
                    }
                } else {
                    small_motions(system, unknowns).ok_or(failed)?.unstable
                };
                return Ok(Converged {
                    iterations,
                    unstable,
                });
            }
            if iterations == ITERATIONS {
                return Err(failed);
            }
            for k in 0..unknowns.len() {
                unknowns[k] += self.newton[k] + change * self.rate[k];
            }
            *parameter += change;
            last_move = next_move;
        }
        unreachable!("the last iteration returns")
    }

    /// Linearises at `unknowns` and factors the Jacobian, to which a tiny multiple is added.
    /// Returns the number of negative pivots, or 0 if the Jacobian is not symmetric; `None` if it
    /// cannot be factored.
    pub(crate) fn linearize(&self, system: &mut System, unknowns: &[f64]) -> Option<usize> {
        system.linearize(unknowns, None);
        system.shift(self.shift, self.shift * self.neutral.weight());
        let inertia = system.factor().ok()?;
        Some(inertia.map_or(0, |inertia| inertia.negative))
    }

    /// Computes b = ∂R/∂λ into `rate`, by central differences at fixed free unknowns.
    pub(crate) fn differentiate(
        &mut self,
        system: &mut System,
        unknowns: &mut [f64],
        parameter: f64,
    ) {
        let step = DIFFERENCE * self.range;
        self.probe.copy_from_slice(unknowns);
        system.drive(parameter + step, &mut self.probe);
        system.evaluate(&self.probe, None);
        self.rate.copy_from_slice(&system.residual);
        system.drive(parameter - step, &mut self.probe);
        system.evaluate(&self.probe, None);
        for (rate, residual) in self.rate.iter_mut().zip(&system.residual) {
            *rate = (*rate - residual) / (2.0 * step);
        }
        system.drive(parameter, unknowns);
    }

    /// Weights of the squares of the unknowns in a dimensionless length: a root mean square over
    /// the nodes, of displacements over `extent` and of angles over a turn.
    pub(crate) fn weights(unknowns: usize, extent: f64) -> [f64; 2] {
        let nodes = (unknowns / STRIDE) as f64;
        let turn = std::f64::consts::TAU;
        [1.0 / (nodes * extent * extent), 1.0 / (nodes * turn * turn)]
    }
}
