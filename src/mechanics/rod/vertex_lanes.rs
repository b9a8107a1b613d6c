//! Gradient and Hessian of [`LANES`] vertices at a time: the formulas of [`super::vertex`] lane by lane.

use super::elastic::Vertex;
use super::vertex::{self, EdgeFrame, VertexGradient, VertexStiffness, VertexStrains};
use super::vertex_hessian;
use crate::linalg::instruction_set::{LANES, Lanes, kernel};
use crate::mechanics::Vector3;

/// Unknowns (x₋, θ⁰, x, θ¹, x₊) of a vertex.
pub(super) const VERTEX_UNKNOWNS: usize = 11;

/// Framed edges, structure of arrays; meaning and units as in [`EdgeFrame`].
#[derive(Clone)]
#[repr(align(64))]
struct EdgeLanes {
    tangent: [Lanes; 3],
    length: Lanes,
    director_1: [Lanes; 3],
    director_2: [Lanes; 3],
    holonomy: [Lanes; 3],
}

#[inline(always)]
fn vector(lanes: &[Lanes; 3], lane: usize) -> Vector3 {
    Vector3::new(lanes[0][lane], lanes[1][lane], lanes[2][lane])
}

impl EdgeLanes {
    fn set(&mut self, lane: usize, edge: &EdgeFrame) {
        for axis in 0..3 {
            self.tangent[axis][lane] = edge.tangent[axis];
            self.director_1[axis][lane] = edge.director_1[axis];
            self.director_2[axis][lane] = edge.director_2[axis];
            self.holonomy[axis][lane] = edge.holonomy[axis];
        }
        self.length[lane] = edge.length;
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> EdgeFrame {
        EdgeFrame {
            tangent: vector(&self.tangent, lane),
            length: self.length[lane],
            director_1: vector(&self.director_1, lane),
            director_2: vector(&self.director_2, lane),
            holonomy: vector(&self.holonomy, lane),
        }
    }
}

/// Strains, structure of arrays, as in [`VertexStrains`].
#[derive(Clone)]
#[repr(align(64))]
struct StrainLanes {
    curvature: [Lanes; 4],
    twist: Lanes,
}

impl StrainLanes {
    fn set(&mut self, lane: usize, strains: &VertexStrains) {
        for k in 0..4 {
            self.curvature[k][lane] = strains.curvature[k];
        }
        self.twist[lane] = strains.twist;
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> VertexStrains {
        let c = &self.curvature;
        VertexStrains {
            curvature: [c[0][lane], c[1][lane], c[2][lane], c[3][lane]],
            twist: self.twist[lane],
        }
    }
}

/// Vertices with their edges, structure of arrays.
#[derive(Clone)]
#[repr(align(64))]
pub(super) struct VertexLanes {
    before: EdgeLanes,
    after: EdgeLanes,
    strains: StrainLanes,
    natural: StrainLanes,
    bending: [Lanes; 2],
    twisting: Lanes,
}

impl VertexLanes {
    pub fn new() -> Self {
        let edge = EdgeLanes {
            tangent: [[1.0; LANES], [0.0; LANES], [0.0; LANES]],
            length: [1.0; LANES],
            director_1: [[0.0; LANES]; 3],
            director_2: [[0.0; LANES]; 3],
            holonomy: [[0.0; LANES]; 3],
        };
        let strains = StrainLanes {
            curvature: [[0.0; LANES]; 4],
            twist: [0.0; LANES],
        };
        Self {
            before: edge.clone(),
            after: edge,
            strains: strains.clone(),
            natural: strains,
            bending: [[0.0; LANES]; 2],
            twisting: [0.0; LANES],
        }
    }

    /// Puts up to [`LANES`] vertices into the lanes; the other lanes keep what they have.
    pub fn fill(&mut self, vertices: &[Vertex], strains: &[VertexStrains], edges: &[EdgeFrame]) {
        for (lane, (vertex, strains)) in vertices.iter().zip(strains).enumerate() {
            self.before.set(lane, &edges[vertex.before]);
            self.after.set(lane, &edges[vertex.after]);
            self.strains.set(lane, strains);
            self.natural.set(lane, &vertex.natural);
            self.bending[0][lane] = vertex.stiffness.bending[0];
            self.bending[1][lane] = vertex.stiffness.bending[1];
            self.twisting[lane] = vertex.stiffness.twisting;
        }
    }

    #[inline(always)]
    fn stiffness(&self, lane: usize) -> VertexStiffness {
        VertexStiffness {
            bending: [self.bending[0][lane], self.bending[1][lane]],
            twisting: self.twisting[lane],
        }
    }
}

/// Gradients over (x₋, θ⁰, x, θ¹, x₊).
pub(super) type GradientLanes = [Lanes; VERTEX_UNKNOWNS];

/// Lower triangles of Hessians over (x₋, θ⁰, x, θ¹, x₊): entry (i, j) at `[j][i - j]`, as in a band matrix.
pub(super) type HessianLanes = [[Lanes; VERTEX_UNKNOWNS]; VERTEX_UNKNOWNS];

kernel! {
    /// [`vertex::gradient`] and [`vertex_hessian::hessian`] of every lane.
    fn derivatives(vertices: &VertexLanes, gradients: &mut GradientLanes, hessians: &mut HessianLanes) {
        for lane in 0..LANES {
            let (before, after) = (vertices.before.get(lane), vertices.after.get(lane));
            let (strains, natural) = (vertices.strains.get(lane), vertices.natural.get(lane));
            let stiffness = vertices.stiffness(lane);
            let gradient = vertex::gradient(&before, &after, &strains, &natural, &stiffness);
            let h = vertex_hessian::hessian(&before, &after, &strains, &natural, &stiffness);
            store_gradient(&gradient, lane, gradients);
            for i in 0..3 {
                for j in 0..3 {
                    let (a, b, c) = (h.e0e0[(i, j)], h.e1e0[(i, j)], h.e1e1[(i, j)]);
                    if j <= i {
                        hessians[j][i - j][lane] = a;
                        hessians[4 + j][i - j][lane] = a - b - h.e1e0[(j, i)] + c;
                        hessians[8 + j][i - j][lane] = c;
                    }
                    hessians[j][4 + i - j][lane] = b - a;
                    hessians[j][8 + i - j][lane] = -b;
                    hessians[4 + j][4 + i - j][lane] = b - c;
                }
                hessians[i][3 - i][lane] = -h.e0phi0[i];
                hessians[i][7 - i][lane] = -h.e0phi1[i];
                hessians[3][1 + i][lane] = h.e0phi0[i] - h.e1phi0[i];
                hessians[3][5 + i][lane] = h.e1phi0[i];
                hessians[4 + i][3 - i][lane] = h.e0phi1[i] - h.e1phi1[i];
                hessians[7][1 + i][lane] = h.e1phi1[i];
            }
            hessians[3][0][lane] = h.phi0phi0;
            hessians[3][4][lane] = h.phi1phi0;
            hessians[7][0][lane] = h.phi1phi1;
        }
    }
}

kernel! {
    /// [`vertex::gradient`] of every lane.
    fn gradients(vertices: &VertexLanes, gradients: &mut GradientLanes) {
        for lane in 0..LANES {
            let (before, after) = (vertices.before.get(lane), vertices.after.get(lane));
            let (strains, natural) = (vertices.strains.get(lane), vertices.natural.get(lane));
            let stiffness = vertices.stiffness(lane);
            let gradient = vertex::gradient(&before, &after, &strains, &natural, &stiffness);
            store_gradient(&gradient, lane, gradients);
        }
    }
}

#[inline(always)]
fn store_gradient(gradient: &VertexGradient, lane: usize, gradients: &mut GradientLanes) {
    for axis in 0..3 {
        gradients[axis][lane] = -gradient.e0[axis];
        gradients[4 + axis][lane] = gradient.e0[axis] - gradient.e1[axis];
        gradients[8 + axis][lane] = gradient.e1[axis];
    }
    gradients[3][lane] = gradient.phi0;
    gradients[7][lane] = gradient.phi1;
}
