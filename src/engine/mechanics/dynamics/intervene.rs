//! Interventions in a simulation between its steps. All are part of the state in checkpoints.

use super::Simulation;
use super::report::SimulationError;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::scene::Motion;
use crate::mechanics::system::Grasp;
use crate::mechanics::{SceneError, UnitQuaternion, Vector3};

impl Simulation {
    /// Sets forces of another solver, for coupling step by step. They act in addition to the loads
    /// of the scene from the next step on. `forces` act on the nodes, N; `moments` about the
    /// tangent of the edge that starts at each node, N m.
    pub fn set_external_forces(&mut self, forces: &[Vector3], moments: &[f64]) {
        self.validity.stop_counting_energy();
        let entries = self.system.terms.loads.external_mut();
        let entries = entries.chunks_exact_mut(STRIDE);
        for (entry, (force, moment)) in entries.zip(forces.iter().zip(moments)) {
            entry.copy_from_slice(&[force.x, force.y, force.z, *moment]);
        }
    }

    /// Multiplies a load of the scene, counted from 0, by a factor in addition to its schedule, from the next step on.
    ///
    /// # Errors
    /// [`SimulationError::BadScene`] if the load does not exist.
    pub fn set_load_factor(&mut self, load: usize, factor: f64) -> Result<(), SimulationError> {
        self.validity.stop_counting_energy();
        let set = self.system.set_load_factor(load, factor);
        set.ok_or_else(|| refused(format!("load {load} does not exist")))
    }

    /// Sets the values of an actuation of the scene, counted from 0, whose course is [`Course::Given`], from the next step
    /// or equilibrium on.
    ///
    /// # Errors
    /// [`SimulationError::BadScene`] if it does not exist, has another course, or another number of values.
    ///
    /// [`Course::Given`]: crate::mechanics::scene::Course::Given
    pub fn set_actuation(
        &mut self,
        actuation: usize,
        values: &[f64],
    ) -> Result<(), SimulationError> {
        self.validity.stop_counting_energy();
        let set = self.system.give_actuation(actuation, values);
        set.map_err(refused)
    }

    /// Replaces the motion of a clamp from the next step or equilibrium on, for ends moved by a
    /// robot or by continuation. Clamps of the scene are counted from 0; those made by
    /// [`Self::grasp`] follow.
    pub fn move_clamp(&mut self, clamp: usize, motion: Motion) {
        self.validity.stop_counting_energy();
        self.system.move_clamp(clamp, motion);
    }

    /// Moves a clamp from its present pose at constant speed to another one. The clamp reaches it
    /// at the time `until`, s, and keeps it; if this is the present time, it moves at once, as
    /// before a search for an equilibrium. `position` in m. `frame` rotates the axes to both
    /// material directors and the tangent; `None` keeps the present frame. Components that the
    /// clamp does not hold are ignored.
    ///
    /// # Errors
    /// [`SimulationError::BadScene`] if the clamp does not exist or was released, or if `until` has passed.
    pub fn carry_clamp(
        &mut self,
        clamp: usize,
        position: Vector3,
        frame: Option<UnitQuaternion>,
        until: f64,
    ) -> Result<(), SimulationError> {
        let now = self.state.time;
        let drives = &self.system.assembly.drives;
        let Some(drive) = drives.get(clamp).filter(|drive| !drive.released) else {
            return Err(refused(format!("clamp {clamp} does not exist")));
        };
        if !(until >= now) {
            return Err(refused(format!(
                "clamp {clamp} cannot move until {until} s: the time is already {now} s"
            )));
        }
        let start = self.published.positions[drive.node];
        let motion = drive.way_to(position, frame, start, [now, until]);
        self.move_clamp(clamp, motion);
        Ok(())
    }

    /// Grasps a node, counted over the whole scene, at its present position. Returns the number of
    /// the clamp, for [`Self::move_clamp`] and [`Self::release`]. If the grasp holds the position,
    /// the node stops at once.
    ///
    /// # Errors
    /// [`SimulationError::BadScene`] if the node does not exist or cannot be grasped.
    pub fn grasp(&mut self, node: usize, grasp: Grasp) -> Result<usize, SimulationError> {
        let grasped = self.system.grasp(node, grasp, &self.state.unknowns);
        let clamp = grasped.map_err(refused)?;
        if grasp.position {
            self.state.velocity[STRIDE * node..STRIDE * node + 3].fill(0.0);
        }
        self.begin_anew();
        Ok(clamp)
    }

    /// Releases a clamp of the scene or of a grasp. The node keeps its velocity.
    ///
    /// # Errors
    /// [`SimulationError::BadScene`] if the clamp does not exist or cannot be released.
    pub fn release(&mut self, clamp: usize) -> Result<(), SimulationError> {
        let released = self.system.release(clamp, &self.state.unknowns);
        released.map_err(refused)?;
        self.begin_anew();
        Ok(())
    }

    /// Discards the earlier steps: their accelerations do not apply after the intervention.
    pub(super) fn begin_anew(&mut self) {
        self.validity.stop_counting_energy();
        self.state.begin_anew();
        self.integrator.begin_anew();
        self.publish();
    }
}

fn refused(what: String) -> SimulationError {
    SimulationError::BadScene(SceneError::Intervention(what))
}
