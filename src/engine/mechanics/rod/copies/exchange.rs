//! Numbers of rods that go into the lanes, and geometry that returns from them.

use super::super::discretization::{ElasticRods, GhostEdge};
use super::super::frame_lanes::{set_vector, vector};
use super::super::geometry::{ReferenceFrames, RodGeometry};
use super::RodCopies;
use crate::linalg::instruction_set::LANES;

/// Rods that go into a lane, with the frames from which the present step transports and the ghost edges of the present time.
#[derive(Clone, Copy)]
pub(crate) struct Original<'a> {
    pub rods: &'a ElasticRods,
    pub reference: &'a ReferenceFrames,
    pub ghosts: &'a [GhostEdge],
}

impl RodCopies {
    /// Puts rods into the lanes.
    pub(crate) fn set(&mut self, originals: &[Original; LANES]) {
        for (place, own) in self.framed.real.iter_mut().enumerate() {
            for (lane, original) in originals.iter().enumerate() {
                let edge = &original.rods.edges[place];
                own.lanes.take_natural_length(lane, edge);
                let (source, director) = (
                    &original.reference.tangent[edge.start],
                    &original.reference.director[edge.start],
                );
                own.lanes.from.set_source(lane, source, director);
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
                let vertex = &original.rods.vertices[place];
                let spin = |edge: usize| {
                    let ghost = edge.checked_sub(nodes);
                    ghost.map_or(0.0, |ghost| original.ghosts[ghost].spin)
                };
                own.sections.set(lane, vertex);
                let twist = original.reference.twist[place];
                own.expected[lane] = twist + spin(vertex.after) - spin(vertex.before);
                own.joint_twist[lane] = vertex.joint_twist;
            }
        }
    }

    /// Gives the geometry of the last evaluation to copies, each with its lane and its ghost edges.
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
