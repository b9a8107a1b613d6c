//! Forces and Jacobians of the contacts with planes at one configuration.

use super::contact_system::ContactSystem;
use super::contacts::{ContactMotion, ContactPair, PlaneContact, Proximity};
use super::evaluated::{EvaluatedNode, Rotation};
use super::evaluation::{Motion, Request, Touch};
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
    pub(super) fn evaluate_planes(&mut self, motion: &Motion, request: Request) {
        let is_known = request == Request::Jacobians;
        if !is_known {
            self.evaluated.nodes.clear();
        }
        let mut known = std::mem::take(&mut self.evaluated.nodes);
        let slots = self.slots();
        let mut next = 0;
        for plane in 0..self.planes.len() {
            for k in 0..self.surface.nodes().len() {
                let of_node = self.surface.nodes()[k];
                let slot = slots.over_plane(plane, of_node.node);
                let own = known.get(next).filter(|own| is_known && own.slot == slot);
                if let Some(own) = own {
                    next += 1;
                    let rotation = self.rotation_over_plane(own.sliding.is_some(), of_node, motion);
                    self.add_node(own, &rotation);
                    self.linearize_plane(own, &rotation, motion);
                    continue;
                }
                let loaded = request.has_jacobians() && self.multipliers.is_loaded(slot);
                if is_known && !loaded {
                    continue;
                }
                let found = self.evaluated_node([plane, slot], of_node, motion, loaded);
                let Some((node, rotation)) = found else {
                    continue;
                };
                self.add_node(&node, &rotation);
                if request.has_jacobians() {
                    self.linearize_plane(&node, &rotation, motion);
                } else {
                    known.push(node);
                }
            }
        }
        if is_known {
            known.clear();
        }
        self.evaluated.nodes = known;
    }

    /// How the bodies of a node over a plane turn in a step with friction.
    fn rotation_over_plane(
        &self,
        has_friction: bool,
        ContactNode { node, radius, .. }: ContactNode,
        motion: &Motion,
    ) -> Rotation {
        if !has_friction {
            return Rotation::default();
        }
        let positions = [motion.positions, motion.previous];
        Rotation {
            turning: self.turning_over_plane(node, radius, positions, motion.time_step),
            spin: self.spin_over_plane(node, motion.time_step),
        }
    }

    /// A node over a plane with its slot and force; `None` if it has none, or if it is out of reach
    /// and not `loaded`.
    fn evaluated_node(
        &mut self,
        [index, slot]: [usize; 2],
        of_node: ContactNode,
        motion: &Motion,
        loaded: bool,
    ) -> Option<(EvaluatedNode, Rotation)> {
        let ContactNode { node, radius, .. } = of_node;
        let plane = self.planes[index];
        if self.surface.roots.frees_from_plane(node, index) {
            return None;
        }
        let distance = plane.distance(&motion.positions[node]);
        let gap = distance - radius;
        if !loaded && gap >= self.parameters.reach() {
            return None;
        }
        if self.is_prescribed(node) {
            self.without_force.push(Proximity {
                pair: ContactPair::NodeAndPlane { node, plane: index },
                distance,
                threshold: radius,
            });
            return None;
        }
        let stiffness = self.stiffness_between(node, node);
        let law = NormalLaw::new(&self.parameters, radius, stiffness);
        let response = law.response(self.counted_gap(gap));
        let coefficient = self.friction_over(&plane, &of_node);
        let friction = motion.friction(coefficient, self.parameters.slip_tolerance);
        let friction = friction.map(|law| self.directed(law, &plane, node, motion.previous));
        let sliding = friction.map(|law| NodeSliding {
            law,
            velocity: motion.velocity(node),
            time_step: motion.time_step,
        });
        let rotation = self.rotation_over_plane(sliding.is_some(), of_node, motion);
        let Rotation { turning, spin } = &rotation;
        let slip = sliding.map_or_else(Vector3::zeros, |sliding| {
            let normal = &plane.normal;
            let spun = (spin.as_ref()).map_or_else(Vector3::zeros, |spin| spin.velocity(normal));
            let turned = with_turning(sliding.velocity, turning.as_ref(), normal);
            slip(normal, &(turned + spun))
        });
        let traction = friction.map_or_else(Vector3::zeros, |law| law.traction_of_slip(&slip));
        let evaluated = EvaluatedNode {
            slot,
            node,
            plane: index,
            distance,
            threshold: radius,
            law,
            response,
            sliding,
            slip,
            traction,
        };
        Some((evaluated, rotation))
    }

    /// Adds the force and the energy of a node over a plane.
    fn add_node(&mut self, evaluated: &EvaluatedNode, rotation: &Rotation) {
        let EvaluatedNode {
            node,
            plane,
            response,
            traction,
            ..
        } = *evaluated;
        let normal = self.planes[plane].normal;
        self.plane_contacts.push(PlaneContact {
            node,
            plane,
            distance: evaluated.distance,
            threshold: evaluated.threshold,
            normal_force: response.force,
            force: plane_force(&normal, response.force, &traction),
        });
        self.plane_tractions.push(traction);
        let friction = traction * response.force;
        if self.has_bodies() {
            let spun = rotation.spin.map(|spin| spin.contact(&normal, &friction));
            self.plane_spun.push(spun);
        }
        if let Some(turning) = &rotation.turning {
            let bodies = TurnedBodies::Plane { plane, node };
            self.push_turned(bodies, turning, &normal, &friction);
        }
        self.energy += response.energy;
        let is_counted = evaluated.gap() < self.parameters.distance_tolerance;
        self.contact_count += usize::from(is_counted);
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

    /// Adds the Jacobian of a node over a plane, and the difference between its force and that of
    /// the linearised laws.
    fn linearize_plane(&mut self, evaluated: &EvaluatedNode, rotation: &Rotation, motion: &Motion) {
        let EvaluatedNode {
            slot,
            node,
            sliding,
            ..
        } = *evaluated;
        let touch = &Touch {
            turning: (rotation.turning.as_ref()).map(|turning| (turning, motion.positions)),
            spin: rotation.spin,
            gap: evaluated.gap(),
            law: evaluated.law,
            response: evaluated.response,
            friction: sliding.map(|sliding| (sliding.law, motion.time_step)),
            normal: self.planes[evaluated.plane].normal,
            slip: evaluated.slip,
            traction: evaluated.traction,
        };
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
        let sliding = sliding.as_ref().map(|sliding| (sliding, friction.slip));
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
