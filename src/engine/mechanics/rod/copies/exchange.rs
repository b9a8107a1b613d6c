//! Transfer of rods into the lanes and of their geometry back.

use super::super::discretization::GhostEdge;
use super::super::frame_lanes::{set_vector, vector};
use super::super::geometry::{ReferenceFrames, RodGeometry};
use super::RodCopies;
use crate::linalg::instruction_set::LANES;

/// Rods that go into a lane.
#[derive(Clone, Copy)]
pub(crate) struct Original<'a> {
    /// Geometry, with the natural strains and stiffnesses of the present stage.
    pub geometry: &'a RodGeometry,
    /// Reference frames from which the present step transports.
    pub reference: &'a ReferenceFrames,
    /// Ghost edges at the present time.
    pub ghosts: &'a [GhostEdge],
}

impl RodCopies {
    /// Puts rods into the lanes.
    pub(crate) fn set(&mut self, originals: &[Original; LANES]) {
        for (place, own) in self.framed.real.iter_mut().enumerate() {
            let [start, _] = own.nodes;
            for (lane, original) in originals.iter().enumerate() {
                let batch = &original.geometry.edge_lanes[place / LANES];
                own.lanes.take_lane(lane, batch, place % LANES);
                let ReferenceFrames {
                    tangent, director, ..
                } = original.reference;
                let from = &mut own.lanes.from;
                from.set_source(lane, &tangent[start], &director[start]);
            }
        }
        for (place, own) in self.framed.ghosts.iter_mut().enumerate() {
            for (lane, original) in originals.iter().enumerate() {
                let ghost = &original.ghosts[place];
                own.frames.set(lane, &ghost.frame());
                set_vector(&mut own.director, lane, &ghost.director);
            }
        }
        let nodes = self.framed.nodes();
        for (place, own) in self.vertices.iter_mut().enumerate() {
            for (lane, original) in originals.iter().enumerate() {
                let batch = &original.geometry.vertex_lanes[place / LANES];
                (own.sections).take_lane(lane, batch.sections(), place % LANES);
                let [before, after] = own.edges.map(|edge| match edge.checked_sub(nodes) {
                    Some(ghost) => original.ghosts[ghost].spin,
                    None => 0.0,
                });
                own.expected[lane] = original.reference.twist[place] + after - before;
            }
        }
    }

    /// Copies the geometry of the last evaluation to rods, each given with its lane and its ghost
    /// edges.
    pub(crate) fn give(&self, copies: &mut [(usize, &mut RodGeometry, &[GhostEdge])]) {
        for (_, geometry, ghosts) in copies.iter_mut() {
            geometry.begin_taking(self.framed.nodes(), ghosts);
        }
        for edge in &self.framed.real {
            let [start, _] = edge.nodes;
            for (lane, geometry, _) in copies.iter_mut() {
                let director = vector(&edge.director, *lane);
                geometry.take_edge(start, &edge.lanes.frames.get(*lane), director);
            }
        }
        for (place, vertex) in self.vertices.iter().enumerate() {
            for (lane, geometry, _) in copies.iter_mut() {
                let strains = vertex.sections.strains(*lane);
                geometry.take_vertex(place, &strains, vertex.between[*lane]);
            }
        }
    }
}
