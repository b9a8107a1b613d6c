//! Edges, frames and strains of all rods at one set of unknowns.

use super::topology::{STRIDE, position};
use super::transport::{parallel_transport, signed_angle, unwrapped};
use super::vertex::{EdgeFrame, VertexStrains, curvatures};
use super::{ElasticRods, GhostEdge};
use crate::linalg::instruction_set::InstructionSet;
use crate::mechanics::Vector3;
use serde::{Deserialize, Serialize};

/// Frames at the start of a step, from which the step transports them in time.
///
/// Arrays over edges have one entry per node (the edge that starts there; unused at the last node of an
/// open rod), `twist` one per vertex.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReferenceFrames {
    /// Unit tangents.
    pub tangent: Vec<Vector3>,
    /// First reference directors.
    pub director: Vec<Vector3>,
    /// Reference twists, rad; they count whole turns.
    pub twist: Vec<f64>,
}

/// Geometry of all rods at one set of unknowns; its storage is reused.
#[derive(Clone, Debug)]
pub struct RodGeometry {
    /// Instructions that kernels may use.
    pub(super) set: InstructionSet,
    /// Framed edges, one per node, then the ghost edges.
    pub edges: Vec<EdgeFrame>,
    /// Strains, one per vertex.
    pub strains: Vec<VertexStrains>,
    /// Reference directors, one per node, then those of the ghost edges.
    reference_director: Vec<Vector3>,
    reference_twist: Vec<f64>,
}

impl RodGeometry {
    /// Storage for `rods`.
    pub fn new(rods: &ElasticRods) -> Self {
        let unused = EdgeFrame {
            tangent: Vector3::zeros(),
            length: 1.0,
            director_1: Vector3::zeros(),
            director_2: Vector3::zeros(),
            holonomy: Vector3::zeros(),
        };
        let edges = rods.nodes + rods.ghosts;
        Self {
            set: InstructionSet::best(),
            edges: vec![unused; edges],
            strains: vec![VertexStrains::default(); rods.vertices.len()],
            reference_director: vec![Vector3::zeros(); edges],
            reference_twist: vec![0.0; rods.vertices.len()],
        }
    }

    /// Computes edges, frames and strains. `unknowns`: 4 per node; `ghosts`: prescribed ghost edges.
    pub fn update(
        &mut self,
        rods: &ElasticRods,
        unknowns: &[f64],
        reference: &ReferenceFrames,
        ghosts: &[GhostEdge],
    ) {
        for edge in &rods.edges {
            let (k, end) = (edge.start, edge.end);
            let vector = position(unknowns, end) - position(unknowns, k);
            let length = vector.norm();
            let tangent = vector / length;
            let source = &reference.tangent[k];
            let director = parallel_transport(&reference.director[k], source, &tangent);
            let (sin, cos) = libm::sincos(unknowns[STRIDE * k + 3]);
            let normal = tangent.cross(&director);
            self.reference_director[k] = director;
            self.edges[k] = EdgeFrame {
                tangent,
                length,
                director_1: director * cos + normal * sin,
                director_2: normal * cos - director * sin,
                holonomy: source.cross(&tangent) * (-1.0 / ((1.0 + source.dot(&tangent)) * length)),
            };
        }
        for (index, ghost) in ghosts.iter().enumerate() {
            let k = rods.nodes + index;
            self.reference_director[k] = ghost.director;
            self.edges[k] = EdgeFrame {
                tangent: ghost.tangent,
                // No move of a node turns it.
                length: f64::INFINITY,
                director_1: ghost.director,
                director_2: ghost.tangent.cross(&ghost.director),
                holonomy: Vector3::zeros(),
            };
        }
        let angle = |edge: usize| {
            if edge < rods.nodes {
                unknowns[STRIDE * edge + 3]
            } else {
                0.0
            }
        };
        for (v, vertex) in rods.vertices.iter().enumerate() {
            let (before, after) = (&self.edges[vertex.before], &self.edges[vertex.after]);
            let carried = parallel_transport(
                &self.reference_director[vertex.before],
                &before.tangent,
                &after.tangent,
            );
            let raw = signed_angle(
                &carried,
                &self.reference_director[vertex.after],
                &after.tangent,
            );
            let reference_twist = unwrapped(raw, reference.twist[v]);
            self.reference_twist[v] = reference_twist;
            self.strains[v] = VertexStrains {
                curvature: curvatures(before, after),
                twist: angle(vertex.after) - angle(vertex.before) + reference_twist
                    - vertex.joint_twist,
            };
        }
    }

    /// Makes the present frames the source of the next step.
    pub fn commit(&self, reference: &mut ReferenceFrames) {
        for k in 0..reference.tangent.len() {
            reference.tangent[k] = self.edges[k].tangent;
            reference.director[k] = self.reference_director[k];
        }
        reference.twist.copy_from_slice(&self.reference_twist);
    }
}
