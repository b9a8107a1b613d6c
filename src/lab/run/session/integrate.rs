//! Integration in time.

use super::Session;
use crate::run::advance::Advance;
use crate::run::stop::{Stop, StopRequests};
use rodlab_engine::mechanics::dynamics::StepReport;
use std::time::{Duration, Instant};

/// Wall time of a step below which the next step is always finished. Saving the state before each
/// step, so that the step can be stopped midway, would slow short steps by some percent.
const SHORT_STEP: Duration = Duration::from_millis(50);

impl Session {
    /// Takes time steps to the end, an output at each of its times.
    pub(super) fn integrate(
        &mut self,
        simulation: &mut impl Advance,
        stop_requested: StopRequests<'_>,
    ) -> Result<(), Stop> {
        while self.run_state.outputs <= self.times.last() {
            let target = self.times.time(self.run_state.outputs);
            while simulation.time() < target {
                self.ask_to_stop(stop_requested)?;
                self.write_checkpoint_if_due(simulation)?;
                let start = Instant::now();
                let report = if self.last_step < SHORT_STEP {
                    let until = self.control(simulation)?.min(target);
                    simulation.advance(until)?
                } else {
                    self.take_long_step(simulation, target, stop_requested)?
                };
                self.last_step = start.elapsed();
                if report.contacts > 0 {
                    self.meter.add_step_with_contact(start.elapsed());
                }
                self.run_state.counters.add_step(&report);
                self.sample_if_due(simulation)?;
                self.progress.update(&report);
            }
            self.record(simulation)?;
            if self.has_ended() {
                break;
            }
        }
        Ok(())
    }

    /// Takes a step that may be stopped midway; the state is then as before.
    fn take_long_step(
        &mut self,
        simulation: &mut impl Advance,
        target: f64,
        stop_requested: StopRequests<'_>,
    ) -> Result<StepReport, Stop> {
        let before = simulation.state();
        let controllers = self.participants.controllers.clone();
        let until = self.control(simulation)?.min(target);
        let start = Instant::now();
        let goes_on = || start.elapsed() < SHORT_STEP || self.ask_to_stop(stop_requested).is_ok();
        if let Some(report) = simulation.advance_while(until, &goes_on)? {
            return Ok(report);
        }
        simulation.restore(before)?;
        self.participants.controllers = controllers;
        Err(self.reason_to_stop(stop_requested))
    }

    /// Lets controllers act before a step; returns when the next of them must act again, s.
    fn control(&mut self, simulation: &mut impl Advance) -> Result<f64, Stop> {
        match simulation.simulation_mut() {
            Some(simulation) => Ok(self.participants.control(simulation)?),
            None => Ok(f64::INFINITY),
        }
    }

    /// Calls the observers that are due, at times that do not depend on those of outputs.
    fn sample_if_due(&mut self, simulation: &impl Advance) -> Result<(), Stop> {
        let Some(sample) = self.sample_of(simulation) else {
            return Ok(());
        };
        let time = simulation.time();
        let findings = self.participants.sample_if_due(&sample, time);
        Ok(self.run_state.counters.conclude_from(findings)?)
    }
}
