//! The drag of a fluid in a step: evaluated at the start or for the predicted motion. Its local
//! part is implicit or, if this is not enough, the whole of it ([`super::coupling`]).

use super::background::Background;
use super::coupling::DragCoupling;
use super::flow_scene::{NodeNames, fluid_of, spins_flow};
use super::scheme::TimeScheme;
use super::state::State;
use crate::mechanics::fluid::{Fluid, FluidError, FluidMemory, Sphere};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::{add_to_node, position};
use crate::mechanics::scene::Scene;
use crate::mechanics::system::{Assembly, Stage, copy_positions};
use crate::mechanics::{Matrix3, SceneError, Vector3};
use std::ops::Range;
use tracing::trace;

/// Safety factor on the estimate of the largest ratio of the resistance to its local part, since
/// rods move on after the estimate.
const RATIO_MARGIN: f64 = 1.2;

/// Power of the drag that an error of the flow solver may cause when the true power is zero,
/// relative to the power of the local resistance.
const ROUNDING: f64 = 1e-4;

/// The fluid of a scene, if it has one, and its forces.
pub(super) struct FluidDrag {
    fluid: Option<Fluid>,
    /// The flow without rods, if the fluid is not at rest.
    background: Option<Background>,
    names: NodeNames,
    /// Force on each node in the last accepted step, N; empty without fluid.
    forces: Vec<Vector3>,
    positions: Vec<Vector3>,
    velocities: Vec<Vector3>,
    /// Spins of the edges that start at the nodes, rad/s; empty where their flow is ignored.
    spins: Vec<f64>,
    /// Drag for the velocities in `velocities`, N; scratch.
    found: Vec<Vector3>,
    /// Least inertia of each node over its directions of motion, kg; infinite if it is held or out
    /// of the fluid.
    inertia: Vec<f64>,
    /// Nodes of the rods in the fluid.
    rods: Vec<Range<usize>>,
    /// Number of nodes; entries for the rotation of spheres follow those of the nodes.
    nodes: usize,
    coupling: DragCoupling,
    /// Whether the drag of this step is found within it.
    is_coupled: bool,
}

impl FluidDrag {
    /// # Errors
    /// [`SceneError::Fluid`] if the fluid or a rod in it is outside the range of the theory.
    pub(crate) fn new(scene: &Scene, assembly: &Assembly) -> Result<Self, SceneError> {
        let fluid = fluid_of(scene, assembly)?;
        let spheres = assembly.spheres();
        let wet = match (&fluid, spheres.is_empty()) {
            (None, _) => 0,
            (Some(_), true) => assembly.rods.nodes,
            (Some(_), false) => assembly.all_places().end,
        };
        let mut rods: Vec<_> = (assembly.rods.rods.iter().zip(&scene.rods))
            .filter(|(_, rod)| !rod.held)
            .map(|(range, _)| range.first_node..range.first_node + range.nodes)
            .collect();
        let mut inertia = vec![f64::INFINITY; wet];
        if wet > 0 {
            let least = assembly.least_inertia();
            for node in rods.iter().flat_map(Clone::clone) {
                if !assembly.held[STRIDE * node] {
                    inertia[node] = least[node];
                }
            }
            for tip in spheres.iter().flat_map(Sphere::tips) {
                inertia[tip] = assembly.masses[STRIDE * tip];
            }
            rods.extend(
                spheres
                    .iter()
                    .map(|sphere| sphere.first_tip..sphere.first_tip + 3),
            );
        }
        Ok(Self {
            background: Background::new(scene, assembly, wet).filter(|_| fluid.is_some()),
            fluid,
            rods,
            nodes: assembly.rods.nodes,
            inertia,
            coupling: DragCoupling::default(),
            is_coupled: false,
            found: vec![Vector3::zeros(); wet],
            names: NodeNames::new(scene, assembly),
            forces: vec![Vector3::zeros(); wet],
            positions: vec![Vector3::zeros(); wet],
            velocities: vec![Vector3::zeros(); wet],
            spins: if spins_flow(scene) {
                vec![0.0; assembly.rods.nodes]
            } else {
                Vec::new()
            },
        })
    }

    /// Number of entries on which the fluid acts: nodes, then rotating spheres.
    pub(crate) fn places(&self) -> usize {
        self.forces.len()
    }

    /// Force on each node in the last accepted step, N.
    pub(crate) fn forces(&self) -> &[Vector3] {
        &self.forces[..self.nodes.min(self.forces.len())]
    }

    /// Writes drag and local resistance at the start of a step to `stage`, in the background flow
    /// of a time, s; returns the Krylov iterations. A repeated step solves for them again, which
    /// takes no iterations.
    ///
    /// # Errors
    /// [`FluidError`] if the drag could not be computed.
    pub(crate) fn of_start(
        &mut self,
        stage: &mut Stage,
        state: &State,
        time: f64,
    ) -> Result<usize, FluidError> {
        copy_positions(&state.unknowns, &mut self.positions);
        copy_positions(&state.velocity, &mut self.velocities);
        for (node, spin) in self.spins.iter_mut().enumerate() {
            *spin = state.velocity[STRIDE * node + 3];
        }
        self.evaluate(stage, time)
    }

    /// Writes drag and local resistance for the motion from the start of `stage` to the predicted
    /// unknowns, in the background flow of a time, s; returns the Krylov iterations.
    ///
    /// # Errors
    /// [`FluidError`] if the drag could not be computed.
    pub(crate) fn of_prediction(
        &mut self,
        stage: &mut Stage,
        predicted: &[f64],
        time: f64,
    ) -> Result<usize, FluidError> {
        let per_step = 1.0 / stage.step;
        for node in 0..self.positions.len() {
            let end = position(predicted, node);
            self.velocities[node] = (end - position(&stage.start, node)) * per_step;
            self.positions[node] = end;
        }
        self.take_spins(stage, predicted);
        self.evaluate(stage, time)
    }

    /// Velocities relative to the background flow in the motion from the start of a stage to
    /// `unknowns`, m/s, of the entries on which the fluid acts.
    pub(crate) fn velocities_in(&self, stage: &Stage, unknowns: &[f64]) -> Vec<Vector3> {
        let velocity =
            |node: usize| (position(unknowns, node) - position(&stage.start, node)) / stage.step;
        let mut velocities: Vec<Vector3> = (0..self.places()).map(velocity).collect();
        if let Some(background) = &self.background {
            background.subtract(&mut velocities);
        }
        velocities
    }

    /// Derivatives of λ·R, for the drag of entries with these relative velocities in a virtual motion
    /// λ, with respect to the unknowns for which the local `resistance` D was last computed; `None`
    /// without a fluid. The drag is that of D alone, D v: resistive force theory.
    pub(crate) fn over_places(
        &mut self,
        velocities: &[Vector3],
        resistance: &[Matrix3],
        motion: &[f64],
    ) -> Option<Vec<f64>> {
        let fluid = self.fluid.as_mut()?;
        let places = 0..self.positions.len();
        let motions: Vec<Vector3> = places.map(|node| position(motion, node)).collect();
        let mut gradient = vec![Vector3::zeros(); motions.len()];
        fluid
            .add_power_gradient(&self.positions, [velocities, &motions], &mut gradient)
            .expect("the fluid has a drag at these positions");
        if let Some(background) = &self.background {
            let turns = |node: usize| motion[STRIDE * node + 3];
            let motion = (&motions[..], turns);
            background.add_power_gradient(&self.positions, resistance, motion, &mut gradient);
        }
        let mut over = vec![0.0; motion.len()];
        for (node, gradient) in gradient.iter().enumerate() {
            add_to_node(&mut over, node, gradient);
        }
        Some(over)
    }

    /// Computes the mean spins of the motion from the start of `stage` to `unknowns`.
    fn take_spins(&mut self, stage: &Stage, unknowns: &[f64]) {
        for (node, spin) in self.spins.iter_mut().enumerate() {
            let angle = STRIDE * node + 3;
            *spin = (unknowns[angle] - stage.start[angle]) / stage.step;
        }
    }

    fn evaluate(&mut self, stage: &mut Stage, time: f64) -> Result<usize, FluidError> {
        let Some(fluid) = &mut self.fluid else {
            return Ok(0);
        };
        stage.drag_velocity.copy_from_slice(&self.velocities);
        let relative = match &mut self.background {
            None => &self.velocities[..],
            Some(background) => {
                background.sample(&self.positions, time);
                background.subtract_spins(&mut self.spins);
                background.write_torques(&mut stage.flow_torque);
                background.relative(&self.velocities)
            }
        };
        let (drag, resistance) = (&mut stage.drag, &mut stage.resistance);
        let report = fluid
            .drag(&self.positions, relative, &self.spins, drag, resistance)
            .map_err(|error| self.names.explain(error, fluid, &self.positions))?;
        Ok(report.iterations)
    }

    /// Solves for the drag to a smaller relative residual from now on; returns whether the fluid
    /// can be solved that accurately.
    pub(crate) fn sharpen(&mut self, tolerance: f64) -> bool {
        (self.fluid.as_mut()).is_none_or(|fluid| fluid.sharpen(tolerance))
    }

    /// Prepares a step whose first drag is in `stage`: enlarges the local resistance as far as the
    /// scheme needs it to leave the rest of the drag to the next step. If that does not suffice, the
    /// step [must be coupled](Self::must_be_coupled).
    pub(crate) fn choose_local_part(&mut self, stage: &mut Stage, scheme: &dyn TimeScheme) {
        self.is_coupled = false;
        let Some(coupling) = self.fluid.as_ref().and_then(Fluid::coupling) else {
            return;
        };
        let nodes = stage.resistance.iter().zip(&self.inertia);
        let least = nodes.fold(f64::INFINITY, |least, (local, inertia)| {
            let resistance = local.m11.max(local.m22).max(local.m33);
            least.min(inertia / (stage.acceleration_step * resistance))
        });
        let ratio = coupling.largest_ratio * RATIO_MARGIN;
        let factor = scheme.lagged_factor(ratio, least);
        trace!(
            ratio,
            inertia = least,
            ?factor,
            "resistance over its local part"
        );
        self.is_coupled = factor.is_none();
        if let Some(factor) = factor.filter(|factor| *factor > 1.0) {
            stage
                .resistance
                .iter_mut()
                .for_each(|local| *local *= factor);
        }
    }

    /// Whether the drag that the local resistance omits must be found within the step, because the
    /// scheme would ring, or might if inertia were smaller compared with the drag.
    pub(crate) fn must_be_coupled(&self) -> bool {
        self.is_coupled
    }

    /// Begins the search for the drag within a step.
    pub(crate) fn begin_coupling(&mut self, stage: &Stage) {
        let inertia = &self.inertia;
        self.coupling
            .begin(stage, |node| inertia[node].is_infinite());
    }

    /// Gives `stage` the drag of its motion to `unknowns`; returns whether it agrees with the drag
    /// with which these were found, and the Krylov iterations.
    ///
    /// # Errors
    /// [`FluidError`] if the drag could not be computed.
    pub(crate) fn couple(
        &mut self,
        stage: &mut Stage,
        unknowns: &[f64],
    ) -> Result<(bool, usize), FluidError> {
        self.take_spins(stage, unknowns);
        if let Some(background) = &self.background {
            background.subtract_spins(&mut self.spins);
        }
        let coupled = self.fluid.as_mut().and_then(|fluid| {
            let flow = fluid.coupling()?;
            Some((fluid, flow))
        });
        let Some((fluid, flow)) = coupled else {
            return Ok((true, 0));
        };
        let per_step = 1.0 / stage.step;
        for (node, velocity) in self.velocities.iter_mut().enumerate() {
            *velocity = (position(unknowns, node) - position(&stage.start, node)) * per_step;
        }
        let relative = match &mut self.background {
            None => &self.velocities[..],
            Some(background) => background.relative(&self.velocities),
        };
        let report = fluid.drag_of(relative, &self.spins, &stage.resistance, &mut self.found)?;
        let rods = self.rods.iter().cloned();
        let agrees = self.coupling.record(
            stage,
            [&self.velocities, relative],
            &self.found,
            rods,
            &flow,
        );
        Ok((agrees, report.iterations))
    }

    /// Energy that the drag of a coupled step adds, J; `None` if the drag takes energy, as it does
    /// for every motion relative to the fluid. Where rods overlap, segments may cause greater
    /// velocities at each other's nodes than at their own. The resistance is then negative for a
    /// separating motion, and the nodes jump.
    pub(crate) fn work_of_coupled(&self, stage: &Stage) -> Option<f64> {
        let power = -self.fluid.as_ref().and_then(Fluid::dissipation)?;
        let against = |(velocity, local): (&Vector3, &Matrix3)| velocity.dot(&(local * velocity));
        let relative = match &self.background {
            None => &stage.drag_velocity[..],
            Some(background) => background.last_relative(),
        };
        let scale: f64 = (relative.iter().zip(&stage.resistance)).map(against).sum();
        (power > ROUNDING * scale).then_some(power * stage.step)
    }

    /// Whether the remainder of the last solution of a coupled step is hardly smaller than the
    /// previous one.
    pub(crate) fn has_stalled(&self) -> bool {
        self.coupling.has_stalled()
    }

    /// Gives `stage` the best drag found so far; `false` once the solutions allowed for a step are
    /// exhausted.
    pub(crate) fn expect_coupled(&mut self, stage: &mut Stage) -> bool {
        if self.coupling.is_exhausted() {
            return false;
        }
        self.coupling.expect(stage);
        true
    }

    /// Stores the forces of an accepted step that ends with a velocity.
    pub(crate) fn accept(&mut self, stage: &Stage, velocity: &[f64]) {
        for (node, force) in self.forces.iter_mut().enumerate() {
            let change = position(velocity, node) - stage.drag_velocity[node];
            *force = stage.drag[node] - stage.resistance[node] * change;
        }
    }

    /// Data for a restart; `None` without fluid.
    pub(crate) fn memory(&self) -> Option<FluidMemory> {
        self.fluid.as_ref().map(Fluid::memory)
    }

    /// Continues from a restart.
    ///
    /// # Errors
    /// A description of the mismatch between the data and the scene.
    pub(crate) fn restore(&mut self, memory: Option<FluidMemory>) -> Result<(), String> {
        match (&mut self.fluid, memory) {
            (Some(fluid), Some(memory)) => fluid.restore(memory).map_err(|e| e.to_string()),
            (None, None) => Ok(()),
            _ => Err("fluid".into()),
        }
    }
}
