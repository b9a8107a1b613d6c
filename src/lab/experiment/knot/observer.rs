//! Measurements of a knot, at each output time and in between.

use super::KnotRow;
use super::tied_knot::{determinant_of_rods, outward};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::contact::ActiveContact;
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_planning::knot::{Silhouette, fit_circle, silhouette};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Measures the knotted rods, the first rods of their scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct KnotObserver {
    /// Number of rods that are tied.
    pub rods: usize,
    /// Nodes of each.
    pub nodes: usize,
    /// Whether two strands are wound into a braid below a loop: an overhand knot.
    pub has_braid: bool,
    /// Radius h of the rods, m.
    pub radius: f64,
    /// Bending stiffness EI, N m².
    pub bending_stiffness: f64,
    /// Stretching stiffness EA, N.
    pub stretching_stiffness: f64,
    /// Length of each rod, m.
    pub length: f64,
    /// Gap below which surfaces count as touching, m.
    pub tolerance: f64,
    /// Determinant of the knot that was tied.
    pub determinant: u64,
    /// Time at which its ends begin to move, s.
    pub pulled_from: f64,
    /// Speed of each end from then on, m/s.
    pub pull_speed: f64,
    /// Largest kinetic over elastic energy of a quasi-static pull.
    pub kinetic_bound: f64,
    /// Whether an inversion is to be detected.
    pub may_invert: bool,
    /// Whether the run ends some time after the knot has inverted.
    pub ends_after_inversion: bool,
}

/// Observation of a knot between output times.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KnotSample {
    /// Mean distance of the ends of a rod along the pull, m.
    pub end_to_end: f64,
    /// Clear height of the loop, m; `None` without a loop.
    pub loop_height: Option<f64>,
}

impl KnotObserver {
    /// The rods of the knot among all nodes of the scene.
    pub fn knotted<'a>(&self, positions: &'a [Vector3]) -> Vec<&'a [Vector3]> {
        let rods = positions.chunks_exact(self.nodes);
        rods.take(self.rods).collect()
    }

    /// F̄ of a traction of one newton: h²/EI, 1/N.
    pub fn force_unit(&self) -> f64 {
        self.radius.powi(2) / self.bending_stiffness
    }

    /// Measures the knot now. Work and losses, which belong to the whole run, are zero.
    pub fn measure(&self, simulation: &Simulation) -> KnotRow {
        let rods = self.knotted(simulation.positions());
        let outward = outward(&rods);
        let tractions: Vec<[f64; 2]> = outward
            .iter()
            .enumerate()
            .map(|(rod, outward)| {
                let first = rod * self.nodes;
                let last = first + self.nodes - 1;
                [
                    simulation.reaction(first).dot(&outward[0]),
                    simulation.reaction(last).dot(&outward[1]),
                ]
            })
            .collect();
        let traction = tractions.iter().flatten().sum::<f64>() / (2 * self.rods) as f64;
        let end_to_end = self.end_to_end(&rods, &outward);
        let contacts = simulation.contacts();
        let touching = self.touching(&contacts);
        let silhouette = self.silhouette(rods[0], &touching);
        let loop_radius = self
            .free_loop(&touching)
            .and_then(|nodes| fit_circle(&simulation.positions()[nodes]))
            .map(|circle| circle.radius);
        KnotRow {
            end_to_end_m: end_to_end,
            shortening_m: self.length - end_to_end,
            traction_start_n: tractions[0][0],
            traction_end_n: tractions[0][1],
            loop_radius_m: loop_radius,
            force_normalized: traction * self.force_unit(),
            epsilon: loop_radius.map(|radius| (self.radius / radius).sqrt()),
            length_normalized: (self.length - end_to_end) / self.radius,
            loop_height_m: silhouette.map(|shape| shape.height),
            braid_width_m: silhouette.map(|shape| shape.width),
            height_normalized: silhouette.map(|shape| shape.height / shape.width),
            contact_force_n: contacts.iter().map(|contact| contact.normal_force).sum(),
            knot_determinant: determinant_of_rods(&rods),
            second_traction_start_n: tractions.get(1).map(|second| second[0]),
            second_traction_end_n: tractions.get(1).map(|second| second[1]),
            ..KnotRow::default()
        }
    }

    /// Observes the knot between output times.
    pub fn sample(&self, simulation: &Simulation) -> KnotSample {
        let rods = self.knotted(simulation.positions());
        let touching = self.touching(&simulation.contacts());
        KnotSample {
            end_to_end: self.end_to_end(&rods, &outward(&rods)),
            loop_height: self
                .silhouette(rods[0], &touching)
                .map(|shape| shape.height),
        }
    }

    /// l̄_k = (L − l_c)/h of the knot at these nodes of its rods (m).
    pub fn length_normalized(&self, rods: &[&[Vector3]]) -> f64 {
        (self.length - self.end_to_end(rods, &outward(rods))) / self.radius
    }

    /// Mean distance of the ends of a rod along the directions in which they are pulled, m.
    fn end_to_end(&self, rods: &[&[Vector3]], outward: &[[Vector3; 2]]) -> f64 {
        let reach = |(rod, outward): (&&[Vector3], &[Vector3; 2])| {
            rod[0].dot(&outward[0]) + rod[self.nodes - 1].dot(&outward[1])
        };
        rods.iter().zip(outward).map(reach).sum::<f64>() / self.rods as f64
    }

    fn silhouette(&self, rod: &[Vector3], touching: &[(usize, usize)]) -> Option<Silhouette> {
        self.has_braid
            .then(|| silhouette(rod, self.radius, touching))
            .flatten()
    }

    /// Whether a measured determinant is that of the knot that was tied.
    pub fn recognises(&self, row: &KnotRow) -> bool {
        row.knot_determinant == Some(self.determinant)
    }

    /// Pairs of nodes of the knot whose edges touch; the node nearer to the start of its rod is
    /// the first.
    fn touching(&self, contacts: &[ActiveContact]) -> Vec<(usize, usize)> {
        let near = |contact: &&ActiveContact| contact.distance - contact.threshold < self.tolerance;
        let pairs = |contact: &ActiveContact| {
            let [a, b, c, d] = contact.nodes;
            [(a, c), (a, d), (b, c), (b, d)].map(|(i, j)| (i.min(j), i.max(j)))
        };
        let knotted = |&(_, last): &(usize, usize)| last < self.rods * self.nodes;
        contacts
            .iter()
            .filter(near)
            .flat_map(pairs)
            .filter(knotted)
            .collect()
    }

    /// The loop: the longest sequence of nodes of a rod without contact between two nodes in
    /// contact; `None` without contact.
    fn free_loop(&self, touching: &[(usize, usize)]) -> Option<Range<usize>> {
        let mut touched = vec![false; self.rods * self.nodes];
        for &(i, j) in touching {
            (touched[i], touched[j]) = (true, true);
        }
        let touched: Vec<usize> = (0..touched.len()).filter(|&node| touched[node]).collect();
        touched
            .windows(2)
            .filter(|pair| pair[0] / self.nodes == pair[1] / self.nodes)
            .map(|pair| pair[0] + 1..pair[1])
            .max_by_key(|run| run.len())
            .filter(|run| !run.is_empty())
    }
}

/// Message for the user about a knot that changed.
pub fn changed_knot(time: f64, expected: u64, found: Option<u64>) -> String {
    let found = found.map_or("not identifiable".to_owned(), |found| found.to_string());
    format!(
        "the knot changed before t = {time:.6} s: its determinant was {expected} and is {found}, so the rod passed through itself; take smaller time steps, or contact.model = \"ipc\" if it is another"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_engine::mechanics::Vector3;

    const OBSERVER: KnotObserver = KnotObserver {
        rods: 1,
        nodes: 60,
        has_braid: true,
        radius: 1e-3,
        bending_stiffness: 1e-6,
        stretching_stiffness: 4.0,
        length: 1.0,
        tolerance: 1e-4,
        determinant: 3,
        pulled_from: 2.0,
        pull_speed: 5e-4,
        kinetic_bound: 1e-3,
        may_invert: true,
        ends_after_inversion: false,
    };

    fn contact(nodes: [usize; 4], gap: f64) -> ActiveContact {
        ActiveContact {
            candidate: 0,
            nodes,
            distance: 2e-3 + gap,
            threshold: 2e-3,
            normal: Vector3::z(),
            normal_force: 1.0,
            force: [0.0; 12],
            first_body: 2,
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
        assert_eq!(OBSERVER.free_loop(&touching), Some(16..30));
        assert_eq!(OBSERVER.free_loop(&[]), None);
    }

    #[test]
    fn the_loop_of_two_rods_is_a_part_of_one() {
        let pair = KnotObserver {
            rods: 2,
            nodes: 30,
            ..OBSERVER
        };
        // The tail between nodes 15 and 30 belongs to the first rod, the rest to the second.
        let contacts = [
            contact([10, 11, 14, 15], 0.0),
            contact([32, 33, 40, 41], 0.0),
            contact([40, 41, 70, 71], 0.0),
        ];
        let touching = pair.touching(&contacts);
        assert_eq!(pair.free_loop(&touching), Some(34..40));
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
