//! Forces and Jacobians of all contacts at one configuration.

use super::candidates::approach;
use super::closest_points::{ClosestPoints, edge_distance};
use super::contact_system::ContactSystem;
use super::contacts::{ActiveContact, PlaneContact};
use super::edge_contact::{Sliding, edge_force, edge_jacobian};
use super::friction::{FrictionLaw, slip};
use super::multipliers::LinearLaw;
use super::normal_law::NormalLaw;
use super::normal_response::NormalResponse;
use super::plane_contact::{NodeSliding, plane_force, plane_jacobian};
use super::surface::ContactNode;
use super::tractions::LinearTraction;
use crate::mechanics::Vector3;

/// The positions at which contact is evaluated.
#[derive(Clone, Copy)]
struct Motion<'a> {
    positions: &'a [Vector3],
    previous: &'a [Vector3],
    time_step: f64,
}

impl Motion<'_> {
    fn velocity(&self, node: usize) -> Vector3 {
        (self.positions[node] - self.previous[node]) / self.time_step
    }

    /// The law where there is friction and time for it.
    fn friction(&self, coefficient: f64, slip_tolerance: f64) -> Option<FrictionLaw> {
        (coefficient > 0.0 && self.time_step.is_finite()).then_some(FrictionLaw {
            coefficient,
            slip_tolerance,
        })
    }
}

/// Two edges within reach of each other.
struct TouchingEdges {
    candidate: usize,
    nodes: [Vector3; 4],
    closest: ClosestPoints,
    gap: f64,
    law: NormalLaw,
    response: NormalResponse,
    sliding: Option<Sliding>,
    /// Relative velocity of the contact points along the surfaces, m/s; zero without friction.
    slip: Vector3,
    /// Friction per normal force.
    traction: Vector3,
    /// Force on the four nodes, N.
    force: [f64; 12],
}

impl ContactSystem {
    /// Finds the active contacts at `positions` and evaluates energy, forces and Jacobians.
    ///
    /// Friction acts on the velocity (`positions` − `previous`)/`time_step`, and not at all where
    /// `time_step` is infinite (statics).
    ///
    /// Centrelines that cross (Δ = 0) have no direction of separation: the forces are not numbers there, for
    /// the line search to refuse.
    pub fn evaluate(&mut self, positions: &[Vector3], previous: &[Vector3], time_step: f64) {
        self.evaluate_contacts(positions, previous, time_step, true);
    }

    /// The same without Jacobians, for line searches; [`Self::jacobians`] and
    /// [`Self::plane_jacobians`] are empty afterwards.
    pub fn evaluate_forces(&mut self, positions: &[Vector3], previous: &[Vector3], time_step: f64) {
        self.evaluate_contacts(positions, previous, time_step, false);
    }

    fn evaluate_contacts(
        &mut self,
        positions: &[Vector3],
        previous: &[Vector3],
        time_step: f64,
        with_jacobians: bool,
    ) {
        self.clear_results();
        if self.parameters.is_complementarity() {
            return self.evaluate_constraints(positions);
        }
        let motion = Motion {
            positions,
            previous,
            time_step,
        };
        self.evaluate_edges(motion, with_jacobians);
        self.evaluate_planes(motion, with_jacobians);
        if with_jacobians {
            self.multipliers.advance();
        }
    }

    fn clear_results(&mut self) {
        self.contacts.clear();
        self.tractions.clear();
        self.jacobians.clear();
        self.linear_corrections.clear();
        self.multiplier_corrections.clear();
        self.plane_contacts.clear();
        self.plane_tractions.clear();
        self.plane_jacobians.clear();
        self.plane_linear_corrections.clear();
        self.plane_multiplier_corrections.clear();
        self.energy = 0.0;
        self.contact_count = 0;
    }

    fn evaluate_edges(&mut self, motion: Motion, with_jacobians: bool) {
        let parameters = self.parameters;
        let (tolerance, reach) = (parameters.distance_tolerance, parameters.reach());
        let friction = motion.friction(parameters.friction, parameters.slip_tolerance);
        self.candidates.motion(motion.positions, &mut self.motion);
        for candidate in 0..self.candidates.pairs().len() {
            let (pair, earlier) = (
                self.candidates.pairs()[candidate],
                self.candidates.gaps()[candidate],
            );
            let loaded = with_jacobians && self.multipliers.is_loaded(candidate);
            if !loaded && earlier - approach(&pair, &self.motion) >= reach {
                continue;
            }
            let nodes = pair.nodes.map(|node| motion.positions[node]);
            let threshold = self.surface.threshold(pair.edges);
            let closest = ClosestPoints::smoothed(&nodes, parameters.smoothing(threshold));
            let gap = closest.distance() - threshold - parameters.standoff();
            if !loaded && gap >= reach {
                continue;
            }
            let law = NormalLaw::new(&parameters, 0.5 * threshold, self.stiffness);
            let response = law.response(gap);
            let sliding = friction.map(|law| Sliding {
                law,
                velocities: pair.nodes.map(|node| motion.velocity(node)),
                time_step: motion.time_step,
            });
            let slip = sliding.map_or_else(Vector3::zeros, |sliding| {
                let velocity = sliding.relative_velocity(&closest.weights());
                slip(&closest.normal(), &velocity)
            });
            let traction = friction.map_or_else(Vector3::zeros, |law| law.traction_of_slip(&slip));
            let force = edge_force(&closest, response.force, &traction);
            self.contacts.push(ActiveContact {
                candidate,
                nodes: pair.nodes,
                // What is reported is the true distance, without smoothing.
                distance: edge_distance(&nodes),
                threshold,
                normal: closest.normal(),
                normal_force: response.force,
                force,
            });
            self.tractions.push(traction);
            if with_jacobians {
                self.linearize_edges(&TouchingEdges {
                    candidate,
                    nodes,
                    closest,
                    gap,
                    law,
                    response,
                    sliding,
                    slip,
                    traction,
                    force,
                });
            }
            self.energy += response.energy;
            self.contact_count += usize::from(gap < tolerance);
        }
    }

    /// Adds the Jacobian of two edges, and the differences between the force of their laws, that of the linearised
    /// laws, and that of the carried normal force and traction.
    fn linearize_edges(&mut self, edges: &TouchingEdges) {
        let normal = edges.closest.normal();
        let pressure =
            self.linear_normal_law(edges.candidate, edges.gap, &edges.law, edges.response);
        let law = edges.sliding.as_ref().map(|sliding| &sliding.law);
        let friction =
            self.linear_friction_law(edges.candidate, law, &normal, &edges.slip, edges.traction);
        let sliding = edges.sliding.as_ref();
        self.jacobians.push(edge_jacobian(
            &edges.nodes,
            &edges.closest,
            &pressure.tangent,
            sliding.map(|sliding| (sliding, friction.slip)),
        ));
        let [linear, carried] =
            corrections(&pressure, &friction, edges.force, |force, traction| {
                edge_force(&edges.closest, force, traction)
            });
        self.linear_corrections.push(linear);
        self.multiplier_corrections.push(carried);
    }

    /// The normal force law of a slot, linearised where its multiplier is.
    fn linear_normal_law(
        &mut self,
        slot: usize,
        gap: f64,
        law: &NormalLaw,
        response: NormalResponse,
    ) -> LinearLaw {
        let linear = self.multipliers.linear_law(
            slot,
            gap,
            &response,
            |gap| law.response(gap),
            |force| law.gap_of_force(force),
        );
        linear.unwrap_or(LinearLaw {
            tangent: response,
            force: response.force,
        })
    }

    /// The friction law of a slot, where there is one, linearised where its traction is.
    fn linear_friction_law(
        &mut self,
        slot: usize,
        law: Option<&FrictionLaw>,
        normal: &Vector3,
        slip: &Vector3,
        traction: Vector3,
    ) -> LinearTraction {
        match law {
            Some(law) if self.multipliers.in_use() => {
                self.carried_tractions.linear_law(slot, law, normal, slip)
            }
            _ => LinearTraction {
                slip: *slip,
                value: traction,
                present: traction,
                carried: traction,
            },
        }
    }

    fn evaluate_planes(&mut self, motion: Motion, with_jacobians: bool) {
        let (tolerance, reach) = (self.parameters.distance_tolerance, self.parameters.reach());
        let slots = self.slots();
        for index in 0..self.planes.len() {
            let plane = self.planes[index];
            let friction = motion.friction(plane.friction, self.parameters.slip_tolerance);
            for k in 0..self.surface.nodes().len() {
                let ContactNode { node, radius } = self.surface.nodes()[k];
                let slot = slots.over_plane(index, node);
                let distance = plane.distance(&motion.positions[node]);
                let gap = distance - radius;
                let loaded = with_jacobians && self.multipliers.is_loaded(slot);
                if !loaded && gap >= reach {
                    continue;
                }
                let law = NormalLaw::new(&self.parameters, radius, self.stiffness);
                let response = law.response(gap);
                let sliding = friction.map(|law| NodeSliding {
                    law,
                    velocity: motion.velocity(node),
                    time_step: motion.time_step,
                });
                let slip = sliding.map_or_else(Vector3::zeros, |sliding| {
                    slip(&plane.normal, &sliding.velocity)
                });
                let traction =
                    friction.map_or_else(Vector3::zeros, |law| law.traction_of_slip(&slip));
                let force = plane_force(&plane.normal, response.force, &traction);
                self.plane_contacts.push(PlaneContact {
                    node,
                    plane: index,
                    distance,
                    threshold: radius,
                    normal_force: response.force,
                    force,
                });
                self.plane_tractions.push(traction);
                if with_jacobians {
                    let pressure = self.linear_normal_law(slot, gap, &law, response);
                    let friction = self.linear_friction_law(
                        slot,
                        friction.as_ref(),
                        &plane.normal,
                        &slip,
                        traction,
                    );
                    self.plane_jacobians.push(plane_jacobian(
                        &plane.normal,
                        &pressure.tangent,
                        sliding.as_ref().map(|sliding| (sliding, friction.slip)),
                    ));
                    let [linear, carried] =
                        corrections(&pressure, &friction, force, |force, traction| {
                            plane_force(&plane.normal, force, traction)
                        });
                    self.plane_linear_corrections.push(linear);
                    self.plane_multiplier_corrections.push(carried);
                }
                self.energy += response.energy;
                self.contact_count += usize::from(gap < tolerance);
            }
        }
    }
}

/// What to add to `force` to have that of the linearised laws, and to have that of the carried normal force and traction;
/// `with` gives the force of a normal force and a traction.
fn corrections<const N: usize>(
    pressure: &LinearLaw,
    friction: &LinearTraction,
    force: [f64; N],
    with: impl Fn(f64, &Vector3) -> [f64; N],
) -> [[f64; N]; 2] {
    // The product of force and direction, linearised where the Jacobian is: N d₀ + N₀ (d − d₀).
    let normal_force = pressure.tangent.force;
    let pressed = with(pressure.force, &friction.value);
    let [slid, base] = [&friction.present, &friction.value].map(|t| with(normal_force, t));
    let carried = with(normal_force, &friction.carried);
    [
        std::array::from_fn(|k| pressed[k] + (slid[k] - base[k]) - force[k]),
        std::array::from_fn(|k| carried[k] - force[k]),
    ]
}
