//! The energy that forces add in a step.
//!
//! An implicit step with the force f = −∇φ at the end of the step removes at most the stored
//! amount from a convex energy φ: f·(q₁ − q₀) ≤ φ(q₀) − φ(q₁). The energy of a contact is convex
//! in its gap, and elastic energy in the strains. Gaps and strains are nearly linear in the
//! unknowns if rotations within the step are small. However, if rods move around each other by a
//! large part of their thickness, they are pushed apart along a normal that has turned meanwhile. A
//! compressed edge is accelerated as it turns. A step in which this adds energy is repeated.

use super::term::Kind;
use super::turned_elements::moments;
use super::{Stage, System, copy_positions};
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactSystem, SpunContact};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::position;

/// Negligible energy, relative to the kinetic and elastic energy of the scene.
const NEGLIGIBLE: f64 = 1e-3;
/// Negligible energy of contacts in steps of the midpoint rule, which do not remove energy either:
/// an impact takes many of them.
const NEGLIGIBLE_IN_THE_MIDDLE: f64 = 1e-5;
/// Negligible energy relative to the work of all contact forces along the distance tolerance δ:
/// rods at rest move by less, in alternating directions.
const NEGLIGIBLE_WAY: f64 = 0.2;
/// Rotation of an edge within a step, rad, up to which strains count as linear: the error is half
/// its square.
const FAR_TURN: f64 = 0.1;

impl System {
    /// Energy that contacts add in a step that ends at `unknowns`, where they were last evaluated,
    /// J; only if it is not negligible. The contact forces are taken as constant, with their values
    /// at the end of the step. Rigid contacts store no energy.
    pub(crate) fn work_of_contact(&self, stage: &Stage, unknowns: &[f64]) -> Option<f64> {
        let contact = self.contact()?;
        let (work, forces) = self.work_and_forces(contact, stage, unknowns);
        let way = NEGLIGIBLE_WAY * contact.parameters().distance_tolerance * forces;
        let kinetic = self.kinetic_energy_at_start(stage);
        let is_small = |made: f64, energy: f64| made <= NEGLIGIBLE * energy + way;
        // The energy that contacts stored before the step is computed only when it matters.
        let most = work + contact.energy();
        if is_small(most, kinetic) {
            return None;
        }
        let energy = kinetic + self.elastic_energy().total();
        if is_small(most, energy) {
            return None;
        }
        let made = most
            - contact
                .stored_at_start(&self.terms.contact.step_start)
                .energy;
        (!is_small(made, energy)).then_some(made)
    }

    /// f·(x₁ − x₀) and |f|, summed over the contacts.
    fn work_and_forces(
        &self,
        contact: &ContactSystem,
        stage: &Stage,
        unknowns: &[f64],
    ) -> (f64, f64) {
        let moved = |node: usize| position(unknowns, node) - self.terms.contact.step_start[node];
        let (mut work, mut forces) = (0.0, 0.0);
        for pair in contact.contacts() {
            forces += pair.normal_force.abs();
            for (node, force) in pair.nodes.iter().zip(pair.force.chunks_exact(3)) {
                let moved = if contact.is_of_rod(*node) {
                    contact.motion_of_point(*node, moved)
                } else {
                    contact.vertex_motion(*node)
                };
                work += Vector3::new(force[0], force[1], force[2]).dot(&moved);
            }
        }
        for touched in contact.plane_contacts() {
            forces += touched.normal_force.abs();
            work += Vector3::from(touched.force).dot(&contact.motion_of_point(touched.node, moved));
        }
        for (unknown, moment) in moments(contact) {
            work += moment * (unknowns[unknown] - stage.start[unknown]);
        }
        work += contact.all_spun().map(SpunContact::work).sum::<f64>();
        work += contact.turning_work();
        (work, forces)
    }

    /// Energy that contacts add in a step of the midpoint rule that ends at `unknowns`, J; only if
    /// it is not negligible. This is the work of the normal forces in the middle of the step, plus
    /// the energy added by a change of the contact stiffness. `None` also if nothing touches.
    pub(crate) fn work_of_contact_in_the_middle(
        &mut self,
        stage: &Stage,
        unknowns: &[f64],
    ) -> Option<f64> {
        let contact = self.terms.contact.model.take()?;
        copy_positions(unknowns, &mut self.terms.contact.positions);
        let made = self.normal_work(&contact, unknowns)
            + contact.energy_at(&self.terms.contact.positions)
            - self.terms.contact.stored_at_start;
        self.terms.contact.model = Some(contact);
        if made <= 0.0 {
            return None;
        }
        let energy = self.kinetic_energy_at_start(stage) + self.elastic_energy().total();
        (made > NEGLIGIBLE_IN_THE_MIDDLE * energy).then_some(made)
    }

    /// Work of the normal forces of all contacts along the path to `unknowns`, J.
    fn normal_work(&self, contact: &ContactSystem, unknowns: &[f64]) -> f64 {
        let moved = |node: usize| position(unknowns, node) - self.terms.contact.step_start[node];
        let mut work = 0.0;
        for pair in contact.contacts() {
            for (node, force) in pair.nodes.iter().zip(pair.force.chunks_exact(3)) {
                let moved = if contact.is_of_rod(*node) {
                    contact.motion_of_point(*node, moved)
                } else {
                    contact.vertex_motion(*node)
                };
                let along = Vector3::from_column_slice(force).dot(&pair.normal);
                work += along * pair.normal.dot(&moved) / pair.normal.norm_squared();
            }
        }
        for touched in contact.plane_contacts() {
            let normal = &contact.planes()[touched.plane].normal;
            let along = Vector3::from(touched.force).dot(normal);
            work += along * normal.dot(&contact.motion_of_point(touched.node, moved));
        }
        work
    }

    /// Energy stored in contacts at `positions`, J.
    pub(crate) fn contact_energy_at(&self, positions: &[Vector3]) -> f64 {
        let contact = self.contact();
        contact.map_or(0.0, |contact| contact.energy_at(positions))
    }

    /// Work that moving obstacles do on the rods in the step against the normal forces of the
    /// contacts, J; and the sum of these forces, N.
    pub(crate) fn work_of_obstacles(&self) -> (f64, f64) {
        let Some(contact) = self.contact() else {
            return (0.0, 0.0);
        };
        let (mut work, mut forces) = (0.0, 0.0);
        for pair in contact.contacts() {
            forces += pair.normal_force;
            let corners = pair.nodes.iter().zip(pair.force.chunks_exact(3));
            for (node, force) in corners.filter(|(node, _)| !contact.is_of_rod(**node)) {
                let along = Vector3::from_column_slice(force).dot(&pair.normal);
                let motion = contact.vertex_motion(*node);
                work -= along * pair.normal.dot(&motion) / pair.normal.norm_squared();
            }
        }
        let planes = contact.plane_contacts().iter();
        (
            work,
            forces + planes.map(|one| one.normal_force).sum::<f64>(),
        )
    }

    /// Energy that elastic forces add in a step of implicit Euler that ends at `unknowns`, where
    /// they were last evaluated, J; only if it is not negligible, i.e. more than inertia loses in
    /// the step, ½ ‖v₁ − v₀‖²_M. A rod that spins as a rigid body regains that loss from the
    /// forces that turn its velocities.
    pub(crate) fn work_of_elasticity(&mut self, stage: &Stage, unknowns: &[f64]) -> Option<f64> {
        if !self.turns_far(stage, unknowns) {
            return None;
        }
        let after = self.elastic_energy().total();
        let mut gradient = std::mem::take(&mut self.corrected_residual);
        gradient.fill(0.0);
        let at = self.at(unknowns, Some(stage));
        let terms = self.terms.all().into_iter();
        for term in terms.filter(|term| term.kind() == Kind::Elastic) {
            term.add_forces(&at, &mut gradient);
        }
        (self.assembly.joints).gather_moments(unknowns, &mut gradient);
        // Prescribed unknowns start at their values at the end of the step, since others do the
        // work on them.
        let start = self.at_start(unknowns, stage);
        let (mut work, mut change) = (0.0, vec![0.0; start.len()]);
        for k in (0..start.len()).filter(|k| !self.assembly.held[*k]) {
            let moved = unknowns[k] - start[k];
            work -= gradient[k] * moved;
            change[k] = moved / stage.step - stage.velocity[k];
        }
        self.corrected_residual = gradient;
        self.update_geometry(&start);
        let before = self.elastic_energy().total();
        self.update_geometry(unknowns);
        let nodes = self.assembly.all_places();
        let lost = self.assembly.kinetic_energy(&nodes, &change);
        let made = work + after - before - lost;
        let energy = self.kinetic_energy_at_start(stage) + after;
        (made > NEGLIGIBLE * energy).then_some(made)
    }

    /// Whether within a step an edge or spring turns, or an edge spins about itself, by more than
    /// [`FAR_TURN`], or is stretched by as large a strain.
    fn turns_far(&self, stage: &Stage, unknowns: &[f64]) -> bool {
        let moved = |node: usize| position(unknowns, node) - stage.positions[node];
        self.assembly.rods.edges.iter().any(|edge| {
            let angle = STRIDE * edge.start + 3;
            let turn = (moved(edge.end) - moved(edge.start)).norm();
            let spin = (unknowns[angle] - stage.start[angle]).abs();
            turn > FAR_TURN * edge.natural_length || spin > FAR_TURN
        }) || self.terms.springs.turn_by(FAR_TURN, moved)
            || self.terms.tendons.turn_by(FAR_TURN, moved)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::scene::RodDescription;
    use crate::mechanics::system::copy_positions;
    use crate::mechanics::test_support::{free_rods, section};

    const STRETCHING: f64 = 30.0;
    const LENGTH: f64 = 0.2;
    const STEP: f64 = 0.1;

    /// A rod along x, turned by `angle` about z and stretched by `strain` beyond its natural
    /// length.
    fn turned(strain: f64, angle: f64) -> impl Fn(f64) -> Vector3 {
        let along = Vector3::new(angle.cos(), angle.sin(), 0.0) * (1.0 + strain);
        move |at| along * (at * LENGTH)
    }

    /// Energy that elastic forces add in a step that turns the rod and in which inertia loses no
    /// energy.
    fn brought(strain: f64, angle: f64) -> Option<f64> {
        let stiffness = section(STRETCHING, [0.02; 2], 0.03);
        let places = [-0.5, -0.25, 0.0, 0.25, 0.5];
        let nodes = places.map(turned(0.0, 0.0)).to_vec();
        let scene = free_rods(vec![RodDescription::uniform(
            "rod", nodes, stiffness, 1e-3, 1e-3,
        )]);
        let mut system = System::new(&scene).unwrap();
        let unknowns_at = |angle: f64| {
            let mut unknowns = system.assembly.unknowns.clone();
            for (node, x) in places.map(turned(strain, angle)).iter().enumerate() {
                unknowns[STRIDE * node..STRIDE * node + 3].copy_from_slice(x.as_slice());
            }
            unknowns
        };
        let (start, end) = (unknowns_at(0.0), unknowns_at(angle));
        let velocity = (end.iter().zip(&start)).map(|(end, start)| (end - start) / STEP);
        let mut stage = Stage {
            step: STEP,
            acceleration_step: STEP,
            keeps_spin: false,
            velocity: velocity.collect(),
            positions: vec![Vector3::zeros(); places.len()],
            angles: vec![0.0; places.len()],
            drag: Vec::new(),
            drag_velocity: Vec::new(),
            resistance: Vec::new(),
            flow_torque: Vec::new(),
            start,
        };
        copy_positions(&stage.start, &mut stage.positions);
        system.update_geometry(&end);
        let brought = system.work_of_elasticity(&stage, &end);
        let left = system.elastic_energy();
        system.update_geometry(&end);
        assert_eq!(left, system.elastic_energy(), "it is left where it was");
        brought
    }

    #[test]
    fn a_compressed_rod_pushes_itself_along_as_it_turns() {
        let strain = -0.1;
        for angle in [0.2, 1.0, 3.0_f64] {
            // The compression N at the end of the step does work over the distance ℓ (1 − cos φ)
            // along its line.
            let force = -STRETCHING * strain;
            let expected = force * LENGTH * (1.0 + strain) * (1.0 - angle.cos());
            let made = brought(strain, angle).unwrap();
            assert!((made / expected - 1.0).abs() < 1e-9, "{made} of {expected}");
        }
        assert_eq!(brought(strain, 0.05), None, "it hardly turns");
    }

    #[test]
    fn a_stretched_rod_takes_energy_as_it_turns() {
        for angle in [0.2, 1.0, 3.0] {
            assert_eq!(brought(0.1, angle), None);
        }
    }
}
