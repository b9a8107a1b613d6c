//! What the iterations of a step know of the configuration at which contact was last linearised.

use super::multipliers::Moved;
use crate::mechanics::Vector3;

/// Resistance of bodies that are held on both sides, N/m: any finite one, since nothing moves them.
const HELD: f64 = 1.0;

/// The configuration of the last linearisation.
#[derive(Clone, Debug, Default)]
pub(super) struct Iterate {
    /// How far a unit force moves each node within a step by inertia alone, h²/m, m/N; zero where it is held.
    mobilities: Vec<f64>,
    /// Positions, m; empty before the first linearisation of a step.
    positions: Vec<Vector3>,
    /// Whether the last correction was small: against the radius, so that directions of contacts hardly turned.
    pub moved_slightly: bool,
}

impl Iterate {
    /// Starts the iterations of a step.
    pub fn begin(&mut self, mobilities: &[f64]) {
        self.mobilities.clear();
        self.mobilities.extend_from_slice(mobilities);
        self.positions.clear();
        self.moved_slightly = false;
    }

    /// Takes over the positions of a linearisation.
    pub fn linearised_at(&mut self, positions: &[Vector3]) {
        self.positions.clear();
        self.positions.extend_from_slice(positions);
    }

    /// How the nodes of a contact, now at `positions`, have moved since, and how they resist with their weights.
    pub fn moved<const N: usize>(
        &self,
        nodes: &[usize; N],
        weights: &[f64; N],
        positions: &[Vector3; N],
    ) -> Moved {
        let mut displacements = [Vector3::zeros(); 4];
        let mut mobility = 0.0;
        for (k, &node) in nodes.iter().enumerate() {
            mobility += weights[k] * weights[k] * self.mobilities[node];
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
