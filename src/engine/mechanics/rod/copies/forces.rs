//! Geometry and gradient of all copies.

use super::super::edge_lanes::{self, EdgeLanes};
use super::super::frame_lanes::{VectorLanes, every_lane, transport_between};
use super::super::topology::STRIDE;
use super::RodCopies;
use crate::linalg::instruction_set::{LANES, Lanes, kernel};
use crate::mechanics::Vector3;

impl RodCopies {
    /// Computes edges, frames and strains at `unknowns`, 4 per node, and adds the gradients to `gradient`.
    pub(crate) fn evaluate(&mut self, unknowns: &[Lanes], gradient: &mut [Lanes]) {
        for edge in &mut self.framed.real {
            let ends = edge.nodes.map(|node| {
                let own = unknowns[STRIDE * node..].first_chunk();
                own.expect("4 are of a node")
            });
            let EdgeLanes { from, frames, .. } = &mut edge.lanes;
            transport_between(self.set, ends, from, frames, &mut edge.director);
        }
        let (framed, nodes) = (&self.framed, self.framed.nodes());
        let local = &mut self.scratch.gradient;
        for vertex in &mut self.vertices {
            let [before, after] = vertex.edges.map(|edge| framed.of(edge));
            let beside = [before.0, after.0];
            let angles = (vertex.sections).bend(self.set, beside, [before.1, after.1]);
            let angle = |edge: usize| match edge < nodes {
                true => &unknowns[STRIDE * edge + 3],
                false => &[0.0; LANES],
            };
            let turned = vertex.edges.map(angle);
            let (between, twists) = (&mut vertex.between, vertex.sections.twists_mut());
            find_twists(self.set, &angles, &vertex.expected, turned, between, twists);
            vertex.sections.gradients(self.set, beside, local);
            let (_, from, to) = vertex.unknowns;
            add_all(self.set, &local[from..to], &mut gradient[vertex.unknowns()]);
        }
        let mut force = every_lane(Vector3::zeros());
        for edge in &self.framed.real {
            edge_lanes::forces(self.set, &edge.lanes, &mut force);
            let start = STRIDE * edge.nodes[0];
            let beside = gradient[start..].first_chunk_mut().expect("both nodes");
            add_force(self.set, &force, beside);
        }
    }
}

kernel! {
    /// Computes reference twists and twists. A reference twist is the angle in `angles` between
    /// reference directors, shifted by full turns to the expected one
    /// ([`super::super::transport::unwrapped`]).
    fn find_twists(
        angles: &Lanes,
        expected: &Lanes,
        turned: [&Lanes; 2],
        between: &mut Lanes,
        twists: &mut Lanes,
    ) {
        for lane in 0..LANES {
            let turn = std::f64::consts::TAU;
            let (angle, away) = (angles[lane], expected[lane] - angles[lane]);
            let shifted = angle + turn * (away / turn).round();
            let own = if away.abs() < 0.5 * turn { angle } else { shifted };
            between[lane] = own;
            twists[lane] = turned[1][lane] - turned[0][lane] + own;
        }
    }
}

kernel! {
    fn add_all(from: &[Lanes], to: &mut [Lanes]) {
        for (to, from) in to.iter_mut().zip(from) {
            for lane in 0..LANES {
                to[lane] += from[lane];
            }
        }
    }
}

kernel! {
    /// Adds the gradient with respect to an edge vector to those of its nodes.
    fn add_force(force: &VectorLanes, gradient: &mut [Lanes; STRIDE + 3]) {
        for axis in 0..3 {
            for lane in 0..LANES {
                gradient[axis][lane] -= force[axis][lane];
                gradient[STRIDE + axis][lane] += force[axis][lane];
            }
        }
    }
}
