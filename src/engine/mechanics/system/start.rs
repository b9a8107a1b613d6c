//! The final state of one scene as the initial state of another scene with the same rods.

use super::build::Assembly;
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::transport::{
    any_normal, normal_part, parallel_transport, rotated, signed_angle, unwrapped,
};
use crate::mechanics::rod::{GhostEdge, RodRange, STRIDE};
use crate::mechanics::scene::Start;
use crate::mechanics::{SceneError, Vector3};

const OTHER_NODES: SceneError =
    SceneError::Unsuitable("the initial state has a different number of nodes");
const NO_LENGTH: SceneError = SceneError::Unsuitable("an edge of the initial state has no length");

impl Assembly {
    /// Moves all parts from their placed to their initial positions; natural shapes, masses and
    /// lengths do not change. Clamps hold the wall of an earlier clamp at their node, or otherwise
    /// the rod as it passes through the node.
    ///
    /// # Errors
    /// [`SceneError::Unsuitable`] if the state does not fit.
    pub(super) fn begin_at(&mut self, start: &Start) -> Result<(), SceneError> {
        let nodes = self.rods.nodes;
        let others = [start.directors.len(), start.twist.len(), start.walls.len()];
        if start.positions.len() != nodes || others != [nodes; 3] {
            return Err(OTHER_NODES);
        }
        for (node, x) in start.positions.iter().enumerate() {
            self.unknowns[STRIDE * node..STRIDE * node + 3].copy_from_slice(x.as_slice());
            // Reference frames initially equal the material frames.
            self.unknowns[STRIDE * node + 3] = 0.0;
        }
        self.place_frames(start)?;
        self.take_velocities(start);
        for index in 0..self.drives.len() {
            self.take_hold(index, start);
        }
        self.begin_joints(start)?;
        self.count_turns(start);
        Ok(())
    }

    fn place_frames(&mut self, start: &Start) -> Result<(), SceneError> {
        for edge in &self.rods.edges {
            let along = position(&self.unknowns, edge.end) - position(&self.unknowns, edge.start);
            let length = along.norm();
            if !(length > 0.0 && length.is_finite()) {
                return Err(NO_LENGTH);
            }
            let tangent = along / length;
            let director = normal_part(&start.directors[edge.start], &tangent);
            self.reference.tangent[edge.start] = tangent;
            self.reference.director[edge.start] = director.unwrap_or_else(|| any_normal(&tangent));
        }
        Ok(())
    }

    fn take_velocities(&mut self, start: &Start) {
        let motions = start.velocities.iter().zip(&start.spins);
        for (node, (velocity, spin)) in motions.enumerate() {
            if !self.obstacle[node] {
                let here = &mut self.velocity[STRIDE * node..STRIDE * (node + 1)];
                here[..3].copy_from_slice(velocity.as_slice());
                here[3] = *spin;
            }
        }
    }

    /// Moves a clamp to the present position of its node.
    fn take_hold(&mut self, index: usize, start: &Start) {
        let node = self.drives[index].node;
        let (rod, along) = self.locate(node);
        let frame = match start.walls[node] {
            Some([tangent, director]) => GhostEdge {
                tangent,
                director,
                spin: 0.0,
            },
            None => self.frame_through(self.rods.rods[rod], along, &start.twist),
        };
        let reference = &self.reference;
        let drive = &mut self.drives[index];
        drive.take_hold(start.positions[node], frame, |edge| {
            reference.director[edge]
        });
        for &ghost in &drive.ghosts {
            self.ghosts[ghost] = frame;
        }
    }

    /// Tangent and material frame of the smooth rod at a node along it.
    fn frame_through(&self, range: RodRange, node: usize, twist: &[f64]) -> GhostEdge {
        let last = range.edges() - 1;
        let tangent_of = |edge: usize| self.reference.tangent[range.first_node + edge];
        let twist_at = |node: usize| twist[range.first_node + node % range.nodes];
        let outside = |edge: usize, neighbour: usize| {
            (tangent_of(edge) * 1.5 - tangent_of(neighbour) * 0.5).normalize()
        };
        let (edge, tangent, turn) = if !range.closed && node == 0 {
            (0, outside(0, last.min(1)), -0.5 * twist_at(last.min(1)))
        } else if !range.closed && node == last + 1 {
            (
                last,
                outside(last, last.saturating_sub(1)),
                0.5 * twist_at(last),
            )
        } else {
            let before = if node == 0 { last } else { node - 1 };
            let mean = (tangent_of(before) + tangent_of(node)).normalize();
            (before, mean, 0.5 * twist_at(node))
        };
        let director = &self.reference.director[range.first_node + edge];
        let carried = parallel_transport(director, &tangent_of(edge), &tangent);
        GhostEdge {
            tangent,
            director: rotated(&carried, &tangent, turn),
            spin: 0.0,
        }
    }

    /// Twist of each vertex from its frames; inside a rod the number of whole turns is that of the
    /// state.
    fn count_turns(&mut self, start: &Start) {
        let nodes = self.rods.nodes;
        let frame_of = |edge: usize| -> (Vector3, Vector3) {
            match edge.checked_sub(nodes) {
                Some(ghost) => (self.ghosts[ghost].tangent, self.ghosts[ghost].director),
                None => (self.reference.tangent[edge], self.reference.director[edge]),
            }
        };
        let twists = self.rods.vertices.iter().map(|vertex| {
            let (before, after) = (frame_of(vertex.before), frame_of(vertex.after));
            let carried = parallel_transport(&before.1, &before.0, &after.0);
            let shown = signed_angle(&carried, &after.1, &after.0);
            if vertex.before.max(vertex.after) < nodes {
                unwrapped(shown, start.twist[vertex.after] + vertex.joint_twist)
            } else {
                shown
            }
        });
        self.reference.twist = twists.collect();
    }
}
