//! Impacts that steps do not resolve: restitution is never more than 1.
//!
//! **The midpoint rule** evaluates contact forces in the middle of a step and extrapolates from
//! there to its end. A rod that comes into contact within a step may therefore be carried deep into
//! it, or be pushed although it has left the contact, and gain spurious energy. With the force f of
//! the middle and the energy φ of the contacts,
//!
//! ΔE = f·(x₁ − x₀) + φ(x₁) − φ(x₀),
//!
//! which vanishes with the step, except at an impact that the step does not resolve. A step in
//! which ΔE is positive is repeated with implicit Euler.
//!
//! **Backward differences** extrapolate from steps before the impact. A rod that approaches at V
//! and touches after the fraction s of a step has at its end the velocity (x₁ − x̂)/H = (5 − 11 s)
//! V/6, up to 0.83 V away from the contact. The step after continues the change with a third of it,
//! so that the rod would leave with up to 1.44 V, twice its energy. The step after such a jump
//! therefore forgets the steps before, which makes it one of implicit Euler, and the rod leaves with
//! 0.83 V at most.
//!
//! The velocity of a contact jumps if its normal part u is not the one, u*, that earlier steps
//! predict: |u − u*| ≥ 0.3 max(|u₀|, |u|), by a way h |u − u*| that the contact does not resolve. It
//! is an impact if inertia takes up the impulses: an impulse h F that changes u by Δu gives the
//! motion ½ ‖Δv‖²_M = ½ h F Δu. If elasticity or damping takes them up, the motion has less energy.
//! In a fluid with the local resistance D, the motion loses h ‖Δv‖²_D in each of the next steps. If
//! this is more than a fifth of its energy, what a step adds does not last, and the differences keep
//! their order.

use super::parameters::Scheme;
use super::stage::{Setting, Workspace};
use super::state::State;
use crate::mechanics::rod::topology::position;
use crate::mechanics::system::{System, Velocities};

/// Part of the impulses that inertia takes up in an impact.
const TAKEN_UP: f64 = 0.2;
/// Part of the energy of an impact that a fluid takes in a step.
const DAMPED: f64 = 0.2;
/// Part of the kinetic energy of all rods below which an impact is negligible.
const NEGLIGIBLE: f64 = 1e-5;

impl Setting {
    /// The setting for a step that ends in an impact.
    pub(crate) fn dissipative(mut self) -> Self {
        self.parameters.scheme = Scheme::ImplicitEuler;
        self
    }
}

impl Workspace {
    /// Whether velocities jump in the step from `state` that was solved, of a scheme that
    /// extrapolates from earlier steps.
    pub(super) fn jumps(&self, system: &System, state: &State, goal: f64) -> bool {
        let velocities = Velocities {
            start: &state.velocity,
            predicted: &self.trial.velocity,
            end: &self.next_velocity,
        };
        let step = goal - state.time;
        let work = system.work_of_jumps(step, &velocities);
        if work == 0.0 {
            return false;
        }
        let free = velocities.end.iter().zip(&system.assembly.held);
        let change = free.zip(velocities.predicted);
        let change: Vec<f64> = change
            .map(|((end, held), predicted)| if *held { 0.0 } else { end - predicted })
            .collect();
        let places = system.assembly.all_places();
        let energy_of = |velocity: &[f64]| system.assembly.kinetic_energy(&places, velocity);
        let energy = energy_of(&change);
        let resistance = self.stage.resistance.iter().enumerate();
        let lost = resistance.map(|(node, local)| {
            let change = position(&change, node);
            step * change.dot(&(local * change))
        });
        energy >= TAKEN_UP * work
            && energy >= NEGLIGIBLE * energy_of(velocities.start)
            && DAMPED * energy >= lost.sum()
    }
}
