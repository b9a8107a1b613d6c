//! Critical points, at which the number of growing small motions changes and other branches may
//! begin.

use super::location::{Location, Origin, PointKind, Tangent};
use super::tracer::Tracer;
use crate::mechanics::statics::inner_product::{inner, scale_angles};
use crate::mechanics::statics::spectrum::inverse_iteration;
use crate::mechanics::system::System;

/// Arclength within which a critical point is located; 1 is the range of the parameter.
const TOLERANCE: f64 = 1e-8;
/// Fractions at which a bracket may be divided: its middle, or another one if Newton's method
/// fails there.
const SHARES: [f64; 5] = [0.5, 0.3, 0.7, 0.1, 0.9];
/// Most critical points between two neighbouring points.
const MOST_IN_A_STEP: usize = 8;
/// Bound on the cosine of the null vector v to ∂R/∂λ, which is zero at a bifurcation; a point with
/// a larger one is a fold. Observed values are at most 1e-9 at bifurcations and some hundredths at
/// folds.
const LARGEST_COUPLING: f64 = 1e-4;
/// Share of the way to a critical point, before it, over which its eigenvalue is taken to be linear.
const BEFORE: f64 = 0.1;
/// Number of halvings of the first step onto a new branch.
const HALVINGS: usize = 6;

impl Tracer {
    /// Returns the critical points between `here` and `next`, which is `step` ahead along `tangent`.
    pub(super) fn locate_critical_points(
        &mut self,
        system: &mut System,
        here: &Location,
        tangent: &Tangent,
        next: &Location,
        step: f64,
    ) {
        let after = std::mem::replace(&mut self.tangent, tangent.clone());
        let mut low = here.clone();
        for _ in 0..MOST_IN_A_STEP {
            if low.unstable == next.unstable {
                break;
            }
            let start = low.clone();
            let high = self.bracket(system, &mut low, next, step);
            self.hand_out_critical(system, &start, &low, &high);
            low = high;
        }
        self.tangent = after;
    }

    /// Narrows the path from `low` to `next` by bisection to a change of the number of negative
    /// eigenvalues; returns the far end of the bracket.
    fn bracket(
        &mut self,
        system: &mut System,
        low: &mut Location,
        next: &Location,
        step: f64,
    ) -> Location {
        let mut high = next.clone();
        let mut length = step;
        while length > TOLERANCE {
            let divided = SHARES
                .into_iter()
                .find_map(|share| Some((share, self.between(system, low, &high, share).ok()?)));
            // If all fail, the bracket is too near the critical point for Newton's method to
            // converge.
            let Some((share, middle)) = divided else {
                break;
            };
            if middle.unstable == low.unstable {
                *low = middle;
                length *= 1.0 - share;
            } else {
                high = middle;
                length *= share;
            }
        }
        high
    }

    /// Hands out the critical point between `low` and `high`, two points next to it, on the way from `start`.
    fn hand_out_critical(
        &mut self,
        system: &mut System,
        start: &Location,
        low: &Location,
        high: &Location,
    ) {
        let (before, after) = (low.unstable, high.unstable);
        let crossing = after.divergent.abs_diff(before.divergent);
        let (vectors, kind) = if before.flutter == after.flutter {
            let (vectors, coupling) = self.null_vectors(system, high, crossing);
            let kind = if coupling > LARGEST_COUPLING {
                PointKind::Fold
            } else {
                PointKind::Bifurcation
            };
            (vectors, kind)
        } else {
            (Vec::new(), PointKind::Flutter)
        };
        let mut error = (high.parameter - low.parameter).abs();
        let mut point = high.clone();
        // The parameter of a fold is stationary there, and the shift changes it by its square only.
        if kind == PointKind::Bifurcation
            && system.is_symmetric()
            && let Some((moved, rounding)) = self.without_shift(system, start, high)
        {
            point = moved;
            error += rounding;
        }
        self.hand_out(system, &point, kind, error);
        if kind == PointKind::Bifurcation && self.plan.switch_branches && self.branch == 0 {
            for vector in vectors {
                self.remember(&point, vector);
            }
            self.crossings.push(Origin {
                location: point,
                direction: self.tangent.clone(),
            });
        }
    }

    /// The critical point of the Hessian itself, from `high`, that of the Hessian with its shift σ, and the error of its
    /// parameter by rounding.
    ///
    /// The eigenvalue μ nearest to zero is −σ at `high`. A little before, on the way from `start`, it has another
    /// value, and between the two it is taken to change linearly.
    fn without_shift(
        &mut self,
        system: &mut System,
        start: &Location,
        high: &Location,
    ) -> Option<(Location, f64)> {
        let earlier = self.between(system, start, high, 1.0 - BEFORE).ok()?;
        let at_high = self.shifted_eigenvalue(system, high)?;
        let change = self.shifted_eigenvalue(system, &earlier)? - at_high;
        let share = BEFORE * (self.bordered.shift - at_high) / change;
        if !(0.0..=1.0).contains(&share) {
            return None;
        }
        let mut point = self.between(system, start, high, 1.0 - share).ok()?;
        // As it is just behind the critical point.
        point.unstable = high.unstable;
        let slope = change / (earlier.parameter - high.parameter);
        Some((point, self.bordered.rounding / slope.abs()))
    }

    /// The eigenvalue nearest to zero of the Hessian with its shift, N/m.
    fn shifted_eigenvalue(&mut self, system: &mut System, location: &Location) -> Option<f64> {
        let unknowns = self.place(system, location);
        self.bordered.linearize(system, &unknowns)?;
        let mut vector = vec![0.0; unknowns.len()];
        inverse_iteration(system, &mut vector, &location.neutral)
    }

    /// The eigenvectors of the `count` eigenvalues nearest to zero, and the cosine of the rate
    /// ∂R/∂λ to the first of them.
    fn null_vectors(
        &mut self,
        system: &mut System,
        location: &Location,
        count: usize,
    ) -> (Vec<Vec<f64>>, f64) {
        let mut unknowns = self.place(system, location);
        self.bordered
            .differentiate(system, &mut unknowns, location.parameter);
        let mut known = location.neutral.clone();
        let (mut vectors, mut coupling) = (Vec::new(), 0.0_f64);
        if self.bordered.linearize(system, &unknowns).is_some() {
            for _ in 0..count {
                let mut vector = vec![0.0; unknowns.len()];
                let Some(eigenvalue) = inverse_iteration(system, &mut vector, &known) else {
                    break;
                };
                coupling = coupling.max(if system.is_symmetric() {
                    self.coupling(&vector)
                } else {
                    self.general_coupling(system, eigenvalue)
                });
                known.push(vector.clone());
                vectors.push(vector);
            }
        }
        (vectors, coupling)
    }

    /// |v·∂R/∂λ| over the norms of both, for a vector v of norm 1.
    fn coupling(&self, vector: &[f64]) -> f64 {
        let product: f64 = vector
            .iter()
            .zip(&self.bordered.rate)
            .map(|(v, b)| v * b)
            .sum();
        product.abs() / self.norm_of_rate()
    }

    /// The coupling for a matrix J that is not symmetric, without its left null vector w: J⁻¹b is
    /// about v (w·b)/(μ w·v) with the eigenvalue μ nearest to zero, so that |μ| ‖J⁻¹b‖/‖b‖
    /// vanishes if w·b does.
    fn general_coupling(&self, system: &mut System, eigenvalue: f64) -> f64 {
        let mut answer = self.bordered.rate.clone();
        if system.solve(&mut answer).is_err() {
            return 0.0;
        }
        let weight = self.bordered.neutral.weight();
        let size = inner(&answer, &answer, weight).sqrt();
        eigenvalue.abs() * size / self.norm_of_rate()
    }

    /// Norm of ∂R/∂λ.
    fn norm_of_rate(&self) -> f64 {
        let weight = self.bordered.neutral.weight();
        let mut force = self.bordered.rate.clone();
        scale_angles(&mut force, 1.0 / weight);
        inner(&force, &force, weight).sqrt()
    }

    /// Records the two branches that leave a bifurcation along a null vector.
    fn remember(&mut self, location: &Location, vector: Vec<f64>) {
        let mut direction = Tangent {
            unknowns: vector,
            parameter: 0.0,
        };
        let length = self.inner(&direction, &direction).sqrt();
        direction.unknowns.iter_mut().for_each(|t| *t /= length);
        for _ in 0..2 {
            self.origins.push_back(Origin {
                location: location.clone(),
                direction: direction.clone(),
            });
            direction.unknowns.iter_mut().for_each(|t| *t = -*t);
        }
    }

    /// Steps onto a branch; returns false if none is found.
    pub(super) fn switch(&mut self, system: &mut System, origin: &Origin) -> bool {
        self.begin_branch();
        let Origin {
            location,
            direction,
        } = origin;
        for halving in 0..HALVINGS {
            let length = self.first_step() * 0.5f64.powi(halving as i32);
            let predicted: Vec<f64> = (location.unknowns.iter().zip(&direction.unknowns))
                .map(|(q, t)| q + length * t)
                .collect();
            let condition = self.across(direction, location.parameter, &predicted);
            let Ok(first) = self.correct(system, location, &condition, predicted) else {
                continue;
            };
            self.turn_tangent(Some(direction));
            self.hand_out(system, location, PointKind::Bifurcation, 0.0);
            self.arrive(system, first);
            return true;
        }
        false
    }
}
