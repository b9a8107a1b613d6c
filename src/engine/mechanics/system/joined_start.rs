//! Joints and bodies in the initial state of a scene.

use super::build::Assembly;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::scene::Start;
use crate::mechanics::{Matrix3, SceneError, UnitQuaternion, Vector3, rotation};
use nalgebra::Rotation3;

const NO_FRAMES: SceneError = SceneError::Unsuitable(
    "the initial state has no rotations of rigid joints, hinges and bodies: an earlier version wrote it, or that scene had none at the same nodes",
);
const BESIDE: SceneError = SceneError::Unsuitable(
    "in the initial state a sliding node is beside its rod, as after its joint has broken",
);

impl Assembly {
    /// Turns frames and bodies, and moves sliding nodes, to the initial state. Positions, velocities
    /// and clamps are those of that state already.
    ///
    /// # Errors
    /// [`SceneError::Unsuitable`] if the state does not fit.
    pub(super) fn begin_joints(&mut self, start: &Start) -> Result<(), SceneError> {
        if self.joints.is_empty() {
            return Ok(());
        }
        self.turn_frames(start)?;
        for slide in &mut self.joints.slides {
            let (parameter, distance) = slide.nearest(&self.unknowns);
            if distance > 0.5 * slide.edge() {
                return Err(BESIDE);
            }
            self.unknowns[slide.unknown] = parameter;
            slide.begin(&self.unknowns);
            self.velocity[slide.unknown] = slide.rate_of(&self.velocity);
        }
        let mut unknowns = std::mem::take(&mut self.unknowns);
        self.joints.complete(&mut unknowns);
        self.joints.turn_ghosts(&unknowns, &mut self.ghosts);
        self.joints.commit();
        self.unknowns = unknowns;
        self.ghosts.iter_mut().for_each(|ghost| ghost.spin = 0.0);
        Ok(())
    }

    /// The node of a rod at which it is clamped to a ghost edge.
    pub(crate) fn node_of_ghost(&self, ghost: usize) -> usize {
        let edge = self.rods.nodes + ghost;
        let mut vertices = self.rods.vertices.iter();
        let vertex = vertices.find(|vertex| vertex.before == edge || vertex.after == edge);
        let vertex = vertex.expect("a ghost edge belongs to a vertex");
        if vertex.before == edge {
            return vertex.after;
        }
        let mut edges = self.rods.edges.iter();
        let before = edges.find(|edge| edge.start == vertex.before);
        before.expect("an edge before the vertex").end
    }

    fn turn_frames(&mut self, start: &Start) -> Result<(), SceneError> {
        for number in 0..self.joints.frames.len() {
            let frame = &self.joints.frames[number];
            if frame.is_ground() {
                continue;
            }
            let found = frame.ghosts.iter().find_map(|(ghost, placed)| {
                let node = self.node_of_ghost(*ghost);
                let placed = [placed.tangent, placed.director];
                Some((placed, start.walls[node]?, node))
            });
            let of_body = frame.vertices.as_ref().and_then(|vertices| {
                let wall = start.walls[vertices.centre]?;
                Some(([Vector3::z(), Vector3::x()], wall, vertices.centre))
            });
            let (placed, wall, node) = found.or(of_body).ok_or(NO_FRAMES)?;
            let turn = axes_of(&wall) * axes_of(&placed).inverse();
            let spin = match start.velocities.is_empty() {
                true => self.spin_as_placed(number),
                false => {
                    let known = start.turning.get(node).copied().flatten();
                    known.ok_or(NO_FRAMES)?
                }
            };
            self.turn_frame(number, &turn, &spin);
        }
        Ok(())
    }

    /// Angular velocity with which the description of the scene starts a frame, rad/s.
    fn spin_as_placed(&self, number: usize) -> Vector3 {
        let frames = &self.joints.frames;
        let of_base = |base: usize| frames[base].vector_of(&self.velocity) / frames[base].length;
        match frames[number].hinge {
            None => of_base(number),
            Some((base, axis)) => of_base(base) + axis * frames[number].hinge_angle(&self.velocity),
        }
    }

    /// Gives a frame a rotation since it was placed, and an angular velocity, rad/s.
    fn turn_frame(&mut self, number: usize, turn: &UnitQuaternion, spin: &Vector3) {
        let frame = &self.joints.frames[number];
        let (first, is_held) = (frame.first_unknown, frame.clamp.is_some());
        let own = &mut self.velocity[first..first + STRIDE];
        match frame.hinge {
            None => {
                self.unknowns[first..first + 3].fill(0.0);
                own[..3].copy_from_slice((spin * frame.length).as_slice());
            }
            Some((base, axis)) => {
                let carried = self.joints.rotation(base);
                let relative = rotation::to_vector(&(carried.inverse() * turn));
                self.unknowns[first + 3] = relative.dot(&axis);
                let base = &self.joints.frames[base];
                let of_base = base.vector_of(&self.velocity) / base.length;
                self.velocity[first + 3] = (spin - of_base).dot(&(carried * axis));
            }
        }
        if let Some((first, tips)) = frame.tips(turn) {
            for (k, tip) in tips.iter().enumerate() {
                let unknown = first + STRIDE * k;
                self.velocity[unknown..unknown + 3].copy_from_slice(spin.cross(tip).as_slice());
            }
        }
        let frame = &mut self.joints.frames[number];
        if is_held {
            // Its clamp turns it from here on.
            for (_, placed) in &mut frame.ghosts {
                placed.tangent = turn * placed.tangent;
                placed.director = turn * placed.director;
            }
        } else if frame.hinge.is_none() {
            frame.base = *turn;
        }
        self.joints.rotate(&self.unknowns);
    }
}

/// The rotation of the axes x, y, z to a tangent, a director, and their cross product.
fn axes_of([tangent, director]: &[Vector3; 2]) -> UnitQuaternion {
    let axes = Matrix3::from_columns(&[*tangent, *director, tangent.cross(director)]);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes))
}
