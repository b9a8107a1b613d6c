//! A simulation and the actions on it.

use crate::actuation::CurvedRods;
use crate::errors::{bad_argument, of_simulation};
use crate::pose::{Target, held};
use crate::scenario::Scenario;
use pyo3::prelude::*;
use rodlab_engine::mechanics::dynamics::{self, SimulationError, StepSize};
use rodlab_lab::run::{LiveRun, LiveState, PreparedRun};
use std::sync::Arc;

/// Report on a call of `step` or `run`.
#[pyclass(frozen, get_all, module = "rodlab._rodlab")]
#[derive(Clone, Default)]
pub struct StepReport {
    /// Time at the end of the call, s.
    pub time: f64,
    /// Size of the last step, s.
    step: f64,
    /// Number of steps.
    steps: usize,
    /// Newton iterations.
    newton_iterations: usize,
    /// Number of contacts with a force at the end.
    contacts: usize,
    /// Number of repeated steps.
    retries: usize,
    /// Reason, if the scenario's own condition ended the motion.
    ended: Option<String>,
}

#[pymethods]
impl StepReport {
    fn __repr__(&self) -> String {
        format!(
            "<rodlab.StepReport: time {} s, {} steps, {} Newton iterations, {} contacts>",
            self.time, self.steps, self.newton_iterations, self.contacts
        )
    }
}

impl StepReport {
    pub fn add(&mut self, step: &dynamics::StepReport) {
        (self.time, self.step) = (step.time, step.step);
        self.steps += 1;
        self.newton_iterations += step.newton_iterations;
        self.contacts = step.contacts;
        self.retries += step.retries;
    }
}

/// A simulation, and the target poses of its clamps.
pub struct Stepper {
    pub scenario: Scenario,
    pub prepared: Arc<PreparedRun>,
    pub run: LiveRun,
    pub curved: CurvedRods,
    /// Target poses of clamps at the end of the next step.
    targets: Vec<Target>,
}

/// Reason why a stepper stopped.
pub enum Stopped {
    /// A signal arrived.
    Signal,
    /// A step failed.
    Failed(SimulationError),
}

impl Stepper {
    pub fn new(scenario: &Scenario, natural_curvature: bool) -> PyResult<Self> {
        let mut prepared = scenario.prepare()?;
        if prepared.table.is_some() {
            return Err(bad_argument(format!(
                "experiment = {:?} fills a table and has no motion; use rodlab.run",
                prepared.experiment
            )));
        }
        let curved = match natural_curvature {
            true => CurvedRods::add_to(&mut prepared.scene),
            false => CurvedRods::default(),
        };
        let run = LiveRun::new(&prepared).map_err(|error| of_simulation(&error))?;
        Ok(Self {
            scenario: scenario.clone(),
            prepared: Arc::new(prepared),
            run,
            curved,
            targets: Vec::new(),
        })
    }

    /// Restores a state bit for bit. If that fails, nothing changes.
    pub fn restore(&mut self, state: LiveState) -> PyResult<()> {
        // Nodes may have been grasped and released since the state was saved.
        let restored = LiveRun::new(&self.prepared).and_then(|mut run| {
            run.restore(state)?;
            Ok(run)
        });
        self.run = restored.map_err(|error| of_simulation(&error))?;
        self.targets.clear();
        Ok(())
    }

    /// Releases a clamp.
    pub fn release(&mut self, clamp: usize) -> PyResult<()> {
        let released = self.run.simulation.release(clamp);
        released.map_err(|error| of_simulation(&error))?;
        self.targets.retain(|target| target.clamp() != clamp);
        Ok(())
    }

    pub fn nodes(&self) -> usize {
        self.run.simulation.positions().len()
    }

    /// Sets a pose for the end of the next step.
    pub fn aim(&mut self, target: Target) -> PyResult<()> {
        if !self.run.simulation.is_held(target.clamp()) {
            held(&self.run.simulation, target.clamp())?;
        }
        self.targets.retain(|other| other.clamp() != target.clamp());
        self.targets.push(target);
        Ok(())
    }

    /// Size of the scenario's steps, s, if it is fixed.
    pub fn fixed_step(&self) -> Option<f64> {
        match self.prepared.integration.step {
            StepSize::Fixed(step) => Some(step),
            StepSize::Auto { .. } => None,
        }
    }

    /// Time at which a call of `step` ends; `None` if it ends after one step of any size.
    pub fn end_of_step(&self, duration: Option<f64>) -> PyResult<Option<f64>> {
        let now = self.run.simulation.time();
        match duration {
            Some(duration) if duration > 0.0 && duration.is_finite() => Ok(Some(now + duration)),
            Some(duration) => Err(bad_argument(format!(
                "duration: {duration}; allowed: finite and greater than 0 s"
            ))),
            None => match self.fixed_step() {
                Some(step) => Ok(Some(now + step)),
                None if self.targets.is_empty() => Ok(None),
                None => Err(bad_argument(
                    "duration: needed where clamps move and the scenario's steps are automatic",
                )),
            },
        }
    }

    /// Starts the motions of clamps with a target.
    pub fn carry(&mut self, until: f64) -> PyResult<()> {
        for target in std::mem::take(&mut self.targets) {
            target.carry(&mut self.run.simulation, until)?;
        }
        Ok(())
    }

    /// Takes steps up to `until`, or a single step.
    pub fn advance(
        &mut self,
        until: Option<f64>,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<StepReport, Stopped> {
        let mut report = StepReport::default();
        let mut step = |run: &mut LiveRun, until: f64| match run.advance(until, goes_on) {
            Ok(Some(step)) => {
                report.add(&step);
                Ok(())
            }
            Ok(None) => Err(Stopped::Signal),
            Err(error) => Err(Stopped::Failed(error)),
        };
        match until {
            None => step(&mut self.run, f64::INFINITY)?,
            Some(until) => {
                while self.run.simulation.time() < until {
                    if !goes_on() {
                        return Err(Stopped::Signal);
                    }
                    step(&mut self.run, until)?;
                }
            }
        }
        report.time = self.run.simulation.time();
        report.ended = self.run.ending().map(str::to_owned);
        Ok(report)
    }
}
