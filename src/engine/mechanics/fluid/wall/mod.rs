//! A plane at which the fluid is at rest: the no-slip wall of the flow, by images of the segments.
//!
//! | file | idea |
//! |---|---|
//! | `image` | the image of one segment in closed form (Blake 1971; Ainley et al. 2008) |
//! | `lanes` | the same for eight segments at a time |
//! | `blocks` | contribution of a wall to the stored operator |
//!
//! # Nodes in the wall
//! The row of a node on the wall vanishes: the fluid is at rest there. A rod that is clamped in
//! the wall has such a node. The force density of the rod falls to zero there, since both the rod
//! and the nearby fluid are at rest. So a held node whose height is less than a tenth of the radius
//! takes no force. If such a node is behind the wall, its edge starts at the wall. Any other node
//! at or behind the wall is an error.
//!
//! # Not resolved
//! Images act between centrelines; lubrication within the gap is not modelled. Ratio of the drag
//! of a long cylinder that moves along the wall to the exact 2πη/arcosh(height/radius), for two
//! regularisations:
//!
//! | height, radii | 1.1 | 1.5 | 2 | 3 | 5 | 10 | 30 |
//! |---|---|---|---|---|---|---|---|
//! | ε = 1.65 radii | 0.47 | 0.80 | 0.91 | 0.97 | 0.99 | 0.998 | 1.000 |
//! | ε = 1.02 radii | 0.33 | 0.59 | 0.69 | 0.77 | 0.82 | 0.86 | 0.89 |
//!
//! √e = 1.65 is the value at which a line of blobs has the drag of a slender cylinder, along and
//! across. With the thesis' 1.02 a rod acts as if it had 0.62 of its radius, which matters more
//! the closer the wall is.

mod blocks;
mod image;
mod lanes;

pub(super) use blocks::WallBlocks;
pub use image::segment_image_integral;

use super::chain::Link;
use super::{Filament, FluidError};
use crate::mechanics::Vector3;

/// Ratio of height to radius below which a held node is in the wall.
const IN_THE_WALL: f64 = 0.1;

/// A plane at which the fluid is at rest.
#[derive(Clone, Debug)]
pub struct Wall {
    /// Any point of the plane, m.
    pub point: Vector3,
    /// Unit normal; the fluid is on the side that it points to.
    pub normal: Vector3,
    /// Nodes of the scene with a held position: these may be in the wall, without drag.
    pub held: Vec<usize>,
}

impl Wall {
    /// Height of a point over the wall, m.
    pub(crate) fn height(&self, x: &Vector3) -> f64 {
        (x - self.point).dot(&self.normal)
    }
}

/// A wall with its effect on each node of the filaments, numbered one filament after the other.
#[derive(Clone, Debug)]
pub(super) struct FlowWall {
    plane: Wall,
    /// Height below which each node is in the wall, m; `None` if the node may not be there.
    sunk_below: Vec<Option<f64>>,
    /// Node of the scene.
    nodes: Vec<usize>,
}

impl FlowWall {
    /// The wall of filaments.
    pub(crate) fn new(plane: Wall, filaments: &[Filament]) -> Self {
        let mut held = plane.held.clone();
        held.sort_unstable();
        let numbered = |filament: &Filament| {
            let radius = filament.radius;
            filament.range().map(move |node| (node, radius))
        };
        let nodes: Vec<(usize, f64)> = filaments.iter().flat_map(numbered).collect();
        Self {
            sunk_below: (nodes.iter())
                .map(|(node, radius)| {
                    (held.binary_search(node).is_ok()).then_some(IN_THE_WALL * radius)
                })
                .collect(),
            nodes: nodes.into_iter().map(|(node, _)| node).collect(),
            plane,
        }
    }

    /// The plane.
    pub(crate) fn plane(&self) -> &Wall {
        &self.plane
    }

    /// Whether a node at `x` is in the wall and so takes no force.
    pub(crate) fn holds(&self, node: usize, x: &Vector3) -> bool {
        self.sunk_below[node].is_some_and(|bound| self.plane.height(x) < bound)
    }

    /// The first node that is at or behind the wall although it may not be: its index in the
    /// scene, and its height, m.
    pub(crate) fn behind(&self, positions: &[Vector3]) -> Option<(usize, f64)> {
        (self.nodes.iter().zip(&self.sunk_below))
            .filter(|(_, sunk_below)| sunk_below.is_none())
            .map(|(&node, _)| (node, self.plane.height(&positions[node])))
            .find(|&(_, height)| height <= 0.0)
    }

    /// Checks that no other node is at or behind the wall. Moves allowed nodes behind the wall
    /// along their edge to the wall, if the other end of the edge is in the fluid.
    ///
    /// # Errors
    /// [`FluidError::BehindWall`].
    pub(crate) fn clip(&self, links: &[Link], positions: &mut [Vector3]) -> Result<(), FluidError> {
        for node in 0..positions.len() {
            let height = self.plane.height(&positions[node]);
            if height > 0.0 {
                continue;
            }
            if self.sunk_below[node].is_none() {
                return Err(FluidError::BehindWall {
                    node: self.nodes[node],
                    name: format!("node {}, counted over all rods,", self.nodes[node]),
                    height,
                });
            }
            let Link { previous, next, .. } = links[node];
            let over = [next, previous]
                .into_iter()
                .flatten()
                .map(|neighbour| positions[neighbour])
                .find(|x| self.plane.height(x) > 0.0);
            if let Some(over) = over {
                let part = height / (height - self.plane.height(&over));
                positions[node] = positions[node].lerp(&over, part);
            }
        }
        Ok(())
    }
}
