//! Pull-back of derivatives from the end of a step to its start.

use super::SensitivityError;
use super::covector::{Covector, VirtualMotion, add, solve};
use super::point::{Point, add_to_edge};
use crate::mechanics::dynamics::sensitivity::Replayed;
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::system::StrainLaws;

/// A repeated step, through which derivatives are pulled back.
pub(super) struct StepBack {
    /// Its solution.
    point: Point,
    /// Derivative of the contact stiffness with respect to the stiffness from which it was
    /// adapted.
    stiffening: f64,
}

impl StepBack {
    /// Creates the pull-back for the step that a simulation has repeated.
    pub(super) fn new(simulation: &Simulation, replayed: &Replayed) -> Self {
        let stage = &simulation.integrator.workspace.stage;
        let solution = &replayed.solution;
        let dampers = simulation.system.dampers(solution, stage);
        Self {
            point: Point::new(simulation, (replayed.step, solution), stage, dampers),
            stiffening: replayed.stiffening,
        }
    }

    /// Laws of the strains at the end of the step.
    pub(super) fn laws(&self) -> &StrainLaws {
        &self.point.laws
    }

    /// Converts the derivative with respect to the end of the step to one with respect to its
    /// start; returns λ.
    ///
    /// # Errors
    /// [`SensitivityError::Singular`].
    pub(super) fn pull_back(
        &mut self,
        covector: &mut Covector,
        simulation: &mut Simulation,
    ) -> Result<VirtualMotion, SensitivityError> {
        let step = simulation.integrator.workspace.stage.step;
        // The end of the step affects itself, the velocity there, dashpots, and the transport of
        // frames.
        let of_strains = simulation.system.forces_of_moments(&covector.strains[0]);
        let mut force = covector.unknowns[0].clone();
        add(&mut force, &of_strains);
        for (force, velocity) in force.iter_mut().zip(&covector.velocities[0]) {
            *force += velocity / step;
        }
        let system = &simulation.system;
        for edge in &system.assembly.rods.edges {
            let holonomy = system.geometry.edges[edge.start].holonomy;
            add_to_edge(&mut force, edge, &(holonomy * covector.spins[edge.start]));
        }
        let motion = solve(simulation, force.clone())?;
        let system = &simulation.system;
        let stiffness = covector.stiffness + system.work_over_contact_stiffness(&motion);
        let spins = covector.begin_start(&of_strains, step, &self.point.weights);
        covector.stiffness = self.stiffening * stiffness;
        let along = [&motion[..], &force];
        Ok((self.point).pull_back(covector, simulation, along, &spins))
    }
}
