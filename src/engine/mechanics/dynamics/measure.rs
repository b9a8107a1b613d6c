//! Measurements of single rods, nodes and edges of a simulation, at its last step.

use super::Simulation;
use super::report::Energies;
use crate::mechanics::contact::{ContactPlane, PlaneContact};
use crate::mechanics::rod::{RodRange, STRIDE};
use crate::mechanics::system::{BodyMotion, Resultants};
use crate::mechanics::{UnitQuaternion, Vector3};
use std::borrow::Cow;

/// Pose of a clamp, and what it holds.
#[derive(Clone, Copy, Debug)]
pub struct HeldPose {
    /// Node of the whole scene.
    pub node: usize,
    /// Position of the node, m.
    pub position: Vector3,
    /// Rotates the axes to the first and second material directors and the tangent of the rod
    /// there.
    pub frame: UnitQuaternion,
    /// Whether the position is held.
    pub holds_position: bool,
    /// Whether the frame is held. If not, `frame` is the frame at which the clamp took hold,
    /// rotated with it since then.
    pub holds_frame: bool,
}

impl Simulation {
    /// Motion of a free body of the scene.
    ///
    /// # Panics
    /// If the body does not exist.
    pub fn body_motion(&self, body: usize) -> BodyMotion {
        self.system
            .body_motion(body, &self.state.unknowns, &self.state.velocity)
    }

    /// Number of clamps, including released ones: first those of the scene, then those that
    /// [`Self::grasp`] made.
    pub fn clamps(&self) -> usize {
        self.system.assembly.drives.len()
    }

    /// Whether a clamp exists and was not released.
    pub fn is_held(&self, clamp: usize) -> bool {
        let drives = &self.system.assembly.drives;
        drives.get(clamp).is_some_and(|drive| !drive.released)
    }

    /// Pose of a clamp; `None` if it does not exist or was released.
    pub fn clamp_pose(&self, clamp: usize) -> Option<HeldPose> {
        if !self.is_held(clamp) {
            return None;
        }
        let drive = &self.system.assembly.drives[clamp];
        Some(HeldPose {
            node: drive.node,
            position: self.published.positions[drive.node],
            frame: drive.frame_at(self.state.time),
            holds_position: drive.holds_position,
            holds_frame: !(drive.ghosts.is_empty() && drive.edges.is_empty()),
        })
    }

    /// Range of the nodes of each rod.
    pub fn rod_ranges(&self) -> &[RodRange] {
        &self.system.assembly.rods.rods
    }

    /// Force that a clamp exerts on its held node, N: the residual M a + ∇E − F there, which
    /// includes the inertia of the node. The force is available after the first step or
    /// equilibrium. With the midpoint rule it is the force in the middle of the step.
    pub fn reaction(&self, node: usize) -> Vector3 {
        Vector3::from_column_slice(&self.system.residual[STRIDE * node..STRIDE * node + 3])
    }

    /// Moment that a clamp exerts on the rod at its node, N m; zero if no frame is held.
    pub fn reaction_moment(&self, node: usize) -> Vector3 {
        self.system.clamp_moment(node)
    }

    /// Tension of the edge that starts at a node, N: positive if it is longer than its natural
    /// length; `None` if no edge starts.
    pub fn tension(&self, edge: usize) -> Option<f64> {
        self.system.tension(edge)
    }

    /// Force of a spring of the scene, N: positive if it pulls, 0 after it broke.
    pub fn spring_force(&self, spring: usize) -> f64 {
        self.system.spring_force(spring)
    }

    /// Tension of a tendon of the scene, N; 0 where it is slack. With friction, that at its first
    /// eyelet.
    pub fn tendon_tension(&self, tendon: usize) -> f64 {
        self.system.tendon_tensions(tendon)[0]
    }

    /// Tension of a tendon of the scene at its last eyelet, N.
    pub fn tendon_end_tension(&self, tendon: usize) -> f64 {
        self.system.tendon_tensions(tendon)[1]
    }

    /// Natural length of the rod outside of a sheath of the scene, m.
    pub fn length_outside(&self, sheath: usize) -> f64 {
        self.system.length_outside(sheath)
    }

    /// Force of a sheath of the scene on its rod in the direction in which it is fed, N, and moment
    /// about this direction, N m.
    pub fn sheath_force(&self, sheath: usize) -> [f64; 2] {
        self.system.sheath_force(sheath)
    }

    /// Length of a tendon of the scene from its first to its last eyelet, m.
    pub fn tendon_length(&self, tendon: usize) -> f64 {
        self.system.tendon_length(tendon)
    }

    /// Force of one of [`Scene::forces`](crate::mechanics::scene::Scene::forces) on its first node, N.
    pub fn node_force(&self, number: usize) -> Vector3 {
        self.system.node_force(number)
    }

    /// Bending and twisting moments, curvature and twist at each node; `None` at free ends.
    pub fn resultants(&self) -> Vec<Option<Resultants>> {
        self.system.resultants()
    }

    /// Twist of the material frame of a rod from one end to the other, rad, including whole turns
    /// and the twist across frames that clamps hold.
    pub fn total_twist(&self, rod: usize) -> f64 {
        self.system.total_twist(rod)
    }

    /// Nodes on which planes press in the last step.
    pub fn plane_contacts(&self) -> Cow<'_, [PlaneContact]> {
        let contact = self.system.contact();
        contact.map_or(Cow::Borrowed(&[]), |contact| {
            contact.plane_contacts_of_nodes()
        })
    }

    /// The planes; empty without contact.
    pub fn planes(&self) -> &[ContactPlane] {
        let contact = self.system.contact();
        contact.map_or(&[], |contact| contact.planes())
    }

    /// Energies of one rod, J; the contact energy is left at zero.
    pub fn energies_of(&self, rod: usize) -> Energies {
        let assembly = &self.system.assembly;
        let nodes = assembly.rods.rods[rod].node_indices();
        let left_out: Vec<bool> = (0..assembly.rods.nodes)
            .map(|node| assembly.obstacle[node] || !nodes.contains(&node))
            .collect();
        let elastic = self.system.elastic_energy_of(rod);
        Energies {
            kinetic: assembly.kinetic_energy(&nodes, &self.state.velocity),
            stretching: elastic.stretching,
            bending: elastic.bending,
            twisting: elastic.twisting,
            contact: 0.0,
            gravitational: self.system.terms.loads.gravitational_energy(
                self.state.time,
                &assembly.masses,
                &left_out,
                &self.state.unknowns,
            ),
        }
    }
}
