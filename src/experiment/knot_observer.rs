//! What is measured of a knot at each output time.

use crate::knot::{determinant, fit_circle, silhouette};
use crate::mechanics::contact::ActiveContact;
use crate::mechanics::dynamics::Simulation;
use crate::results::KnotRow;
use std::ops::Range;

/// Measures a knotted rod, the only rod of its scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnotObserver {
    /// Radius h of the rod, m.
    pub radius: f64,
    /// Bending stiffness EI, N m².
    pub bending_stiffness: f64,
    /// Stretching stiffness EA, N.
    pub stretching_stiffness: f64,
    /// Length of the rod, m.
    pub length: f64,
    /// Gap below which surfaces count as touching, m.
    pub tolerance: f64,
    /// Determinant of the knot that was tied.
    pub determinant: u64,
    /// When its ends begin to move, s.
    pub pulled_from: f64,
    /// Whether the run ends some time after the knot has inverted.
    pub ends_after_inversion: bool,
}

impl KnotObserver {
    /// Measures the knot now.
    pub fn measure(&self, simulation: &Simulation) -> KnotRow {
        let positions = simulation.positions();
        let last = positions.len() - 1;
        let axis = (positions[last] - positions[0]).normalize();
        let tractions = [
            -simulation.reaction(0).dot(&axis),
            simulation.reaction(last).dot(&axis),
        ];
        let contacts = simulation.contacts();
        let touching = self.touching(contacts);
        let silhouette = silhouette(positions, self.radius, &touching);
        let loop_radius = self
            .free_loop(positions.len(), &touching)
            .and_then(|nodes| fit_circle(&positions[nodes]))
            .map(|circle| circle.radius);
        let end_to_end = (positions[last] - positions[0]).norm();
        let unit = self.radius.powi(2) / self.bending_stiffness;
        KnotRow {
            end_to_end_m: end_to_end,
            shortening_m: self.length - end_to_end,
            traction_start_n: tractions[0],
            traction_end_n: tractions[1],
            loop_radius_m: loop_radius,
            force_normalized: 0.5 * (tractions[0] + tractions[1]) * unit,
            epsilon: loop_radius.map(|radius| (self.radius / radius).sqrt()),
            length_normalized: (self.length - end_to_end) / self.radius,
            loop_height_m: silhouette.map(|shape| shape.height),
            braid_width_m: silhouette.map(|shape| shape.width),
            height_normalized: silhouette.map(|shape| shape.height / shape.width),
            contact_force_n: contacts.iter().map(|contact| contact.normal_force).sum(),
            knot_determinant: determinant(positions),
        }
    }

    /// Whether a measured determinant is that of the knot that was tied.
    pub fn recognises(&self, row: &KnotRow) -> bool {
        row.knot_determinant == Some(self.determinant)
    }

    /// The pairs of nodes whose edges touch, the node nearer to the start of the rod first.
    fn touching(&self, contacts: &[ActiveContact]) -> Vec<(usize, usize)> {
        let near = |contact: &&ActiveContact| contact.distance - contact.threshold < self.tolerance;
        let pairs = |contact: &ActiveContact| {
            let [a, b, c, d] = contact.nodes;
            [(a, c), (a, d), (b, c), (b, d)].map(|(i, j)| (i.min(j), i.max(j)))
        };
        contacts.iter().filter(near).flat_map(pairs).collect()
    }

    /// The loop: the longest run of nodes out of contact between nodes in contact; `None` without contact.
    fn free_loop(&self, nodes: usize, touching: &[(usize, usize)]) -> Option<Range<usize>> {
        let mut touched = vec![false; nodes];
        for &(i, j) in touching {
            (touched[i], touched[j]) = (true, true);
        }
        let touched: Vec<usize> = (0..nodes).filter(|&node| touched[node]).collect();
        touched
            .windows(2)
            .map(|pair| pair[0] + 1..pair[1])
            .max_by_key(|run| run.len())
            .filter(|run| !run.is_empty())
    }
}

/// A knot that is no longer what it was: a sentence for people.
pub fn changed_knot(time: f64, expected: u64, found: Option<u64>) -> String {
    let found = found.map_or("none that can be told".to_owned(), |found| {
        found.to_string()
    });
    format!(
        "the knot changed before t = {time:.6} s: its determinant was {expected} and is {found}, so the rod passed through itself; raise the contact stiffness or cut the time step"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const OBSERVER: KnotObserver = KnotObserver {
        radius: 1e-3,
        bending_stiffness: 1e-6,
        stretching_stiffness: 4.0,
        length: 1.0,
        tolerance: 1e-4,
        determinant: 3,
        pulled_from: 2.0,
        ends_after_inversion: false,
    };

    fn contact(nodes: [usize; 4], gap: f64) -> ActiveContact {
        ActiveContact {
            candidate: 0,
            nodes,
            distance: 2e-3 + gap,
            threshold: 2e-3,
            normal_force: 1.0,
            force: [0.0; 12],
        }
    }

    #[test]
    fn the_loop_is_the_longest_part_out_of_contact_between_contacts() {
        let contacts = [
            contact([10, 11, 30, 31], 0.0),
            contact([14, 15, 33, 34], 5e-5),
            contact([22, 23, 40, 41], 2e-4),
        ];
        let touching = OBSERVER.touching(&contacts);
        assert_eq!(OBSERVER.free_loop(60, &touching), Some(16..30));
        assert_eq!(OBSERVER.free_loop(60, &[]), None);
    }

    #[test]
    fn another_knot_is_not_recognised() {
        let row = |determinant: Option<u64>| KnotRow {
            knot_determinant: determinant,
            ..KnotRow::default()
        };
        assert!(OBSERVER.recognises(&row(Some(3))));
        assert!(!OBSERVER.recognises(&row(Some(1))));
        assert!(!OBSERVER.recognises(&row(None)));
    }
}
