//! Estimates of the memory and time of a scene before the scene is built.

use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{RodDescription, Scene};
use std::collections::HashMap;

/// Measured memory of a pair of edges in the search for contacts, bytes.
const PAIR: f64 = 80.0;
/// Maximum number of pairs of edges. The repeated search for so many takes a second each time.
/// Edges that are not much shorter than their radius have a few pairs each.
const MOST_PAIRS: f64 = 3e6;
/// Number of edges whose neighbours on other rods are counted; the other edges are assumed to have
/// as many.
const COUNTED: usize = 2000;

/// Rejects scenes in which contact would have too many pairs of edges, because edges are too
/// short, or because too many edges of different rods are near each other. The error is the index
/// of a faulty rod and a message.
pub fn refuse_countless_pairs(scene: &Scene) -> Result<(), (usize, String)> {
    let Some(contact) = scene.contact else {
        return Ok(());
    };
    for (index, rod) in scene.rods.iter().enumerate() {
        let pairs = neighbouring_pairs(rod);
        if pairs > MOST_PAIRS {
            let why = format!(
                "The {} nodes of rod `{}` are much closer together than its diameter of {} m",
                rod.centreline.len(),
                rod.name,
                2.0 * rod.radius,
            );
            return Err((index, too_many(&why, pairs)));
        }
    }
    let (rod, pairs) = pairs_between_rods(scene, contact.distance_tolerance);
    if pairs > MOST_PAIRS {
        let why = format!(
            "Many short edges of different rods, mainly of `{}`, are close together",
            scene.rods[rod].name
        );
        return Err((rod, too_many(&why, pairs)));
    }
    Ok(())
}

fn too_many(why: &str, pairs: f64) -> String {
    format!(
        "contact has {pairs:.1e} pairs of edges to check, which take {:.1} GB; allowed: {MOST_PAIRS:.0e}. {why}: take fewer nodes, \
         or contact.model = \"none\"",
        1e-9 * PAIR * pairs,
    )
}

/// Number of pairs of edges of a rod within a diameter of each other along the rod.
fn neighbouring_pairs(rod: &RodDescription) -> f64 {
    let edges = rod.centreline.windows(2);
    let length: f64 = edges.map(|pair| (pair[1] - pair[0]).norm()).sum();
    let count = rod.centreline.len() as f64;
    count * (count * 2.0 * rod.radius / length).min(0.5 * count)
}

/// An edge.
struct Edge {
    rod: usize,
    ends: [Vector3; 2],
    radius: f64,
}

impl Edge {
    fn middle(&self) -> Vector3 {
        0.5 * (self.ends[0] + self.ends[1])
    }

    /// Radius of the ball around the edge, m.
    fn extent(&self) -> f64 {
        self.radius + 0.5 * (self.ends[1] - self.ends[0]).norm()
    }

    /// Distance of the centrelines, m, measured from ends and middles.
    fn distance(&self, other: &Self) -> f64 {
        let points = |edge: &Self| [edge.ends[0], edge.middle(), edge.ends[1]];
        let there = points(self).map(|point| other.distance_to(&point));
        let back = points(other).map(|point| self.distance_to(&point));
        there.into_iter().chain(back).fold(f64::INFINITY, f64::min)
    }

    fn distance_to(&self, point: &Vector3) -> f64 {
        let along = self.ends[1] - self.ends[0];
        let part = (point - self.ends[0]).dot(&along) / along.norm_squared();
        (self.ends[0] + along * part.clamp(0.0, 1.0) - point).norm()
    }
}

/// Gap of the surfaces of rods, as a fraction of their radii, below which they may soon touch.
const SOON: f64 = 0.25;

/// Number of pairs of edges of different rods that touch, are within the `tolerance` (m) of
/// contact or may soon be, and the rod that has most of them.
fn pairs_between_rods(scene: &Scene, tolerance: f64) -> (usize, f64) {
    let edges = scene
        .rods
        .iter()
        .enumerate()
        .flat_map(|(rod, description)| {
            let edge = move |pair: &[Vector3]| Edge {
                rod,
                ends: [pair[0], pair[1]],
                radius: (1.0 + SOON) * description.radius,
            };
            description.centreline.windows(2).map(edge)
        });
    let edges: Vec<Edge> = edges.collect();
    let largest = edges.iter().map(Edge::extent).fold(0.0, f64::max);
    let size = 2.0 * largest + tolerance;
    let cell = |x: &Vector3| [x.x, x.y, x.z].map(|along| (along / size).floor() as i64);
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    for (index, edge) in edges.iter().enumerate() {
        let here = cells.entry(cell(&edge.middle())).or_default();
        here.push(index as u32);
    }
    let mut of_rod = vec![0.0; scene.rods.len()];
    let every = edges.len().div_ceil(COUNTED).max(1);
    for edge in edges.iter().step_by(every) {
        let [x, y, z] = cell(&edge.middle());
        let near = (0..27).filter_map(|number| {
            let [i, j, k] = [number % 3, number / 3 % 3, number / 9].map(|step: i64| step - 1);
            let place = [
                x.saturating_add(i),
                y.saturating_add(j),
                z.saturating_add(k),
            ];
            cells.get(&place)
        });
        let near = near.flatten().map(|&index| &edges[index as usize]);
        let touching = near.filter(|other| {
            let both_held = scene.rods[edge.rod].held && scene.rods[other.rod].held;
            let reach = edge.radius + other.radius + tolerance;
            other.rod != edge.rod && !both_held && edge.distance(other) < reach
        });
        // Each pair is found from both sides.
        of_rod[edge.rod] += 0.5 * every as f64 * touching.count() as f64;
    }
    let most = (0..of_rod.len()).max_by(|a, b| of_rod[*a].total_cmp(&of_rod[*b]));
    (most.unwrap_or_default(), of_rod.iter().sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_engine::mechanics::contact::ContactParameters;
    use rodlab_engine::mechanics::scene::Stiffness;

    /// A square bundle of parallel rods of 1 m with this number of edges each.
    fn bundle(side: usize, edges: usize, radius: f64) -> Scene {
        let stiffness = Stiffness {
            stretching: 1.0,
            bending: [1.0; 2],
            twisting: 1.0,
        };
        let rod = |number: usize| {
            let spacing = 2.1 * radius;
            let [y, z] = [number % side, number / side].map(|k| spacing * k as f64);
            let node = |k: usize| Vector3::new(k as f64 / edges as f64, y, z);
            RodDescription::uniform(
                "rod",
                (0..=edges).map(node).collect(),
                stiffness,
                radius,
                1.0,
            )
        };
        Scene {
            rods: (0..side * side).map(rod).collect(),
            contact: Some(ContactParameters::default()),
            ..Scene::default()
        }
    }

    #[test]
    fn pairs_of_many_rods_are_counted_before_memory_is_spent_on_them() {
        // 24 pairs of neighbouring rods; an edge pairs with those beside, before and behind it on
        // the other rod.
        let (_, pairs) = pairs_between_rods(&bundle(4, 20, 1e-3), 1e-5);
        assert_eq!(pairs, f64::from(24 * (20 + 2 * 19)));
        refuse_countless_pairs(&bundle(4, 20, 1e-3)).unwrap();
        // A hundred ropes with edges of a twenty-eighth of their radius.
        let (_, message) = refuse_countless_pairs(&bundle(10, 4000, 7e-3)).unwrap_err();
        assert!(message.contains("edges of different rods"), "{message}");
        assert!(message.contains("allowed: 3e6"), "{message}");
    }
}
