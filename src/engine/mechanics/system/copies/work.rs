//! Work of the residuals of all copies.

use super::super::balance::NEGLIGIBLE_WORK;
use super::Copies;
use crate::linalg::instruction_set::{LANES, Lanes, kernel};

impl Copies {
    /// Whether the residual of the last evaluation, at `unknowns`, may do work on a rod. In lanes
    /// with `false`, [`super::System::residual_does_work`] returns false as well.
    pub(crate) fn may_do_work(&self, unknowns: &[Lanes]) -> [bool; LANES] {
        let mut found = [false; LANES];
        for allowance in self.rods_that_move() {
            let own = allowance.unknowns.clone();
            let numbers = [
                unknowns,
                &self.start,
                &self.residual,
                &self.masses,
                &self.loads,
            ];
            let numbers = numbers.map(|of_all| &of_all[own.clone()]);
            let (mut work, mut energy) = ([0.0; LANES], [0.0; LANES]);
            add_work(
                self.set,
                numbers,
                &self.held[own],
                &self.step,
                &mut work,
                &mut energy,
            );
            for lane in 0..LANES {
                found[lane] |= work[lane].abs() > NEGLIGIBLE_WORK * energy[lane];
            }
        }
        found
    }
}

kernel! {
    /// Adds the work of the residual along the path from the start of the stage, and the energy
    /// against which it may be negligible, without elastic energy.
    fn add_work(
        numbers: [&[Lanes]; 5],
        held: &[bool],
        step: &Lanes,
        work: &mut Lanes,
        energy: &mut Lanes,
    ) {
        let [unknowns, start, residual, masses, loads] = numbers.map(|own| &own[..held.len()]);
        for k in 0..held.len() {
            if held[k] {
                continue;
            }
            for lane in 0..LANES {
                let moved = unknowns[k][lane] - start[k][lane];
                let velocity = moved / step[lane];
                work[lane] += residual[k][lane] * moved;
                let kinetic = 0.5 * masses[k][lane] * velocity * velocity;
                energy[lane] = (energy[lane] + kinetic) + (loads[k][lane] * moved).abs();
            }
        }
    }
}
