//! Predictions of all experiments at values of the fitted keys.

use super::data::{DataFile, Datum};
use super::error::IdentifyError;
use super::observe::{Observation, Prediction, Unpredicted};
use super::parameter::Parameter;
use super::shooting::Followed;
use crate::experiment;
use crate::scenario::CaseSet;
use rayon::prelude::*;
use tracing::subscriber::NoSubscriber;

/// A scenario with its files of measurements.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// The scenario, without a sweep.
    pub scenario: CaseSet,
    /// The files.
    pub files: Vec<DataFile>,
}

/// All experiments with the keys that they share.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    /// The experiments.
    pub experiments: &'a [Experiment],
    /// The keys.
    pub parameters: &'a [Parameter],
    /// Returns false if the work should stop.
    pub goes_on: &'a (dyn Fn() -> bool + Sync),
    /// Number of windows of each motion; 1 is the whole motion.
    pub windows: usize,
}

impl Problem<'_> {
    /// The data of all experiments, in the order of predictions.
    pub fn data(&self) -> impl Iterator<Item = (&DataFile, &Datum)> {
        let files = self.experiments.iter().flat_map(|one| &one.files);
        files.flat_map(|file| file.data.iter().map(move |datum| (file, datum)))
    }

    /// Returns the values of the keys at coordinates.
    pub fn values(&self, coordinates: &[f64]) -> Vec<f64> {
        let pairs = self.parameters.iter().zip(coordinates);
        pairs
            .map(|(parameter, coordinate)| parameter.value(*coordinate))
            .collect()
    }

    /// Returns the predicted numbers at each point, which holds coordinates of all keys. All runs
    /// are independent and use all threads.
    pub fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Vec<f64>, IdentifyError>> {
        let count = self.experiments.len();
        let runs: Vec<Result<Vec<f64>, IdentifyError>> = (0..points.len() * count)
            .into_par_iter()
            .map(|run| Ok(self.run(run % count, &points[run / count])?.values))
            .collect();
        let mut runs = runs.into_iter();
        let joined = points.iter().map(|_| {
            let own: Vec<_> = runs.by_ref().take(count).collect();
            let own: Result<Vec<Vec<f64>>, IdentifyError> = own.into_iter().collect();
            own.map(|values| values.concat())
        });
        joined.collect()
    }

    /// Returns the remarks of the simulations at a point, with the names of their scenarios.
    ///
    /// # Errors
    /// A simulation fails there, or the caller asked to stop.
    pub fn remarks(&self, point: &[f64]) -> Result<Vec<String>, IdentifyError> {
        let mut remarks = Vec::new();
        for (index, experiment) in self.experiments.iter().enumerate() {
            let own = self.run(index, point)?.remarks;
            let name = experiment.scenario.name();
            remarks.extend(own.iter().map(|remark| format!("`{name}`: {remark}")));
        }
        Ok(remarks)
    }

    /// Runs an experiment. This function logs nothing, because hundreds of runs would repeat the
    /// same remarks.
    fn run(&self, experiment: usize, coordinates: &[f64]) -> Result<Prediction, IdentifyError> {
        let one = &self.experiments[experiment];
        let pairs = self.parameters.iter().zip(coordinates);
        let numbers: Vec<(&str, f64)> = pairs
            .filter(|(parameter, _)| parameter.concerns[experiment])
            .map(|(parameter, at)| (parameter.key.as_str(), parameter.value(*at)))
            .collect();
        let loaded = one.scenario.scenario_with(&numbers)?;
        let prepared =
            experiment::prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues))?;
        let observation = Observation::new(&prepared, &one.files)?;
        let followed = (self.windows > 1)
            .then(|| Followed::new(&prepared, &observation, &one.files))
            .flatten();
        let predict = || match &followed {
            Some(markers) => markers.predict(&prepared, &observation, self.windows, self.goes_on),
            None => observation.predict(&prepared, self.goes_on),
        };
        tracing::subscriber::with_default(NoSubscriber::new(), predict).map_err(|why| match why {
            Unpredicted::Stopped => IdentifyError::Interrupted,
            Unpredicted::Failed(source) => IdentifyError::Simulation {
                scenario: one.scenario.name().to_owned(),
                source,
            },
            Unpredicted::NoValue(file, datum, message) => IdentifyError::Row {
                file: one.files[file].path.clone(),
                line: one.files[file].data[datum].line,
                message,
            },
        })
    }
}
