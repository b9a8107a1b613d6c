//! Height and width of the loop of a tied overhand knot (thesis figure 3.4a).

use rodlab_engine::mechanics::Vector3;
use std::ops::RangeInclusive;

/// Fraction of the largest distance along the rod between touching nodes, above which a contact is
/// between the two strands of the braid. If an inverted loop is on the braid, nodes at half of
/// that distance touch.
const STRAND_TO_STRAND: f64 = 0.75;

/// Dimensions of the loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Silhouette {
    /// Clear height H: distance between the surfaces of the rod in the middle of the loop and of
    /// the braid, m; 0 if they touch.
    pub height: f64,
    /// Width W: distance of the two ends of the braid, m.
    pub width: f64,
}

/// Measures the loop of an overhand knot from its nodes (m), its radius (m), and the pairs of
/// touching nodes. The first node of each pair is the one nearer to the start of the rod. `None`
/// if no nodes touch.
///
/// The braid extends from the first to the last contact of its two strands; the loop joins the
/// strands.
pub fn silhouette(
    nodes: &[Vector3],
    radius: f64,
    touching: &[(usize, usize)],
) -> Option<Silhouette> {
    let [first, second] = strands(touching)?;
    let between = |i: usize, j: usize| 0.5 * (nodes[i] + nodes[j]);
    let start = between(*first.start(), *second.start());
    let end = between(*first.end(), *second.end());
    let inner = first.end() + second.start();
    let middle = between(inner / 2, inner.div_ceil(2));
    let distance = |strand: &RangeInclusive<usize>| {
        nodes[strand.clone()]
            .windows(2)
            .map(|edge| distance_to_segment(&middle, &edge[0], &edge[1]))
            .fold(f64::INFINITY, f64::min)
    };
    Some(Silhouette {
        height: distance(&first).min(distance(&second)) - 2.0 * radius,
        width: (end - start).norm(),
    })
}

/// The nodes of the two strands of the braid.
fn strands(touching: &[(usize, usize)]) -> Option<[RangeInclusive<usize>; 2]> {
    let apart = |&(i, j): &(usize, usize)| (j - i) as f64;
    let farthest = touching.iter().map(apart).fold(0.0, f64::max);
    let mut pairs = touching
        .iter()
        .filter(|pair| apart(pair) >= STRAND_TO_STRAND * farthest);
    let &(i, j) = pairs.next()?;
    let [mut first, mut second] = [i..=i, j..=j];
    for &(i, j) in pairs {
        first = *first.start().min(&i)..=*first.end().max(&i);
        second = *second.start().min(&j)..=*second.end().max(&j);
    }
    // Strands with a single node have no edges.
    (first.start() < first.end() && second.start() < second.end()).then_some([first, second])
}

fn distance_to_segment(point: &Vector3, from: &Vector3, to: &Vector3) -> f64 {
    let edge = to - from;
    let part = (point - from).dot(&edge) / edge.norm_squared();
    (point - (from + edge * part.clamp(0.0, 1.0))).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two straight strands at a distance of 2h from x = −3 to x = 3 (nodes 0 to 6, and the last
    /// seven), joined by a polygon. Its middle is at the height `top` above the upper strand.
    fn knot(top: f64) -> (Vec<Vector3>, Vec<(usize, usize)>) {
        let strand = |y: f64| (-3..=3).map(move |x| Vector3::new(f64::from(x), y, 0.0));
        let mut nodes: Vec<Vector3> = strand(0.0).collect();
        nodes.extend([3.0, 0.0, -3.0].map(|x| {
            let y = if x == 0.0 { 0.2 + top } else { 1.0 };
            Vector3::new(x, y, 0.0)
        }));
        nodes.extend(strand(0.2));
        (nodes, (1..=5).map(|i| (i, i + 10)).collect())
    }

    #[test]
    fn a_loop_is_as_high_as_it_is_clear_of_the_braid() {
        let (nodes, touching) = knot(2.0);
        let found = silhouette(&nodes, 0.1, &touching).unwrap();
        assert!((found.height - 1.8).abs() < 1e-12, "{found:?}");
        assert!((found.width - 4.0).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn a_loop_on_its_braid_has_no_height_and_the_braid_keeps_its_width() {
        let (nodes, mut touching) = knot(0.2);
        touching.extend([(8, 13), (3, 8), (8, 14)]);
        let found = silhouette(&nodes, 0.1, &touching).unwrap();
        assert!(found.height.abs() < 1e-12, "{found:?}");
        assert!((found.width - 4.0).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn without_a_braid_there_is_no_loop() {
        let (nodes, touching) = knot(2.0);
        assert_eq!(silhouette(&nodes, 0.1, &[]), None);
        assert_eq!(silhouette(&nodes, 0.1, &touching[..1]), None);
    }
}
