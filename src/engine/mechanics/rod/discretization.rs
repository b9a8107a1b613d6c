//! Rods as edges and the vertices between them.

use super::topology::RodRange;
use super::turning_angle::{AngleRatio, BendingStrain};
use super::vertex::{self, EdgeFrame, Moments, VertexGradient, VertexStiffness, VertexStrains};
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
    /// Rotation of the director about the tangent since the reference frames were committed, rad,
    /// including whole turns, which the frames do not show.
    pub spin: f64,
}

impl GhostEdge {
    /// Frame of the edge, which does not rotate with any node.
    pub(super) fn frame(&self) -> EdgeFrame {
        EdgeFrame {
            tangent: self.tangent,
            length: f64::INFINITY,
            inverse_length: 0.0,
            director_1: self.director,
            director_2: self.tangent.cross(&self.director),
            holonomy: Vector3::zeros(),
        }
    }
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

/// Weight of a vertex in the integrals of energy, relative to its Voronoi length; `clamped_end`
/// describes where and why it is not 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VertexWeights {
    /// In that of bending.
    pub bending: f64,
    /// In that of twist.
    pub twisting: f64,
}

impl Default for VertexWeights {
    /// Weights of one: the Voronoi length itself.
    fn default() -> Self {
        Self {
            bending: 1.0,
            twisting: 1.0,
        }
    }
}

/// A point where two edges meet, one of which may be a ghost.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Vertex {
    /// Edge before it.
    pub before: usize,
    /// Edge after it.
    pub after: usize,
    /// Natural strains; without bending if the angle is the strain.
    pub natural: VertexStrains,
    /// The measure of bending.
    pub strain: BendingStrain,
    /// Stiffness divided by the weighted Voronoi length.
    pub stiffness: VertexStiffness,
    /// Weights relative to its Voronoi length; not 1 next to clamps of rods with consistent
    /// inertia.
    pub weights: VertexWeights,
    /// Twist at which the frames of a ring are joined at its closure, rad; zero elsewhere.
    pub joint_twist: f64,
    /// Positions of its unknowns.
    pub unknowns: VertexUnknowns,
}

impl Vertex {
    /// Strains of bending and twist minus the natural ones, rad.
    pub(crate) fn elastic_strains(&self, strains: &VertexStrains) -> VertexStrains {
        let (turning, natural) = (self.strain.of(strains), &self.natural);
        VertexStrains {
            curvature: std::array::from_fn(|k| turning.curvature[k] - natural.curvature[k]),
            twist: turning.twist - natural.twist,
        }
    }

    /// Bending energy and twisting energy, J.
    pub(crate) fn energies(&self, strains: &VertexStrains) -> (f64, f64) {
        vertex::energies(&self.strain.of(strains), &self.natural, &self.stiffness)
    }

    /// Gradient of the energy.
    pub(crate) fn gradient(
        &self,
        [before, after]: [&EdgeFrame; 2],
        strains: &VertexStrains,
    ) -> VertexGradient {
        let c = 0.5 * (1.0 + before.tangent.dot(&after.tangent));
        let ratio = AngleRatio::of(c, self.strain.share());
        let moments = Moments::new(&ratio.turning(strains), &self.natural, &self.stiffness);
        ratio
            .over_components(&moments, &strains.curvature)
            .gradient(before, after)
    }
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
    /// One of its edges is a ghost that rotates with a joint or a body. The unknowns of the vertex,
    /// those of the real edge and the rotation of the ghost, are those of element number `element`
    /// (`turning_ghost`).
    Turning {
        /// Index into [`ElasticRods::elements`].
        element: usize,
        /// Whether the ghost is the edge before.
        ghost_first: bool,
    },
}

/// All rods as elastic bodies.
#[derive(Clone, Debug, Default)]
pub struct ElasticRods {
    /// Numbering of each rod.
    pub rods: Vec<RodRange>,
    /// Real edges.
    pub edges: Vec<Edge>,
    /// Vertices, including those with ghost edges.
    pub vertices: Vec<Vertex>,
    /// Unknowns of the vertices that close rings or rotate with joints; they do not fit in the
    /// band.
    pub elements: Vec<Element>,
    /// Number of nodes of all rods.
    pub nodes: usize,
    /// Number of ghost edges; their indices follow those of the nodes.
    pub ghosts: usize,
    /// Indices among the ghost edges of those that rotate with joints and bodies.
    pub turning_ghosts: Vec<usize>,
}
