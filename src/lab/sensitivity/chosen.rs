//! The columns of probes that are differentiated.

use super::error::SensitivityError;
use crate::run::probes::{Probes, Quantity};
use crate::run::{Observer, PreparedRun, Sample};
use crate::scenario::did_you_mean;
use rodlab_engine::mechanics::dynamics::{Exchange, Simulation};

/// The requested columns.
pub(super) struct Chosen {
    /// Indices of the columns among the columns of all probes.
    numbers: Vec<usize>,
    /// Names of the columns.
    pub(super) columns: Vec<String>,
}

impl Chosen {
    /// Returns the columns with these names, and all columns of probes with these names.
    ///
    /// # Errors
    /// [`SensitivityError::Probe`], and [`SensitivityError::Unsuitable`] if the scenario has no
    /// probes.
    pub(super) fn new(run: &PreparedRun, names: &[String]) -> Result<Self, SensitivityError> {
        let probes = probes_of(run)?;
        if probes.may_stop() {
            return Err(SensitivityError::Unsuitable(
                "derivatives support no stop_when: remove it, or set time.end to where it stops",
            ));
        }
        let all = probes.columns();
        let mut numbers: Vec<usize> = Vec::new();
        for name in names {
            let before = numbers.len();
            let mut first = 0;
            for (probe, columns) in probes.names().zip(probes.columns_of_each()) {
                let own = first..first + columns.len();
                first = own.end;
                numbers.extend(own.filter(|&index| probe == name || all[index] == *name));
            }
            if numbers.len() == before {
                let known = probes.names().chain(all.iter().map(String::as_str));
                let known = did_you_mean(name, known).unwrap_or_else(|| {
                    let list: Vec<&str> = probes.names().collect();
                    format!("the probes are: {}", list.join(", "))
                });
                return Err(SensitivityError::Probe {
                    name: name.clone(),
                    known,
                });
            }
        }
        if names.is_empty() {
            numbers.extend(0..all.len());
        }
        let mut seen = std::collections::BTreeSet::new();
        numbers.retain(|&index| seen.insert(index));
        let chosen = Self {
            columns: numbers.iter().map(|&index| all[index].clone()).collect(),
            numbers,
        };
        let is_rigid = (run.scene.contact).is_some_and(|contact| contact.is_complementarity());
        if is_rigid {
            let reason = "derivatives of contact forces and energies need contact.model = \"imc\" or \"ipc\"";
            chosen.check(run, |quantity| !quantity.is_of_contact(), reason)?;
        }
        Ok(chosen)
    }

    /// Checks that all columns depend only on shapes and velocities.
    ///
    /// # Errors
    /// [`SensitivityError::Key`] for the first column that does not.
    pub(super) fn check_shape(&self, run: &PreparedRun) -> Result<(), SensitivityError> {
        let reason = "derivatives with respect to fields support probes of shapes and velocities; \
                      use --to KEY for forces, moments and energies";
        self.check(run, Quantity::is_of_shape, reason)
    }

    /// Checks that the quantities of all columns are supported.
    fn check(
        &self,
        run: &PreparedRun,
        is_supported: fn(&Quantity) -> bool,
        reason: &str,
    ) -> Result<(), SensitivityError> {
        let probes = probes_of(run)?;
        let of_columns = probes.quantities().zip(probes.columns_of_each());
        let of_columns = of_columns
            .flat_map(|(quantity, columns)| columns.into_iter().map(|_| is_supported(quantity)));
        let of_columns: Vec<bool> = of_columns.collect();
        for (number, column) in self.numbers.iter().zip(&self.columns) {
            if !of_columns[*number] {
                return Err(SensitivityError::Key {
                    key: column.clone(),
                    reason: reason.to_owned(),
                });
            }
        }
        Ok(())
    }

    /// The values of the columns in a simulation of `run`. The places of measurement of `run` may
    /// differ from those of the other runs.
    pub(super) fn values(
        &self,
        run: &PreparedRun,
        simulation: &Simulation,
        steps: u64,
    ) -> Vec<Option<f64>> {
        let sample = Sample {
            simulation,
            steps,
            exchange: Exchange::default(),
        };
        let all = run
            .observer::<Probes>()
            .map(|probes| probes.values(&sample));
        let all = all.unwrap_or_default();
        self.numbers.iter().map(|&index| all[index]).collect()
    }
}

fn probes_of(run: &PreparedRun) -> Result<&Probes, SensitivityError> {
    let probes = run.observer::<Probes>();
    let probes = probes.filter(|probes| probes.names().next().is_some());
    probes.ok_or(SensitivityError::Unsuitable(
        "the scenario has no [[probes]] to differentiate; add one, as in `rodlab guide probes`",
    ))
}

/// Returns the difference of each value, divided by a number.
pub(super) fn rates(plus: &[Option<f64>], minus: &[Option<f64>], over: f64) -> Vec<Option<f64>> {
    let pairs = plus.iter().zip(minus);
    pairs
        .map(|(plus, minus)| Some(((*plus)? - (*minus)?) / over))
        .collect()
}
