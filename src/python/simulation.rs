//! A simulation with its steps, actions and state.

use crate::arrays::{Written, column, copy_rows, cube, rows, table, vectors};
use crate::attention::Attention;
use crate::contacts::Contacts;
use crate::errors::{bad_argument, of_simulation};
use crate::gradient::derivatives;
use crate::pose::{Target, held, matrix};
use crate::scenario::Scenario;
use crate::state::{Saved, State};
use crate::stepper::{StepReport, Stepper, Stopped};
use crate::table::dictionary;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{self, SimulationError};
use rodlab_engine::mechanics::statics::PointKind;
use rodlab_engine::mechanics::system::Grasp;
use rodlab_files::results::Value;
use rodlab_lab::run::Mode;

/// A scene in motion with n nodes in total, rod after rod.
#[pyclass(module = "rodlab._rodlab")]
pub struct Simulation {
    stepper: Stepper,
    forces: Written,
    torques: Written,
    curvature: Written,
    /// Whether the program has changed the course of the scenario.
    intervened: bool,
}

impl Simulation {
    /// Applies what the program wrote into the arrays of actions.
    fn act(&mut self, py: Python<'_>) -> PyResult<()> {
        let forces = self.forces.changed(py)?.is_some();
        if self.torques.changed(py)?.is_some() || forces {
            self.intervened = true;
            let forces = vectors(self.forces.last_read());
            let simulation = &mut self.stepper.run.simulation;
            simulation.set_external_forces(&forces, self.torques.last_read());
        }
        if let Some(curvature) = self.curvature.changed(py)? {
            self.intervened = true;
            let set = (self.stepper.curved).set(&mut self.stepper.run.simulation, curvature);
            set.map_err(|error| of_simulation(&error))?;
        }
        Ok(())
    }

    fn advance(&mut self, py: Python<'_>, until: Option<f64>) -> PyResult<StepReport> {
        let stepper = &mut self.stepper;
        if let Some(until) = until {
            stepper.carry(until)?;
        }
        let (result, attention) = py.detach(|| {
            let attention = Attention::new();
            (stepper.advance(until, &|| attention.continues()), attention)
        });
        attention.finish()?;
        result.map_err(|stopped| match stopped {
            Stopped::Failed(error) => of_simulation(&error),
            Stopped::Signal => pyo3::exceptions::PyKeyboardInterrupt::new_err(()),
        })
    }

    fn simulation(&self) -> &dynamics::Simulation {
        &self.stepper.run.simulation
    }
}

#[pymethods]
impl Simulation {
    #[new]
    #[pyo3(signature = (scenario, natural_curvature = false))]
    fn new(scenario: &Scenario, natural_curvature: bool) -> PyResult<Self> {
        let stepper = Stepper::new(scenario, natural_curvature)?;
        let nodes = stepper.nodes();
        Ok(Self {
            stepper,
            forces: Written::new("forces", &[nodes, 3]),
            torques: Written::new("torques", &[nodes]),
            curvature: Written::new("natural_curvature", &[nodes, 2]),
            intervened: false,
        })
    }

    #[pyo3(signature = (duration = None))]
    fn step(&mut self, py: Python<'_>, duration: Option<f64>) -> PyResult<StepReport> {
        let until = self.stepper.end_of_step(duration)?;
        self.act(py)?;
        self.advance(py, until)
    }

    fn run(&mut self, py: Python<'_>, until: f64) -> PyResult<StepReport> {
        let now = self.simulation().time();
        if !(until.is_finite() && until >= now) {
            return Err(bad_argument(format!(
                "until: {until}; allowed: finite and at least {now} s, the present time"
            )));
        }
        self.act(py)?;
        self.advance(py, Some(until))
    }

    fn find_equilibrium(&mut self, py: Python<'_>) -> PyResult<StepReport> {
        self.act(py)?;
        let now = self.simulation().time();
        self.intervened |= self.stepper.run.mode() != Mode::Static;
        self.stepper.carry(now)?;
        let stepper = &mut self.stepper;
        let (found, attention) = py.detach(|| {
            let attention = Attention::new();
            (
                stepper.run.find_equilibrium(&|| attention.continues()),
                attention,
            )
        });
        attention.finish()?;
        let found = found.map_err(|error| of_simulation(&error))?;
        let mut report = StepReport::default();
        if let Some(found) = found {
            report.add(&found);
        }
        report.time = self.simulation().time();
        Ok(report)
    }

    #[pyo3(signature = (to = None, step = None))]
    fn follow<'py>(
        &mut self,
        py: Python<'py>,
        to: Option<f64>,
        step: Option<f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let Mode::Continuation(mut plan) = self.stepper.run.mode() else {
            return Err(bad_argument(
                "the scenario follows no path: time.mode = \"continuation\" is needed",
            ));
        };
        self.act(py)?;
        plan.to = to.unwrap_or(plan.to);
        plan.step = step.unwrap_or(plan.step);
        plan.largest_step = plan.largest_step.max(plan.step);
        if !(plan.to.is_finite() && plan.to != plan.from && plan.step > 0.0) {
            return Err(bad_argument(format!(
                "to: {}, step: {}; allowed: a finite parameter other than {}, and a step above 0",
                plan.to, plan.step, plan.from
            )));
        }
        let run = &mut self.stepper.run;
        let nodes = run.simulation.positions().len();
        let followed = py.detach(|| {
            let attention = Attention::new();
            let mut points = Vec::new();
            let mut positions: Vec<Vector3> = Vec::new();
            let mut follow = || -> Result<(), SimulationError> {
                let mut tracer = run.simulation.path(plan)?;
                while attention.continues() {
                    let Some(point) = run.simulation.next_point(&mut tracer)? else {
                        break;
                    };
                    run.count_point(&point);
                    positions.extend(run.simulation.positions());
                    points.push((point.parameter, point.negative, point.kind));
                }
                Ok(())
            };
            let result = follow();
            (result, attention, points, positions)
        });
        let (result, attention, points, positions) = followed;
        attention.finish()?;
        result.map_err(|error| of_simulation(&error))?;
        let parameter = points.iter().map(|point| point.0).collect();
        let modes: Vec<usize> = points.iter().map(|point| point.1).collect();
        let kinds: Vec<&str> = points.iter().map(|point| word(point.2)).collect();
        let flat = positions.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
        let answer = PyDict::new(py);
        answer.set_item("parameter", column(py, parameter))?;
        answer.set_item("positions", cube(py, [points.len(), nodes, 3], flat))?;
        answer.set_item(
            "unstable_modes",
            py.import("numpy")?.call_method1("array", (modes,))?,
        )?;
        answer.set_item("kind", kinds)?;
        Ok(answer)
    }

    #[getter]
    fn scenario(&self) -> Scenario {
        self.stepper.scenario.clone()
    }

    #[getter]
    fn time(&self) -> f64 {
        self.simulation().time()
    }

    #[getter]
    fn end(&self) -> Option<f64> {
        match self.stepper.run.mode() {
            Mode::Dynamic { end, .. } => Some(end),
            Mode::Static | Mode::Continuation(_) => None,
        }
    }

    #[getter]
    fn ended(&self) -> Option<&str> {
        self.stepper.run.ending()
    }

    #[getter]
    fn step_size(&self) -> Option<f64> {
        self.stepper.fixed_step()
    }

    #[getter]
    fn rod_names(&self) -> Vec<&str> {
        let rods = self.stepper.prepared.scene.rods.iter();
        rods.map(|rod| rod.name.as_str()).collect()
    }

    #[getter]
    fn rod_slices(&self) -> Vec<(usize, usize)> {
        // Free bodies follow the rods.
        let rods = self.stepper.prepared.scene.rods.len();
        let ranges = self.simulation().rod_ranges().iter().take(rods);
        ranges
            .map(|range| (range.first_node, range.first_node + range.nodes))
            .collect()
    }

    #[getter]
    fn clamp_names(&self) -> Vec<String> {
        let scene = &self.stepper.prepared.scene;
        let names = scene.clamps.iter().map(|clamp| {
            let rod = &scene.rods[clamp.rod];
            match clamp.node {
                0 => format!("{}.start", rod.name),
                node if node + 1 == rod.centreline.len() => format!("{}.end", rod.name),
                node => format!("{}.{node}", rod.name),
            }
        });
        names.collect()
    }

    #[getter]
    fn clamp_nodes(&self) -> Vec<Option<usize>> {
        let simulation = self.simulation();
        let clamps = 0..simulation.clamps();
        clamps
            .map(|clamp| Some(simulation.clamp_pose(clamp)?.node))
            .collect()
    }

    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        rows(py, self.simulation().positions())
    }

    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        rows(py, self.simulation().velocities())
    }

    #[getter]
    fn directors<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        rows(py, &self.simulation().material_directors())
    }

    #[getter]
    fn edge_angles<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        column(py, self.simulation().edge_angles().to_vec())
    }

    #[getter]
    fn twists<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        column(py, self.simulation().twist_rates())
    }

    #[getter]
    fn curvatures<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let resultants = self.simulation().resultants();
        let curvature = |one: &Option<dynamics::Resultants>| one.map_or(f64::NAN, |r| r.curvature);
        column(py, resultants.iter().map(curvature).collect())
    }

    #[getter]
    fn moments<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let resultants = self.simulation().resultants();
        let moments = |one: &Option<dynamics::Resultants>| {
            one.map_or([f64::NAN; 2], |r| [r.bending_moment, r.twisting_moment])
        };
        let flat = resultants.iter().flat_map(moments).collect();
        table(py, [resultants.len(), 2], flat)
    }

    #[getter]
    fn tensions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let simulation = self.simulation();
        let edges = 0..self.stepper.nodes();
        let tensions = edges.map(|edge| simulation.tension(edge).unwrap_or(f64::NAN));
        column(py, tensions.collect())
    }

    fn read_positions(&self, out: &Bound<'_, PyArray2<f64>>) -> PyResult<()> {
        copy_rows(out, self.simulation().positions())
    }

    #[getter]
    fn get_forces(&mut self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.forces.array(py)
    }

    #[setter]
    fn set_forces(&mut self, py: Python<'_>, forces: &Bound<'_, PyAny>) -> PyResult<()> {
        self.forces.assign(py, forces)
    }

    #[getter]
    fn get_torques(&mut self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.torques.array(py)
    }

    #[setter]
    fn set_torques(&mut self, py: Python<'_>, torques: &Bound<'_, PyAny>) -> PyResult<()> {
        self.torques.assign(py, torques)
    }

    #[getter]
    fn get_natural_curvature(&mut self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        if self.stepper.curved.is_empty() {
            return Err(bad_argument(
                "natural_curvature: set up the simulation with natural_curvature=True",
            ));
        }
        self.curvature.array(py)
    }

    #[setter]
    fn set_natural_curvature(
        &mut self,
        py: Python<'_>,
        curvature: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        self.get_natural_curvature(py)?;
        self.curvature.assign(py, curvature)
    }

    fn clamp_pose<'py>(
        &self,
        py: Python<'py>,
        clamp: usize,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        Ok(matrix(py, &held(self.simulation(), clamp)?))
    }

    fn move_clamp(
        &mut self,
        py: Python<'_>,
        clamp: usize,
        pose: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let target = Target::read(py, clamp, pose)?;
        self.stepper.aim(target)?;
        self.intervened = true;
        Ok(())
    }

    #[pyo3(signature = (node, position = true, frame = true))]
    fn grasp(&mut self, node: usize, position: bool, frame: bool) -> PyResult<usize> {
        let grasp = Grasp { position, frame };
        let grasped = self.stepper.run.simulation.grasp(node, grasp);
        let clamp = grasped.map_err(|error| of_simulation(&error))?;
        self.intervened = true;
        Ok(clamp)
    }

    fn release(&mut self, clamp: usize) -> PyResult<()> {
        self.stepper.release(clamp)?;
        self.intervened = true;
        Ok(())
    }

    fn set_load_factor(&mut self, load: usize, factor: f64) -> PyResult<()> {
        if !factor.is_finite() {
            return Err(bad_argument(format!("factor: {factor}; allowed: finite")));
        }
        let set = self.stepper.run.simulation.set_load_factor(load, factor);
        set.map_err(|error| of_simulation(&error))?;
        self.intervened = true;
        Ok(())
    }

    fn reaction<'py>(&self, py: Python<'py>, clamp: usize) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let simulation = self.simulation();
        let node = held(simulation, clamp)?.node;
        let (force, moment) = (simulation.reaction(node), simulation.reaction_moment(node));
        Ok(column(
            py,
            force.iter().chain(moment.iter()).copied().collect(),
        ))
    }

    #[getter]
    fn contacts(&self, py: Python<'_>) -> Contacts {
        Contacts::of(py, self.simulation())
    }

    #[getter]
    fn contact_forces<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        rows(
            py,
            &or_zeros(self.simulation().contact_forces(), self.stepper.nodes()),
        )
    }

    #[getter]
    fn fluid_forces<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        rows(
            py,
            &or_zeros(self.simulation().fluid_forces(), self.stepper.nodes()),
        )
    }

    #[getter]
    fn energies<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let energies = self.simulation().energies();
        dictionary(
            py,
            [
                ("kinetic", energies.kinetic),
                ("stretching", energies.stretching),
                ("bending", energies.bending),
                ("twisting", energies.twisting),
                ("contact", energies.contact),
                ("gravitational", energies.gravitational),
            ],
        )
    }

    fn probes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let measured = self.stepper.run.measure();
        let measured = measured.map_err(|error| of_simulation(&error))?;
        let answer = PyDict::new(py);
        for (name, value) in measured {
            match value {
                Value::Empty => answer.set_item(name, f64::NAN)?,
                Value::Flag(flag) => answer.set_item(name, flag)?,
                Value::Integer(number) => answer.set_item(name, number)?,
                Value::Number(number) => answer.set_item(name, number)?,
                Value::Text(text) => answer.set_item(name, text)?,
            }
        }
        Ok(answer)
    }

    fn gradient<'py>(
        &mut self,
        py: Python<'py>,
        to: Vec<String>,
        of: Vec<String>,
    ) -> PyResult<Bound<'py, PyDict>> {
        self.act(py)?;
        if self.intervened {
            return Err(bad_argument(
                "gradient: the program has changed the motion, by an action or a call of find_equilibrium; \
                 derivatives exist only for the motion that the scenario prescribes",
            ));
        }
        let time = self.simulation().time();
        derivatives(py, self.stepper.scenario.source(), &to, &of, Some(&[time]))
    }

    #[getter]
    fn remarks(&self) -> Vec<String> {
        self.stepper.run.remarks()
    }

    fn save(&mut self, py: Python<'_>) -> PyResult<State> {
        self.act(py)?;
        Ok(State {
            saved: Saved {
                run: self.stepper.run.save(),
                actions: [self.forces.last_read(), self.torques.last_read()].map(<[f64]>::to_vec),
                curvature: self.curvature.last_read().to_vec(),
                intervened: self.intervened,
            },
        })
    }

    fn restore(&mut self, py: Python<'_>, state: &State) -> PyResult<()> {
        let saved = state.saved.clone();
        if saved.actions[1].len() != self.stepper.nodes() {
            return Err(bad_argument("state: it belongs to another scenario"));
        }
        self.stepper.restore(saved.run)?;
        self.intervened = saved.intervened;
        let [forces, torques] = &saved.actions;
        self.forces.put_back(py, forces)?;
        self.torques.put_back(py, torques)?;
        self.curvature.put_back(py, &saved.curvature)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let mut this = slf.borrow_mut();
        let made = py.get_type::<Self>().getattr("_resumed")?;
        let with_curvature = !this.stepper.curved.is_empty();
        let arguments = (
            this.scenario(),
            with_curvature,
            Bound::new(py, this.save(py)?)?,
        );
        (made, arguments).into_pyobject(py).map(Bound::into_any)
    }

    #[staticmethod]
    fn _resumed(
        py: Python<'_>,
        scenario: &Scenario,
        natural_curvature: bool,
        state: &State,
    ) -> PyResult<Self> {
        let mut simulation = Self::new(scenario, natural_curvature)?;
        simulation.restore(py, state)?;
        Ok(simulation)
    }

    fn __repr__(&self) -> String {
        format!(
            "<rodlab.Simulation of {:?}: {} rods, {} nodes, at {} s>",
            self.stepper.prepared.name,
            self.stepper.prepared.scene.rods.len(),
            self.stepper.nodes(),
            self.time()
        )
    }
}

fn or_zeros(forces: Vec<Vector3>, nodes: usize) -> Vec<Vector3> {
    match forces.is_empty() {
        true => vec![Vector3::zeros(); nodes],
        false => forces,
    }
}

fn word(kind: PointKind) -> &'static str {
    match kind {
        PointKind::Regular => "regular",
        PointKind::Fold => "fold",
        PointKind::Bifurcation => "bifurcation",
        PointKind::Flutter => "flutter",
    }
}
