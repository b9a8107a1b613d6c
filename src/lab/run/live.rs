//! A run without files, stepped by the calling program.

use super::counters::Counters;
use super::observer::{Finding, Sample};
use super::participants::{self, Participants, SavedStates};
use super::prepared::{Mode, PreparedRun};
use rodlab_engine::mechanics::dynamics::{
    Lockstep, Simulation, SimulationError, SimulationState, StepReport,
};
use rodlab_engine::mechanics::statics::PathPoint;
use rodlab_files::results::Value;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::{Duration, Instant};

/// Wall time of a step below which the next step is always finished, as in a run with files.
const SHORT_STEP: Duration = Duration::from_millis(50);

/// A simulation with the observers and controllers of its experiment.
///
/// The steps equal those of [`run`](super::run()) if they end at the same times; outputs also end
/// steps there.
pub struct LiveRun {
    /// The simulation.
    pub simulation: Simulation,
    participants: Participants,
    counters: Counters,
    mode: Mode,
    /// Wall time of the last step.
    last_step: Duration,
}

/// Complete state of a [`LiveRun`].
#[derive(Clone, Serialize, Deserialize)]
pub struct LiveState {
    /// The state of the simulation.
    pub simulation: SimulationState,
    participants: SavedStates,
    counters: Counters,
}

impl LiveRun {
    /// Sets up the scene of a run at time zero.
    ///
    /// # Errors
    /// [`SimulationError::BadScene`] for an invalid scene.
    pub fn new(prepared: &PreparedRun) -> Result<Self, SimulationError> {
        let mut simulation = Simulation::new(&prepared.scene, &prepared.integration)?;
        let mut counters = Counters::default();
        if matches!(prepared.mode, Mode::Dynamic { settles: true, .. }) {
            counters.add_equilibrium(&simulation.find_equilibrium()?);
        }
        Ok(Self {
            simulation,
            participants: Participants::of(prepared),
            counters,
            mode: prepared.mode,
            last_step: Duration::ZERO,
        })
    }

    /// Whether the scene moves, rests or follows a path.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// The sentence in which an observer stated why the run is complete, if it did.
    pub fn ending(&self) -> Option<&str> {
        let ending = self.counters.outcome.ending.as_ref();
        ending.map(|ending| ending.sentence.as_str())
    }

    /// Takes one step that ends no later than `until`, s. `None` if `goes_on` returned false; the
    /// state is then that before the step.
    ///
    /// # Errors
    /// The errors of [`Simulation::advance`], and [`SimulationError::Unphysical`] if an observer
    /// finds a fault; the state is then that of the last accepted step.
    pub fn advance(
        &mut self,
        until: f64,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError> {
        let is_long = self.last_step >= SHORT_STEP;
        let before = is_long.then(|| self.save());
        let start = Instant::now();
        let until = self.participants.control(&mut self.simulation)?.min(until);
        let report = if let Some(before) = before {
            let goes_on = || start.elapsed() < SHORT_STEP || goes_on();
            match self.simulation.advance_while(until, &goes_on)? {
                Some(report) => report,
                None => {
                    self.restore(before)?;
                    return Ok(None);
                }
            }
        } else {
            self.simulation.advance(until)?
        };
        self.last_step = start.elapsed();
        self.conclude(&report)?;
        Ok(Some(report))
    }

    /// Takes one step in each of several runs. The step of a run ends no later than the time
    /// beside it, s; its result is that of [`Self::advance`]. Runs of one kind of scene are solved
    /// together (see [`Lockstep`]).
    pub fn advance_together(
        runs: &mut [(&mut Self, f64)],
        lockstep: &mut Lockstep,
        goes_on: &dyn Fn() -> bool,
    ) -> Vec<Result<Option<StepReport>, SimulationError>> {
        if runs.iter().any(|(run, _)| run.last_step >= SHORT_STEP) {
            let alone = runs.iter_mut();
            return alone
                .map(|(run, until)| run.advance(*until, goes_on))
                .collect();
        }
        let start = Instant::now();
        let mut ends = Vec::with_capacity(runs.len());
        for (run, until) in runs.iter_mut() {
            let end = run.participants.control(&mut run.simulation);
            ends.push(end.map(|end| end.min(*until)));
        }
        let mut simulations: Vec<_> = (runs.iter_mut().zip(&ends))
            .filter_map(|((run, _), end)| Some((&mut run.simulation, *end.as_ref().ok()?)))
            .collect();
        let mut steps = lockstep.advance(&mut simulations, &|| true).into_iter();
        let took = start.elapsed() / runs.len().max(1) as u32;
        let results = runs.iter_mut().zip(ends).map(|((run, _), end)| {
            end?;
            run.last_step = took;
            let step = steps.next().expect("each was stepped")?;
            if let Some(report) = &step {
                run.conclude(report)?;
            }
            Ok(step)
        });
        results.collect()
    }

    /// Counts a step, and calls the observers.
    fn conclude(&mut self, report: &StepReport) -> Result<(), SimulationError> {
        self.counters.add_step(report);
        let time = self.simulation.time();
        let (sample, participants) = self.sample();
        let findings = participants.sample_if_due(&sample, time);
        self.counters.conclude_from(findings)
    }

    /// Finds the equilibrium. `None` if `goes_on` returned false; the state is then the one before
    /// the call.
    ///
    /// # Errors
    /// The errors of [`Simulation::find_equilibrium_while`].
    pub fn find_equilibrium(
        &mut self,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<StepReport>, SimulationError> {
        let before = self.save();
        let found = self.simulation.find_equilibrium_while(goes_on);
        match found {
            Ok(Some(report)) => self.counters.add_equilibrium(&report),
            Ok(None) => self.restore(before)?,
            Err(_) => {}
        }
        found
    }

    /// Counts a point of a path of equilibria.
    pub fn count_point(&mut self, point: &PathPoint) {
        self.counters.add_point(point);
    }

    /// The columns that the observers add to the series, with their current values; the call does
    /// not change the observers.
    ///
    /// # Errors
    /// [`SimulationError::Unphysical`] if an observer finds a fault.
    pub fn measure(&self) -> Result<Vec<(String, Value)>, SimulationError> {
        let simulation = &self.simulation;
        let row = self.counters.clone().take_row(
            simulation.time(),
            simulation.nearest(),
            &simulation.energies(),
        );
        let mut observers = self.participants.observers.clone();
        let names = participants::columns(&observers);
        let sample = Sample {
            simulation,
            steps: self.counters.outcome.steps,
            exchange: self.counters.exchange,
        };
        let mut values = Vec::with_capacity(names.len());
        for observer in &mut observers {
            let (cells, finding) = observer.measure(&sample, &row);
            values.extend(cells);
            if let Finding::Fail(reason) = finding {
                return Err(SimulationError::Unphysical(reason));
            }
        }
        Ok(names.into_iter().zip(values).collect())
    }

    /// Remarks of the simulation and the observers so far, a sentence each.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = self.simulation.remarks();
        let observers = self.participants.observers.iter();
        remarks.extend(observers.flat_map(|one| one.remarks()));
        remarks
    }

    /// The present state.
    pub fn save(&self) -> LiveState {
        LiveState {
            simulation: self.simulation.state(),
            participants: self.participants.save(),
            counters: self.counters.clone(),
        }
    }

    /// Continues from a state of the same scenario, bit for bit.
    ///
    /// # Errors
    /// [`SimulationError::BadScene`] if it belongs to another scenario.
    pub fn restore(&mut self, state: LiveState) -> Result<(), SimulationError> {
        let mut participants = self.participants.clone();
        let restored = participants.restore(&state.participants, Path::new("state"));
        restored.map_err(|error| {
            let foreign = rodlab_engine::mechanics::SceneError::Checkpoint(error.to_string());
            SimulationError::BadScene(foreign)
        })?;
        self.simulation.restore(state.simulation)?;
        self.participants = participants;
        self.counters = state.counters;
        Ok(())
    }

    /// Current input of the observers, and the participants.
    fn sample(&mut self) -> (Sample<'_>, &mut Participants) {
        let sample = Sample {
            simulation: &self.simulation,
            steps: self.counters.outcome.steps,
            exchange: self.counters.exchange,
        };
        (sample, &mut self.participants)
    }
}
