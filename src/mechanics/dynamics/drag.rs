//! The drag of a fluid in a step: evaluated once, at the start or for the predicted motion, and implicit in the local part.

use crate::mechanics::fluid::{Filament, Fluid, FluidError, FluidMemory};
use crate::mechanics::rod::topology::position;
use crate::mechanics::scene::Scene;
use crate::mechanics::system::{Assembly, Stage, copy_positions};
use crate::mechanics::{SceneError, Vector3};

/// The fluid of a scene, if it has one, and its forces.
pub(super) struct FluidDrag {
    fluid: Option<Fluid>,
    /// Force on each node in the last accepted step, N; empty without fluid.
    forces: Vec<Vector3>,
    positions: Vec<Vector3>,
    velocities: Vec<Vector3>,
}

impl FluidDrag {
    /// # Errors
    /// [`SceneError::Fluid`] where the fluid or a rod in it is beyond the theory.
    pub fn new(scene: &Scene, assembly: &Assembly) -> Result<Self, SceneError> {
        let filaments: Vec<Filament> = (assembly.rods.rods.iter().zip(&scene.rods))
            .filter(|(_, rod)| !rod.held)
            .map(|(range, rod)| Filament {
                first_node: range.first_node,
                nodes: range.nodes,
                closed: range.closed,
                radius: rod.radius,
            })
            .collect();
        let fluid = scene.fluid.map(|model| Fluid::new(&model, &filaments));
        let fluid = fluid.transpose()?;
        let wet = if fluid.is_some() {
            assembly.rods.nodes
        } else {
            0
        };
        Ok(Self {
            fluid,
            forces: vec![Vector3::zeros(); wet],
            positions: vec![Vector3::zeros(); wet],
            velocities: vec![Vector3::zeros(); wet],
        })
    }

    /// Nodes that feel the fluid.
    pub fn nodes(&self) -> usize {
        self.forces.len()
    }

    /// Force on each node in the last accepted step, N.
    pub fn forces(&self) -> &[Vector3] {
        &self.forces
    }

    /// Writes drag and local resistance at the start of a step to `stage`; returns the Krylov iterations.
    ///
    /// # Errors
    /// [`FluidError`] where the fluid has no answer.
    pub fn of_start(
        &mut self,
        stage: &mut Stage,
        unknowns: &[f64],
        velocity: &[f64],
    ) -> Result<usize, FluidError> {
        copy_positions(unknowns, &mut self.positions);
        copy_positions(velocity, &mut self.velocities);
        self.evaluate(stage)
    }

    /// The same for the motion from the start of `stage` to the predicted unknowns.
    ///
    /// # Errors
    /// [`FluidError`] where the fluid has no answer.
    pub fn of_prediction(
        &mut self,
        stage: &mut Stage,
        predicted: &[f64],
    ) -> Result<usize, FluidError> {
        let per_step = 1.0 / stage.step;
        for node in 0..self.positions.len() {
            let end = position(predicted, node);
            self.velocities[node] = (end - stage.positions[node]) * per_step;
            self.positions[node] = end;
        }
        self.evaluate(stage)
    }

    fn evaluate(&mut self, stage: &mut Stage) -> Result<usize, FluidError> {
        let Some(fluid) = &mut self.fluid else {
            return Ok(0);
        };
        stage.drag_velocity.copy_from_slice(&self.velocities);
        let (drag, resistance) = (&mut stage.drag, &mut stage.resistance);
        let report = fluid.drag(&self.positions, &self.velocities, drag, resistance)?;
        Ok(report.iterations)
    }

    /// Takes over the forces of an accepted step that ends with a velocity.
    pub fn accept(&mut self, stage: &Stage, velocity: &[f64]) {
        for (node, force) in self.forces.iter_mut().enumerate() {
            let change = position(velocity, node) - stage.drag_velocity[node];
            *force = stage.drag[node] - stage.resistance[node] * change;
        }
    }

    /// What a restart needs; `None` without fluid.
    pub fn memory(&self) -> Option<FluidMemory> {
        self.fluid.as_ref().map(Fluid::memory)
    }

    /// Continues from a restart.
    ///
    /// # Errors
    /// What does not fit, in words.
    pub fn restore(&mut self, memory: Option<FluidMemory>) -> Result<(), String> {
        match (&mut self.fluid, memory) {
            (Some(fluid), Some(memory)) => fluid.restore(memory).map_err(|e| e.to_string()),
            (None, None) => Ok(()),
            _ => Err("fluid".into()),
        }
    }
}
