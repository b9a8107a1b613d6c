//! Pull-back of derivatives from the end of a step to its start.

use super::SensitivityError;
use super::covector::{Covector, VirtualMotion, solve};
use super::extrapolation::Extrapolation;
use super::point::{Point, add_to_edge};
use crate::mechanics::dynamics::sensitivity::Replayed;
use crate::mechanics::dynamics::simulation::Simulation;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::{OfStrains, StrainLaws};

/// A repeated step, through which derivatives are pulled back.
pub(super) struct StepBack {
    /// The solution of its stage.
    point: Point,
    solution: Vec<f64>,
    /// End of the step, if this is not the solution.
    extrapolation: Option<Extrapolation>,
    /// Derivative of the contact stiffness with respect to the stiffness from which it was
    /// adapted.
    stiffening: f64,
}

impl StepBack {
    /// Creates the pull-back for the step to `end` that a simulation has repeated.
    pub(super) fn new(simulation: &Simulation, replayed: &Replayed, end: &[f64]) -> Self {
        let stage = &simulation.integrator.workspace.stage;
        let solution = &replayed.solution;
        let contacts = simulation.system.contacts_from_start(solution, stage);
        let extrapolates = simulation.rules().extrapolates();
        Self {
            point: Point::new(simulation, (replayed.step, solution), stage, contacts),
            solution: solution.clone(),
            extrapolation: extrapolates.then(|| Extrapolation::new(simulation, replayed.step, end)),
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
        let (over, of_strains, spins) = match &self.extrapolation {
            Some(extrapolation) => extrapolation.pull_back(covector, simulation),
            None => self.over_solution(covector, simulation),
        };
        let system = &mut simulation.system;
        let force = system.gather_over(&self.solution, &over, of_strains);
        let motion = solve(simulation, &self.solution, force.clone())?;
        let system = &simulation.system;
        let stiffness = covector.stiffness + system.work_over_contact_stiffness(&motion);
        covector.stiffness = self.stiffening * stiffness;
        let along = [&motion[..], &force];
        Ok((self.point).pull_back(covector, simulation, along, &spins))
    }

    /// Derivatives with respect to the solution, which is the end of the step, forces of the
    /// moments on its strains, and derivatives with respect to the spins of the frames there. The
    /// covector is then that at the start of the step, without the part of λ.
    fn over_solution(
        &self,
        covector: &mut Covector,
        simulation: &Simulation,
    ) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let (system, step) = (
            &simulation.system,
            simulation.integrator.workspace.stage.step,
        );
        // The end of the step affects itself, the velocity there, dashpots, and the transport of
        // frames.
        let mut over = covector.unknowns[0].clone();
        for (over, velocity) in over.iter_mut().zip(&covector.velocities[0]) {
            *over += velocity / step;
        }
        for edge in &system.assembly.rods.edges {
            let holonomy = system.geometry.edges[edge.start].holonomy;
            add_to_edge(&mut over, edge, &(holonomy * covector.spins[edge.start]));
        }
        let gained = self.laws().relaxation.as_ref().map(|laws| {
            let gained = OfStrains::product(&laws.gained, &covector.relaxing);
            covector.relaxing = OfStrains::product(&laws.kept, &covector.relaxing);
            covector.strains[0].add(1.0, &gained);
            gained
        });
        let of_strains = system.forces_of_moments(&covector.strains[0]);
        let over_start = covector.velocities[0]
            .iter()
            .map(|velocity| -velocity / step);
        let over_start: Vec<f64> = over_start.collect();
        covector.begin_start();
        covector.add_history(1.0, [&self.point.weights.start], [&over_start]);
        if let Some(gained) = gained {
            covector.strains[0].add(-1.0, &gained);
        }
        let spins = covector.spins.iter_mut().enumerate();
        let spins = spins
            .map(|(node, spin)| std::mem::take(spin) + of_strains[STRIDE * node + 3])
            .collect();
        (over, of_strains, spins)
    }
}
