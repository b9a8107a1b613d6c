//! What can be seen of a simulation, and how it is saved and restored.

use super::Simulation;
use super::report::{Energies, SimulationError, SimulationState};
use crate::mechanics::Vector3;
use crate::mechanics::contact::ActiveContact;

impl Simulation {
    /// Time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Positions of all nodes, rod after rod, m.
    pub fn positions(&self) -> &[Vector3] {
        &self.positions
    }

    /// Velocities of all nodes, m/s.
    pub fn velocities(&self) -> &[Vector3] {
        &self.velocities
    }

    /// Angle of the edge that starts at each node, rad; zero where no edge starts.
    pub fn edge_angles(&self) -> &[f64] {
        &self.edge_angles
    }

    /// First material director of the edge that starts at each node; zero where no edge starts.
    pub fn material_directors(&self) -> Vec<Vector3> {
        self.system.geometry.edges[..self.positions.len()]
            .iter()
            .map(|edge| edge.director_1)
            .collect()
    }

    /// Twist per length at each node, rad/m; zero at free ends.
    pub fn twist_rates(&self) -> Vec<f64> {
        self.system.assembly.rods.twist_rates(&self.system.geometry)
    }

    /// Force of the fluid on each node in the last step, N; empty without fluid.
    pub fn fluid_forces(&self) -> Vec<Vector3> {
        self.fluid_forces.clone()
    }

    /// Pairs of edges that bear on each other in the last step.
    pub fn contacts(&self) -> &[ActiveContact] {
        self.system
            .contact
            .as_ref()
            .map_or(&[], |contact| contact.contacts())
    }

    /// Contact force on each node in the last step, N; empty without contact.
    pub fn contact_forces(&self) -> Vec<Vector3> {
        let Some(contact) = &self.system.contact else {
            return Vec::new();
        };
        let mut forces = vec![Vector3::zeros(); self.positions.len()];
        for pair in contact.contacts() {
            for (corner, &node) in pair.nodes.iter().enumerate() {
                forces[node] += Vector3::from_column_slice(&pair.force[3 * corner..3 * corner + 3]);
            }
        }
        for touch in contact.plane_contacts() {
            forces[touch.node] += Vector3::from(touch.force);
        }
        forces
    }

    /// Energies now, J.
    pub fn energies(&self) -> Energies {
        let elastic = self.system.elastic_energy();
        let assembly = &self.system.assembly;
        let kinetic = self
            .velocity
            .iter()
            .zip(&assembly.masses)
            .map(|(v, m)| 0.5 * m * v * v)
            .sum();
        Energies {
            kinetic,
            stretching: elastic.stretching,
            bending: elastic.bending,
            twisting: elastic.twisting,
            contact: self
                .system
                .contact
                .as_ref()
                .map_or(0.0, |contact| contact.energy()),
            gravitational: assembly.loads.gravitational_energy(
                self.time,
                &assembly.masses,
                &assembly.obstacle,
                &self.unknowns,
            ),
        }
    }

    /// Smallest distance between centrelines that may touch, m; infinite if none is near.
    pub fn minimum_distance(&self) -> f64 {
        self.system
            .contact
            .as_ref()
            .map_or(f64::INFINITY, |contact| {
                contact.minimum_distance(&self.positions)
            })
    }

    /// Numbers of the unknowns that are not held: node k has x, y, z at 4k..4k+2, its edge's angle at 4k+3.
    pub fn free_unknowns(&self) -> Vec<usize> {
        (0..self.unknowns.len())
            .filter(|&k| !self.system.assembly.held[k])
            .collect()
    }

    /// Masses (kg) and moments of inertia (kg m²) of the free unknowns.
    pub fn masses(&self) -> Vec<f64> {
        self.free_unknowns()
            .into_iter()
            .map(|k| self.system.assembly.masses[k])
            .collect()
    }

    /// Hessian of the elastic energy, less the derivative of loads and contact forces, over the free
    /// unknowns at the present configuration, N/m.
    pub fn stiffness_matrix(&mut self) -> nalgebra::DMatrix<f64> {
        self.system.linearize(&self.unknowns, None);
        let dense = self.system.dense_matrix();
        let free = self.free_unknowns();
        nalgebra::DMatrix::from_fn(free.len(), free.len(), |i, j| dense[(free[i], free[j])])
    }

    /// What a checkpoint must hold to continue bit for bit.
    pub fn state(&self) -> SimulationState {
        SimulationState {
            time: self.time,
            unknowns: self.unknowns.clone(),
            velocity: self.velocity.clone(),
            history: self.history.clone(),
            reference: self.system.reference.clone(),
            control: self.control,
            interventions: self.system.interventions(),
            contact: self.system.contact.as_ref().map(|contact| contact.memory()),
            fluid: self.fluid.as_ref().map(|fluid| fluid.memory()),
        }
    }

    /// Continues from a checkpoint of the same scene.
    ///
    /// # Errors
    /// [`SimulationError::BadScene`] where the checkpoint does not fit the scene.
    pub fn restore(&mut self, state: SimulationState) -> Result<(), SimulationError> {
        let foreign = |what: String| {
            SimulationError::BadScene(format!("the checkpoint does not fit: {what}"))
        };
        let restored = self.system.restore_interventions(state.interventions);
        restored.map_err(|what| foreign(what.to_owned()))?;
        if state.unknowns.len() != self.unknowns.len()
            || state.reference.twist.len() != self.system.reference.twist.len()
        {
            return Err(foreign("other numbers of nodes or vertices".into()));
        }
        match (&mut self.system.contact, &state.contact) {
            (Some(contact), Some(memory)) => contact
                .restore(memory)
                .map_err(|e| foreign(e.to_string()))?,
            (None, None) => {}
            _ => return Err(foreign("contact".into())),
        }
        match (&mut self.fluid, state.fluid) {
            (Some(fluid), Some(memory)) => {
                fluid.restore(memory).map_err(|e| foreign(e.to_string()))?
            }
            (None, None) => {}
            _ => return Err(foreign("fluid".into())),
        }
        self.time = state.time;
        self.unknowns = state.unknowns;
        self.velocity = state.velocity;
        self.history = state.history;
        self.control = state.control;
        self.system.reference = state.reference;
        self.system.forget_pattern();
        self.system.drive(self.time, &mut self.unknowns);
        self.system.update_geometry(&self.unknowns);
        self.publish();
        Ok(())
    }
}
