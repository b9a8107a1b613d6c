//! A scenario, its keys, and the run with derivatives.

use super::error::SensitivityError;
use crate::experiment::{self, prepare};
use crate::run::{Mode, OutputTimes, PreparedRun};
use crate::scenario::{Loaded, ScenarioError};
use rodlab_engine::mechanics::dynamics::IntegrationParameters;
use rodlab_engine::mechanics::dynamics::sensitivity::{Sensitivity, Variation};
use rodlab_engine::mechanics::fluid::FluidModel;

/// Function that reads a scenario with further overrides, `key=value` each.
pub type Source<'a> = &'a dyn Fn(&[String]) -> Result<Loaded, ScenarioError>;

/// Sizes of ε. Larger ones cause truncation errors, smaller ones rounding errors.
struct Steps {
    /// ε over the size of a value.
    relative: f64,
    /// Upper bound of ε over the size of a value, used if the value has little effect.
    largest: f64,
    /// ε of a value that is 0, in its SI unit, before its effect is known.
    first: f64,
    /// Range of differences of the neighbours (rad) within which ε is kept, and the difference for
    /// which a new ε is chosen.
    amplitudes: [f64; 2],
    best_amplitude: f64,
}

const STEPS: Steps = Steps {
    relative: 2e-5,
    largest: 1e-4,
    first: 1e-6,
    amplitudes: [5e-7, 2e-4],
    best_amplitude: 1e-5,
};
/// Sizes for the flow of regularized Stokeslets, whose operator is stored in single precision.
const STEPS_IN_FLOW: Steps = Steps {
    relative: 2e-3,
    largest: 5e-3,
    first: 1e-4,
    amplitudes: [5e-5, 2e-3],
    best_amplitude: 5e-4,
};

impl Steps {
    fn of(run: &PreparedRun) -> &'static Self {
        match run.scene.fluid {
            Some(FluidModel::RegularizedStokeslets { .. }) => &STEPS_IN_FLOW,
            _ => &STEPS,
        }
    }
}

/// Upper bounds of the tolerances of Newton's method: derivatives have the relative error of the
/// motion itself.
const FORCE_TOLERANCE: f64 = 1e-10;
const DISPLACEMENT_TOLERANCE: f64 = 1e-8;

/// A key with respect to which a scenario is differentiated.
#[derive(Clone, Debug)]
pub struct Key {
    /// The dotted key.
    pub key: String,
    /// Value of the key, in the SI unit.
    pub value: f64,
    /// The SI unit, where it has one.
    pub unit: Option<String>,
    /// ε: the values of the two neighbours are the value plus and minus ε.
    pub step: f64,
    /// Scale of its values, because a value may be near 0 by chance.
    size: f64,
    /// The runs of the two neighbours.
    neighbours: [PreparedRun; 2],
}

/// A scenario with the keys of its derivatives.
pub struct Problem<'a> {
    source: Source<'a>,
    base: PreparedRun,
    keys: Vec<Key>,
}

/// A moment of a run with derivatives.
pub struct Moment<'a> {
    /// The simulation, with its neighbours.
    pub sensitivity: &'a Sensitivity,
    /// Accepted steps or equilibria so far.
    pub steps: u64,
    /// Time, s.
    pub time: f64,
}

impl<'a> Problem<'a> {
    /// Reads a scenario, and for each key two neighbours with a slightly changed value.
    ///
    /// # Errors
    /// [`SensitivityError`] for a scenario without derivatives, and for a key that is not a number
    /// or whose change affects more than numbers.
    pub fn new(source: Source<'a>, keys: &[String]) -> Result<Self, SensitivityError> {
        Self::sized(source, keys, &vec![0.0; keys.len()])
    }

    /// Reads the scenario as [`Self::new`] does, with minimum sizes of the values of the keys, in
    /// their SI units.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn sized(
        source: Source<'a>,
        keys: &[String],
        sizes: &[f64],
    ) -> Result<Self, SensitivityError> {
        let loaded = source(&[])?;
        let base = prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues))?;
        refuse(&base)?;
        let steps = Steps::of(&base);
        let mut problem = Self {
            source,
            base,
            keys: Vec::new(),
        };
        for (key, size) in keys.iter().zip(sizes) {
            let key = key.trim();
            let value = loaded.number(key).ok_or_else(|| no_number(source, key))?;
            let size = size.max(value.abs());
            let step = match size {
                0.0 => steps.first,
                _ => steps.relative * size,
            };
            problem.keys.push(Key {
                key: key.to_owned(),
                value,
                unit: experiment::unit(key),
                step,
                size,
                neighbours: problem.neighbours(key, value, step)?,
            });
        }
        Ok(problem)
    }

    /// The run itself.
    pub fn base(&self) -> &PreparedRun {
        &self.base
    }

    /// The keys.
    pub fn keys(&self) -> &[Key] {
        &self.keys
    }

    /// The two runs with one key changed by ±ε.
    pub fn neighbours_of(&self, key: usize) -> &[PreparedRun; 2] {
        &self.keys[key].neighbours
    }

    /// Times of the outputs of the run, s; for an equilibrium only the start.
    pub fn output_times(&self) -> Vec<f64> {
        let times = match self.base.mode {
            Mode::Dynamic { end, .. } => OutputTimes::new(self.base.output.interval, end),
            Mode::Static | Mode::Continuation(_) => OutputTimes::only_start(),
        };
        (0..=times.last()).map(|index| times.time(index)).collect()
    }

    /// The run with a key set to a value.
    ///
    /// # Errors
    /// [`SensitivityError`] if the value is not allowed, or changes the steps.
    pub fn run_with(&self, key: &str, value: f64) -> Result<PreparedRun, SensitivityError> {
        let loaded = (self.source)(&[format!("{key}={value:?}")])?;
        let run = prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues))?;
        if run.mode != self.base.mode
            || run.integration != self.base.integration
            || run.output != self.base.output
        {
            return Err(SensitivityError::Key {
                key: key.to_owned(),
                reason:
                    "it changes the steps, the tolerances or the outputs of the run, for which \
                    there are no derivatives"
                        .to_owned(),
            });
        }
        let inertia = |run: &PreparedRun| -> Vec<_> {
            let rods = run.scene.rods.iter();
            rods.map(|rod| rod.inertia).collect()
        };
        if inertia(&run) != inertia(&self.base) {
            return Err(SensitivityError::Key {
                key: key.to_owned(),
                reason: "the default of rods.inertia changes with it: set rods.inertia".to_owned(),
            });
        }
        Ok(run)
    }

    fn neighbours(
        &self,
        key: &str,
        value: f64,
        step: f64,
    ) -> Result<[PreparedRun; 2], SensitivityError> {
        Ok([
            self.run_with(key, value + step)?,
            self.run_with(key, value - step)?,
        ])
    }

    /// Parameters of the steps: those of the run, with tolerances tight enough for derivatives.
    pub fn integration(&self) -> IntegrationParameters {
        let own = self.base.integration;
        IntegrationParameters {
            force_tolerance: own.force_tolerance.min(FORCE_TOLERANCE),
            displacement_tolerance: own.displacement_tolerance.min(DISPLACEMENT_TOLERANCE),
            ..own
        }
    }

    /// Runs to the given times (s, ascending) until `goes_on` returns false, and passes each
    /// moment to `observe`; an equilibrium is one moment. Returns for each key the largest
    /// difference of its neighbours from the run, rad.
    ///
    /// # Errors
    /// The errors of the run, steps without derivatives, and [`SensitivityError::Interrupted`].
    pub fn follow(
        &self,
        times: &[f64],
        goes_on: &dyn Fn() -> bool,
        observe: &mut dyn FnMut(&Moment<'_>),
    ) -> Result<Vec<f64>, SensitivityError> {
        let mut sensitivity = self.start()?;
        let mut steps = 0;
        match self.base.mode {
            Mode::Dynamic { settles, .. } => {
                if settles {
                    sensitivity.find_equilibrium()?;
                }
                for &time in times {
                    while sensitivity.base().time() < time {
                        if !goes_on() {
                            return Err(SensitivityError::Interrupted);
                        }
                        sensitivity.advance(time)?;
                        steps += 1;
                    }
                    observe(&Moment {
                        sensitivity: &sensitivity,
                        steps,
                        time,
                    });
                }
            }
            Mode::Static | Mode::Continuation(_) => {
                sensitivity.find_equilibrium()?;
                observe(&Moment {
                    sensitivity: &sensitivity,
                    steps: 1,
                    time: 0.0,
                });
            }
        }
        let keys = 0..self.keys.len();
        Ok(keys.map(|key| sensitivity.amplitude(key)).collect())
    }

    /// The simulation with its neighbours at the start.
    ///
    /// # Errors
    /// The scene has elements without derivatives.
    pub(super) fn start(&self) -> Result<Sensitivity, SensitivityError> {
        let variation = |key: &Key| {
            let [plus, minus] = &key.neighbours;
            Variation {
                scenes: [plus.scene.clone(), minus.scene.clone()],
                step: key.step,
            }
        };
        let variations: Vec<Variation> = self.keys.iter().map(variation).collect();
        Ok(Sensitivity::new(
            &self.base.scene,
            &self.integration(),
            &variations,
        )?)
    }

    /// Chooses another ε for keys whose neighbours were too far away or too near, from the
    /// differences that [`Self::follow`] returned. Returns whether any ε changed.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn adapt(&mut self, amplitudes: &[f64]) -> Result<bool, SensitivityError> {
        let mut has_changed = false;
        let steps = Steps::of(&self.base);
        let [least, largest] = steps.amplitudes;
        for (index, &amplitude) in amplitudes.iter().enumerate() {
            let Key {
                value, step, size, ..
            } = self.keys[index];
            if amplitude == 0.0 || (least..=largest).contains(&amplitude) {
                continue;
            }
            let bound = match size {
                0.0 => f64::INFINITY,
                _ => steps.largest * size,
            };
            let better = (step * steps.best_amplitude / amplitude).min(bound);
            if better == step {
                continue;
            }
            let name = self.keys[index].key.clone();
            let neighbours = self.neighbours(&name, value, better)?;
            let key = &mut self.keys[index];
            (key.step, key.neighbours) = (better, neighbours);
            has_changed = true;
        }
        Ok(has_changed)
    }
}

/// The error for a key without a number. Setting the key detects unknown keys.
fn no_number(source: Source<'_>, key: &str) -> SensitivityError {
    match source(&[format!("{key}=1.0")]) {
        Err(error) => error.into(),
        Ok(_) => SensitivityError::Key {
            key: key.to_owned(),
            reason: "it has no numeric value and no numeric default; set it by --set".to_owned(),
        },
    }
}

/// Checks that a run has derivatives.
fn refuse(run: &PreparedRun) -> Result<(), SensitivityError> {
    let refusals = [
        (
            matches!(run.mode, Mode::Continuation(_)),
            "derivatives need time.mode = \"static\" or \"dynamic\", not a path of equilibria",
        ),
        (
            !run.controllers.is_empty(),
            "derivatives support no experiment in which a controller acts on the scene",
        ),
        (
            run.table.is_some(),
            "derivatives support no experiment that fills a table",
        ),
    ];
    match refusals.into_iter().find(|(refused, _)| *refused) {
        Some((_, reason)) => Err(SensitivityError::Unsuitable(reason)),
        None => Ok(()),
    }
}
