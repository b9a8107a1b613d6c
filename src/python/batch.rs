//! Many simulations on all cores.

use crate::arrays::{Written, column, cube, elements, vectors};
use crate::attention::{Attention, BETWEEN};
use crate::errors::bad_argument;
use crate::pose::Target;
use crate::scenario::Scenario;
use crate::state::{Saved, State};
use crate::stepper::Stepper;
use numpy::{PyArray1, PyArray3};
use pyo3::prelude::*;
use rayon::prelude::*;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{Lockstep, Simulation};
use rodlab_lab::run::LiveRun;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{self, RecvTimeoutError};

/// Simulations that are stepped together on all cores: c cases with n nodes each.
#[pyclass(module = "rodlab._rodlab")]
pub struct Batch {
    cases: Vec<Case>,
    nodes: usize,
    forces: Written,
    /// Unused work memory for the threads.
    spare: Mutex<Vec<Lockstep>>,
}

struct Case {
    stepper: Stepper,
    failure: Option<String>,
}

impl Case {
    fn new(scenario: &Scenario) -> PyResult<Self> {
        Ok(Self {
            stepper: Stepper::new(scenario, false)?,
            failure: None,
        })
    }

    /// Starts the motions of clamps that must end at the first of the given times.
    fn carry(&mut self, until: &[Option<f64>]) {
        let now = self.stepper.run.simulation.time();
        if let Some(&Some(first)) = until.first()
            && self.failure.is_none()
            && first >= now
            && let Err(error) = self.stepper.carry(first)
        {
            self.failure = Some(error.to_string());
        }
    }
}

/// Advances a group of cases through the times of their plans, or by single steps. A failure stops its case alone.
fn advance_group(
    group: &mut [(&mut Case, Vec<Option<f64>>)],
    lockstep: &mut Lockstep,
    goes_on: &dyn Fn() -> bool,
) {
    for (case, plan) in group.iter_mut() {
        case.carry(plan);
    }
    let rounds = group.iter().map(|(_, plan)| plan.len()).max().unwrap_or(0);
    for round in 0..rounds {
        let mut rests = vec![false; group.len()];
        while goes_on() {
            let members = group.iter_mut().zip(&mut rests);
            let mut moving: Vec<_> = members
                .filter_map(|((case, plan), rests)| {
                    let until = *plan.get(round)?;
                    let now = case.stepper.run.simulation.time();
                    let done = *rests || until.is_some_and(|until| now >= until);
                    let moves = case.failure.is_none() && !done;
                    *rests = until.is_none();
                    moves.then_some((case, until.unwrap_or(f64::INFINITY)))
                })
                .collect();
            if moving.is_empty() {
                break;
            }
            let mut runs: Vec<_> = (moving.iter_mut())
                .map(|(case, until)| (&mut case.stepper.run, *until))
                .collect();
            let results = LiveRun::advance_together(&mut runs, lockstep, goes_on);
            for ((case, _), result) in moving.iter_mut().zip(results) {
                if let Err(error) = result {
                    case.failure = Some(error.to_string());
                }
            }
        }
    }
}

impl Batch {
    fn act(&mut self, py: Python<'_>) -> PyResult<()> {
        let size = 3 * self.nodes;
        let Some(forces) = self.forces.changed(py)? else {
            return Ok(());
        };
        let none = vec![0.0; self.nodes];
        for (case, forces) in self.cases.iter_mut().zip(forces.chunks_exact(size)) {
            let simulation = &mut case.stepper.run.simulation;
            simulation.set_external_forces(&vectors(forces), &none);
        }
        Ok(())
    }

    fn advance(
        &mut self,
        py: Python<'_>,
        plan: impl Fn(&Case) -> PyResult<Vec<Option<f64>>>,
    ) -> PyResult<()> {
        self.act(py)?;
        let plans: Vec<_> = self.cases.iter().map(plan).collect::<PyResult<_>>()?;
        let mut cases: Vec<_> = self.cases.iter_mut().zip(plans).collect();
        let spare = &self.spare;
        let interrupted = AtomicBool::new(false);
        let goes_on = || !interrupted.load(Relaxed);
        py.detach(|| {
            std::thread::scope(|scope| {
                let (finish, finished) = mpsc::channel();
                scope.spawn(move || {
                    cases.par_chunks_mut(Lockstep::LANES).for_each(|group| {
                        let mut lockstep = spare.lock().unwrap().pop().unwrap_or_default();
                        advance_group(group, &mut lockstep, &goes_on);
                        spare.lock().unwrap().push(lockstep);
                    });
                    // The receiver waits for this message.
                    let _ = finish.send(());
                });
                // The calling thread checks for signals.
                let attention = Attention::new();
                while let Err(RecvTimeoutError::Timeout) = finished.recv_timeout(BETWEEN) {
                    if !attention.continues() {
                        interrupted.store(true, Relaxed);
                        break;
                    }
                }
                attention.finish()
            })
        })
    }

    fn gather<'py>(
        &self,
        py: Python<'py>,
        of: impl Fn(&Simulation) -> &[Vector3],
    ) -> Bound<'py, PyArray3<f64>> {
        let mut flat = Vec::with_capacity(3 * self.nodes * self.cases.len());
        for case in &self.cases {
            for vector in of(&case.stepper.run.simulation) {
                flat.extend_from_slice(vector.as_slice());
            }
        }
        cube(py, [self.cases.len(), self.nodes, 3], flat)
    }

    fn case(&mut self, case: usize) -> PyResult<&mut Case> {
        let count = self.cases.len();
        let found = self.cases.get_mut(case);
        found.ok_or_else(|| bad_argument(format!("case: {case}; allowed: 0 to {}", count - 1)))
    }
}

#[derive(FromPyObject)]
enum Scenarios {
    One(Scenario),
    Many(Vec<Scenario>),
}

#[pymethods]
impl Batch {
    #[new]
    #[pyo3(signature = (scenarios, count = None))]
    fn new(py: Python<'_>, scenarios: Scenarios, count: Option<usize>) -> PyResult<Self> {
        let scenarios = match (scenarios, count) {
            (Scenarios::One(scenario), count) => vec![scenario; count.unwrap_or(1)],
            (Scenarios::Many(scenarios), None) => scenarios,
            (Scenarios::Many(scenarios), Some(count)) if scenarios.len() == count => scenarios,
            (Scenarios::Many(scenarios), Some(count)) => {
                return Err(bad_argument(format!(
                    "count: {count}, but there are {} scenarios",
                    scenarios.len()
                )));
            }
        };
        if scenarios.is_empty() {
            return Err(bad_argument("scenarios: at least one is needed"));
        }
        let cases: Vec<Case> = py.detach(|| {
            let cases = scenarios.par_iter().map(Case::new);
            cases.collect::<PyResult<_>>()
        })?;
        let nodes = cases[0].stepper.nodes();
        if let Some(other) = cases.iter().position(|case| case.stepper.nodes() != nodes) {
            return Err(bad_argument(format!(
                "scenarios: number {other} has {} nodes, the first has {nodes}; allowed: equal numbers",
                cases[other].stepper.nodes()
            )));
        }
        let forces = Written::new("forces", &[cases.len(), nodes, 3]);
        Ok(Self {
            cases,
            nodes,
            forces,
            spare: Mutex::default(),
        })
    }

    fn __len__(&self) -> usize {
        self.cases.len()
    }

    #[pyo3(signature = (duration = None, count = 1))]
    fn step(&mut self, py: Python<'_>, duration: Option<f64>, count: usize) -> PyResult<()> {
        self.advance(py, |case| {
            let Some(first) = case.stepper.end_of_step(duration)? else {
                return Ok(vec![None; count]);
            };
            let now = case.stepper.run.simulation.time();
            let step = first - now;
            // The times are those of a single simulation with the same number of steps.
            let ends = std::iter::successors(Some(first), |end| Some(end + step));
            Ok(ends.take(count).map(Some).collect())
        })
    }

    fn run(&mut self, py: Python<'_>, until: f64) -> PyResult<()> {
        if !until.is_finite() {
            return Err(bad_argument(format!("until: {until}; allowed: finite")));
        }
        self.advance(py, |_| Ok(vec![Some(until)]))
    }

    #[getter]
    fn failures(&self) -> Vec<Option<String>> {
        self.cases.iter().map(|case| case.failure.clone()).collect()
    }

    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let times = self
            .cases
            .iter()
            .map(|case| case.stepper.run.simulation.time());
        column(py, times.collect())
    }

    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f64>> {
        self.gather(py, |simulation| simulation.positions())
    }

    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f64>> {
        self.gather(py, |simulation| simulation.velocities())
    }

    #[getter]
    fn get_forces(&mut self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.forces.array(py)
    }

    #[setter]
    fn set_forces(&mut self, py: Python<'_>, forces: &Bound<'_, PyAny>) -> PyResult<()> {
        self.forces.assign(py, forces)
    }

    fn move_clamp(
        &mut self,
        py: Python<'_>,
        clamp: usize,
        poses: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let count = self.cases.len();
        let (which, flat) = elements(py, "poses", poses, &[&[count, 4, 4], &[count, 3]])?;
        let size = [16, 3][which];
        for (case, pose) in self.cases.iter_mut().zip(flat.chunks_exact(size)) {
            case.stepper.aim(Target::new(clamp, pose)?)?;
        }
        Ok(())
    }

    fn save(&mut self, py: Python<'_>, case: usize) -> PyResult<State> {
        self.act(py)?;
        let nodes = self.nodes;
        let forces = self.forces.last_read().chunks_exact(3 * nodes).nth(case);
        let forces = forces.map_or_else(|| vec![0.0; 3 * nodes], <[f64]>::to_vec);
        let run = self.case(case)?.stepper.run.save();
        Ok(State {
            saved: Saved {
                run,
                actions: [forces, vec![0.0; nodes]],
                curvature: vec![0.0; 2 * nodes],
                intervened: true,
            },
        })
    }

    fn restore(&mut self, py: Python<'_>, case: usize, state: &State) -> PyResult<()> {
        let nodes = self.nodes;
        let own = self.case(case)?;
        own.stepper.restore(state.saved.run.clone())?;
        own.failure = None;
        let mut forces = self.forces.last_read().to_vec();
        forces[3 * nodes * case..3 * nodes * (case + 1)].copy_from_slice(&state.saved.actions[0]);
        self.forces.put_back(py, &forces)
    }

    #[pyo3(signature = (cases = None))]
    fn reset(&mut self, py: Python<'_>, cases: Option<Vec<usize>>) -> PyResult<()> {
        let nodes = self.nodes;
        let cases = cases.unwrap_or_else(|| (0..self.cases.len()).collect());
        let mut forces = self.forces.last_read().to_vec();
        for case in cases {
            let own = self.case(case)?;
            let scenario = own.stepper.scenario.clone();
            *own = Case::new(&scenario)?;
            forces[3 * nodes * case..3 * nodes * (case + 1)].fill(0.0);
        }
        self.forces.put_back(py, &forces)
    }

    fn __repr__(&self) -> String {
        format!(
            "<rodlab.Batch of {} cases with {} nodes>",
            self.cases.len(),
            self.nodes
        )
    }
}
