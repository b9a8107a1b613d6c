//! Work and losses of a step, which together with the energies give its balance.
//!
//! With the displacement Δq of the step and the forces and velocities v of its implicit stage,
//!
//! W = Σ r·Δq over all held unknowns, D_friction = −Σ f_t·Δx over all contacts, D_drag = Σ c v Δq,
//!
//! where r is the reaction, f_t the tangential part of the contact force, and c the drag
//! coefficient. The losses of the dashpots of viscous rods count as lost to drag. W = ΔE +
//! D_friction + D_drag except for the numerical damping of the scheme: implicit Euler removes ½ M
//! (Δv)² and similar terms, which vanish with the step.

use super::parameters::Scheme;
use super::report::Exchange;
use crate::mechanics::Vector3;
use crate::mechanics::contact::SpunContact;
use crate::mechanics::rod::{STRIDE, topology::position};
use crate::mechanics::system::{System, moments};

/// A step that is about to be accepted.
pub(super) struct AcceptedStep<'a> {
    /// The system with the forces of the implicit stage.
    pub system: &'a System,
    /// Unknowns at the start.
    pub before: &'a [f64],
    /// Unknowns at the end.
    pub after: &'a [f64],
    /// Velocity at the end.
    pub velocity: &'a [f64],
    /// Size, s.
    pub step: f64,
    pub scheme: Scheme,
}

impl AcceptedStep<'_> {
    /// Work and losses of the step.
    pub(crate) fn exchange(&self) -> Exchange {
        Exchange {
            clamp_work: self.clamp_work(),
            friction_loss: self.friction_loss(),
            drag_loss: self.drag_loss() + self.system.viscous_loss() + self.system.plastic_loss(),
        }
    }

    fn displacement(&self, node: usize) -> Vector3 {
        position(self.after, node) - position(self.before, node)
    }

    fn clamp_work(&self) -> f64 {
        let assembly = &self.system.assembly;
        (0..STRIDE * assembly.rods.nodes)
            .filter(|&k| assembly.held[k] && !assembly.obstacle[k / STRIDE])
            .map(|k| self.system.residual[k] * (self.after[k] - self.before[k]))
            .sum()
    }

    fn friction_loss(&self) -> f64 {
        let Some(contact) = self.system.contact() else {
            return 0.0;
        };
        let loss = |force: Vector3, normal: &Vector3, node: usize| {
            let across = force - normal * force.dot(normal);
            -across.dot(&contact.motion_of_point(node, |node| self.displacement(node)))
        };
        let mut sum = 0.0;
        for pair in contact.contacts() {
            let corners = pair.nodes.iter().enumerate();
            for (corner, &node) in corners.filter(|(_, node)| contact.is_of_rod(**node)) {
                let force = Vector3::from_column_slice(&pair.force[3 * corner..3 * corner + 3]);
                sum += loss(force, &pair.normal, node);
            }
        }
        for touch in contact.plane_contacts() {
            let normal = &contact.planes()[touch.plane].normal;
            sum += loss(Vector3::from(touch.force), normal, touch.node);
        }
        sum -= contact.all_spun().map(SpunContact::work).sum::<f64>();
        for (unknown, moment) in moments(contact) {
            sum -= moment * (self.after[unknown] - self.before[unknown]);
        }
        sum
    }

    fn drag_loss(&self) -> f64 {
        let damping = self.system.terms.drag.coefficients.iter().enumerate();
        damping
            .map(|(k, coefficient)| {
                let moved = self.after[k] - self.before[k];
                let velocity = match self.scheme {
                    // The next velocity is that at the end of the step.
                    Scheme::ImplicitMidpoint => moved / self.step,
                    Scheme::ImplicitEuler | Scheme::BackwardDifferences => self.velocity[k],
                };
                coefficient * velocity * moved
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::super::*;
    use crate::mechanics::Vector3;
    use crate::mechanics::contact::ContactParameters;
    use crate::mechanics::scene::{Clamp, Motion, RodDescription, Scene};
    use crate::mechanics::test_support::{
        clamp, drag, fixed, gravity, ground, run_with, straight_rod,
    };

    fn energy(simulation: &Simulation) -> f64 {
        let energies = simulation.energies();
        energies.kinetic
            + energies.stretching
            + energies.bending
            + energies.twisting
            + energies.contact
            + energies.gravitational
    }

    /// Gain of energy from `start` (s) to `end` (s), and the work and losses in between.
    fn budget(scene: &Scene, step: f64, start: f64, end: f64) -> (f64, Exchange) {
        let parameters = fixed(step);
        let mut simulation = run_with(scene, &parameters, start);
        let before = energy(&simulation);
        let mut sum = Exchange::default();
        while simulation.time() < end {
            sum += simulation.advance(end).unwrap().exchange;
        }
        (energy(&simulation) - before, sum)
    }

    #[test]
    fn a_sliding_rod_loses_its_kinetic_energy_to_friction() {
        let rod = RodDescription {
            centreline: (0..=10)
                .map(|k| Vector3::new(0.02 * f64::from(k), 0.0, 5e-3))
                .collect(),
            velocity: Vector3::x() * 0.5,
            ..straight_rod(10, 0.2)
        };
        let kinetic = 0.5 * rod.mass_per_length * 0.2 * 0.25;
        let scene = Scene {
            rods: vec![rod],
            loads: vec![gravity(9.81)],
            planes: vec![ground()],
            contact: Some(ContactParameters {
                friction: 0.5,
                ..ContactParameters::default()
            }),
            ..Scene::default()
        };
        // It stops after v/μg = 0.10 s.
        let (_, exchange) = budget(&scene, 1e-4, 0.0, 0.15);
        assert_eq!((exchange.clamp_work, exchange.drag_loss), (0.0, 0.0));
        let part = exchange.friction_loss / kinetic;
        assert!((part - 1.0).abs() < 5e-3, "{part}");
    }

    #[test]
    fn a_rod_drawn_through_drag_takes_the_work_of_its_clamp() {
        let motion = Motion {
            translation: vec![(0.0, Vector3::zeros()), (1.0, Vector3::x())],
            ..Motion::default()
        };
        let scene = Scene {
            rods: vec![straight_rod(10, 0.2)],
            clamps: vec![Clamp {
                motion,
                ..clamp(0, 0)
            }],
            loads: vec![drag(None, 2.0, 0.0)],
            ..Scene::default()
        };
        let (gain, exchange) = budget(&scene, 1e-3, 0.5, 1.0);
        // Product of coefficient, length, speed and distance.
        let expected = 2.0 * 0.2 * 1.0 * 0.5;
        assert!(gain.abs() < 1e-6 * expected);
        assert!((exchange.drag_loss / expected - 1.0).abs() < 1e-6);
        assert!((exchange.clamp_work / expected - 1.0).abs() < 1e-6);
    }
}
