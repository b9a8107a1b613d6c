//! Forces and Jacobians of the contacts with planes at one configuration.

use super::contact_system::ContactSystem;
use super::contacts::{ContactMotion, ContactPair, PlaneContact, Proximity};
use super::evaluation::{Motion, Touch};
use super::friction::{FrictionLaw, slip};
use super::normal_law::NormalLaw;
use super::plane::ContactPlane;
use super::plane_contact::{NodeSliding, plane_force, plane_jacobian};
use super::surface::ContactNode;
use super::surface_turns::TurnedBodies;
use super::tractions::correction;
use super::turned_contacts::{Turned, with_turning};
use crate::mechanics::Vector3;

impl ContactSystem {
    /// Evaluates the contacts of nodes with planes.
    pub(super) fn evaluate_planes(&mut self, motion: &Motion, with_jacobians: bool) {
        let (tolerance, reach) = (self.parameters.distance_tolerance, self.parameters.reach());
        let slots = self.slots();
        for index in 0..self.planes.len() {
            let plane = self.planes[index];
            for k in 0..self.surface.nodes().len() {
                let of_node = self.surface.nodes()[k];
                let ContactNode { node, radius, .. } = of_node;
                let slot = slots.over_plane(index, node);
                if self.surface.roots.frees_from_plane(node, index) {
                    continue;
                }
                let distance = plane.distance(&motion.positions[node]);
                let gap = distance - radius;
                let loaded = with_jacobians && self.multipliers.is_loaded(slot);
                if !loaded && gap >= reach {
                    continue;
                }
                if self.is_prescribed(node) {
                    self.without_force.push(Proximity {
                        pair: ContactPair::NodeAndPlane { node, plane: index },
                        distance,
                        threshold: radius,
                    });
                    continue;
                }
                let stiffness = self.stiffness_between(node, node);
                let law = NormalLaw::new(&self.parameters, radius, stiffness);
                let response = law.response(self.counted_gap(gap));
                let coefficient = self.friction_over(&plane, &of_node);
                let friction = motion.friction(coefficient, self.parameters.slip_tolerance);
                let friction =
                    friction.map(|law| self.directed(law, &plane, node, motion.previous));
                let sliding = friction.map(|law| NodeSliding {
                    law,
                    velocity: motion.velocity(node),
                    time_step: motion.time_step,
                });
                let turning = sliding.and_then(|_| {
                    let positions = [motion.positions, motion.previous];
                    self.turning_over_plane(node, radius, positions, motion.time_step)
                });
                let spin = sliding.and_then(|_| self.spin_over_plane(node, motion.time_step));
                let slip = sliding.map_or_else(Vector3::zeros, |sliding| {
                    let normal = &plane.normal;
                    let spun = spin.map_or_else(Vector3::zeros, |spin| spin.velocity(normal));
                    let turned = with_turning(sliding.velocity, turning.as_ref(), normal);
                    slip(normal, &(turned + spun))
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
                if self.has_bodies() {
                    let friction = traction * response.force;
                    let spun = spin.map(|spin| spin.contact(&plane.normal, &friction));
                    self.plane_spun.push(spun);
                }
                if let Some(turning) = &turning {
                    let bodies = TurnedBodies::Plane { plane: index, node };
                    let friction = traction * response.force;
                    self.push_turned(bodies, turning, &plane.normal, &friction);
                }
                if with_jacobians {
                    let touching = Touch {
                        turning: (turning.as_ref()).map(|turning| (turning, motion.positions)),
                        spin,
                        gap,
                        law,
                        response,
                        friction: friction.map(|law| (law, motion.time_step)),
                        normal: plane.normal,
                        slip,
                        traction,
                    };
                    self.linearize_plane([slot, node], &touching, sliding.as_ref(), motion);
                }
                self.energy += response.energy;
                self.contact_count += usize::from(gap < tolerance);
            }
        }
    }

    /// The law of a node on a plane whose friction may depend on the direction of the rod, here at
    /// the `previous` positions.
    fn directed(
        &self,
        law: FrictionLaw,
        plane: &ContactPlane,
        node: usize,
        previous: &[Vector3],
    ) -> FrictionLaw {
        let Some(own) = plane.directed_friction else {
            return law;
        };
        let [before, after] = self.chords[node];
        FrictionLaw {
            coefficient: own.sideways,
            grain: Some(own.grain(&plane.normal, &(previous[after] - previous[before]))),
            ..law
        }
    }

    /// Adds the Jacobian of a node over a plane with its slot, and the difference between its
    /// force and that of the linearised laws.
    fn linearize_plane(
        &mut self,
        [slot, node]: [usize; 2],
        touch: &Touch,
        sliding: Option<&NodeSliding>,
        motion: &Motion,
    ) {
        let position = motion.positions[node];
        let (pressure, friction) = self.linear_laws(slot, touch, |system| {
            system.iterate.moved(&[node], &[1.0], &[position])
        });
        let carries = self.multipliers.in_use();
        if carries {
            self.compare_with_last(slot, 1, &pressure, &friction);
        }
        if let (Some((turning, _)), Some(sliding)) = (touch.turning, sliding) {
            let turned = Turned {
                turning,
                sliding: &sliding.of_first_node(),
                motion: &ContactMotion::over_plane(&touch.normal),
                turns: true,
                sign: 1.0,
                force: (touch.response.force, touch.traction),
            };
            self.linearize_turned(slot, &turned, &pressure, &friction);
            self.plane_jacobians.push([[0.0; 3]; 3]);
            self.plane_linear_corrections.push([0.0; 3]);
            return;
        }
        let with = |force: f64, traction: &Vector3| plane_force(&touch.normal, force, traction);
        let force = with(touch.response.force, &touch.traction);
        let corrected = correction(&pressure, &friction, force, with);
        self.plane_linear_corrections.push(corrected);
        if let (Some(spin), Some(sliding)) = (&touch.spin, sliding) {
            let place = ContactMotion::over_plane(&touch.normal);
            let (laws, sliding) = ((&pressure, &friction), sliding.of_first_node());
            let force = (touch.response.force, touch.traction);
            let spun = self.linearize_spun((slot, spin), &place, force, laws, &sliding);
            if let Some(last) = self.plane_spun.last_mut() {
                *last = spun;
            }
            self.plane_jacobians.push([[0.0; 3]; 3]);
            return;
        }
        let sliding = sliding.map(|sliding| (sliding, friction.slip));
        let linearised = plane_jacobian(&touch.normal, &pressure.tangent, sliding);
        self.plane_jacobians.push(linearised.jacobian);
        if carries {
            self.multipliers
                .keep(slot, &pressure, &linearised.gap_gradient);
            self.carried_tractions
                .keep(slot, &friction, &linearised.traction_gradient);
        }
    }
}
