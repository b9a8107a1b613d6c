//! An implicit stage of a time step.

use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::position;
use crate::mechanics::{Matrix3, Vector3};

/// Data of an implicit stage of a time step that forces use.
#[derive(Clone, Debug)]
pub struct Stage {
    /// Size h of the implicit stage, s: velocities are (q − qₙ)/h.
    pub step: f64,
    /// Size hₐ of the stage for velocities, s: accelerations are (v − vₙ)/hₐ. This size equals h
    /// except for backward differences.
    pub acceleration_step: f64,
    /// Whether free bodies keep their spin, as in steps of implicit Euler (`spin`).
    pub keeps_spin: bool,
    /// Unknowns at its start.
    pub start: Vec<f64>,
    /// Velocities at its start.
    pub velocity: Vec<f64>,
    /// Drag F₀ of a motion that is near the motion of the stage, N: one force per node, and one per
    /// place for spheres in the fluid; empty without fluid.
    pub drag: Vec<Vector3>,
    /// Velocities v₀ of that motion, m/s, for the same places.
    pub drag_velocity: Vec<Vector3>,
    /// Local resistance D, N s/m, for the same places.
    pub resistance: Vec<Matrix3>,
    /// Torque with which a background flow spins the edge that starts at each node about its axis,
    /// N m; empty without such a flow.
    pub flow_torque: Vec<f64>,
    /// Positions at the start, m per node.
    pub positions: Vec<Vector3>,
    /// Angles at the start, rad for each node at which an edge begins.
    pub angles: Vec<f64>,
}

impl Stage {
    /// Tip of a body at the start, relative to its centre (m), and its velocity there, m/s.
    pub(crate) fn tip_at_start(&self, place: usize) -> [Vector3; 2] {
        [&self.start, &self.velocity].map(|of| position(of, place))
    }

    /// The same stage without the drag of a fluid, but with its local resistance.
    pub(crate) fn without_drag(&self) -> Self {
        let mut stage = self.clone();
        stage.drag.fill(Vector3::zeros());
        stage.drag_velocity.fill(Vector3::zeros());
        stage.flow_torque.clear();
        stage
    }

    /// Sets the positions and angles at the start from the unknowns.
    pub(crate) fn start_at(&mut self, unknowns: &[f64]) {
        copy_positions(unknowns, &mut self.positions);
        for (own, angle) in self
            .angles
            .iter_mut()
            .zip(unknowns.iter().skip(3).step_by(STRIDE))
        {
            *own = *angle;
        }
    }
}

/// The angles of all edges, rad for each node at which one may begin.
pub(crate) fn angles_of(unknowns: &[f64]) -> Vec<f64> {
    unknowns.iter().skip(3).step_by(STRIDE).copied().collect()
}

/// Copies the positions out of the unknowns.
pub(crate) fn copy_positions(unknowns: &[f64], positions: &mut [Vector3]) {
    for (node, x) in positions.iter_mut().enumerate() {
        *x = position(unknowns, node);
    }
}
