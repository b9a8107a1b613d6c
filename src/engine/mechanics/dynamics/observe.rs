//! Observation of a simulation, and its checkpoints.

use super::Simulation;
use super::parameters::Scheme;
use super::report::{Energies, SimulationError, SimulationState};
use super::state::State;
use crate::mechanics::contact::{ActiveContact, Proximity};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::scene::Start;
use crate::mechanics::system::Break;
use crate::mechanics::{SceneError, Vector3};
use std::borrow::Cow;

impl Simulation {
    /// Time, s.
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// Positions of all nodes, rod after rod, m.
    pub fn positions(&self) -> &[Vector3] {
        &self.published.positions
    }

    /// Velocities of all nodes, m/s.
    pub fn velocities(&self) -> &[Vector3] {
        &self.published.velocities
    }

    /// Angle of the edge that starts at each node, rad; zero if no edge starts.
    pub fn edge_angles(&self) -> &[f64] {
        &self.published.edge_angles
    }

    /// First material director of the edge that starts at each node; zero if no edge starts.
    pub fn material_directors(&self) -> Vec<Vector3> {
        self.system.geometry.edges[..self.published.positions.len()]
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
        let published = &self.published;
        let (positions, velocities) = (&published.positions, &published.velocities);
        let quadratic = self.system.quadratic_drag(positions, velocities);
        if quadratic.is_empty() {
            return self.integrator.fluid.forces().to_vec();
        }
        quadratic
    }

    /// Pairs of edges that press on each other in the last step.
    pub fn contacts(&self) -> Cow<'_, [ActiveContact]> {
        let contact = self.system.contact();
        contact.map_or(Cow::Borrowed(&[]), |contact| contact.contacts_of_edges())
    }

    /// The obstacle of a contact.
    pub fn obstacle_at(&self, contact: &ActiveContact) -> Option<usize> {
        let system = self.system.contact()?;
        let pair = system.candidates().get(contact.candidate)?;
        system.surface().obstacle_of(pair.edges[1])
    }

    /// Contact force on each node in the last step, N; empty without contact.
    pub fn contact_forces(&self) -> Vec<Vector3> {
        let Some(contact) = self.system.contact() else {
            return Vec::new();
        };
        let mut forces = vec![Vector3::zeros(); self.published.positions.len()];
        for pair in contact.contacts() {
            let corners = pair.nodes.iter().enumerate();
            for (corner, &node) in corners.filter(|(_, node)| contact.is_of_rod(**node)) {
                let own = std::array::from_fn(|axis| pair.force[3 * corner + axis]);
                contact.spread(node, own, |node, part| forces[node] += Vector3::from(part));
            }
        }
        for touch in contact.plane_contacts() {
            contact.spread(touch.node, touch.force, |node, part| {
                forces[node] += Vector3::from(part);
            });
        }
        forces
    }

    /// Present energies, J.
    pub fn energies(&self) -> Energies {
        let elastic = self.system.elastic_energy();
        let assembly = &self.system.assembly;
        let nodes = assembly.all_places();
        let (loads, State { time, unknowns, .. }) = (&self.system.terms.loads, &self.state);
        let of_nodes =
            loads.gravitational_energy(*time, &assembly.masses, &assembly.obstacle, unknowns);
        Energies {
            kinetic: assembly.kinetic_energy(&nodes, &self.state.velocity),
            stretching: elastic.stretching,
            bending: elastic.bending,
            twisting: elastic.twisting,
            contact: self.contact_energy(),
            gravitational: of_nodes + loads.gravitational_energy_of_arms(*time, unknowns),
        }
    }

    /// Present energy of the contacts, J. The midpoint rule evaluates them in the middle of its
    /// steps.
    fn contact_energy(&self) -> f64 {
        let scheme = self.integrator.setting.parameters.scheme;
        match self.system.contact() {
            None => 0.0,
            Some(_) if scheme == Scheme::ImplicitMidpoint => {
                self.system.contact_energy_at(&self.published.positions)
            }
            Some(contact) => contact.energy(),
        }
    }

    /// Smallest distance between centrelines that may touch, m; infinite if none is near.
    pub fn minimum_distance(&self) -> f64 {
        self.system.contact().map_or(f64::INFINITY, |contact| {
            contact.minimum_distance(&self.published.positions)
        })
    }

    /// The bodies, planes and obstacles included, that are nearest to touching; `None` if none is near.
    pub fn nearest(&self) -> Option<Proximity> {
        let contact = self.system.contact()?;
        contact.nearest(&self.published.positions)
    }

    /// Mean gap between surfaces in contact, weighted by their normal forces, in the last step, m; `None` if nothing
    /// touches.
    pub fn mean_gap(&self) -> Option<f64> {
        self.system.contact()?.mean_gap()
    }

    /// Remarks on the motion so far, one sentence each: strains beyond rod theory, spurious
    /// energy, steps far smaller than requested, joints that broke, contact that is ignored at
    /// roots.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = self.validity.remarks(&self.system);
        remarks.extend(self.system.remarks_on_breaks());
        remarks.extend_from_slice(self.system.remarks_on_roots());
        remarks
    }

    /// Break of each joint that may break; `None` if it did not. In the order of the joints of the
    /// scene, then of its springs.
    pub fn breaks(&self) -> Vec<Option<Break>> {
        self.system.breaks()
    }

    /// Indices of the unknowns that are not held: node k has x, y, z at 4k..4k+2, and the angle of
    /// its edge at 4k+3.
    pub fn free_unknowns(&self) -> Vec<usize> {
        let assembly = &self.system.assembly;
        let mut owned = assembly.held.clone();
        for unknown in assembly.joints.dependent() {
            owned[unknown] = true;
        }
        (0..owned.len()).filter(|&k| !owned[k]).collect()
    }

    /// Momentum, kg m/s, and angular momentum about the origin, kg m²/s, of the motion of all nodes.
    pub fn momenta(&self) -> [Vector3; 2] {
        let assembly = &self.system.assembly;
        assembly.momenta(&self.state.unknowns, &self.state.velocity)
    }

    /// Masses (kg) and moments of inertia (kg m²) of the free unknowns: the mass matrix.
    pub fn mass_matrix(&self) -> nalgebra::DMatrix<f64> {
        let dense = self.system.assembly.mass_matrix();
        let free = self.free_unknowns();
        nalgebra::DMatrix::from_fn(free.len(), free.len(), |i, j| dense[(free[i], free[j])])
    }

    /// Hessian of the elastic energy minus the derivative of loads and contact forces, over the
    /// free unknowns at the present configuration, N/m.
    pub fn stiffness_matrix(&mut self) -> nalgebra::DMatrix<f64> {
        self.system.linearize(&self.state.unknowns, None);
        let dense = self.system.dense_matrix();
        let free = self.free_unknowns();
        nalgebra::DMatrix::from_fn(free.len(), free.len(), |i, j| dense[(free[i], free[j])])
    }

    /// The present state, as the start of another scene with the same rods.
    pub fn as_start(&self) -> Start {
        let system = &self.system;
        let rods = &system.assembly.rods;
        let mut twist = vec![0.0; rods.nodes];
        for (index, vertex) in rods.vertices.iter().enumerate() {
            if vertex.before.max(vertex.after) < rods.nodes {
                twist[vertex.after] = system.geometry.twist(index);
            }
        }
        let mut directors = self.material_directors();
        let mut walls = vec![None; rods.nodes];
        for drive in system
            .assembly
            .drives
            .iter()
            .filter(|drive| !drive.released)
        {
            let frame = drive.ghosts.first().map(|&ghost| system.ghosts[ghost]);
            walls[drive.node] = frame.map(|frame| [frame.tangent, frame.director]);
        }
        let mut turning = vec![None; rods.nodes];
        let joints = &system.assembly.joints;
        for (number, frame) in joints.frames.iter().enumerate() {
            let spin = joints.turn_of_frame(number, &self.state.unknowns, &self.state.velocity);
            if let Some(vertices) = &frame.vertices {
                let rotation = joints.rotation(number);
                walls[vertices.centre] =
                    Some([Vector3::z(), Vector3::x()].map(|axis| rotation * axis));
                turning[vertices.centre] = Some(spin);
            }
            for (ghost, _) in &frame.ghosts {
                let node = system.assembly.node_of_ghost(*ghost);
                let now = system.ghosts[*ghost];
                walls[node] = Some([now.tangent, now.director]);
                turning[node] = Some(spin);
            }
        }
        for range in rods.rods.iter().filter(|range| !range.closed) {
            directors[range.first_node + range.nodes - 1] = Vector3::zeros();
        }
        let spins = self.state.velocity.iter().skip(3).step_by(STRIDE);
        Start {
            positions: self.positions().to_vec(),
            directors,
            twist,
            velocities: self.velocities().to_vec(),
            spins: spins.copied().collect(),
            walls,
            turning,
        }
    }

    /// Data of a checkpoint, from which the simulation continues bit for bit.
    pub fn state(&self) -> SimulationState {
        SimulationState {
            time: self.state.time,
            unknowns: self.state.unknowns.clone(),
            velocity: self.state.velocity.clone(),
            history: self.state.history.clone(),
            reference: self.system.reference.clone(),
            control: self.integrator.control,
            interventions: self.system.interventions(),
            validity: self.validity.memory.clone(),
            contact: self.system.contact().map(|contact| contact.memory()),
            fluid: self.integrator.fluid.memory(),
            strains: self.system.memory(),
            frames: self.system.frame_bases(),
            breaks: self.system.breaks(),
        }
    }

    /// Continues from a checkpoint of the same scene.
    ///
    /// # Errors
    /// [`SimulationError::BadScene`] if the checkpoint belongs to another scene.
    pub fn restore(&mut self, state: SimulationState) -> Result<(), SimulationError> {
        let foreign = |what: String| SimulationError::BadScene(SceneError::Checkpoint(what));
        // Breaks are restored before the grasps, which may have followed them.
        let restored = self.system.restore_breaks(&state.breaks);
        restored.map_err(|what| foreign(what.to_owned()))?;
        let restored = self.system.restore_interventions(state.interventions);
        restored.map_err(|what| foreign(what.to_owned()))?;
        if state.unknowns.len() != self.state.unknowns.len()
            || state.reference.twist.len() != self.system.reference.twist.len()
        {
            return Err(foreign("the number of nodes or vertices differs".into()));
        }
        self.system.terms.contact.place_obstacles(state.time);
        match (&mut self.system.terms.contact.model, &state.contact) {
            (Some(contact), Some(memory)) => contact
                .restore(memory)
                .map_err(|e| foreign(e.to_string()))?,
            (None, None) => {}
            _ => return Err(foreign("the contact model differs".into())),
        }
        self.integrator
            .fluid
            .restore(state.fluid)
            .map_err(foreign)?;
        let restored = self.system.restore(state.strains);
        restored.map_err(|what| foreign(what.to_owned()))?;
        let restored = self.system.restore_frame_bases(&state.frames);
        restored.map_err(|what| foreign(what.to_owned()))?;
        self.state = State {
            time: state.time,
            unknowns: state.unknowns,
            velocity: state.velocity,
            history: state.history,
        };
        self.integrator.control = state.control;
        self.validity.memory = state.validity;
        self.system
            .resume(state.time, &self.state.unknowns, &state.reference);
        self.system.forget_pattern();
        self.system.drive(self.state.time, &mut self.state.unknowns);
        self.system.update_geometry(&self.state.unknowns);
        self.publish();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::contact::ContactParameters;
    use crate::mechanics::dynamics::IntegrationParameters;
    use crate::mechanics::scene::{Plane, RodDescription, Scene};
    use crate::mechanics::test_support::{clamp, ground, run_with, section, steady};

    /// A straight rod of 25 edges of 8 mm along an axis. `middle` is its midpoint.
    fn rod(name: &str, radius: f64, axis: usize, middle: [f64; 3]) -> RodDescription {
        let node = |k: i32| {
            let mut node = Vector3::from(middle);
            node[axis] += 8e-3 * (f64::from(k) - 12.5);
            node
        };
        let stiffness = section(10.0, [1e-5; 2], 1e-5);
        RodDescription::uniform(name, (0..26).map(node).collect(), stiffness, radius, 0.01)
    }

    fn nearest(rods: Vec<RodDescription>, planes: Vec<Plane>) -> Proximity {
        let scene = Scene {
            rods,
            planes,
            contact: Some(ContactParameters::default()),
            ..Scene::default()
        };
        let simulation = Simulation::new(&scene, &IntegrationParameters::default());
        simulation.unwrap().nearest().unwrap()
    }

    #[test]
    fn a_thin_rod_that_touches_a_thick_post_is_at_a_ratio_of_one() {
        let post = RodDescription {
            held: true,
            ..rod("post", 20e-3, 2, [0.0; 3])
        };
        let thin = rod("thin", 2e-3, 0, [0.0, 22e-3, 4e-3]);
        let nearest = nearest(vec![thin, post], Vec::new());
        assert!((nearest.distance - 22e-3).abs() < 1e-12, "{nearest:?}");
        assert!((nearest.ratio() - 1.0).abs() < 1e-9, "{nearest:?}");
    }

    #[test]
    fn a_start_is_the_state_that_was_left() {
        use crate::mechanics::scene::{Clamp, LoadKind, Motion};
        let mut beam = rod("beam", 2e-3, 0, [0.0; 3]);
        beam.twist = 9.0;
        let turned = |node: usize| Clamp {
            motion: Motion {
                angle: vec![(0.0, 0.0), (0.2, if node == 0 { 2.0 } else { 0.0 })],
                ..Motion::default()
            },
            ..clamp(0, node)
        };
        let gravity = LoadKind::Gravity {
            acceleration: Vector3::new(0.0, -1.0, -9.81),
        };
        let mut scene = Scene {
            rods: vec![beam],
            clamps: vec![turned(0), turned(25)],
            loads: vec![steady(gravity)],
            ..Scene::default()
        };
        let parameters = IntegrationParameters::default();
        let first = run_with(&scene, &parameters, 0.3);
        let start = first.as_start();
        scene
            .clamps
            .iter_mut()
            .for_each(|clamp| clamp.motion = Motion::default());
        scene.start = Some(start.clone());
        let second = Simulation::new(&scene, &parameters).unwrap();
        assert_eq!(second.positions(), first.positions());
        assert_eq!(second.velocities(), first.velocities());
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs();
        let (before, after) = (first.energies(), second.energies());
        for (before, after) in [
            (before.kinetic, after.kinetic),
            (before.stretching, after.stretching),
            (before.bending, after.bending),
            (before.twisting, after.twisting),
        ] {
            assert!(before > 0.0 && near(after, before), "{before} {after}");
        }
        for (one, other) in second.as_start().twist.iter().zip(&start.twist) {
            assert!((one - other).abs() < 1e-12);
        }
    }

    #[test]
    fn planes_are_bodies_that_may_be_near() {
        let ground = ground();
        let nearest = nearest(vec![rod("thin", 2e-3, 0, [0.0, 0.0, 2.5e-3])], vec![ground]);
        assert!((nearest.distance - 2.5e-3).abs() < 1e-15, "{nearest:?}");
        assert!((nearest.ratio() - 1.25).abs() < 1e-12, "{nearest:?}");
    }
}
