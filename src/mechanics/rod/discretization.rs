//! Rods as edges and the vertices between them.

use super::topology::RodRange;
use super::vertex::{VertexStiffness, VertexStrains};
use crate::linalg::Element;
use crate::mechanics::Vector3;
use serde::{Deserialize, Serialize};

/// An edge of prescribed direction and frame at a clamped node.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GhostEdge {
    /// Unit tangent.
    pub tangent: Vector3,
    /// First material director.
    pub director: Vector3,
    /// Turn of the director about the tangent since the reference frames were committed, rad. The frames show it but for
    /// whole turns.
    pub spin: f64,
}

/// A real edge.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// Node at its start, also its own index.
    pub start: usize,
    /// Node at its end.
    pub end: usize,
    /// Natural length l̃, m.
    pub natural_length: f64,
    /// Stretching stiffness EA, N.
    pub stretching: f64,
}

/// A place where two edges, one of which may be a ghost, meet.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Vertex {
    /// Edge before it.
    pub before: usize,
    /// Edge after it.
    pub after: usize,
    /// Natural strains.
    pub natural: VertexStrains,
    /// Stiffness over Voronoi length.
    pub stiffness: VertexStiffness,
    /// Twist at which the frames of a ring are glued at its joint, rad; zero elsewhere.
    pub joint_twist: f64,
    /// Where its derivatives go.
    pub unknowns: VertexUnknowns,
}

/// Numbering of the eleven unknowns (x₋, θ⁰, x, θ¹, x₊) of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum VertexUnknowns {
    /// Local unknowns `from..to` are consecutive and start at `first`; the others belong to a ghost.
    Consecutive {
        /// Global number of local unknown `from`.
        first: usize,
        /// First local unknown that exists.
        from: usize,
        /// End of the local unknowns that exist.
        to: usize,
    },
    /// The vertex closes a ring: its unknowns are those of element number `element`.
    Closing {
        /// Index into [`ElasticRods::elements`].
        element: usize,
    },
}

/// All rods as elastic bodies.
#[derive(Clone, Debug, Default)]
pub struct ElasticRods {
    /// Numbering of each rod.
    pub rods: Vec<RodRange>,
    /// Real edges.
    pub edges: Vec<Edge>,
    /// Vertices, those of ghost edges among them.
    pub vertices: Vec<Vertex>,
    /// Unknowns of the vertices that close rings; they do not fit in the band.
    pub elements: Vec<Element>,
    /// Number of nodes of all rods.
    pub nodes: usize,
    /// Number of ghost edges; their indices follow those of the nodes.
    pub ghosts: usize,
}
