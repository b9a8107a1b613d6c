//! A request for an identification, and all steps from it to the result.

use super::error::IdentifyError;
use super::fit::{Estimate, Loss, Weighting, minimise};
use super::frame;
use super::identified::Identified;
use super::jacobian::Jacobian;
use super::observe::Observation;
use super::parameter::{Parameter, Request};
use super::problem::{Experiment, Problem};
use super::statistics::{self, Group, noise, statistics};
use crate::experiment;
use crate::scenario::CaseSet;
use std::collections::BTreeMap;

/// Most rounds in which the noise is estimated from the residuals of a fit, and the fit is repeated with it.
const ROUNDS: usize = 6;
/// Relative change of the noise below which it is final.
const SAME_NOISE: f64 = 0.01;

/// What to identify.
#[derive(Clone, Debug)]
pub struct Task {
    /// Scenarios with their data.
    pub experiments: Vec<Experiment>,
    /// The keys.
    pub keys: Vec<Request>,
    /// Treatment of large residuals.
    pub loss: Loss,
    /// Standard deviations of the noise by the name of a quantity, `position` or a column.
    pub noise: BTreeMap<String, f64>,
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

/// Fits the keys. `goes_on` returns false where the work is to stop.
///
/// # Errors
/// Faults of scenarios and data, simulations that fail at the start, and the request to stop.
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
    let problem = Problem {
        experiments: &task.experiments,
        parameters: &parameters,
        goes_on,
    };
    let measured: Vec<f64> = problem.data().map(|(_, datum)| datum.value).collect();
    let groups = groups(&problem, &task.noise)?;
    let coordinates = vec![0.0; parameters.len()];
    let predicted = problem
        .predict(std::slice::from_ref(&coordinates))
        .remove(0)?;
    frame::check(&problem, &predicted)?;
    let mut estimate = Estimate {
        coordinates,
        predicted,
        columns: Vec::new(),
        iterations: 0,
        has_converged: false,
    };
    let stated: Vec<Option<f64>> = problem.data().map(|(_, datum)| datum.deviation).collect();
    let spread = |deviations: &[f64], widening: &[(f64, f64)]| {
        let mut all = vec![1.0; measured.len()];
        for ((group, deviation), (_, widened)) in groups.iter().zip(deviations).zip(widening) {
            for member in &group.members {
                all[*member] = widened * stated[*member].unwrap_or(*deviation);
            }
        }
        all
    };
    let unit = vec![1.0; measured.len()];
    let mut deviations = noise(
        &problem,
        &estimate,
        &weighting(task, &measured, &unit),
        &groups,
    );
    let mut widening = vec![(0.0, 1.0); groups.len()];
    for _ in 0..ROUNDS {
        let all = spread(&deviations, &widening);
        let current = weighting(task, &measured, &all);
        let mut forward = |estimate: &Estimate, root_mean_square: f64| {
            report(&Progress {
                iterations: estimate.iterations,
                root_mean_square,
                values: problem.values(&estimate.coordinates),
            });
        };
        estimate.has_converged = false;
        estimate = minimise(&problem, jacobian, &current, estimate, &mut forward)?;
        let found = noise(&problem, &estimate, &current, &groups);
        let residuals = current.residuals(&estimate.predicted);
        let of = |group: &Group| statistics::widening(group, &residuals);
        let widened: Vec<(f64, f64)> = groups.iter().map(of).collect();
        let is_same = |new: f64, old: f64| (new / old - 1.0).abs() < SAME_NOISE;
        let is_final = found
            .iter()
            .zip(&deviations)
            .all(|(new, old)| is_same(*new, *old))
            && widened
                .iter()
                .zip(&widening)
                .all(|(new, old)| is_same(new.1, old.1));
        widening = widened;
        deviations = found;
        if is_final {
            break;
        }
    }
    let all = spread(&deviations, &widening);
    let weighting = weighting(task, &measured, &all);
    let found = statistics(&problem, &estimate, &weighting, &groups);
    let mut identified =
        Identified::new(&problem, &estimate, &weighting, &groups, &widening, &found);
    (identified.remarks).extend(problem.remarks(&estimate.coordinates)?);
    Ok(identified)
}

fn weighting<'a>(task: &Task, measured: &'a [f64], deviations: &'a [f64]) -> Weighting<'a> {
    Weighting {
        measured,
        deviations,
        loss: task.loss,
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
                "`{}` has no simulation to compare with; allowed: scenarios that move, rest or follow a path",
                one.scenario.name()
            ));
        }
        Observation::new(&prepared, &one.files)?;
        numbers += one.files.iter().map(|file| file.data.len()).sum::<usize>();
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
