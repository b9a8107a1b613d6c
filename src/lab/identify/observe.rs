//! Predictions of measured numbers by a simulation.
//!
//! A point of a rod at an arc length between nodes is interpolated by the cubic polynomial through
//! the four nearest nodes, whose error is of fourth order in the edge length. The arc length is
//! measured along the rod without stress.
//!
//! Derived columns: `critical_parameter` is the first fold or bifurcation of a path of equilibria
//! (`time.mode = "continuation"`). `frequency_1_hz`, `frequency_2_hz`, ... are the natural
//! frequencies of small vibrations about an equilibrium, f = ω/2π with K v = ω² M v, from the
//! lowest. `sliding_onset_s` is defined in [`onset`](super::onset).

use super::data::DataFile;
use super::error::IdentifyError;
use super::frequencies::natural_frequencies;
use super::onset::Onset;
use super::reading::{Reading, is_same, reading, time_of};
use crate::run::probes::Probes;
use crate::run::{LiveRun, Mode, PreparedRun, Sample};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{Exchange, Simulation, SimulationError};
use rodlab_engine::mechanics::statics::PointKind;

/// Predictions of a simulation.
pub struct Prediction {
    /// Predicted numbers, in the order of the files.
    pub values: Vec<f64>,
    /// Remarks of the simulation, a sentence each.
    pub remarks: Vec<String>,
}

/// Reason why a simulation gave no prediction.
pub enum Unpredicted {
    /// It failed.
    Failed(SimulationError),
    /// The caller asked to stop.
    Stopped,
    /// The simulation has no value for a measured number: index of the file, index of the datum in
    /// it, and the reason.
    NoValue(usize, usize, String),
}

impl From<SimulationError> for Unpredicted {
    fn from(error: SimulationError) -> Self {
        Self::Failed(error)
    }
}

/// All data of an experiment, matched with its scene.
pub struct Observation {
    readings: Vec<Reading>,
    times: Vec<Option<f64>>,
    /// Index of the file of each datum, and its index in the file.
    origins: Vec<(usize, usize)>,
}

impl Observation {
    /// Matches files with the scene of a run.
    ///
    /// # Errors
    /// The first datum that does not fit, with its line and what is allowed.
    pub fn new(prepared: &PreparedRun, files: &[DataFile]) -> Result<Self, IdentifyError> {
        let mut observation = Self {
            readings: Vec::new(),
            times: Vec::new(),
            origins: Vec::new(),
        };
        for (number, file) in files.iter().enumerate() {
            for (index, datum) in file.data.iter().enumerate() {
                let fault = |message: String| IdentifyError::Row {
                    file: file.path.clone(),
                    line: datum.line,
                    message,
                };
                observation
                    .readings
                    .push(reading(prepared, datum).map_err(fault)?);
                observation
                    .times
                    .push(time_of(prepared, file, datum).map_err(fault)?);
                observation.origins.push((number, index));
            }
        }
        Ok(observation)
    }

    /// Runs the simulation.
    pub fn predict(
        &self,
        prepared: &PreparedRun,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Prediction, Unpredicted> {
        let mut run = LiveRun::new(prepared)?;
        let mut values = vec![f64::NAN; self.readings.len()];
        match prepared.mode {
            Mode::Static => {
                if run.find_equilibrium(goes_on)?.is_none() {
                    return Err(Unpredicted::Stopped);
                }
                let all: Vec<usize> = (0..values.len()).collect();
                self.read(&mut run, &all, &mut values)?;
            }
            Mode::Continuation(plan) => {
                let critical = critical_parameter(&mut run, plan, goes_on)?;
                let missing = || {
                    let reason =
                        "the path has no fold and no bifurcation; extend it by continuation.to";
                    Unpredicted::NoValue(0, 0, reason.to_owned())
                };
                values.fill(critical.ok_or_else(missing)?);
            }
            Mode::Dynamic { end, .. } => {
                let onsets = self.onsets();
                let mut onset = match onsets.first() {
                    Some(first) => {
                        Some(Onset::new(prepared).map_err(|why| self.no_value(*first, why))?)
                    }
                    None => None,
                };
                let mut advance_to = |run: &mut LiveRun, until: f64, only_onset: bool| {
                    let is_over = |run: &LiveRun| {
                        run.simulation.time() >= until || is_same(run.simulation.time(), until)
                    };
                    while !is_over(run) {
                        let goes = goes_on()
                            && match &mut onset {
                                Some(onset) if only_onset && onset.found.is_some() => break,
                                Some(onset) => onset.advance(run, until, goes_on)?,
                                None => run.advance(until, goes_on)?.is_some(),
                            };
                        if !goes {
                            return Err(Unpredicted::Stopped);
                        }
                    }
                    Ok(onset.as_ref().and_then(|onset| onset.found))
                };
                for (until, together) in self.moments() {
                    advance_to(&mut run, until, false)?;
                    self.read(&mut run, &together, &mut values)?;
                }
                if let Some(first) = onsets.first() {
                    let found = advance_to(&mut run, end, true)?;
                    let found = found.ok_or_else(|| {
                        let reason = "nothing begins to slide; extend the run by time.end";
                        self.no_value(*first, reason.to_owned())
                    })?;
                    onsets.iter().for_each(|index| values[*index] = found);
                }
            }
        }
        Ok(Prediction {
            values,
            remarks: run.simulation.remarks(),
        })
    }

    /// Times of the data, s, in ascending order, each with the indices of its data; an equilibrium
    /// has one time.
    pub fn moments(&self) -> Vec<(f64, Vec<usize>)> {
        let time = |index: usize| self.times[index].unwrap_or(0.0);
        let has_time = |index: &usize| !matches!(self.readings[*index], Reading::Onset);
        let mut order: Vec<usize> = (0..self.readings.len()).filter(has_time).collect();
        order.sort_by(|one, other| time(*one).total_cmp(&time(*other)));
        order
            .chunk_by(|one, other| is_same(time(*one), time(*other)))
            .map(|together| (time(together[0]), together.to_vec()))
            .collect()
    }

    /// Indices of the data that are onsets of sliding.
    fn onsets(&self) -> Vec<usize> {
        let all = 0..self.readings.len();
        all.filter(|index| matches!(self.readings[*index], Reading::Onset))
            .collect()
    }

    fn no_value(&self, index: usize, reason: String) -> Unpredicted {
        let (file, datum) = self.origins[index];
        Unpredicted::NoValue(file, datum, reason)
    }

    /// Whether each datum follows from the state at its own time, and no observer may end the run.
    pub fn is_differentiable(&self, run: &PreparedRun) -> bool {
        let has_column = self
            .readings
            .iter()
            .any(|reading| matches!(reading, Reading::Column(_)));
        let is_single =
            |reading: &Reading| matches!(reading, Reading::Along { .. } | Reading::Column(_));
        self.readings.iter().all(is_single)
            && !run.observer::<Probes>().is_some_and(Probes::may_stop)
            && (!has_column
                || run
                    .observers
                    .iter()
                    .all(|one| (**one).as_any().is::<Probes>()))
    }

    /// Returns the predicted value of a datum in a state of a simulation of `run`; `None` if it
    /// has none.
    pub fn value(
        &self,
        datum: usize,
        run: &PreparedRun,
        simulation: &Simulation,
        steps: u64,
    ) -> Option<f64> {
        match &self.readings[datum] {
            Reading::Along { weights, direction } => {
                Some(along(simulation.positions(), weights, direction))
            }
            Reading::Column(number) => {
                let sample = Sample {
                    simulation,
                    steps,
                    exchange: Exchange::default(),
                };
                let values = run.observer::<Probes>()?.values(&sample);
                values.get(*number).copied().flatten()
            }
            Reading::Critical | Reading::Frequency(_) | Reading::Onset => None,
        }
    }

    /// Reading of each number from the simulation, with the index of its file and its index there.
    pub(super) fn readings(&self) -> impl Iterator<Item = (&Reading, (usize, usize))> {
        self.readings.iter().zip(self.origins.iter().copied())
    }

    /// Reads the data with the given indices at the present state.
    pub(super) fn read(
        &self,
        run: &mut LiveRun,
        which: &[usize],
        values: &mut [f64],
    ) -> Result<(), Unpredicted> {
        let is_column = |index: &&usize| matches!(self.readings[**index], Reading::Column(_));
        let columns = match which.iter().find(is_column) {
            Some(_) => run.measure()?,
            None => Vec::new(),
        };
        let is_frequency = |index: &&usize| matches!(self.readings[**index], Reading::Frequency(_));
        let frequencies = match which.iter().find(is_frequency) {
            Some(_) => natural_frequencies(run),
            None => Vec::new(),
        };
        for &index in which {
            let value = match &self.readings[index] {
                Reading::Along { weights, direction } => {
                    Some(along(run.simulation.positions(), weights, direction))
                }
                Reading::Column(number) => columns[*number].1.number(),
                Reading::Frequency(number) => frequencies.get(*number).copied(),
                Reading::Critical | Reading::Onset => None,
            };
            values[index] = value.filter(|value| value.is_finite()).ok_or_else(|| {
                let reason = "the simulation has no value for this row; forces have none at time 0 of a motion, moments none at free ends, frequencies none where an equilibrium is unstable";
                self.no_value(index, reason.to_owned())
            })?;
        }
        Ok(())
    }
}

/// A weighted sum of the positions of nodes along a direction.
fn along(positions: &[Vector3], weights: &[(usize, f64)], direction: &Vector3) -> f64 {
    let parts = weights.iter();
    parts
        .map(|(node, weight)| weight * positions[*node].dot(direction))
        .sum()
}

/// Parameter of the first point of a path at which stability changes.
fn critical_parameter(
    run: &mut LiveRun,
    plan: rodlab_engine::mechanics::statics::PathPlan,
    goes_on: &dyn Fn() -> bool,
) -> Result<Option<f64>, Unpredicted> {
    let mut path = run.simulation.path(plan)?;
    while let Some(point) = run.simulation.next_point(&mut path)? {
        if point.kind != PointKind::Regular {
            return Ok(Some(point.parameter));
        }
        if !goes_on() {
            return Err(Unpredicted::Stopped);
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::prepared;

    const BEAM: &str = include_str!("../../../scenarios/heavy_cantilever.toml");

    fn observed(scenario: &str, data: &str) -> Result<Vec<f64>, String> {
        let prepared = prepared("beam", scenario)?;
        let file = DataFile::from_text("beam.csv".as_ref(), data, &Default::default());
        let files = [file.map_err(|error| error.to_string())?];
        let observation = Observation::new(&prepared, &files).map_err(|error| error.to_string())?;
        observation
            .predict(&prepared, &|| true)
            .map(|prediction| prediction.values)
            .map_err(|error| match error {
                Unpredicted::Failed(error) => error.to_string(),
                Unpredicted::Stopped => "stopped".into(),
                Unpredicted::NoValue(_, _, reason) => reason,
            })
    }

    #[test]
    fn arc_lengths_between_nodes_are_interpolated_with_fourth_order() {
        let error = |edges: usize| {
            let text = BEAM.replace("edges = 50", &format!("edges = {edges}"));
            let at = observed(&text, "arc_length_m,x_m\n0.45,0\n").unwrap()[0];
            let finer = observed(
                &text.replace(
                    &format!("edges = {edges}"),
                    &format!("edges = {}", 20 * edges / 10),
                ),
                "arc_length_m,x_m\n0.45,0\n",
            )
            .unwrap()[0];
            (at - finer).abs()
        };
        // With 10 edges, 0.45 m is between two nodes; with 20 edges it is a node. The error of the
        // discrete rod itself is of second order.
        assert!(
            error(10) < 2e-3 && error(20) < 0.3 * error(10),
            "{} {}",
            error(10),
            error(20)
        );
    }

    #[test]
    fn the_lowest_frequency_of_a_light_cantilever_is_that_of_theory() {
        let text = BEAM.replace("acceleration = [0, 0, -9.81]", "acceleration = [0, 0, 0]");
        let frequency = observed(&text, "frequency_1_hz\n0\n").unwrap()[0];
        // f = 1.8751² / 2π · √(EI/ρA) / L², with EI/ρA = E r²/4ρ.
        let theory =
            1.875_104_068_7_f64.powi(2) / std::f64::consts::TAU * (1e8 * 25e-6 / 4e3_f64).sqrt();
        assert!(
            (frequency / theory - 1.0).abs() < 1e-3,
            "{frequency} {theory}"
        );
    }

    #[test]
    fn data_that_do_not_fit_name_the_line_and_what_is_allowed() {
        let moving = BEAM.replace("mode = \"static\"", "step = 1e-2\nend = 1.0");
        for (scenario, data, expected) in [
            (
                BEAM,
                "rod,node,x_m\nbar,0,1\n",
                "beam.csv, line 2: no rod is called `bar`; the rods are: beam",
            ),
            (
                BEAM,
                "node,x_m\n51,1\n",
                "line 2: there is no node 51; `beam` has nodes 0 to 50",
            ),
            (
                BEAM,
                "arc_length_m,x_m\n1.5,1\n",
                "line 2: the arc length 1.5 m is beyond `beam`; allowed: 0 to 1 m",
            ),
            (
                BEAM,
                "tip_z_m\n1\n",
                "line 2: no probe has the column `tip_z_m`; the scenario has no [[probes]]",
            ),
            (BEAM, "critical_parameter\n1\n", "continuation"),
            (
                BEAM,
                "time_s,node,x_m\n0,1,1\n1,1,1\n",
                "line 3: the time 1 s differs",
            ),
            (
                moving.as_str(),
                "time_s,node,x_m\n2,1,1\n",
                "line 2: the time 2 s is outside of the run; allowed: 0 to 1 s (time.end)",
            ),
            (
                moving.as_str(),
                "node,x_m\n1,1\n",
                "line 2: the time is missing",
            ),
        ] {
            let error = observed(scenario, data).unwrap_err();
            assert!(error.contains(expected), "{error}");
        }
    }
}
