//! The background flow at the rods in a step: velocities relative to it, and the rate at which it
//! spins them about their axes.
//!
//! The drag of a fluid is that of the velocities v − U. As for the local resistance, U is that at
//! the places for which the drag is evaluated: at the start of the step or at its prediction. The
//! torque of the fluid on an edge that spins at the rate θ' is −c (θ' − ½ (∇ × U)·t) with the
//! tangent t. A sphere moves relative to U at its centre and spins relative to ½ ∇ × U.

use crate::mechanics::fluid::{BackgroundFlow, Sphere};
use crate::mechanics::rod::{Edge, STRIDE};
use crate::mechanics::scene::Scene;
use crate::mechanics::system::Assembly;
use crate::mechanics::{Matrix3, Vector3};

/// A background flow at the places of a fluid.
pub(super) struct Background {
    flow: BackgroundFlow,
    spheres: Vec<Sphere>,
    /// Edges with the coefficient c of their spin, N m s.
    edges: Vec<(Edge, f64)>,
    /// Time of the last sample, s.
    time: f64,
    /// U at each place, m/s.
    velocity: Vec<Vector3>,
    /// ½ (∇ × U)·t of the edge that starts at each node, rad/s.
    spins: Vec<f64>,
    /// Relative velocities of the places, m/s; scratch.
    relative: Vec<Vector3>,
}

impl Background {
    /// The background flow of a scene at this number of places; `None` without one.
    pub(crate) fn new(scene: &Scene, assembly: &Assembly, places: usize) -> Option<Self> {
        let flow = scene.flow.clone()?;
        let coefficients = assembly.spin_resistance(scene);
        let edges = assembly.rods.edges.iter().map(|edge| {
            let angle = STRIDE * edge.start + 3;
            let coefficient = coefficients.as_ref().map_or(0.0, |all| all[angle]);
            (*edge, coefficient)
        });
        Some(Self {
            flow,
            spheres: assembly.spheres(),
            edges: edges.collect(),
            time: 0.0,
            velocity: vec![Vector3::zeros(); places],
            spins: vec![0.0; assembly.rods.nodes],
            relative: vec![Vector3::zeros(); places],
        })
    }

    /// Evaluates the flow at the places of nodes and spheres, m, and at a time, s.
    pub(crate) fn sample(&mut self, positions: &[Vector3], time: f64) {
        self.time = time;
        for (velocity, x) in self.velocity.iter_mut().zip(positions) {
            *velocity = self.flow.velocity(x, time);
        }
        for sphere in &self.spheres {
            let spin = self.flow.spin(&positions[sphere.centre], time);
            for tip in sphere.tips() {
                self.velocity[tip] = spin.cross(&positions[tip]);
            }
        }
        for (edge, _) in &self.edges {
            let [start, end] = [positions[edge.start], positions[edge.end]];
            let spin = self.flow.spin(&((start + end) * 0.5), time);
            self.spins[edge.start] = spin.dot(&(end - start).normalize());
        }
    }

    /// Velocities of the places relative to the last sample, m/s.
    pub(crate) fn relative(&mut self, velocities: &[Vector3]) -> &[Vector3] {
        let pairs = velocities.iter().zip(&self.velocity);
        for (relative, (velocity, flow)) in self.relative.iter_mut().zip(pairs) {
            *relative = velocity - flow;
        }
        &self.relative
    }

    /// Makes velocities of the places relative to the last sample, m/s.
    pub(crate) fn subtract(&self, velocities: &mut [Vector3]) {
        for (velocity, flow) in velocities.iter_mut().zip(&self.velocity) {
            *velocity -= flow;
        }
    }

    /// Relative velocities of the last call of [`Self::relative`], m/s.
    pub(crate) fn last_relative(&self) -> &[Vector3] {
        &self.relative
    }

    /// Subtracts the spin of the flow from the spins of edges, rad/s; `spins` may be empty.
    pub(crate) fn subtract_spins(&self, spins: &mut [f64]) {
        for (spin, flow) in spins.iter_mut().zip(&self.spins) {
            *spin -= flow;
        }
    }

    /// Writes the torque with which the flow spins each edge, N m, for the node at its start.
    pub(crate) fn write_torques(&self, torques: &mut Vec<f64>) {
        torques.clear();
        torques.resize(self.spins.len(), 0.0);
        for (edge, coefficient) in &self.edges {
            torques[edge.start] = coefficient * self.spins[edge.start];
        }
    }

    /// Adds to a derivative with respect to the places the parts of U and of the torques in λ·R,
    /// R = D (v − U) + c (θ' − ½ (∇ × U)·t), for a virtual motion λ of places and of edge angles.
    /// The flow of a profile counts as linear.
    pub(crate) fn add_power_gradient(
        &self,
        positions: &[Vector3],
        resistance: &[Matrix3],
        (motions, turns): (&[Vector3], impl Fn(usize) -> f64),
        gradient: &mut [Vector3],
    ) {
        let mut slopes: Vec<Matrix3> = positions
            .iter()
            .map(|x| self.flow.gradient(x, self.time))
            .collect();
        for sphere in &self.spheres {
            let spin = self.flow.spin(&positions[sphere.centre], self.time);
            for tip in sphere.tips() {
                slopes[tip] = spin.cross_matrix();
            }
        }
        for (place, slope) in slopes.iter().enumerate() {
            gradient[place] -= slope.transpose() * (resistance[place] * motions[place]);
        }
        for (edge, coefficient) in self.edges.iter().filter(|(_, c)| *c > 0.0) {
            let [start, end] = [positions[edge.start], positions[edge.end]];
            let (along, spin) = (end - start, self.flow.spin(&start, self.time));
            let tangent = along.normalize();
            let across = spin - tangent * spin.dot(&tangent);
            let over = across * (coefficient * turns(edge.start) / along.norm());
            gradient[edge.end] -= over;
            gradient[edge.start] += over;
        }
    }
}
