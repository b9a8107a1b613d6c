//! What a simulation says of itself: strains beyond the theory, energy that comes from nowhere.
//!
//! Both are warnings in the log, once in a simulation: the numbers are what the model gives, but not what a rod does.

use super::parameters::Scheme;
use super::report::{Energies, StepReport};
use crate::mechanics::scene::{Clamp, Load, LoadKind, Scene};
use crate::mechanics::system::System;
use tracing::warn;

/// Stretch beyond which a warning is due: the theory of rods is one of small strains, and Hooke's law holds no farther.
const LARGEST_STRETCH: f64 = 0.05;
/// Gain of energy that is no more rounding, Newton's method or a swing of the midpoint rule, over the largest energy so far.
const LARGEST_GAIN: f64 = 0.05;
/// Steps between two looks, which cost some thousandths of a step each.
const INTERVAL: usize = 16;

/// Watches a simulation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Validity {
    /// Whether energy can only come from clamps, so that any other gain is an error of the scheme.
    is_conservative: bool,
    steps: usize,
    /// Energy at the start, J.
    start: Option<f64>,
    /// What clamps did less what was lost since, J.
    taken_in: f64,
    /// Largest kinetic and elastic energy so far, J.
    largest: f64,
    has_warned_of_stretch: bool,
    has_warned_of_energy: bool,
}

impl Validity {
    /// For simulations of `scene`.
    pub fn new(scene: &Scene) -> Self {
        let is_accounted_for = |load: &Load| match load.kind {
            LoadKind::Gravity { .. } => load.schedule.is_empty(),
            LoadKind::Drag { .. } => true,
            LoadKind::Force { .. } | LoadKind::Moment { .. } | LoadKind::Distributed { .. } => {
                false
            }
        };
        // The work of a clamp that turns is not counted, nor that of a contact that is made stiffer.
        let turns = |clamp: &Clamp| {
            let motion = &clamp.motion;
            motion.angular_velocity != 0.0
                || !motion.angle.is_empty()
                || !motion.orientation.is_empty()
        };
        Self {
            is_conservative: scene.fluid.is_none()
                && scene.contact.is_none()
                && scene.loads.iter().all(is_accounted_for)
                && !scene.clamps.iter().any(turns),
            steps: 0,
            start: None,
            taken_in: 0.0,
            largest: 0.0,
            has_warned_of_stretch: false,
            has_warned_of_energy: false,
        }
    }

    /// Work is done that is not counted: other forces act than those of the scene, or a clamp moves otherwise.
    pub fn stop_counting_energy(&mut self) {
        self.is_conservative = false;
    }

    /// Looks at the stretch of all edges at `unknowns`.
    pub fn check_stretch(&mut self, system: &System, unknowns: &[f64], time: f64) {
        if self.has_warned_of_stretch {
            return;
        }
        if let Some(strain) = system.largest_stretch(unknowns, LARGEST_STRETCH) {
            self.has_warned_of_stretch = true;
            let (rod, node) = system.assembly.locate(strain.node);
            warn!(
                "at t = {time:.4} s rod `{}` is {} by {:.0} % at node {node}: the theory of rods holds for a few per cent",
                system.assembly.names[rod],
                strain.kind,
                100.0 * strain.size
            );
        }
    }

    /// After a step: looks now and then.
    pub fn after_step(
        &mut self,
        system: &System,
        scheme: Scheme,
        report: &StepReport,
        unknowns: &[f64],
        energies: impl Fn() -> Energies,
    ) {
        let (time, exchange) = (report.time, &report.exchange);
        self.taken_in += exchange.clamp_work - exchange.friction_loss - exchange.drag_loss;
        self.steps += 1;
        if self.steps % INTERVAL != 1 {
            return;
        }
        self.check_stretch(system, unknowns, time);
        // Implicit Euler takes energy and never gives any.
        if scheme == Scheme::ImplicitEuler || !self.is_conservative || self.has_warned_of_energy {
            return;
        }
        let now = energies();
        self.largest = self.largest.max(now.kinetic + now.elastic());
        let start = *self.start.get_or_insert(now.total() - self.taken_in);
        let gain = now.total() - self.taken_in - start;
        if gain > LARGEST_GAIN * self.largest {
            self.has_warned_of_energy = true;
            warn!(
                "at t = {time:.4} s the rods have gained {gain:.3e} J that nothing gave them, {:.0} % of their energy: the time step is too large for this scheme; take smaller steps, step = \"auto\", or scheme = \"implicit-euler\"",
                100.0 * gain / self.largest
            );
        }
    }
}
