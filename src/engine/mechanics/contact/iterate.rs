//! Data of the configuration at which contact was last linearised, for the iterations of a step.

use super::multipliers::Moved;
use crate::mechanics::Vector3;

/// Resistance of bodies that are held on both sides, N/m. Any finite value will do, since they do
/// not move.
const HELD: f64 = 1.0;

/// Least numbers of rods and contacts for which a prediction of all forces may pay. Ten rods of a
/// pile take 3.3 iterations a step with it and 4.0 without, in the same time; two touching
/// flagella take a sixth more time for the same number of iterations.
const MANY_RODS: usize = 16;
const MANY_CONTACTS: usize = 8;
/// Largest mean number of contacts per rod for which the prediction may pay. Every contact moves
/// its whole rod in every sweep, whereas the cost of an iteration grows with the number of rods
/// that contacts join. A pile has ten contacts per rod, a knot forty.
const MOST_PER_ROD: usize = 24;
/// Least relative change of the forces for the prediction, from the last step to the linear laws
/// at the predicted positions.
const SURPRISE: f64 = 0.05;

/// The configuration of the last linearisation.
#[derive(Clone, Debug, Default)]
pub(super) struct Iterate {
    /// Displacement of each node under a unit force within a step by inertia alone, h²/m, m/N; zero where it is held. Vertices of
    /// obstacles are not included.
    mobilities: Vec<f64>,
    /// Positions, m; empty before the first linearisation of a step.
    positions: Vec<Vector3>,
    /// Number of contacts in the first linearisation that carry or carried a force; below, the sum
    /// of these forces and the sum of their changes, N.
    contacts: usize,
    /// Number of rods under the contacts that carried a force, each counted once per contact.
    /// Where rods overlap in the prediction, each true contact has many neighbours, which count
    /// too.
    pressed: usize,
    forces: f64,
    changes: f64,
    /// Whether the last correction was small compared with the radius, so that the directions of
    /// contacts hardly turned.
    pub moved_slightly: bool,
}

impl Iterate {
    /// Starts the iterations of a step.
    pub(crate) fn begin(&mut self, mobilities: &[f64]) {
        self.mobilities.clear();
        self.mobilities.extend_from_slice(mobilities);
        self.positions.clear();
        self.moved_slightly = false;
        self.forget_changes();
    }

    /// Records the force of a contact with `rods` rods in the first linearisation: normal force
    /// (N) and traction, in the last step and now.
    pub(crate) fn compare(&mut self, rods: usize, before: (f64, Vector3), now: (f64, Vector3)) {
        if !self.positions.is_empty() {
            return;
        }
        self.contacts += 1;
        if before.0 > 0.0 {
            self.pressed += rods;
        }
        self.forces += before.0.max(now.0);
        self.changes += (now.0 - before.0).abs() + (now.1 * now.0 - before.1 * before.0).norm();
    }

    /// Whether the forces differ much from those of the last step, with many contacts, but not too
    /// many for the number of rods.
    pub(crate) fn is_surprised(&self, rods: usize) -> bool {
        let are_many = rods >= MANY_RODS && self.contacts >= MANY_CONTACTS;
        let suits = are_many && self.pressed <= MOST_PER_ROD * rods;
        suits && self.changes > SURPRISE * self.forces
    }

    /// Discards the record of changes of contact forces.
    pub(crate) fn forget_changes(&mut self) {
        (self.contacts, self.pressed) = (0, 0);
        (self.forces, self.changes) = (0.0, 0.0);
    }

    /// Stores the positions of a linearisation.
    pub(crate) fn linearised_at(&mut self, positions: &[Vector3]) {
        self.positions.clear();
        self.positions.extend_from_slice(positions);
    }

    /// Displacement of a node, now at `position`, since the last linearisation; `None` before the
    /// first.
    pub(crate) fn moved_by(&self, node: usize, position: &Vector3) -> Option<Vector3> {
        Some(position - self.positions.get(node)?)
    }

    /// Displacements of the nodes of a contact, now at `positions`, since the last linearisation,
    /// and their weighted resistance.
    pub(crate) fn moved<const N: usize>(
        &self,
        nodes: &[usize; N],
        weights: &[f64; N],
        positions: &[Vector3; N],
    ) -> Moved {
        let mut displacements = [Vector3::zeros(); 4];
        let mut mobility = 0.0;
        for (k, &node) in nodes.iter().enumerate() {
            let own = self.mobilities.get(node).copied().unwrap_or(0.0);
            mobility += weights[k] * weights[k] * own;
            if let Some(before) = self.positions.get(node) {
                displacements[k] = positions[k] - before;
            }
        }
        Moved {
            displacements,
            inertia: if mobility > 0.0 { 1.0 / mobility } else { HELD },
            slightly: self.moved_slightly,
            predicted: self.positions.is_empty(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An iterate with a number of contacts between two rods each, whose force has changed by this
    /// factor.
    fn seen(contacts: usize, factor: f64) -> Iterate {
        let mut iterate = Iterate::default();
        iterate.begin(&[]);
        for _ in 0..contacts {
            iterate.compare(2, (1.0, Vector3::zeros()), (factor, Vector3::zeros()));
        }
        iterate
    }

    #[test]
    fn many_new_forces_among_many_rods_are_a_surprise() {
        assert!(seen(100, 1.5).is_surprised(20));
        assert!(!seen(100, 1.05).is_surprised(20), "the forces are known");
        assert!(!seen(7, 1.5).is_surprised(20), "there are few");
        assert!(!seen(100, 1.5).is_surprised(2), "a knot");
    }

    #[test]
    fn friction_that_turns_is_a_surprise() {
        let mut iterate = seen(0, 1.0);
        for _ in 0..20 {
            let traction = Vector3::x() * 0.3;
            iterate.compare(2, (1.0, traction), (1.0, -traction));
        }
        assert!(iterate.is_surprised(20));
    }

    #[test]
    fn later_linearisations_do_not_count() {
        let mut iterate = seen(20, 1.0);
        iterate.linearised_at(&[Vector3::zeros()]);
        iterate.compare(2, (1.0, Vector3::zeros()), (1e6, Vector3::zeros()));
        assert!(!iterate.is_surprised(20));
    }
}
