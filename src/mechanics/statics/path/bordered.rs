//! Newton's method on the equilibrium bordered by one unknown, the path parameter, and one condition:
//!
//! ```text
//! | J   b | |dq|     |R|        b = ∂R/∂λ
//! | cᵀ  d | |dλ| = − |g|        g = c·(q − q₀) + d (λ − λ₀)
//! ```
//!
//! by block elimination with the factors of J (Keller 1977): J z₁ = −R, J z₂ = −b, then
//! dλ = −(g + c·z₁)/(d + c·z₂), dq = z₁ + dλ z₂. Rounding errors near a singular J are left to the next
//! iteration, whose residual is computed afresh.

use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::{Divergence, System};

/// Added to the Hessian that is solved with at first, in units of EI/L³, and most iterations with it: rods
/// that can move without stiffness (a ring that rolls, a column that buckles in any plane) have singular
/// Hessians, by which rounding errors would grow without bound. Equilibria are not changed by it, but near
/// critical points it takes many iterations; where these do not suffice, next to nothing is added.
const REGULARIZATION: f64 = 1e-3;
const REGULARIZED_ITERATIONS: usize = 6;
/// Added to the Hessian whose pivots are counted, so that motions without stiffness count as stable. The
/// loads of critical points are too large by some millionths for it.
const NEUTRAL: f64 = 1e-6;
/// But no less than this multiple of the rounding error of the stiffest entry.
const ROUNDINGS: f64 = 8.0;
/// Most iterations with next to nothing added; a step that needs more is too long.
const ITERATIONS: usize = 12;
/// Step of the parameter over its range in the difference quotient of ∂R/∂λ.
const DIFFERENCE: f64 = 1e-3;

/// The condition that singles out a point of the path: c·(q − q₀) + d (λ − λ₀) = 0.
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
#[derive(Clone, Debug)]
pub(super) struct Bordered {
    /// z₁ and z₂ of the last factorisation; z₂ is the rate of the unknowns with the parameter.
    newton: Vec<f64>,
    pub rate: Vec<f64>,
    probe: Vec<f64>,
    /// Range of the parameter.
    range: f64,
    /// Residual allowed, as a multiple of the force scale.
    pub tolerance: f64,
    /// EI/L³, and that times the square of the shortest edge.
    pub unit: [f64; 2],
    /// Stiffness that counts as none, in those units.
    neutral: f64,
}

/// How an iteration ended.
pub(super) struct Converged {
    pub iterations: usize,
    /// Number of negative eigenvalues there.
    pub negative: usize,
}

impl Bordered {
    pub fn new(unknowns: usize, range: f64, tolerance: f64, unit: [f64; 2], rounding: f64) -> Self {
        Self {
            newton: vec![0.0; unknowns],
            rate: vec![0.0; unknowns],
            probe: vec![0.0; unknowns],
            range: range.abs(),
            tolerance,
            neutral: NEUTRAL.max(ROUNDINGS * rounding / unit[0]),
            unit,
        }
    }

    /// Goes to the point of the path that meets `condition`; `rate` is ∂q/∂λ there.
    pub fn correct(
        &mut self,
        system: &mut System,
        unknowns: &mut [f64],
        parameter: &mut f64,
        condition: &Condition,
    ) -> Result<Converged, Divergence> {
        let start = (unknowns.to_vec(), *parameter);
        let regularization = REGULARIZATION.max(self.neutral);
        let most = REGULARIZED_ITERATIONS;
        self.iterate(system, unknowns, parameter, condition, regularization, most)
            .or_else(|_| {
                unknowns.copy_from_slice(&start.0);
                *parameter = start.1;
                let neutral = self.neutral;
                self.iterate(system, unknowns, parameter, condition, neutral, ITERATIONS)
            })
    }

    fn iterate(
        &mut self,
        system: &mut System,
        unknowns: &mut [f64],
        parameter: &mut f64,
        condition: &Condition,
        regularization: f64,
        most: usize,
    ) -> Result<Converged, Divergence> {
        for iterations in 0..=most {
            system.drive(*parameter, unknowns);
            system.update_candidates(unknowns);
            self.differentiate(system, unknowns, *parameter);
            system.linearize(unknowns, None);
            let force = system.force_tolerance(self.tolerance, unknowns);
            let (residual, unknown) = system.worst_residual();
            let failed = Divergence {
                iterations,
                residual,
                unknown,
            };
            if !residual.is_finite() {
                return Err(failed);
            }
            self.factor(system, regularization).ok_or(failed)?;
            self.newton.copy_from_slice(&system.residual);
            self.newton.iter_mut().for_each(|r| *r = -*r);
            self.rate.iter_mut().for_each(|b| *b = -*b);
            for right_hand_side in [&mut self.newton, &mut self.rate] {
                system.solve(right_hand_side).map_err(|_| failed)?;
            }
            let along =
                |z: &[f64]| -> f64 { condition.unknowns.iter().zip(z).map(|(c, z)| c * z).sum() };
            let gap = condition.value(unknowns, *parameter);
            let change = -(gap + along(&self.newton)) / (condition.parameter + along(&self.rate));
            if !change.is_finite() {
                return Err(failed);
            }
            // An equilibrium; where along the path it lies does not matter to the last digit.
            if residual <= force {
                system.linearize(unknowns, None);
                let negative = self.factor(system, self.neutral).ok_or(failed)?;
                return Ok(Converged {
                    iterations,
                    negative,
                });
            }
            if iterations == most {
                return Err(failed);
            }
            for k in 0..unknowns.len() {
                unknowns[k] += self.newton[k] + change * self.rate[k];
            }
            *parameter += change;
        }
        unreachable!("the last iteration returns")
    }

    /// Factors the Hessian of the last linearisation, shifted by so many units; returns the number of
    /// negative pivots.
    fn factor(&self, system: &mut System, shift: f64) -> Option<usize> {
        let [unit, spin_unit] = self.unit;
        system.shift(shift * unit, shift * spin_unit);
        Some(system.factor().ok()??.negative)
    }

    /// Writes b = ∂R/∂λ into `rate`, by central differences at fixed free unknowns.
    fn differentiate(&mut self, system: &mut System, unknowns: &mut [f64], parameter: f64) {
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

    /// Weights of the squares of the unknowns in a length without unit: a root mean square over the
    /// nodes, of displacements over `extent` and of angles over a turn.
    pub fn weights(unknowns: usize, extent: f64) -> [f64; 2] {
        let nodes = (unknowns / STRIDE) as f64;
        let turn = std::f64::consts::TAU;
        [1.0 / (nodes * extent * extent), 1.0 / (nodes * turn * turn)]
    }
}
