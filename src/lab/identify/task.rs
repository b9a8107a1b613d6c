//! Request for an identification, and all steps from the request to the result.

use super::error::IdentifyError;
use super::fit::{Estimate, Loss, Weighting, minimise};
use super::frame;
use super::identified::Identified;
use super::jacobian::Jacobian;
use super::observe::Observation;
use super::parameter::{Parameter, Request};
use super::problem::{Experiment, Problem};
use super::shooting::Followed;
use super::statistics::{self, Group, Shared, noise, statistics};
use crate::experiment;
use crate::scenario::CaseSet;
use std::collections::BTreeMap;

/// Maximum number of rounds, each of which estimates the noise from the residuals and repeats the
/// fit with it.
const ROUNDS: usize = 6;
/// Factor by which windows become longer in each round of multiple shooting.
const LONGER: usize = 4;
/// Maximum number of these rounds for fits in windows.
const WINDOWED_ROUNDS: usize = 2;
/// Relative change of the noise below which it is final.
const SAME_NOISE: f64 = 0.01;

/// Task of an identification.
#[derive(Clone, Debug)]
pub struct Task {
    /// Scenarios with their data.
    pub experiments: Vec<Experiment>,
    /// The keys.
    pub keys: Vec<Request>,
    /// Treatment of large residuals.
    pub loss: Loss,
    /// Standard deviations of the noise, by the name of a quantity: `position` or a column.
    pub noise: BTreeMap<String, f64>,
    /// Errors that the numbers of each experiment share.
    pub shared: Option<Shared>,
    /// Initial number of windows of each motion for multiple shooting; 1 for no division.
    pub windows: usize,
}

/// Progress of a fit.
#[derive(Clone, Debug)]
pub struct Progress {
    /// Derivatives computed so far.
    pub iterations: usize,
    /// Root mean square of the residuals in standard deviations.
    pub root_mean_square: f64,
    /// Values of the keys.
    pub values: Vec<f64>,
}

/// Fits the keys. `goes_on` returns false if the work should stop.
///
/// # Errors
/// A scenario or data file is wrong, a simulation fails at the start, or the caller asked to stop.
pub fn identify(
    task: &Task,
    jacobian: &dyn Jacobian,
    goes_on: &(dyn Fn() -> bool + Sync),
    report: &mut dyn FnMut(&Progress),
) -> Result<Identified, IdentifyError> {
    check(task)?;
    let scenarios: Vec<CaseSet> = task
        .experiments
        .iter()
        .map(|one| one.scenario.clone())
        .collect();
    let parameters: Result<Vec<Parameter>, IdentifyError> = task
        .keys
        .iter()
        .map(|key| Parameter::new(key, &scenarios))
        .collect();
    let parameters = parameters?;
    let mut problem = Problem {
        experiments: &task.experiments,
        parameters: &parameters,
        goes_on,
        windows: task.windows,
    };
    let mut noise = Scatter::new(task, &problem)?;
    let mut estimate = Estimate::at_start(&problem)?;
    frame::check(&problem, &estimate.predicted)?;
    let mut divided = Vec::new();
    while problem.windows > 1 {
        divided.push(problem.windows.to_string());
        estimate = noise.fit(&problem, jacobian, estimate, WINDOWED_ROUNDS, report)?;
        problem.windows = problem.windows.div_ceil(LONGER);
        let iterations = estimate.iterations;
        estimate = Estimate::at(&problem, estimate.coordinates)?;
        estimate.iterations = iterations;
    }
    let in_windows = estimate.iterations;
    estimate = noise.fit(&problem, jacobian, estimate, ROUNDS, report)?;
    let mut identified = noise.identified(&problem, &estimate);
    (identified.remarks).extend(problem.remarks(&estimate.coordinates)?);
    if !divided.is_empty() {
        identified.remarks.push(format!(
            "multiple shooting in {} windows took {in_windows} iterations, each as long as about {} runs of the motion; the whole motion then took {} iterations",
            divided.join(", "),
            2 * (2 * parameters.len() + 1),
            estimate.iterations - in_windows,
        ));
    }
    Ok(identified)
}

/// Present knowledge of the noise of all numbers.
struct Scatter {
    loss: Loss,
    shared: Option<Shared>,
    measured: Vec<f64>,
    /// Standard deviations that the files state.
    stated: Vec<Option<f64>>,
    groups: Vec<Group>,
    /// The standard deviation of each group.
    deviations: Vec<f64>,
    /// The correlation of neighbours in each group, and the factor by which it widens the error bars.
    widening: Vec<(f64, f64)>,
}

impl Scatter {
    fn new(task: &Task, problem: &Problem<'_>) -> Result<Self, IdentifyError> {
        let groups = groups(problem, &task.noise)?;
        Ok(Self {
            loss: task.loss,
            shared: task.shared,
            measured: problem.data().map(|(_, datum)| datum.value).collect(),
            stated: problem.data().map(|(_, datum)| datum.deviation).collect(),
            deviations: vec![1.0; groups.len()],
            widening: vec![(0.0, 1.0); groups.len()],
            groups,
        })
    }

    /// Standard deviations of all numbers, including the factors that widen them.
    fn spread(&self) -> Vec<f64> {
        let mut all = vec![1.0; self.measured.len()];
        let widened = self.deviations.iter().zip(&self.widening);
        for (group, (deviation, (_, widened))) in self.groups.iter().zip(widened) {
            for member in &group.members {
                all[*member] = widened * self.stated[*member].unwrap_or(*deviation);
            }
        }
        all
    }

    fn weighting<'a>(&'a self, deviations: &'a [f64]) -> Weighting<'a> {
        Weighting {
            measured: &self.measured,
            deviations,
            loss: self.loss,
        }
    }

    /// Fits the keys and estimates the noise from the residuals in turn, for at most `rounds`
    /// rounds.
    fn fit(
        &mut self,
        problem: &Problem<'_>,
        jacobian: &dyn Jacobian,
        start: Estimate,
        rounds: usize,
        report: &mut dyn FnMut(&Progress),
    ) -> Result<Estimate, IdentifyError> {
        let mut estimate = start;
        let all = self.spread();
        self.deviations = noise(problem, &estimate, &self.weighting(&all), &self.groups);
        let mut forward = |estimate: &Estimate, root_mean_square: f64| {
            report(&Progress {
                iterations: estimate.iterations,
                root_mean_square,
                values: problem.values(&estimate.coordinates),
            });
        };
        for _ in 0..rounds {
            let all = self.spread();
            let current = self.weighting(&all);
            estimate.has_converged = false;
            estimate = minimise(problem, jacobian, &current, estimate, &mut forward)?;
            let found = noise(problem, &estimate, &current, &self.groups);
            let residuals = current.residuals(&estimate.predicted);
            let of = |group: &Group| statistics::widening(group, &residuals);
            let widened: Vec<(f64, f64)> = self.groups.iter().map(of).collect();
            let is_same = |new: f64, old: f64| (new / old - 1.0).abs() < SAME_NOISE;
            let mut of_noise = found.iter().zip(&self.deviations);
            let mut of_widening = widened.iter().zip(&self.widening);
            let is_final = of_noise.all(|(new, old)| is_same(*new, *old))
                && of_widening.all(|(new, old)| is_same(new.1, old.1));
            self.widening = widened;
            self.deviations = found;
            if is_final {
                break;
            }
        }
        Ok(estimate)
    }

    /// Builds the result at an estimate.
    fn identified(&self, problem: &Problem<'_>, estimate: &Estimate) -> Identified {
        let all = self.spread();
        let weighting = self.weighting(&all);
        let found = statistics(problem, estimate, &weighting, &self.groups, self.shared);
        Identified::new(
            problem,
            estimate,
            &weighting,
            &self.groups,
            &self.widening,
            &found,
        )
    }
}

/// Checks the request and that all data fit their scenarios, before anything runs.
fn check(task: &Task) -> Result<(), IdentifyError> {
    let fault = |message: String| Err(IdentifyError::Input(message));
    if task.keys.is_empty() {
        return fault("no key is fitted; name at least one by --fit KEY".to_owned());
    }
    for (index, request) in task.keys.iter().enumerate() {
        if task.keys[..index]
            .iter()
            .any(|other| other.key == request.key)
        {
            return fault(format!(
                "the key `{}` is fitted twice; name it once",
                request.key
            ));
        }
    }
    let mut numbers = 0;
    let (mut is_followed, mut most_windows) = (false, usize::MAX);
    for one in &task.experiments {
        if one.scenario.is_sweep() {
            return fault(format!(
                "`{}` is a sweep; allowed: a scenario of one case",
                one.scenario.name()
            ));
        }
        let loaded = one.scenario.scenario_of(0)?;
        let prepared =
            experiment::prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues))?;
        if prepared.table.is_some() {
            return fault(format!(
                "`{}` has no simulation to compare with; allowed: scenarios with time.mode \"dynamic\", \"static\" or \
                 \"continuation\"",
                one.scenario.name()
            ));
        }
        let observation = Observation::new(&prepared, &one.files)?;
        if let Some(markers) = Followed::new(&prepared, &observation, &one.files) {
            most_windows = most_windows.min(markers.most_windows());
            is_followed = true;
        }
        numbers += one.files.iter().map(|file| file.data.len()).sum::<usize>();
    }
    if task.windows > 1 && !is_followed {
        return fault("--shooting: no marker of a motion was measured often enough; allowed: positions over time, time_s,marker,x_m,y_m,z_m".to_owned());
    }
    if task.windows > most_windows.max(1) {
        return fault(format!(
            "--shooting {}: the measured times are too few; allowed: at most {most_windows} windows",
            task.windows
        ));
    }
    if numbers < task.keys.len() {
        return fault(format!(
            "{numbers} measured numbers cannot determine {} keys; allowed: at least as many numbers as keys",
            task.keys.len()
        ));
    }
    Ok(())
}

/// Numbers of a file and a quantity.
fn groups(
    problem: &Problem<'_>,
    given: &BTreeMap<String, f64>,
) -> Result<Vec<Group>, IdentifyError> {
    let mut groups: Vec<Group> = Vec::new();
    let mut last: BTreeMap<(String, String), usize> = BTreeMap::new();
    let mut quantities: Vec<&str> = Vec::new();
    for (index, (file, datum)) in problem.data().enumerate() {
        quantities.push(datum.group());
        let name = format!("{} {}", file.path.display(), datum.group());
        let place = groups.iter().position(|group| group.name == name);
        let place = place.unwrap_or_else(|| {
            groups.push(Group {
                name: name.clone(),
                members: Vec::new(),
                pairs: Vec::new(),
                given: given.get(datum.group()).copied(),
            });
            groups.len() - 1
        });
        groups[place].members.push(index);
        if let Some(before) = last.insert((name, datum.series.clone()), index) {
            groups[place].pairs.push([before, index]);
        }
        if let Some(deviation) = datum.deviation {
            groups[place].given = Some(deviation);
        }
    }
    for name in given.keys() {
        if !quantities.contains(&name.as_str()) {
            quantities.sort_unstable();
            quantities.dedup();
            return Err(IdentifyError::Input(format!(
                "--noise {name}: nothing of that name was measured; there are: {}",
                quantities.join(", ")
            )));
        }
    }
    Ok(groups)
}
