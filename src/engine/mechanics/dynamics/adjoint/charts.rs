//! Pull-back of derivatives through the reset of rotation vectors at the end of a step.
//!
//! A reset changes the chart in which the rotation of a frame is measured, for the present state
//! and those of the last steps alike ([`crate::mechanics::system`], `joints/frame`). The new chart
//! is that of the motion itself: it stays the same if the motion changes. So the reset is a smooth
//! function of the rotation vector and its rate, six numbers of one frame, which is differentiated
//! by differences.

use super::covector::Covector;
use super::trace::End;
use super::weights::MOTIONS;
use crate::mechanics::dynamics::report::SimulationState;
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::system::TurningFrame;
use crate::mechanics::{UnitQuaternion, Vector3, rotation};

/// Change of a rotation vector for differences, rad: truncation and rounding errors are both about
/// 1e-10. The reset is linear in the rate.
const TURN: f64 = 1e-5;

impl Covector {
    /// Converts derivatives with respect to a state whose rotation vectors were reset at the end of
    /// a step to those before; the simulation has the frames of the start of the step.
    pub(super) fn before_reset(
        &mut self,
        simulation: &Simulation,
        long: &[usize],
        start: &SimulationState,
        end: &End,
    ) {
        let frames = &simulation.system.assembly.joints.frames;
        for frame in long.iter().map(|number| &frames[*number]) {
            let now = frame.rotation_vector(end.solution());
            let back = rotation::from_vector(now).inverse();
            let velocity = frame.vector_of(&end.state.velocity);
            let inverse = rotation::left_jacobian(&now).try_inverse();
            let rate = inverse.map_or(velocity, |inverse| inverse * velocity);
            let mut motions = vec![[frame.vector_of(end.solution()), rate]];
            motions.push([&start.unknowns, &start.velocity].map(|of| frame.vector_of(of)));
            let earlier = start.history.steps.iter().take(MOTIONS - 2);
            motions.extend(
                earlier.map(|past| [&past.unknowns, &past.velocity].map(|of| frame.vector_of(of))),
            );
            let all = self.unknowns.iter_mut().zip(&mut self.velocities);
            for ((unknowns, velocities), at) in all.zip(motions) {
                let over = [&*unknowns, &*velocities].map(|of| frame.vector_of(of));
                let over = pull_back(frame, at, &back, over);
                for (to, over) in [unknowns, velocities].into_iter().zip(over) {
                    let first = frame.first_unknown;
                    to[first..first + 3].copy_from_slice(over.as_slice());
                }
            }
        }
    }
}

/// Derivatives with respect to ℓφ and its rate in the old chart, from those in the new one.
fn pull_back(
    frame: &TurningFrame,
    at: [Vector3; 2],
    back: &UnitQuaternion,
    over: [Vector3; 2],
) -> [Vector3; 2] {
    let value = |at: [Vector3; 2]| {
        let [place, rate] = frame.in_chart(at, back);
        place.dot(&over[0]) + rate.dot(&over[1])
    };
    let step = TURN * frame.length;
    std::array::from_fn(|of| {
        Vector3::from_fn(|axis, _| {
            let moved = |by: f64| {
                let mut at = at;
                at[of][axis] += by;
                value(at)
            };
            (moved(step) - moved(-step)) / (2.0 * step)
        })
    })
}
