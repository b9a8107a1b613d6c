//! Residuals of all copies.

use super::{Copies, NONE};
use crate::linalg::instruction_set::{LANES, Lanes, kernel};
use crate::mechanics::rod::STRIDE;

impl Copies {
    /// Computes frames and strains at `unknowns`, and the residuals.
    pub(crate) fn evaluate(&mut self, unknowns: &[Lanes]) {
        self.residual.fill(NONE);
        self.rods.evaluate(unknowns, &mut self.residual);
        let motion = Motion {
            unknowns,
            start: &self.start,
            velocity: &self.velocity,
            per_step: &self.per_step,
            per_acceleration_step: &self.per_acceleration_step,
        };
        let (set, residual) = (self.set, &mut self.residual[..]);
        add_loads_and_inertia(set, &motion, &self.loads, &self.masses, residual);
        for chain in &self.shared {
            let first = STRIDE * chain.first_node;
            add_shared_inertia(set, &motion.from(first), &chain.masses, &mut residual[first..]);
        }
        add_drag(set, &motion, &self.drag, residual);
    }
}

/// The motion of a stage, (q − qₙ)/h and vₙ.
struct Motion<'a> {
    unknowns: &'a [Lanes],
    start: &'a [Lanes],
    velocity: &'a [Lanes],
    per_step: &'a Lanes,
    per_acceleration_step: &'a Lanes,
}

impl Motion<'_> {
    /// That of the unknowns from `first` on.
    fn from(&self, first: usize) -> Self {
        Self {
            unknowns: &self.unknowns[first..],
            start: &self.start[first..],
            velocity: &self.velocity[first..],
            ..*self
        }
    }
}

/// (q − qₙ)/h − vₙ of an unknown in a lane.
#[inline(always)]
fn change(
    [unknown, start, velocity, per_step]: [&Lanes; 4],
    lane: usize,
) -> f64 {
    (unknown[lane] - start[lane]) * per_step[lane] - velocity[lane]
}

kernel! {
    /// Adds −F + M/hₐ ((q − qₙ)/h − vₙ) with the masses lumped at each unknown.
    fn add_loads_and_inertia(motion: &Motion, loads: &[Lanes], masses: &[Lanes], residual: &mut [Lanes]) {
        let (per_step, per_acceleration_step) = (*motion.per_step, *motion.per_acceleration_step);
        let forces = loads.iter().zip(masses);
        let moved = motion.unknowns.iter().zip(motion.start).zip(motion.velocity);
        for ((entry, (load, mass)), ((unknown, start), velocity)) in residual.iter_mut().zip(forces).zip(moved) {
            for lane in 0..LANES {
                let mass = mass[lane] * per_acceleration_step[lane];
                let change = change([unknown, start, velocity, &per_step], lane);
                entry[lane] = (entry[lane] - load[lane]) + mass * change;
            }
        }
    }
}

kernel! {
    /// Adds what the accelerations make of the masses that neighbours share: see [`super::super::mass`].
    fn add_shared_inertia(motion: &Motion, shared: &[Lanes], residual: &mut [Lanes]) {
        let (per_step, per_acceleration_step) = (*motion.per_step, *motion.per_acceleration_step);
        let change_of = |k: usize, lane: usize| {
            let moved = [&motion.unknowns[k], &motion.start[k], &motion.velocity[k], &per_step];
            per_acceleration_step[lane] * change(moved, lane)
        };
        let mut own = [NONE; STRIDE];
        for k in 0..STRIDE {
            for lane in 0..LANES {
                own[k][lane] = change_of(k, lane);
            }
        }
        for (unknown, shared) in shared.iter().enumerate() {
            let own = &mut own[unknown % STRIDE];
            for lane in 0..LANES {
                let next = change_of(unknown + STRIDE, lane);
                let force = shared[lane] * (next - own[lane]);
                residual[unknown][lane] += force;
                residual[unknown + STRIDE][lane] -= force;
                own[lane] = next;
            }
        }
    }
}

kernel! {
    /// Adds C (q − qₙ)/h.
    fn add_drag(motion: &Motion, coefficients: &[Lanes], residual: &mut [Lanes]) {
        let per_step = *motion.per_step;
        let moved = motion.unknowns.iter().zip(motion.start);
        for ((entry, coefficient), (unknown, start)) in residual.iter_mut().zip(coefficients).zip(moved) {
            for lane in 0..LANES {
                entry[lane] += coefficient[lane] * (unknown[lane] - start[lane]) * per_step[lane];
            }
        }
    }
}
