//! Clamps: prescribed positions and frames as functions of time.

use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::transport::{
    any_normal, normal_part, parallel_transport, rotated, signed_angle, unwrapped,
};
use crate::mechanics::rod::{GhostEdge, ReferenceFrames, STRIDE};
use crate::mechanics::scene::{Clamp, Motion, piecewise_linear, piecewise_turning};
use crate::mechanics::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// A clamp with everything resolved.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Drive {
    /// Node of the whole scene.
    pub node: usize,
    /// Whether its position is prescribed.
    pub holds_position: bool,
    /// Position at time zero, or when it took hold, m.
    pub position: Vector3,
    /// Tangent and director at that time.
    pub frame: GhostEdge,
    /// Ghost edges that follow the frame.
    pub ghosts: Vec<usize>,
    /// Edges whose both ends are held; their material frames follow, too.
    pub edges: Vec<HeldEdge>,
    /// Whether it has let go: it then holds nothing.
    pub released: bool,
    motion: Motion,
    axis: Vector3,
    pivot: Vector3,
}

/// An edge whose nodes are both held, one of them with its frame.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct HeldEdge {
    /// Node of the whole scene where it starts.
    pub start: usize,
    /// Node where it ends.
    pub end: usize,
    /// First material director at time zero.
    pub director: Vector3,
}

impl Drive {
    /// A clamp at a node that is at `position` with tangent and director `frame` at time zero.
    pub fn new(clamp: &Clamp, node: usize, position: Vector3, frame: GhostEdge) -> Self {
        Self {
            node,
            holds_position: clamp.holds_position,
            position,
            frame,
            ghosts: Vec::new(),
            edges: Vec::new(),
            released: false,
            axis: clamp.motion.axis.unwrap_or(frame.tangent),
            pivot: clamp.motion.pivot.unwrap_or(position),
            motion: clamp.motion.clone(),
        }
    }

    /// Steady rate of turning, rad/s.
    pub fn angular_velocity(&self) -> f64 {
        self.motion.angular_velocity
    }

    /// Replaces the prescribed motion.
    pub fn follow(&mut self, motion: Motion) {
        self.axis = motion.axis.unwrap_or(self.frame.tangent);
        self.pivot = motion.pivot.unwrap_or(self.position);
        self.motion = motion;
    }

    /// The rotation R(t) at a time.
    fn turning(&self, time: f64) -> Turning {
        Turning {
            axis: self.axis,
            angle: piecewise_linear(&self.motion.angle, time).unwrap_or(0.0)
                + self.motion.angular_velocity * time,
            orientation: piecewise_turning(&self.motion.orientation, time),
        }
    }

    /// Writes the prescribed position and frames at `time`.
    pub fn apply(&self, time: f64, unknowns: &mut [f64], ghosts: &mut [GhostEdge]) {
        if self.released {
            return;
        }
        let turning = self.turning(time);
        if self.holds_position {
            let arm = self.position - self.pivot;
            let translation =
                piecewise_linear(&self.motion.translation, time).unwrap_or_else(Vector3::zeros);
            let position = self.pivot + turning.of(&arm) + translation;
            unknowns[STRIDE * self.node..STRIDE * self.node + 3]
                .copy_from_slice(position.as_slice());
        }
        for &ghost in &self.ghosts {
            let tangent = turning.of(&self.frame.tangent).normalize();
            let director = turning.of(&self.frame.director);
            let director = normal_part(&director, &tangent).unwrap_or_else(|| any_normal(&tangent));
            ghosts[ghost] = GhostEdge { tangent, director };
        }
    }

    /// Writes the angles of held edges at `time`, within half a turn of the angles found there; the
    /// positions of all nodes are in place already.
    pub fn turn_edges(&self, time: f64, reference: &ReferenceFrames, unknowns: &mut [f64]) {
        let turning = self.turning(time);
        for edge in &self.edges {
            let along = position(unknowns, edge.end) - position(unknowns, edge.start);
            let tangent = along.normalize();
            let source = &reference.tangent[edge.start];
            let carried = parallel_transport(&reference.director[edge.start], source, &tangent);
            let director = turning.of(&edge.director);
            let angle = signed_angle(&carried, &director, &tangent);
            let unknown = STRIDE * edge.start + 3;
            unknowns[unknown] = unwrapped(angle, unknowns[unknown]);
        }
    }
}

/// A rotation: about an axis first, to an orientation then.
struct Turning {
    axis: Vector3,
    angle: f64,
    orientation: Option<UnitQuaternion>,
}

impl Turning {
    fn of(&self, vector: &Vector3) -> Vector3 {
        let turned = rotated(vector, &self.axis, self.angle);
        match self.orientation {
            Some(orientation) => orientation * turned,
            None => turned,
        }
    }
}
