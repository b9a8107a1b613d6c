//! An implicit stage of a time step.

use crate::mechanics::rod::topology::position;
use crate::mechanics::{Matrix3, Vector3};

/// Data of an implicit stage of a time step that forces use.
#[derive(Clone, Debug)]
pub struct Stage {
    /// Size h of the implicit stage, s: velocities are (q − qₙ)/h.
    pub step: f64,
    /// Size hₐ of the same for velocities, s: accelerations are (v − vₙ)/hₐ. It is h except for backward differences.
    pub acceleration_step: f64,
    /// Unknowns at its start.
    pub start: Vec<f64>,
    /// Velocities at its start.
    pub velocity: Vec<f64>,
    /// Drag F₀ of a motion near that of the stage, N per node, and with spheres in the fluid per place; empty without fluid.
    pub drag: Vec<Vector3>,
    /// Velocities v₀ of that motion, m/s for the same places.
    pub drag_velocity: Vec<Vector3>,
    /// Local resistance D, N s/m for the same places.
    pub resistance: Vec<Matrix3>,
    /// Positions at the start, m per node.
    pub positions: Vec<Vector3>,
}

/// Copies the positions out of the unknowns.
pub(crate) fn copy_positions(unknowns: &[f64], positions: &mut [Vector3]) {
    for (node, x) in positions.iter_mut().enumerate() {
        *x = position(unknowns, node);
    }
}
