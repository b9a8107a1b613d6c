//! Exact derivatives of predictions, from runs with the derivatives of their state.

use super::error::IdentifyError;
use super::jacobian::{CentralDifferences, Jacobian};
use super::observe::Observation;
use super::parameter::Parameter;
use super::problem::Problem;
use crate::sensitivity;
use rayon::prelude::*;
use tracing::subscriber::NoSubscriber;

/// Maximum number of passes to find a suitable ε for each key.
const PASSES: usize = 3;

/// Exact derivatives of the computed motion, see [`crate::sensitivity`]. Experiments without such
/// derivatives, for example with natural frequencies, critical loads or windows, are
/// differentiated by central differences.
#[derive(Clone, Copy, Debug, Default)]
pub struct Exact {
    /// Derivatives of experiments without exact ones.
    pub otherwise: CentralDifferences,
}

impl Jacobian for Exact {
    fn derivatives(
        &self,
        problem: &Problem<'_>,
        coordinates: &[f64],
        here: &[f64],
    ) -> Result<Vec<Vec<f64>>, IdentifyError> {
        let mut first = 0;
        let sizes = problem.experiments.iter().map(|one| {
            let rows = one.files.iter().map(|file| file.data.len()).sum::<usize>();
            first += rows;
            first - rows..first
        });
        let ranges: Vec<_> = sizes.collect();
        let blocks: Vec<Result<Vec<Vec<f64>>, IdentifyError>> =
            (ranges.into_par_iter().enumerate())
                .map(|(experiment, range)| {
                    self.of_experiment(problem, experiment, coordinates, &here[range])
                })
                .collect();
        let mut columns = vec![Vec::with_capacity(here.len()); coordinates.len()];
        for block in blocks {
            for (column, part) in columns.iter_mut().zip(block?) {
                column.extend(part);
            }
        }
        Ok(columns)
    }
}

impl Exact {
    /// Derivatives of the predictions of one experiment.
    fn of_experiment(
        &self,
        problem: &Problem<'_>,
        experiment: usize,
        coordinates: &[f64],
        here: &[f64],
    ) -> Result<Vec<Vec<f64>>, IdentifyError> {
        let pairs = problem.parameters.iter().zip(coordinates).enumerate();
        let concerned = pairs.filter(|(_, (parameter, _))| parameter.concerns[experiment]);
        let (keys, own): (Vec<usize>, Vec<(Parameter, f64)>) = concerned
            .map(|(key, (parameter, at))| {
                let parameter = Parameter {
                    concerns: vec![true],
                    ..parameter.clone()
                };
                (key, (parameter, *at))
            })
            .unzip();
        let (parameters, own): (Vec<Parameter>, Vec<f64>) = own.into_iter().unzip();
        let alone = Problem {
            experiments: &problem.experiments[experiment..=experiment],
            parameters: &parameters,
            goes_on: problem.goes_on,
            windows: problem.windows,
        };
        let found = match exact(&alone, &own, here.len()) {
            Some(found) => found,
            None if !(problem.goes_on)() => return Err(IdentifyError::Interrupted),
            None => self.otherwise.derivatives(&alone, &own, here)?,
        };
        let mut columns = vec![vec![0.0; here.len()]; coordinates.len()];
        for (key, column) in keys.into_iter().zip(found) {
            columns[key] = column;
        }
        Ok(columns)
    }
}

/// Derivatives of the predictions of the only experiment over all keys; `None` if it has none, or
/// if the caller asked to stop.
fn exact(problem: &Problem<'_>, coordinates: &[f64], rows: usize) -> Option<Vec<Vec<f64>>> {
    if problem.windows > 1 {
        return None;
    }
    let keys = problem.parameters.iter().zip(coordinates);
    let keys: Vec<(&Parameter, f64)> = keys.map(|(key, at)| (key, *at)).collect();
    // Each thread follows the run with some of the keys.
    let share = keys.len().div_ceil(rayon::current_num_threads()).max(1);
    let shares: Vec<Option<Vec<Vec<f64>>>> = keys
        .par_chunks(share)
        .map(|share| followed(problem, coordinates, share, rows))
        .collect();
    let shares: Option<Vec<Vec<Vec<f64>>>> = shares.into_iter().collect();
    Some(shares?.concat())
}

/// Computes the derivatives with respect to some of the keys.
fn followed(
    problem: &Problem<'_>,
    coordinates: &[f64],
    share: &[(&Parameter, f64)],
    rows: usize,
) -> Option<Vec<Vec<f64>>> {
    let one = &problem.experiments[0];
    let values = problem.values(coordinates);
    let names = problem.parameters.iter().map(|one| one.key.as_str());
    let numbers: Vec<(&str, f64)> = names.zip(values).collect();
    let source = |more: &[String]| one.scenario.changed_with(&numbers, more);
    let keys: Vec<String> = share.iter().map(|(key, _)| key.key.clone()).collect();
    // ε of a value that is near 0 by chance would be lost in round-off.
    let size = |(key, _): &(&Parameter, f64)| match key.is_logarithmic {
        true => 0.0,
        false => key.scale,
    };
    let sizes: Vec<f64> = share.iter().map(size).collect();
    let mut followed = sensitivity::Problem::sized(&source, &keys, &sizes).ok()?;
    let observation = Observation::new(followed.base(), &one.files).ok()?;
    if !observation.is_differentiable(followed.base()) {
        return None;
    }
    let neighbours = (0..keys.len()).map(|key| {
        let observe = |run| Observation::new(run, &one.files).ok();
        let [plus, minus] = followed.neighbours_of(key).each_ref().map(observe);
        Some([plus?, minus?])
    });
    let neighbours: Option<Vec<[Observation; 2]>> = neighbours.collect();
    let neighbours = neighbours?;
    let moments = observation.moments();
    let times: Vec<f64> = moments.iter().map(|(time, _)| *time).collect();
    for pass in 1..=PASSES {
        let mut columns = vec![vec![f64::NAN; rows]; keys.len()];
        let mut next = moments.iter();
        let mut observe = |moment: &sensitivity::Moment<'_>| {
            let Some((_, which)) = next.next() else {
                return;
            };
            for (key, observations) in neighbours.iter().enumerate() {
                let runs = followed.neighbours_of(key);
                let [plus, minus] = moment.sensitivity.neighbours(key);
                let width = 2.0 * followed.keys()[key].step;
                let slope = share[key].0.slope(share[key].1);
                for &row in which {
                    let above = observations[0].value(row, &runs[0], plus, moment.steps);
                    let below = observations[1].value(row, &runs[1], minus, moment.steps);
                    if let (Some(above), Some(below)) = (above, below) {
                        columns[key][row] = slope * (above - below) / width;
                    }
                }
            }
        };
        let follow = || followed.follow(&times, problem.goes_on, &mut observe);
        // Hundreds of runs would repeat the same remarks.
        let amplitudes = tracing::subscriber::with_default(NoSubscriber::new(), follow).ok()?;
        if pass == PASSES || !followed.adapt(&amplitudes).ok()? {
            let numbers = columns.iter().flatten();
            let is_whole = numbers.into_iter().all(|number| number.is_finite());
            return is_whole.then_some(columns);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::tests::{SWING, SWING_KEYS, TWISTED, scenario, swing_rows};
    use super::super::{DataFile, Experiment, Request};
    use super::*;
    use std::collections::BTreeMap;
    use std::path::Path;

    /// Derivatives of an experiment, and the largest deviation of the exact ones from extrapolated
    /// differences, relative to the largest derivative with respect to the key.
    fn deviation(text: &str, rows: &str, keys: &[&str]) -> f64 {
        let file = DataFile::from_text(Path::new("data.csv"), rows, &BTreeMap::new()).unwrap();
        let experiments = [Experiment {
            scenario: scenario(text),
            files: vec![file],
        }];
        let scenarios = [experiments[0].scenario.clone()];
        let parameter = |key: &&str| {
            let request = Request {
                key: (*key).to_owned(),
                // The scale of values near 0.
                prior: ["bend", "shift"]
                    .iter()
                    .any(|end| key.ends_with(end))
                    .then_some([0.0, 0.01]),
                ..Request::default()
            };
            Parameter::new(&request, &scenarios).unwrap()
        };
        let parameters: Vec<Parameter> = keys.iter().map(parameter).collect();
        let problem = Problem {
            experiments: &experiments,
            parameters: &parameters,
            goes_on: &|| true,
            windows: 1,
        };
        let at = vec![0.0; keys.len()];
        let here = problem
            .predict(std::slice::from_ref(&at))
            .remove(0)
            .unwrap();
        let own = exact(&problem, &at, here.len()).expect("exact derivatives");
        let by = |step: f64| {
            let central = CentralDifferences { step };
            central.derivatives(&problem, &at, &here).unwrap()
        };
        let (fine, coarse) = (by(1e-3), by(2e-3));
        let mut worst = 0.0_f64;
        for (key, own) in own.iter().enumerate() {
            let pairs = fine[key].iter().zip(&coarse[key]);
            let other: Vec<f64> = pairs
                .map(|(fine, coarse)| (4.0 * fine - coarse) / 3.0)
                .collect();
            let largest = other.iter().fold(0.0_f64, |most, one| most.max(one.abs()));
            assert!(largest > 0.0);
            for (own, other) in own.iter().zip(&other) {
                worst = worst.max((own - other).abs() / largest);
            }
        }
        worst
    }

    #[test]
    fn derivatives_of_a_damped_swing_are_those_of_differences() {
        let worst = deviation(SWING, &swing_rows(), &SWING_KEYS);
        assert!(worst < 1e-5, "{worst:e}");
    }

    #[test]
    fn derivatives_over_values_that_are_near_0_by_chance_are_those_of_differences() {
        let hanging = SWING
            .replace(
                "stiffness = 2e-4",
                "stiffness = 2e-4\nbend = 1e-7\nshift = -1e-9",
            )
            .replace(
                "start = [0, 0, 0], end = [0.2, 0, 0]",
                r#"start = [0, 0, "shift"], end = [0.2, 0, "shift"]"#,
            )
            .replace(
                "[[clamps]]",
                "natural_curvature = [\"bend\", 0]\n[[clamps]]",
            )
            .replace("step = \"5 ms\"\nend = 1.0", "mode = \"static\"");
        let positions = "node,x_m,z_m\n3,0,0\n6,0,0\n10,0,0\n";
        let worst = deviation(
            &hanging,
            positions,
            &["parameters.bend", "parameters.shift"],
        );
        assert!(worst < 1e-5, "{worst:e}");
    }

    #[test]
    fn derivatives_of_a_static_loop_and_its_moments_are_those_of_differences() {
        let positions = "node,x_m,y_m,z_m\n6,0,0,0\n12,0,0,0\n18,0,0,0\n";
        let keys = ["parameters.ei", "parameters.gj"];
        let worst = deviation(TWISTED, positions, &keys);
        assert!(worst < 1e-5, "{worst:e}");
        let moments = "grip_moment_x_n_m,grip_moment_y_n_m,grip_moment_z_n_m\n0,0,0\n";
        let worst = deviation(TWISTED, moments, &keys);
        assert!(worst < 1e-5, "{worst:e}");
    }

    #[test]
    fn natural_frequencies_are_differentiated_by_differences() {
        let file = DataFile::from_text(
            Path::new("data.csv"),
            "frequency_1_hz\n1\n",
            &BTreeMap::new(),
        );
        let still = SWING.replace("step = \"5 ms\"\nend = 1.0", "mode = \"static\"");
        let experiments = [Experiment {
            scenario: scenario(&still),
            files: vec![file.unwrap()],
        }];
        let request = Request {
            key: SWING_KEYS[0].to_owned(),
            ..Request::default()
        };
        let scenarios = [experiments[0].scenario.clone()];
        let parameters = [Parameter::new(&request, &scenarios).unwrap()];
        let problem = Problem {
            experiments: &experiments,
            parameters: &parameters,
            goes_on: &|| true,
            windows: 1,
        };
        let here = problem.predict(&[vec![0.0]]).remove(0).unwrap();
        assert!(exact(&problem, &[0.0], 1).is_none());
        let own = Exact::default()
            .derivatives(&problem, &[0.0], &here)
            .unwrap();
        let central = CentralDifferences::default();
        let other = central.derivatives(&problem, &[0.0], &here).unwrap();
        assert_eq!(own, other);
    }
}
