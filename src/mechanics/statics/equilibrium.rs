//! Equilibrium of a system: ∇E(q) = F, approached along directions that go downhill.
//!
//! Where the Hessian has negative pivots the rod is near an instability and a plain Newton step may go
//! uphill; a multiple of the unit matrix is added then, large enough that all pivots are positive. A step
//! moves no node farther than a fraction of the rods' extent, which lets a straight rod find its way to a
//! strongly bent shape, and is shortened until the force along it falls.

use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::{Divergence, System};

/// Most iterations; strongly bent shapes from a straight start take some tens.
const ITERATIONS: usize = 500;
/// Largest move of a node in one iteration, as a fraction of the extent of all rods. Larger jumps skip
/// solution branches; smaller ones only cost iterations.
const LARGEST_MOVE: f64 = 0.1;
/// Growth of the shift until the pivots are positive.
const SHIFT_GROWTH: f64 = 4.0;
/// Most reductions of one step.
const REDUCTIONS: usize = 20;

/// Finds an equilibrium from `unknowns`; returns the iterations. `force` is the largest residual left, N.
///
/// # Errors
/// [`Divergence`] with the largest residual after the last iteration.
pub fn find_equilibrium(
    system: &mut System,
    unknowns: &mut [f64],
    force: f64,
) -> Result<usize, Divergence> {
    let time = system.time;
    system.drive(time, unknowns);
    let extent = extent(unknowns);
    // EI/L³: the bending stiffness of the softest mode, the natural unit of a shift.
    let unit = system.assembly.force_scale / extent;
    let spin_unit = unit * system.assembly.shortest_edge * system.assembly.shortest_edge;
    let mut direction = vec![0.0; unknowns.len()];
    let mut trial = unknowns.to_vec();
    let mut shift = 0.0;
    for iteration in 0..=ITERATIONS {
        system.update_candidates(unknowns);
        system.linearize(unknowns, None);
        let (residual, unknown) = system.worst_residual();
        if residual <= force {
            system.commit_frames();
            return Ok(iteration);
        }
        let failed = Divergence {
            iterations: iteration,
            residual,
            unknown,
        };
        if !residual.is_finite() || iteration == ITERATIONS {
            return Err(failed);
        }
        shift = stabilise(system, unknowns, shift / SHIFT_GROWTH, unit, spin_unit).ok_or(failed)?;
        system.direction(&mut direction).map_err(|_| failed)?;
        limit(&mut direction, LARGEST_MOVE * extent);
        let initial: f64 = dot(&direction, &system.residual);
        let before = system.squared_residual();
        for k in 0..trial.len() {
            trial[k] = unknowns[k] + direction[k];
        }
        let mut length = system.largest_step(unknowns, &trial);
        for _ in 0..REDUCTIONS {
            for k in 0..trial.len() {
                trial[k] = unknowns[k] + length * direction[k];
            }
            system.evaluate(&trial, None);
            // Downhill still at the end of the step, or past the bottom with less force than at its start.
            let slope = dot(&direction, &system.residual);
            if slope <= 0.5 * initial.abs() || system.squared_residual() < before {
                break;
            }
            length *= 0.5;
        }
        unknowns.copy_from_slice(&trial);
        system.update_geometry(unknowns);
        system.commit_frames();
    }
    unreachable!("the last iteration returns")
}

/// Factors the Jacobian, shifted until no pivot is negative; returns the shift in units of EI/L³.
fn stabilise(
    system: &mut System,
    unknowns: &[f64],
    start: f64,
    unit: f64,
    spin_unit: f64,
) -> Option<f64> {
    let mut shift = if start < 1e-3 { 0.0 } else { start };
    for _ in 0..60 {
        if shift > 0.0 {
            system.linearize(unknowns, None);
            system.shift(shift * unit, shift * spin_unit);
        }
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

/// Scales `direction` so that no position moves farther than `largest`.
fn limit(direction: &mut [f64], largest: f64) {
    let moved = direction
        .iter()
        .enumerate()
        .filter(|(k, _)| k % STRIDE != 3)
        .map(|(_, d)| d.abs());
    let most = moved.fold(0.0, f64::max);
    if most > largest {
        let factor = largest / most;
        direction.iter_mut().for_each(|d| *d *= factor);
    }
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
