//! The place of an eyelet and its derivatives.
//!
//! An eyelet on a rod is at p = x + Σ w r, where r = a m₁ + b m₂ turns with an edge and w is the
//! weight of the edge: 1 at an end of the rod, ½ for each of the two edges at an inner node. As in
//! [`super::super::follower`], with s = t × r, the edge vector e of the length l and the holonomy
//! c of its frame,
//!
//! ```text
//! ∂r/∂θ = s,     ∂r/∂e = −t rᵀ/l + s cᵀ
//! ```
//!
//! For a force f on the eyelet, ∂(f·r)/∂e = −(f·t) r/l + (f·s) c, and with ∂s/∂e = −t sᵀ/l − r cᵀ
//! the second derivatives are
//!
//! ```text
//! ∂²(f·r)/∂θ² = −f·r
//! ∂²(f·r)/∂θ∂e = −(f·t) s/l − (f·r) c = g
//! ∂²(f·r)/∂e² = (f·t) (t rᵀ/l − s cᵀ)/l − r (f − 2 (f·t) t)ᵀ/l² + c gᵀ + (f·s) ∇c
//! ```
//!
//! Of the last, the symmetric part is used, as in the Hessian of elastic energy.

use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::vertex::EdgeFrame;
use crate::mechanics::rod::{RodGeometry, STRIDE, holonomy_jacobian};
use crate::mechanics::{Matrix3, Vector3};

/// Edge whose frame carries an eyelet.
#[derive(Clone, Copy, Debug)]
pub(super) struct CarryingEdge {
    pub start: usize,
    pub end: usize,
    /// w.
    pub weight: f64,
}

/// An eyelet on a rod.
#[derive(Clone, Debug)]
pub(super) struct RodEyelet {
    pub node: usize,
    /// a and b, m.
    pub offset: [f64; 2],
    /// The edges at the node; none if the offset is zero.
    pub edges: Vec<CarryingEdge>,
}

impl RodEyelet {
    /// r of an edge, m.
    fn arm(&self, frame: &EdgeFrame) -> Vector3 {
        frame.director_1 * self.offset[0] + frame.director_2 * self.offset[1]
    }

    /// p, m.
    pub(super) fn place(&self, unknowns: &[f64], geometry: &RodGeometry) -> Vector3 {
        let arm = |edge: &CarryingEdge| self.arm(&geometry.edges[edge.start]) * edge.weight;
        position(unknowns, self.node) + self.edges.iter().map(arm).sum::<Vector3>()
    }

    /// The unknowns on which p depends: the position of the node, then for each edge the positions
    /// of its end and of its start, and its angle. They are counted in this order below; an unknown
    /// may occur more than once, and its derivatives add up.
    pub(super) fn unknowns(&self) -> impl Iterator<Item = usize> {
        let of_edge = |edge: &CarryingEdge| {
            let nodes = [edge.end, edge.start].into_iter().flat_map(of_position);
            nodes.chain([STRIDE * edge.start + 3])
        };
        of_position(self.node).chain(self.edges.iter().flat_map(of_edge))
    }

    /// Calls `set` with ∂p/∂q for each of the unknowns.
    pub(super) fn rates(&self, geometry: &RodGeometry, mut set: impl FnMut(Vector3)) {
        (0..3).for_each(|axis| set(Vector3::ith(axis, 1.0)));
        for edge in &self.edges {
            let frame = &geometry.edges[edge.start];
            let arm = self.arm(frame) * edge.weight;
            let spun = frame.tangent.cross(&arm);
            let over_edge = [0, 1, 2].map(|axis| {
                let swing = frame.tangent * (-arm[axis] * frame.inverse_length);
                swing + spun * frame.holonomy[axis]
            });
            over_edge.into_iter().for_each(&mut set);
            over_edge.into_iter().for_each(|rate| set(-rate));
            set(spun);
        }
    }

    /// Calls `add` with the second derivatives of f·p over two unknowns, for a force f. Those over
    /// a position and an angle are passed in both orders.
    pub(super) fn curvature(
        &self,
        force: &Vector3,
        geometry: &RodGeometry,
        sources: &[Vector3],
        mut add: impl FnMut(usize, usize, f64),
    ) {
        for (number, edge) in self.edges.iter().enumerate() {
            let frame = &geometry.edges[edge.start];
            let arm = self.arm(frame) * edge.weight;
            let source = &sources[edge.start];
            let (over_edge, over_both, over_angle) = second_derivatives(force, &arm, frame, source);
            let first = 3 + 7 * number;
            let angle = first + 6;
            let sign = |k: usize| if k < 3 { 1.0 } else { -1.0 };
            for row in 0..6 {
                for column in 0..6 {
                    let value = over_edge[(row % 3, column % 3)];
                    add(
                        first + row,
                        first + column,
                        sign(row) * sign(column) * value,
                    );
                }
                add(first + row, angle, sign(row) * over_both[row % 3]);
                add(angle, first + row, sign(row) * over_both[row % 3]);
            }
            add(angle, angle, over_angle);
        }
    }
}

/// The second derivatives of f·r with respect to the edge vector, to both, and to the angle.
fn second_derivatives(
    force: &Vector3,
    arm: &Vector3,
    frame: &EdgeFrame,
    source: &Vector3,
) -> (Matrix3, Vector3, f64) {
    let (tangent, holonomy, inverse_length) =
        (&frame.tangent, &frame.holonomy, frame.inverse_length);
    let spun = tangent.cross(arm);
    let [along, on_arm, on_spun] = [tangent, arm, &spun].map(|vector| force.dot(vector));
    // The derivative of −(f·t) r/l + (f·s) c with respect to e.
    let of_share = (force - tangent * (2.0 * along)) * (inverse_length * inverse_length);
    let of_arm = (tangent * arm.transpose() * inverse_length - spun * holonomy.transpose())
        * (along * inverse_length);
    let over_both = spun * (-along * inverse_length) - holonomy * on_arm;
    let over_edges = of_arm - arm * of_share.transpose()
        + holonomy * over_both.transpose()
        + holonomy_jacobian(source, frame) * on_spun;
    (
        (over_edges + over_edges.transpose()) * 0.5,
        over_both,
        -on_arm,
    )
}

/// The unknowns of the position of a node.
fn of_position(node: usize) -> impl Iterator<Item = usize> {
    STRIDE * node..STRIDE * node + 3
}
