//! Equilibrium of a system, ∇E(q) = F, where it would come to rest: Newton's method with decreasing energy.
//!
//! - If the Hessian has negative pivots, a multiple of the unit matrix is added that makes all of
//!   them positive (Nocedal & Wright, Numerical Optimization, 2nd ed., algorithm 3.3).
//! - A rod hardly stretches, but a straight step that rotates an edge by φ lengthens it by φ²/2,
//!   which soon costs more energy than bending releases. So each step is bent back by another
//!   solution with the same factors: the second-order correction of constrained optimisation
//!   (ibid., sec. 15.6), with the lengths as constraints.
//! - A step is halved until the potential E − F·q falls.
//! - The search leaves an unstable equilibrium along the lowest eigenvector.
//! - Near the solution the potential falls by less than its rounding error. There its decrease is
//!   judged by its slope at the end of the step (Hager & Zhang 2005, "approximate Wolfe"). Once
//!   the residual is below its tolerance, whole corrections are made without a check. A residual
//!   that no correction lowers is accepted if it is as small as rounding allows
//!   ([`System::is_at_rounding`]).
//!
//! Moments of fixed direction, and friction, have no potential. With them, a step is halved until
//! the solution for the forces at its end is shorter than the step itself (Deuflhard, Newton
//! Methods for Nonlinear Problems, sec. 3.3).

use super::neutral::NeutralModes;
use super::spectrum::inverse_iteration;
use crate::mechanics::rod::{STRIDE, topology::position};
use crate::mechanics::system::{Divergence, System};
use tracing::trace;

/// Most iterations. Strongly bent shapes from a straight start take some tens; stiff lines with a
/// weight that slides along them take a thousand or more. Rods that settle on each other take
/// many, since no step may be longer than their radius.
const ITERATIONS: usize = 10_000;
/// Largest move of a node in one iteration, as a fraction of the extent of all rods. Larger jumps skip
/// solution branches; smaller ones only cost iterations.
const LARGEST_MOVE: f64 = 0.3;
/// Largest rotation of an edge in one iteration, rad: about as large as a corrected step can
/// follow.
const LARGEST_TURN: f64 = 0.8;
/// Largest factor by which a step may exceed the solution with the shifted Hessian.
const LENGTHENING: f64 = 8.0;
/// Stiffness that counts as zero, over EI/L³: motions with less are not followed.
const NEUTRAL: f64 = 1e-6;
/// Lower bound of that stiffness: this multiple of the rounding error of the stiffest entry of
/// each rod.
const ROUNDINGS: f64 = 8.0;
/// Number of whole corrections that suffice if the residual is small compared with EI/L², but not
/// with the loads. The first leaves a relative error of a millionth, from the addition to the
/// Hessian, the second its square.
const CORRECTIONS: usize = 2;
/// Growth factor of the shift, until the pivots are positive or if no step lowers the potential;
/// and the smallest shift, over EI/L³.
const SHIFT_GROWTH: f64 = 4.0;
const SMALLEST_SHIFT: f64 = 1e-3;
/// Most increases of the shift in a row, after which it exceeds every stiffness.
const SHIFT_GROWTHS: usize = 60;
/// Most halvings of one step.
const HALVINGS: usize = 12;
/// Sufficient decrease of the potential, relative to that of its linear model (Armijo).
const SUFFICIENT_FALL: f64 = 1e-4;
/// Sufficient decrease by slope: the largest ratio of the slope of the potential at the end of the
/// step to that at its start. Used if the potential itself changes by at most this multiple of the
/// rounding error of its terms.
const LARGEST_END_SLOPE: f64 = 0.8;
const ROUNDINGS_OF_POTENTIAL: f64 = 64.0;
/// Sufficient ratio of the squared residuals if the Hessian is positive: near the solution the
/// potential decreases by less than its rounding error.
const SUFFICIENT_REDUCTION: f64 = 0.5;
/// Displacement from an unstable equilibrium: the largest move of a node over the extent, and the
/// number of halvings.
const DEPARTURE: f64 = 0.05;
const DEPARTURE_HALVINGS: usize = 20;

/// Scratch of a search for an equilibrium.
#[derive(Clone, Debug)]
pub(crate) struct Descent {
    direction: Vec<f64>,
    correction: Vec<f64>,
    trial: Vec<f64>,
}

/// Units of a scene.
struct Scale {
    /// Side of the box around all rods, m.
    extent: f64,
    /// Largest move of a node in one iteration, m.
    largest_move: f64,
    /// EI/L³, N/m.
    stiffness: f64,
    /// Square of the shortest edge, which converts N/m to N m per rad.
    spin: f64,
    /// Stiffness that counts as zero, N/m.
    neutral: f64,
}

impl Scale {
    fn of(system: &System, unknowns: &[f64]) -> Self {
        let extent = extent(unknowns);
        let stiffness = system
            .assembly
            .softest_scale
            .min(system.assembly.force_scale)
            / extent;
        Self {
            extent,
            largest_move: (LARGEST_MOVE * extent).min(system.largest_safe_move()),
            stiffness,
            spin: system.assembly.shortest_edge * system.assembly.shortest_edge,
            neutral: NEUTRAL * stiffness,
        }
    }

    /// A shift that dominates the Hessian, over EI/L³.
    fn largest_shift(&self, system: &System) -> f64 {
        let stiffest = system.assembly.rounding_stiffness / f64::EPSILON;
        stiffest / self.stiffness
    }

    /// Length of a set of moves, m.
    fn norm(&self, moves: &[f64]) -> f64 {
        let squares = moves.chunks_exact(STRIDE).map(|node| {
            node[0] * node[0]
                + node[1] * node[1]
                + node[2] * node[2]
                + self.spin * node[3] * node[3]
        });
        squares.sum::<f64>().sqrt()
    }
}

/// A quantity that a step must decrease.
struct Start {
    potential: f64,
    /// Rounding error of the potential, J.
    rounding: f64,
    /// R·d: the slope of the potential along the direction, negative.
    slope: f64,
    squared_residual: f64,
    /// Whether the Hessian is positive without a shift.
    positive: bool,
}

impl Descent {
    /// Scratch for so many unknowns.
    pub(crate) fn new(unknowns: usize) -> Self {
        Self {
            direction: vec![0.0; unknowns],
            correction: vec![0.0; unknowns],
            trial: vec![0.0; unknowns],
        }
    }

    /// Finds an equilibrium from `unknowns`, a stable one if forces have a potential. Returns the
    /// iterations, or `None` once `goes_on` returns false. `tolerance` is the final residual, as a
    /// multiple of the forces of each rod ([`System::set_tolerances`]).
    ///
    /// # Errors
    /// [`Divergence`] with the largest residual after the last iteration.
    pub(crate) fn run(
        &mut self,
        system: &mut System,
        unknowns: &mut [f64],
        tolerance: f64,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<usize>, Divergence> {
        let time = system.time;
        system.drive(time, unknowns);
        let scale = Scale::of(system, unknowns);
        system.set_tolerances(tolerance, unknowns, None);
        let mut shift = 0.0;
        // Number of whole corrections with the unshifted Hessian.
        let mut corrections = 0;
        // Whether the residual is at rounding level and no correction lowers it.
        let mut is_exhausted = false;
        for iterations in 0..=ITERATIONS {
            if !goes_on() {
                return Ok(None);
            }
            system.update_candidates(unknowns);
            system.linearize(unknowns, None);
            let imbalance = system.imbalance();
            let residual = imbalance.residual;
            let failed = Divergence {
                iterations,
                residual,
                unknown: imbalance.unknown,
            };
            if !residual.is_finite() || iterations == ITERATIONS {
                return Err(failed);
            }
            trace!(iterations, residual, shift, "Newton iteration");
            let is_rounded = system.is_at_rounding();
            let is_small = imbalance.is_balanced();
            let balanced = is_exhausted
                || is_small
                    && (corrections >= CORRECTIONS
                        || system.is_balanced_as_predicted(unknowns, None));
            let least = if balanced { 0.0 } else { shift };
            shift = stabilise(system, unknowns, &scale, least).ok_or(failed)?;
            if balanced && (shift == 0.0 || !self.leave(system, unknowns, &scale)) {
                // Restore the residual of this configuration, in case a departure was tried.
                system.evaluate(unknowns, None);
                system.commit_frames();
                return Ok(Some(iterations));
            }
            if !balanced {
                system.direction(&mut self.direction).map_err(|_| failed)?;
                let lengthening = self.lengthening(system, shift, &scale);
                let factor = limit(&mut self.direction, system, scale.largest_move, lengthening);
                let is_whole = factor >= 1.0;
                let is_certain = is_small && shift == 0.0 && is_whole;
                let step = if is_certain && self.correct(system, unknowns) {
                    Some(1.0)
                } else {
                    self.step(system, unknowns, &scale, shift == 0.0, factor.min(1.0))
                };
                match step {
                    Some(1.0) => {
                        corrections += usize::from(shift == 0.0 && is_whole);
                        shift /= SHIFT_GROWTH * SHIFT_GROWTH;
                    }
                    Some(_) => {}
                    None if is_rounded => {
                        is_exhausted = true;
                        continue;
                    }
                    None if shift > scale.largest_shift(system) => return Err(failed),
                    None => {
                        shift = SHIFT_GROWTH * SHIFT_GROWTH * shift.max(SMALLEST_SHIFT);
                        continue;
                    }
                }
            }
            unknowns.copy_from_slice(&self.trial);
            system.update_geometry(unknowns);
            system.commit_frames();
        }
        unreachable!("the last iteration returns")
    }

    /// Ratio of the distance to the minimum along the direction, by the unshifted Hessian, to the
    /// length of the direction.
    fn lengthening(&self, system: &System, shift: f64, scale: &Scale) -> f64 {
        if shift == 0.0 || !system.is_symmetric() {
            return 1.0;
        }
        let fall = -dot(&self.direction, &system.residual);
        let curvature = fall - shift * scale.stiffness * scale.norm(&self.direction).powi(2);
        if LENGTHENING * curvature > fall {
            fall / curvature
        } else {
            LENGTHENING
        }
    }

    /// Searches for a better configuration along the direction, which is `factor` times the
    /// solution. Leaves it in `trial` and returns the fraction of the whole step taken; `None` if
    /// there is none.
    fn step(
        &mut self,
        system: &mut System,
        unknowns: &[f64],
        scale: &Scale,
        positive: bool,
        factor: f64,
    ) -> Option<f64> {
        let whole = scale.norm(&self.direction);
        let start = Start {
            potential: system.potential(unknowns),
            rounding: ROUNDINGS_OF_POTENTIAL * f64::EPSILON * system.potential_size(unknowns),
            slope: dot(&self.direction, &system.residual),
            squared_residual: system.squared_residual(),
            positive,
        };
        self.move_by(system, unknowns, 1.0);
        let longest = system.largest_step(unknowns, &self.trial);
        let mut part = 1.0;
        for _ in 0..HALVINGS {
            let length = part * longest;
            self.move_by(system, unknowns, length);
            let bent = self.bend_back(system, unknowns, length)
                && scale.norm(&self.correction) <= length * whole;
            if bent && system.largest_step(unknowns, &self.trial) >= 1.0 {
                system.evaluate(&self.trial, None);
                let accepted = if system.is_symmetric() {
                    let end_slope = dot(&self.direction, &system.residual);
                    start.is_improved(system, &self.trial, length, end_slope)
                } else {
                    self.correction.copy_from_slice(&system.residual);
                    let solved = system.solve(&mut self.correction).is_ok();
                    // Fraction of the unlimited solution that this step covers. With a shift, that
                    // solution does not solve the equations, and the remainder may be as long as
                    // the solution.
                    let part = if positive { length * factor } else { 0.0 };
                    solved && factor * scale.norm(&self.correction) <= (1.0 - 0.25 * part) * whole
                };
                if accepted {
                    return Some(part);
                }
            }
            part *= 0.5;
        }
        None
    }

    /// Makes the whole correction without a check of improvement; returns false if a contact is in
    /// its way.
    fn correct(&mut self, system: &mut System, unknowns: &[f64]) -> bool {
        self.move_by(system, unknowns, 1.0);
        system.largest_step(unknowns, &self.trial) >= 1.0
    }

    /// Corrects `trial` for the lengthening of edges beyond first order, with the factors of the
    /// Hessian at the start; returns false if that fails. `trial` is `part` of the direction from
    /// `unknowns`. Straight paths lengthen edges that rotate, and edges of nodes that slide around
    /// a curve.
    fn bend_back(&mut self, system: &mut System, unknowns: &[f64], part: f64) -> bool {
        self.correction.fill(0.0);
        for edge in &system.assembly.rods.edges {
            let span = |of: &[f64]| position(of, edge.end) - position(of, edge.start);
            let (before, after) = (span(unknowns), span(&self.trial));
            let tangent = before.normalize();
            let linear = part * span(&self.direction).dot(&tangent);
            let lengthening = after.norm() - before.norm() - linear;
            let force = edge.stretching / edge.natural_length * lengthening * tangent;
            for axis in 0..3 {
                self.correction[STRIDE * edge.start + axis] += force[axis];
                self.correction[STRIDE * edge.end + axis] -= force[axis];
            }
        }
        let solved = system.solve(&mut self.correction).is_ok();
        for (trial, correction) in self.trial.iter_mut().zip(&self.correction) {
            *trial += correction;
        }
        system.complete(&mut self.trial);
        solved
    }

    /// Leaves an unstable equilibrium along the lowest eigenvector, in the direction of its
    /// largest entry, as far as the potential decreases; returns false if it does not. `system`
    /// holds the factors of the shifted Hessian.
    fn leave(&mut self, system: &mut System, unknowns: &[f64], scale: &Scale) -> bool {
        let neutral = NeutralModes::new(scale.spin);
        if inverse_iteration(system, &mut self.direction, &neutral).is_none() {
            return false;
        }
        // Angles are weighted as if they moved the far end.
        let lengths = [1.0, 1.0, 1.0, scale.extent];
        let largest = (self.direction.iter().enumerate())
            .map(|(k, d)| lengths[k % STRIDE] * d)
            .max_by(|a, b| a.abs().total_cmp(&b.abs()))
            .unwrap_or(1.0);
        let sign = 1f64.copysign(largest);
        self.direction
            .iter_mut()
            .for_each(|d| *d *= sign / largest.abs() * scale.extent);
        limit(&mut self.direction, system, DEPARTURE * scale.extent, 1.0);
        let potential = system.potential(unknowns);
        let mut length = 1.0;
        for _ in 0..DEPARTURE_HALVINGS {
            self.move_by(system, unknowns, length);
            if self.bend_back(system, unknowns, length)
                && system.largest_step(unknowns, &self.trial) >= 1.0
            {
                system.evaluate(&self.trial, None);
                if system.potential(&self.trial) < potential {
                    return true;
                }
            }
            length *= 0.5;
        }
        false
    }

    fn move_by(&mut self, system: &mut System, unknowns: &[f64], length: f64) {
        for k in 0..self.trial.len() {
            self.trial[k] = unknowns[k] + length * self.direction[k];
        }
        system.complete(&mut self.trial);
    }
}

impl Start {
    /// Whether the last evaluation, at `trial`, is a sufficient improvement for a step of this
    /// length; `end_slope` is the slope of the potential along the direction at its end.
    fn is_improved(&self, system: &System, trial: &[f64], length: f64, end_slope: f64) -> bool {
        let rise = system.potential(trial) - self.potential;
        rise <= SUFFICIENT_FALL * length * self.slope
            || self.positive
                && system.squared_residual() <= SUFFICIENT_REDUCTION * self.squared_residual
            || rise <= self.rounding && end_slope.abs() <= -LARGEST_END_SLOPE * self.slope
    }
}

/// Runs [`Descent::run`] to its end, without keeping the scratch.
///
/// # Errors
/// [`Divergence`] with the largest residual after the last iteration.
pub(crate) fn find_equilibrium(
    system: &mut System,
    unknowns: &mut [f64],
    tolerance: f64,
) -> Result<usize, Divergence> {
    let found = Descent::new(unknowns.len()).run(system, unknowns, tolerance, &|| true)?;
    Ok(found.expect("it is never stopped"))
}

/// Factors the Jacobian of the last linearisation, shifted by at least `least` and until no pivot
/// is negative; returns the shift over EI/L³. The stiffness that counts as zero is always added.
fn stabilise(system: &mut System, unknowns: &[f64], scale: &Scale, least: f64) -> Option<f64> {
    let mut shift = if least < SMALLEST_SHIFT { 0.0 } else { least };
    for growth in 0..SHIFT_GROWTHS {
        if growth > 0 {
            system.linearize(unknowns, None);
        }
        let rounding: Vec<f64> = (system.assembly.scales.iter())
            .map(|rod| ROUNDINGS * rod.rounding_stiffness)
            .collect();
        let least = (shift * scale.stiffness).max(scale.neutral);
        system.shift_rods(|rod| least.max(rounding[rod]), scale.spin);
        match system.factor() {
            Ok(Some(inertia)) if inertia.negative > 0 => {}
            Ok(_) => return Some(shift),
            Err(_) => {}
        }
        shift = if shift == 0.0 {
            1.0
        } else {
            shift * SHIFT_GROWTH
        };
    }
    None
}

/// Scales `direction` by up to `lengthening`, such that no node moves farther than `largest` (m)
/// and no edge rotates too far; returns the factor.
fn limit(direction: &mut [f64], system: &System, largest: f64, lengthening: f64) -> f64 {
    let mut excess = 1.0 / lengthening;
    for (k, entry) in direction.iter().enumerate() {
        let allowed = if k % STRIDE == 3 {
            LARGEST_TURN
        } else {
            largest
        };
        excess = excess.max(entry.abs() / allowed);
    }
    for edge in &system.assembly.rods.edges {
        let relative = (0..3).map(|axis| {
            direction[STRIDE * edge.end + axis] - direction[STRIDE * edge.start + axis]
        });
        let turn = relative.map(|d| d * d).sum::<f64>().sqrt() / edge.natural_length;
        excess = excess.max(turn / LARGEST_TURN);
    }
    direction.iter_mut().for_each(|d| *d /= excess);
    1.0 / excess
}

/// Largest side of the box around all nodes, m.
pub(super) fn extent(unknowns: &[f64]) -> f64 {
    let mut extent = 0.0_f64;
    for axis in 0..3 {
        let values = unknowns.iter().skip(axis).step_by(STRIDE);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| {
            (l.min(x), h.max(x))
        });
        extent = extent.max(high - low);
    }
    extent
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
