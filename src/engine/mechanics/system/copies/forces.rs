//! Residuals of all copies.

use super::{Copies, NONE};
use crate::linalg::instruction_set::{LANES, Lanes, kernel};
use crate::mechanics::rod::STRIDE;

impl Copies {
    /// Computes frames and strains at `unknowns`, and the residuals.
    pub(crate) fn evaluate(&mut self, unknowns: &[Lanes]) {
        self.residual.fill(NONE);
        self.rods.evaluate(unknowns, &mut self.residual);
        let (set, residual) = (self.set, &mut self.residual[..]);
        let motion = Motion {
            unknowns,
            start: &self.start,
            velocity: &self.velocity,
            per_step: &self.per_step,
            per_acceleration_step: &self.per_acceleration_step,
        };
        for first in (0..residual.len()).step_by(STRIDE) {
            let masses = [&self.loads, &self.masses].map(|own| node(own, first));
            let own = residual[first..].first_chunk_mut();
            let motion = motion.of_node(first);
            add_loads_and_inertia(set, &motion, masses, own.expect("a whole node"));
        }
        for chain in &self.shared {
            let first = STRIDE * chain.first_node;
            let residual = &mut residual[first..];
            add_shared_inertia(set, &motion.from(first), &chain.masses, residual);
        }
        for first in (0..self.drag.len()).step_by(STRIDE) {
            let own = residual[first..].first_chunk_mut();
            let motion = motion.of_node(first);
            add_drag(
                set,
                &motion,
                node(&self.drag, first),
                own.expect("a whole node"),
            );
        }
    }
}

/// Numbers of a node.
type OfNode = [Lanes; STRIDE];

fn node(lanes: &[Lanes], first: usize) -> &OfNode {
    lanes[first..].first_chunk().expect("a whole node")
}

/// The motion of a stage, (q − qₙ)/h and vₙ.
pub(super) struct Motion<'a, T: ?Sized> {
    unknowns: &'a T,
    start: &'a T,
    velocity: &'a T,
    per_step: &'a Lanes,
    per_acceleration_step: &'a Lanes,
}

impl Motion<'_, [Lanes]> {
    /// Motion of the unknowns from `first` on.
    fn from(&self, first: usize) -> Self {
        Self {
            unknowns: &self.unknowns[first..],
            start: &self.start[first..],
            velocity: &self.velocity[first..],
            ..*self
        }
    }

    /// Motion of the node whose first unknown is `first`.
    fn of_node(&self, first: usize) -> Motion<'_, OfNode> {
        Motion {
            unknowns: node(self.unknowns, first),
            start: node(self.start, first),
            velocity: node(self.velocity, first),
            per_step: self.per_step,
            per_acceleration_step: self.per_acceleration_step,
        }
    }

    /// (q − qₙ)/h − vₙ of an unknown in a lane.
    #[inline(always)]
    fn change(&self, k: usize, lane: usize) -> f64 {
        let moved = self.unknowns[k][lane] - self.start[k][lane];
        moved * self.per_step[lane] - self.velocity[k][lane]
    }
}

kernel! {
    /// Adds −F + M/hₐ ((q − qₙ)/h − vₙ) for the unknowns of one node with their lumped masses. A
    /// loop over all nodes would be vectorised across nodes, with gathers.
    fn add_loads_and_inertia(motion: &Motion<OfNode>, loads_and_masses: [&OfNode; 2], residual: &mut OfNode) {
        let [loads, masses] = loads_and_masses;
        for k in 0..STRIDE {
            for lane in 0..LANES {
                let mass = masses[k][lane] * motion.per_acceleration_step[lane];
                let moved = motion.unknowns[k][lane] - motion.start[k][lane];
                let change = moved * motion.per_step[lane] - motion.velocity[k][lane];
                residual[k][lane] = (residual[k][lane] - loads[k][lane]) + mass * change;
            }
        }
    }
}

kernel! {
    /// Adds the inertia forces of masses that neighbours share: see [`super::super::mass`].
    fn add_shared_inertia(motion: &Motion<[Lanes]>, shared: &[Lanes], residual: &mut [Lanes]) {
        let mut own = [NONE; STRIDE];
        for k in 0..STRIDE {
            for lane in 0..LANES {
                own[k][lane] = motion.per_acceleration_step[lane] * motion.change(k, lane);
            }
        }
        for (unknown, shared) in shared.iter().enumerate() {
            let own = &mut own[unknown % STRIDE];
            for lane in 0..LANES {
                let change = motion.change(unknown + STRIDE, lane);
                let next = motion.per_acceleration_step[lane] * change;
                let force = shared[lane] * (next - own[lane]);
                residual[unknown][lane] += force;
                residual[unknown + STRIDE][lane] -= force;
                own[lane] = next;
            }
        }
    }
}

kernel! {
    /// Adds C (q − qₙ)/h of a node.
    fn add_drag(motion: &Motion<OfNode>, coefficients: &OfNode, residual: &mut OfNode) {
        for k in 0..STRIDE {
            for lane in 0..LANES {
                let moved = motion.unknowns[k][lane] - motion.start[k][lane];
                residual[k][lane] += coefficients[k][lane] * moved * motion.per_step[lane];
            }
        }
    }
}
