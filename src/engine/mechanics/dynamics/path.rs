//! Equilibria along a path.

use super::Simulation;
use super::failure::no_next_point;
use super::report::SimulationError;
use crate::mechanics::SceneError;
use crate::mechanics::statics::{PathPlan, PathPoint, Tracer};
use crate::mechanics::system::{Demand, MOST_UNKNOWNS};

const TOO_MANY: SceneError = SceneError::Unsuitable(
    "the stability of a path under moments and forces that turn with rods is computed for at most 1500 nodes: use fewer edges",
);

impl Simulation {
    /// Creates a tracer for the path of equilibria that begins at the present configuration. The
    /// path parameter replaces time in what the scene prescribes.
    ///
    /// # Errors
    /// [`SimulationError::BadScene`] with friction, with rigid contact, and if forces have no
    /// energy and there are too many unknowns for small motions.
    pub fn path(&self, plan: PathPlan) -> Result<Tracer, SimulationError> {
        self.system.admit(Demand::Path)?;
        if !self.system.is_symmetric() && self.state.unknowns.len() > MOST_UNKNOWNS {
            return Err(TOO_MANY.into());
        }
        let tolerance = self.integrator.setting.parameters.force_tolerance;
        Ok(Tracer::new(
            &self.system,
            &self.state.unknowns,
            plan,
            tolerance,
        ))
    }

    /// Moves to the next point of a path; returns `None` after the last. The time of the
    /// simulation is then the path parameter.
    ///
    /// # Errors
    /// [`SimulationError::NoEquilibrium`] where the path cannot be followed.
    pub fn next_point(
        &mut self,
        tracer: &mut Tracer,
    ) -> Result<Option<PathPoint>, SimulationError> {
        let point = tracer.next(&mut self.system).map_err(|divergence| {
            no_next_point(&mut self.system, &self.state.unknowns, &divergence)
        })?;
        if let Some(point) = &point {
            self.state.time = point.parameter;
            self.state.rest_at(&point.unknowns);
            self.system
                .resume(point.parameter, &point.unknowns, &point.reference);
            self.system.drive(self.state.time, &mut self.state.unknowns);
            self.system.evaluate(&self.state.unknowns, None);
            self.publish();
            let unknowns = &self.state.unknowns;
            self.validity
                .check_strains(&self.system, unknowns, self.state.time);
        }
        Ok(point)
    }
}
