//! Memory that a scene would take, before it is spent.

use crate::mechanics::scene::{RodDescription, Scene};

/// Memory of a pair of edges that may touch, in the search for them, bytes; measured.
const PAIR: f64 = 80.0;
/// Most memory that pairs of edges may take, bytes.
const MOST_MEMORY: f64 = 3e9;

/// Refuses edges so much shorter than the diameter of their rod that contact would drown in pairs of neighbours: the
/// index of the first such rod, and why.
pub fn refuse_countless_pairs(scene: &Scene) -> Result<(), (usize, String)> {
    if scene.contact.is_none() {
        return Ok(());
    }
    for (index, rod) in scene.rods.iter().enumerate() {
        let pairs = neighbouring_pairs(rod);
        if PAIR * pairs > MOST_MEMORY {
            let message = format!(
                "the {} nodes of rod `{}` lie so much nearer to each other than its diameter of {} m that contact has \
                 {pairs:.1e} pairs of edges to look at, which take {:.1} GB; allowed: {} GB. Take fewer nodes, or \
                 contact.model = \"none\"",
                rod.centreline.len(),
                rod.name,
                2.0 * rod.radius,
                1e-9 * PAIR * pairs,
                1e-9 * MOST_MEMORY,
            );
            return Err((index, message));
        }
    }
    Ok(())
}

/// Pairs of edges of a rod that lie within a diameter of each other along it.
fn neighbouring_pairs(rod: &RodDescription) -> f64 {
    let edges = rod.centreline.windows(2);
    let length: f64 = edges.map(|pair| (pair[1] - pair[0]).norm()).sum();
    let count = rod.centreline.len() as f64;
    count * (count * 2.0 * rod.radius / length).min(0.5 * count)
}
