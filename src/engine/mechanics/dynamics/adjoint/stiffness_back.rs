//! Pull-back of derivatives with respect to the contact stiffness of a step that adapted it to
//! forces at the prediction.
//!
//! The stiffness is a function of the force on one node at the prediction, so it is pulled back
//! like the residual: along the virtual motion of that node. Energies may bound it, and a contact
//! may shorten the prediction; the amount of shortening depends on few nodes and is differentiated
//! by differences.

use super::SensitivityError;
use super::covector::{Covector, VirtualMotion};
use super::differences::Functions;
use super::point::Point;
use crate::mechanics::contact::Adaption;
use crate::mechanics::dynamics::sensitivity::Replayed;
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::dynamics::stage::PREDICTED_PART;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::{add_to_node, position};
use crate::mechanics::system::{StiffnessCourse, StrainLaws};

/// Step of a position, relative to the length of an edge, for the free fraction of a prediction.
const RELATIVE_STEP: f64 = 1e-6;

/// The contact stiffness of a step that adapted it to the forces at its prediction, through which
/// derivatives are pulled back.
pub(super) struct StiffnessBack {
    point: Point,
    course: StiffnessCourse,
    shortening: Option<Shortening>,
}

/// A prediction shortened by a contact: from the start q to q + c (p − q), with the fraction c of
/// the path to the prediction p.
struct Shortening {
    part: f64,
    /// p − q.
    way: Vec<f64>,
    /// Derivatives of c with respect to q and p.
    over: [Vec<f64>; 2],
}

impl StiffnessBack {
    /// Creates the pull-back for the step that a simulation has repeated.
    ///
    /// # Errors
    /// [`SensitivityError::NotRepeated`] if the stiffness was not set by these forces.
    pub(super) fn new(
        simulation: &mut Simulation,
        replayed: &Replayed,
    ) -> Result<Self, SensitivityError> {
        let may_bound = !simulation.rules().extrapolates();
        let Simulation {
            system,
            state,
            integrator,
            ..
        } = simulation;
        let workspace = &mut integrator.workspace;
        let ((course, at, stage), part) =
            workspace.at_prediction(&integrator.setting, system, state, |system, at, stage| {
                let course = system.stiffness_course(at, stage, replayed.adaption, may_bound);
                (course, at.to_vec(), stage.clone())
            });
        let course = course.ok_or(SensitivityError::NotRepeated {
            time: replayed.goal,
            reason: "the contact stiffness was adapted to other forces than those of the prediction",
        })?;
        Ok(Self {
            point: Point::new(simulation, (replayed.step, &at), &stage, Vec::new()),
            shortening: (part < 1.0).then(|| Shortening::new(simulation, part)),
            course,
        })
    }

    /// Converts the derivative with respect to the adapted stiffness to one with respect to the
    /// start of the step; returns λ.
    pub(super) fn pull_back(
        &mut self,
        covector: &mut Covector,
        simulation: &mut Simulation,
    ) -> VirtualMotion {
        let system = &simulation.system;
        let zero = vec![0.0; system.residual.len()];
        let mut over_wanted = std::mem::take(&mut covector.stiffness);
        let mut over_prediction = zero.clone();
        if let Some(bound) = &self.course.bound {
            let over_bounded = over_wanted;
            let [before, wanted] = bound.stiffness;
            covector.stiffness = before * over_bounded;
            over_wanted *= wanted;
            let weights = &self.point.weights.velocity;
            covector.add_history(over_bounded, [weights], [&bound.velocity]);
            let now = covector.unknowns[0].iter_mut().zip(&bound.start);
            now.for_each(|(sum, start)| *sum += over_bounded * start);
            let prediction = over_prediction.iter_mut().zip(&bound.prediction);
            prediction.for_each(|(sum, own)| *sum += over_bounded * own);
        }
        let spins = (0..covector.spins.len()).map(|node| over_prediction[STRIDE * node + 3]);
        let spins: Vec<f64> = spins.collect();
        let mut motion = zero;
        match self.course.adaption {
            _ if self.course.without_inertia.is_some() => {}
            Adaption::OfForce { node, factor } => {
                let force = position(&system.residual, node).normalize();
                for axis in 0..3 {
                    motion[STRIDE * node + axis] = -over_wanted * factor * force[axis];
                }
            }
            Adaption::Falls(part) => covector.stiffness += part * over_wanted,
            Adaption::Least => {}
        }
        if let Some(force) = &self.course.without_inertia {
            let slope = force.slope * over_wanted;
            add_to_node(&mut motion, force.node, &-slope);
            let [per_velocity, per_position] = force.inertia;
            add_to_node(&mut over_prediction, force.node, &(slope * -per_position));
            let [mut start, mut velocity] = [vec![0.0; motion.len()], vec![0.0; motion.len()]];
            add_to_node(&mut start, force.node, &(slope * per_position));
            add_to_node(&mut velocity, force.node, &(slope * per_velocity));
            let weights = &self.point.weights;
            covector.add_history(
                1.0,
                [&weights.start, &weights.velocity],
                [&start, &velocity],
            );
        }
        system.spread_points(&mut motion);
        let mut force = self.course.jacobian.multiply(&motion);
        system.gather_product(&motion, &mut force);
        // The prediction moves only the unknowns that clamps do not hold.
        let entries = over_prediction.iter_mut().zip(&force);
        for ((entry, force), held) in entries.zip(&system.assembly.held) {
            *entry = if *held { 0.0 } else { *entry - force };
        }
        if let Some(shortening) = &self.shortening {
            shortening.pull_back(covector, &mut over_prediction);
        }
        let weights = &self.point.weights.prediction;
        covector.add_history(1.0, [weights], [&over_prediction]);
        let along = [&motion[..], &force];
        self.point.pull_back(covector, simulation, along, &spins)
    }

    /// Laws of the strains at the prediction.
    pub(super) fn laws(&self) -> &StrainLaws {
        &self.point.laws
    }
}

impl Shortening {
    /// Creates the derivative for a simulation with such a prediction, of which this fraction
    /// remains.
    fn new(simulation: &mut Simulation, part: f64) -> Self {
        let start = simulation.state.unknowns.clone();
        let prediction = simulation.integrator.workspace.trial.unknowns.clone();
        let way = (start.iter().zip(&prediction)).map(|(start, end)| end - start);
        let way = way.collect();
        let system = &mut simulation.system;
        let unknowns = start.len();
        let mut over = [vec![0.0; unknowns], vec![0.0; unknowns]];
        // A zero fraction does not depend on q and p.
        if part > 0.0 {
            let edges = system.assembly.rods.edges.iter();
            let lengths = edges.map(|edge| edge.natural_length);
            let change = RELATIVE_STEP * lengths.fold(f64::INFINITY, f64::min);
            let held = system.assembly.held.clone();
            let step = |number: usize| match number % unknowns {
                own if held[own] || own % STRIDE == 3 => 0.0,
                _ => change,
            };
            let mut values = |at: &[f64]| {
                let (start, end) = at.split_at(unknowns);
                vec![PREDICTED_PART * system.largest_step(start, end)]
            };
            let at = [&start[..], &prediction].concat();
            let mut functions = Functions {
                here: values(&at),
                at,
                values: &mut values,
                step: &step,
            };
            let mut store = |_: usize, number: usize, derivative: f64| {
                over[number / unknowns][number % unknowns] = derivative;
            };
            functions.differentiate(0..2 * unknowns, &mut store);
        }
        Self { part, way, over }
    }

    /// Converts a derivative with respect to the shortened prediction to one with respect to the
    /// full prediction, and adds the derivative with respect to the start.
    fn pull_back(&self, covector: &mut Covector, over_prediction: &mut [f64]) {
        let products = over_prediction.iter().zip(&self.way);
        let over_part: f64 = products.map(|(over, way)| over * way).sum();
        let now = covector.unknowns[0].iter_mut().zip(over_prediction);
        for (k, (start, own)) in now.enumerate() {
            *start += (1.0 - self.part) * *own + over_part * self.over[0][k];
            *own = self.part * *own + over_part * self.over[1][k];
        }
    }
}
