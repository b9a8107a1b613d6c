//! A polyline with material frames: the placement of a rod and its natural strains.

use super::discretization::GhostEdge;
use super::topology::RodRange;
use super::transport::{any_normal, normal_part, parallel_transport, rotated, signed_angle};
use super::vertex::{EdgeFrame, VertexStrains, curvatures};
use crate::mechanics::Vector3;

/// Reason why a polyline does not describe a rod.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlacementError {
    /// Two neighbouring nodes coincide.
    #[error("edge {0} has no length")]
    NoLength(usize),
    /// Two neighbouring edges point in opposite directions.
    #[error("the rod turns back on itself at node {0}")]
    TurnsBack(usize),
}

/// A rod's polyline with its frames. Edge arrays have one entry per edge.
#[derive(Clone, Debug)]
pub(crate) struct Placement {
    /// Unit tangents of the edges.
    pub tangents: Vec<Vector3>,
    /// Lengths of the edges, m.
    pub lengths: Vec<f64>,
    /// First reference directors: parallel transported along the rod, without twist.
    pub directors: Vec<Vector3>,
    /// Angles from reference to material directors, rad: the imposed twist, evenly spread.
    pub angles: Vec<f64>,
    /// Twist of each inner vertex, rad.
    pub vertex_twist: f64,
    closed: bool,
    end_tangents: [Option<Vector3>; 2],
}

impl Placement {
    /// Frames along `nodes`; `twist` is the total from first to last edge (once around for a ring).
    ///
    /// # Errors
    /// [`PlacementError`]: the first edge without length, or the first vertex at which the
    /// polyline turns back.
    pub(crate) fn new(
        nodes: &[Vector3],
        closed: bool,
        first_director: Option<Vector3>,
        twist: f64,
        end_tangents: [Option<Vector3>; 2],
    ) -> Result<Self, PlacementError> {
        let range = RodRange {
            first_node: 0,
            nodes: nodes.len(),
            closed,
            rigid: false,
        };
        let edges = range.edges();
        let mut tangents = Vec::with_capacity(edges);
        let mut lengths = Vec::with_capacity(edges);
        for k in 0..edges {
            let edge = nodes[range.end_of(k)] - nodes[k];
            let length = edge.norm();
            if !(length > 0.0 && length.is_finite()) {
                return Err(PlacementError::NoLength(k));
            }
            lengths.push(length);
            tangents.push(edge / length);
        }
        let vertices = if closed { edges } else { edges - 1 };
        for k in 0..vertices {
            if 1.0 + tangents[k].dot(&tangents[(k + 1) % edges]) < 1e-6 {
                return Err(PlacementError::TurnsBack(range.end_of(k)));
            }
        }
        let hint = first_director.and_then(|hint| normal_part(&hint, &tangents[0]));
        let mut directors = vec![hint.unwrap_or_else(|| any_normal(&tangents[0]))];
        for k in 1..edges {
            let carried = parallel_transport(&directors[k - 1], &tangents[k - 1], &tangents[k]);
            directors.push(
                normal_part(&carried, &tangents[k]).expect("transport keeps directors normal"),
            );
        }
        let vertex_twist = if vertices == 0 {
            0.0
        } else {
            twist / vertices as f64
        };
        let angles = (0..edges).map(|k| k as f64 * vertex_twist).collect();
        Ok(Self {
            tangents,
            lengths,
            directors,
            angles,
            vertex_twist,
            closed,
            end_tangents,
        })
    }

    /// First material director of edge `k`.
    pub(crate) fn material_director(&self, k: usize) -> Vector3 {
        self.framed(k).director_1
    }

    /// Material frame of edge `k`.
    fn framed(&self, k: usize) -> EdgeFrame {
        frame(
            &self.tangents[k],
            rotated(&self.directors[k], &self.tangents[k], self.angles[k]),
        )
    }

    /// Tangent and material frame of the smooth rod at `node`, as a clamp there holds it.
    pub(crate) fn frame_at_node(&self, node: usize) -> GhostEdge {
        let last = self.tangents.len() - 1;
        let (edge, tangent, turn) = if !self.closed && node == 0 {
            let tangent = self.end_tangents[0]
                .unwrap_or_else(|| extrapolated(&self.tangents[0], self.tangents.get(1)));
            (0, tangent, -0.5 * self.vertex_twist)
        } else if !self.closed && node == last + 1 {
            let before = last.checked_sub(1).map(|k| &self.tangents[k]);
            let tangent =
                self.end_tangents[1].unwrap_or_else(|| extrapolated(&self.tangents[last], before));
            (last, tangent, 0.5 * self.vertex_twist)
        } else {
            let before = if node == 0 { last } else { node - 1 };
            let mean = (self.tangents[before] + self.tangents[node]).normalize();
            (before, mean, 0.5 * self.vertex_twist)
        };
        let material = self.framed(edge);
        let carried = parallel_transport(&material.director_1, &material.tangent, &tangent);
        GhostEdge {
            tangent,
            director: rotated(&carried, &tangent, turn),
            spin: 0.0,
        }
    }

    /// Reference twist from the last edge of a ring to its first, rad: the angle that remains after
    /// transport once around the ring.
    pub(crate) fn joint_reference_twist(&self) -> f64 {
        let last = self.tangents.len() - 1;
        let carried = parallel_transport(
            &self.directors[last],
            &self.tangents[last],
            &self.tangents[0],
        );
        signed_angle(&carried, &self.directors[0], &self.tangents[0])
    }

    /// Strains at the inner vertex between edges `before` and `after`.
    pub(crate) fn strains(&self, before: usize, after: usize) -> VertexStrains {
        VertexStrains {
            curvature: curvatures(&self.framed(before), &self.framed(after)),
            twist: self.vertex_twist,
        }
    }

    /// Strains between the ghost edge at `node` and the edge `k` before or after it.
    pub(crate) fn ghost_strains(&self, node: usize, k: usize, ghost_first: bool) -> VertexStrains {
        let ghost = self.frame_at_node(node);
        let (ghost, edge) = (frame(&ghost.tangent, ghost.director), self.framed(k));
        let (before, after) = if ghost_first {
            (ghost, edge)
        } else {
            (edge, ghost)
        };
        let carried = parallel_transport(&before.director_1, &before.tangent, &after.tangent);
        VertexStrains {
            curvature: curvatures(&before, &after),
            twist: signed_angle(&carried, &after.director_1, &after.tangent),
        }
    }
}

fn frame(tangent: &Vector3, director: Vector3) -> EdgeFrame {
    EdgeFrame {
        tangent: *tangent,
        length: 1.0,
        inverse_length: 1.0,
        director_1: director,
        director_2: tangent.cross(&director),
        holonomy: Vector3::zeros(),
    }
}

/// Tangent at the outer end of an edge, extrapolated from its neighbour to second order.
fn extrapolated(edge: &Vector3, neighbour: Option<&Vector3>) -> Vector3 {
    match neighbour {
        Some(neighbour) => (edge * 1.5 - neighbour * 0.5).normalize(),
        None => *edge,
    }
}
