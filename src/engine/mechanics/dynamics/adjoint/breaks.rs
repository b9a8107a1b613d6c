//! Pull-back of derivatives through the breaking of joints at the end of a step.
//!
//! The step at whose end a joint breaks does not depend on the data. The parts that were joined
//! then have unknowns of their own, with the values that they had before; so derivatives with
//! respect to them are gathered on the common unknowns once the joint is whole again. Only a frame
//! on a hinge gets other unknowns: a rotation vector instead of an angle. This vector is a function
//! of the angle and of the rotation of the frame that carries the hinge. The function is
//! differentiated by differences.

use super::covector::Covector;
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::position;
use crate::mechanics::{Vector3, rotation};

/// Change of a rotation for differences, rad.
const TURN: f64 = 1e-5;

/// A derivative with respect to an unknown and its velocity, at the end of a step.
pub(super) struct OfUnknown {
    unknown: usize,
    over: [f64; 2],
}

impl OfUnknown {
    /// Adds it to a derivative with respect to a state.
    pub(super) fn add_to(&self, covector: &mut Covector) {
        covector.unknowns[0][self.unknown] += self.over[0];
        covector.velocities[0][self.unknown] += self.over[1];
    }
}

/// For each frame whether it turns on a hinge.
pub(super) fn hinged(simulation: &Simulation) -> Vec<bool> {
    let frames = simulation.system.assembly.joints.frames.iter();
    frames.map(|frame| frame.hinge.is_some()).collect()
}

impl Covector {
    /// Converts a derivative with respect to the state after joints broke at the end of a step to
    /// one with respect to the state before. Returns the part of frames that were on hinges, which
    /// is not converted. It refers to the rotation vectors before a reset. The simulation has
    /// repeated the step, which ended at `solution`; `hinged` are the frames on hinges after the
    /// break.
    pub(super) fn before_breaks(
        &mut self,
        simulation: &Simulation,
        hinged: &[bool],
        solution: &[f64],
    ) -> Vec<OfUnknown> {
        self.before_restart();
        let joints = &simulation.system.assembly.joints;
        let stage = &simulation.integrator.workspace.stage;
        let mut all = Vec::new();
        for (frame, is_hinged) in joints.frames.iter().zip(hinged) {
            let Some((base, axis)) = frame.hinge.filter(|_| !is_hinged) else {
                continue;
            };
            let base = &joints.frames[base];
            let own = frame.first_unknown / STRIDE;
            let over = [&self.unknowns[0], &self.velocities[0]].map(|of| position(of, own));
            for of in [&mut self.unknowns[0], &mut self.velocities[0]] {
                of[STRIDE * own..STRIDE * (own + 1)].fill(0.0);
            }
            let first = base.first_unknown;
            let unknowns = [first, first + 1, first + 2, frame.first_unknown + 3];
            let rate = |k: usize| (solution[k] - stage.start[k]) / stage.step;
            let at = [unknowns.map(|k| solution[k]), unknowns.map(rate)];
            // The rotation and the spin of the frame.
            let turned = |[[x, y, z, angle], [u, v, w, spin]]: [[f64; 4]; 2]| {
                let vector = Vector3::new(x, y, z) / base.length;
                let carried = rotation::from_vector(vector) * base.base;
                let turn = carried * rotation::from_vector(axis * angle);
                let carried_spin = rotation::left_jacobian(&vector) * Vector3::new(u, v, w);
                (turn, carried_spin / base.length + carried * axis * spin)
            };
            let (rotation, _) = turned(at);
            let value = |at: [[f64; 4]; 2]| {
                let (turn, spin) = turned(at);
                let vector = rotation::to_vector(&(turn * rotation.inverse()));
                let inverse = rotation::left_jacobian(&vector).try_inverse();
                let rate = inverse.map_or(spin, |inverse| inverse * spin);
                frame.length * (vector.dot(&over[0]) + rate.dot(&over[1]))
            };
            for (index, unknown) in unknowns.into_iter().enumerate() {
                let step = if index < 3 { TURN * base.length } else { TURN };
                let over = [0, 1].map(|of| {
                    let moved = |by: f64| {
                        let mut at = at;
                        at[of][index] += by;
                        value(at)
                    };
                    (moved(step) - moved(-step)) / (2.0 * step)
                });
                all.push(OfUnknown { unknown, over });
            }
        }
        all
    }
}
