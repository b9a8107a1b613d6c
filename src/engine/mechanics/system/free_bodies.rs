//! Free rigid bodies: a centre of mass, a frame that turns about it ([`super::joints`], `frame`),
//! and vertices that follow both,
//!
//! ```text
//! xᵥ = x + R dᵥ,    F = Σ Fᵥ,    T = Σ R dᵥ × Fᵥ
//! ```
//!
//! On an axle the centre of mass is held, and the frame turns by an angle alone, to which the
//! moment of inertia belongs.
//!
//! The vertices are nodes without mass. Contact treats them like nodes of rods, and the segments
//! between them like edges; [`super::attached`] converts the derivatives of its forces.

use super::joints::frame::Vertices;
use super::joints::{JointPlan, Joints, Pin, TurningFrame};
use super::rod_scale::RodScale;
use super::{Assembly, System};
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::{RodRange, STRIDE};
use crate::mechanics::scene::{FreeBody, LoadKind, Scene};
use crate::mechanics::{SceneError, Vector3, rotation};

const NO_FLUID: SceneError = SceneError::Unsuitable(
    "free bodies in a fluid are not supported: remove the fluid or the bodies",
);

impl Assembly {
    /// Numbers and places the nodes of the free bodies of a scene, which begin at `first_node`.
    ///
    /// # Errors
    /// [`SceneError::Unsuitable`] in a scene with a fluid.
    pub(super) fn add_free_bodies(
        &mut self,
        scene: &Scene,
        mut first_node: usize,
    ) -> Result<(), SceneError> {
        if !scene.free_bodies.is_empty() && scene.fluid.is_some() {
            return Err(NO_FLUID);
        }
        let weight = largest_acceleration(scene);
        for body in &scene.free_bodies {
            let range = RodRange {
                first_node,
                nodes: body.nodes(),
                closed: false,
                rigid: true,
            };
            self.place_free_body(body, &range);
            let reach = body.reach();
            let force = body.mass * weight;
            self.scales.push(RodScale {
                // Without weight the forces of a body are those of its contacts.
                force: force.max(f64::MIN_POSITIVE),
                shortest_edge: reach,
                rounding_stiffness: 0.0,
            });
            self.force_scale = self.force_scale.max(force);
            self.shortest_edge = self.shortest_edge.min(reach);
            self.rods.rods.push(range);
            self.names.push(body.name.clone());
            self.radii.push(body.shape.radius);
            first_node += range.nodes;
        }
        Ok(())
    }

    fn place_free_body(&mut self, body: &FreeBody, range: &RodRange) {
        let centre = range.first_node;
        let vertices = &body.shape.vertices;
        for (node, x) in range
            .node_indices()
            .zip([body.centre].iter().chain(vertices))
        {
            let velocity = body.velocity_at(x);
            let own = STRIDE * node..STRIDE * node + 3;
            self.unknowns[own.clone()].copy_from_slice(x.as_slice());
            self.velocity[own.clone()].copy_from_slice(velocity.as_slice());
            // Vertices follow the centre and the frame.
            self.held[own.start..own.end + 1].fill(true);
        }
        let own = STRIDE * centre..STRIDE * centre + 3;
        self.masses[own.clone()].fill(body.mass);
        self.held[own].fill(body.axle.is_some());
    }

    /// Gives free bodies the frames of a plan, and joins rods to them.
    pub(super) fn turn_free_bodies(&mut self, scene: &Scene, plan: &JointPlan) {
        for (number, body) in scene.free_bodies.iter().enumerate() {
            let centre = self.rods.rods[scene.rods.len() + number].first_node;
            let own = plan.frame_of_body(scene, number);
            self.turn_free_body(own, body, centre);
            self.joints.bodies.push(own);
        }
        for (at, number) in &plan.pins {
            let body = &scene.free_bodies[*number];
            let node = self.number(at);
            let place = position(&self.unknowns, node);
            let velocity = body.velocity_at(&place);
            self.velocity[STRIDE * node..STRIDE * node + 3].copy_from_slice(velocity.as_slice());
            let frame = self.joints.bodies[*number];
            (self.joints.pins).push(Pin::new(node, frame, place - body.centre));
        }
    }

    fn turn_free_body(&mut self, number: usize, body: &FreeBody, centre: usize) {
        let frame = &mut self.joints.frames[number];
        frame.length = frame.length.min(body.reach());
        frame.node = centre;
        frame.vertices = Some(Vertices {
            centre,
            radius: body.shape.radius,
            arms: (body.shape.vertices.iter())
                .map(|x| x - body.centre)
                .collect(),
        });
        let (first_unknown, reach) = (frame.first_unknown, frame.length);
        let spin = body.angular_velocity;
        if let Some(axle) = &body.axle {
            self.masses[first_unknown + 3] = axle.inertia;
            self.velocity[first_unknown + 3] = spin.dot(&axle.direction);
            return;
        }
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| body.axes * axis);
        let first_tip = first_unknown + STRIDE;
        frame.body = Some((first_tip, axes));
        self.velocity[first_unknown..first_unknown + 3].copy_from_slice((spin * reach).as_slice());
        let sum: f64 = body.inertia.iter().sum();
        for (k, (moment, axis)) in body.inertia.iter().zip(&axes).enumerate() {
            let tip = first_tip + STRIDE * k;
            let velocity = spin.cross(axis) * reach;
            self.masses[tip..tip + 3].fill((0.5 * sum - moment) / (reach * reach));
            self.velocity[tip..tip + 3].copy_from_slice(velocity.as_slice());
            self.held[tip..tip + STRIDE].fill(true);
        }
    }

    /// Whether the position of each node is prescribed. Those of free bodies are not, although
    /// vertices are no unknowns, and a centre on an axle does not move.
    pub(crate) fn prescribed_nodes(&self) -> Vec<bool> {
        let nodes = self.held.iter().step_by(STRIDE).take(self.rods.nodes);
        let mut prescribed: Vec<bool> = nodes.copied().collect();
        for (_, _, vertices) in self.joints.free_frames() {
            prescribed[vertices.centre..vertices.nodes().end].fill(false);
        }
        prescribed
    }

    /// The mass (kg) of a free body as felt at each of its vertices, 1/(1/m + d²/I) for the mean
    /// moment of inertia I, with the nodes.
    pub(super) fn masses_at_vertices(&self) -> impl Iterator<Item = (usize, f64)> {
        self.joints.free_frames().flat_map(|(_, frame, vertices)| {
            let mean = match frame.body {
                // The moments add up to twice the sum of the masses at the tips.
                Some((first, _)) => {
                    let tips = [0, 1, 2].map(|k| self.masses[first + STRIDE * k]);
                    2.0 / 3.0 * tips.iter().sum::<f64>() * frame.length * frame.length
                }
                None => self.masses[frame.first_unknown + 3],
            };
            let mass = self.masses[STRIDE * vertices.centre];
            vertices
                .nodes()
                .zip(&vertices.arms)
                .map(move |(node, arm)| {
                    let turning = (arm.norm() + vertices.radius).powi(2) / mean;
                    (node, 1.0 / (1.0 / mass + turning))
                })
        })
    }
}

/// Motion of a free body.
#[derive(Clone, Copy, Debug)]
pub struct BodyMotion {
    /// Position of its centre of mass, m.
    pub position: Vector3,
    /// Rotation vector since it was placed, rad, of a length of at most π.
    pub turn: Vector3,
    /// Kinetic energy, J.
    pub kinetic_energy: f64,
}

impl Joints {
    /// Frames of the free bodies with their indices and the vertices that follow them, in the order
    /// of the bodies.
    pub(crate) fn free_frames(&self) -> impl Iterator<Item = (usize, &TurningFrame, &Vertices)> {
        let frames = self
            .bodies
            .iter()
            .map(|number| (*number, &self.frames[*number]));
        frames.filter_map(|(number, frame)| Some((number, frame, frame.vertices.as_ref()?)))
    }

    /// Rotation vectors of the free bodies from their rotations at the unknowns `start` to those of
    /// the last evaluation, rad.
    pub(crate) fn turns_since<'a>(
        &'a self,
        start: &'a [f64],
    ) -> impl Iterator<Item = Vector3> + use<'a> {
        self.free_frames().map(|(number, frame, _)| {
            let before = self.rotation_at(frame, start);
            rotation::to_vector(&(self.rotation(number) * before.inverse()))
        })
    }
}

impl System {
    /// Motion of a free body at the last evaluation.
    pub(crate) fn body_motion(
        &self,
        body: usize,
        unknowns: &[f64],
        velocity: &[f64],
    ) -> BodyMotion {
        let joints = &self.assembly.joints;
        let found = joints.free_frames().nth(body);
        let (number, frame, vertices) = found.expect("the body exists");
        let centre = vertices.centre;
        // On an axle there are no tips, and the frame has the inertia.
        let own = frame.first_unknown / STRIDE;
        let turning = match frame.body {
            Some(_) => own + 1..own + 4,
            None => own..own + 1,
        };
        let energy = |place| self.assembly.kinetic_energy(&place, velocity);
        BodyMotion {
            position: position(unknowns, centre),
            turn: rotation::to_vector(&joints.rotation(number)),
            kinetic_energy: energy(centre..centre + 1) + energy(turning),
        }
    }
}

/// Largest acceleration of free fall in a scene, m/s².
fn largest_acceleration(scene: &Scene) -> f64 {
    let sizes = scene.loads.iter().map(|load| match load.kind {
        LoadKind::Gravity { acceleration } => acceleration.norm(),
        _ => 0.0,
    });
    sizes.fold(0.0, f64::max)
}
