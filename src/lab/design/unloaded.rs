//! The nodes of a rod without stress, from its natural strains.

use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::rod::transport::{parallel_transport, rotated};
use rodlab_engine::mechanics::scene::NaturalStrains;

/// Nodes of the rod without stress. The rod begins at `first`, with the frame (tangent and first
/// material director) of the clamp there if `is_clamped`, else of its first edge.
pub fn unloaded(
    natural: &NaturalStrains,
    first: Vector3,
    [mut tangent, mut director]: [Vector3; 2],
    is_clamped: bool,
) -> Vec<Vector3> {
    let mut nodes = vec![first];
    for (edge, length) in natural.lengths.iter().enumerate() {
        if edge > 0 || is_clamped {
            let before = match edge {
                0 => 0.0,
                _ => natural.lengths[edge - 1],
            };
            let voronoi = 0.5 * (before + length);
            let [a, b] = natural.curvature[edge].map(|one| one * voronoi);
            // κb = 2 tan(φ/2) about the axis of turning, with the same components in both frames.
            let binormal = director * a + tangent.cross(&director) * b;
            let size = binormal.norm();
            if size > 0.0 {
                let turned = rotated(&tangent, &(binormal / size), 2.0 * libm::atan(0.5 * size));
                director = parallel_transport(&director, &tangent, &turned);
                tangent = turned;
            }
            director = rotated(&director, &tangent, natural.twist[edge] * voronoi);
        }
        nodes.push(nodes[edge] + tangent * *length);
    }
    nodes
}
