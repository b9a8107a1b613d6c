//! Rods that rub with high friction: few iterations, harmless short steps, Coulomb's law in each
//! step.

use super::barrier_tests::{RADIUS, crossing, rod};
use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactModel, ContactParameters};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::scene::Scene;
use crate::mechanics::system::{Imbalance, Stage, angles_of};
use crate::mechanics::test_support::{clamp, drag, fixed, ground, run_with, weight};

const MODEL: ContactModel = ContactModel::ImplicitContact;

/// The ends of the upper rod are lowered by 3 mm, and then moved back and forth along the lower
/// one.
fn rubbing(friction: f64) -> Simulation {
    let mut scene = crossing(MODEL, 1e-6, friction);
    for node in [0, 10] {
        let mut end = clamp(1, node);
        let at = |x: f64| Vector3::new(x, 0.0, -3e-3);
        end.motion.translation = vec![
            (0.0, Vector3::zeros()),
            (0.1, at(0.0)),
            (0.3, at(4e-3)),
            (0.6, at(-4e-3)),
        ];
        scene.clamps.push(end);
    }
    scene.loads.push(drag(None, 0.5, 1e-4));
    Simulation::new(&scene, &fixed(1e-3)).unwrap()
}

#[test]
fn rods_that_stick_and_slide_take_few_iterations() {
    for friction in [0.3, 1.0] {
        let mut simulation = rubbing(friction);
        let (mut steps, mut iterations, mut retries) = (0, 0, 0);
        while simulation.time() < 0.6 {
            let report = simulation.advance(0.6).unwrap();
            steps += 1;
            iterations += report.newton_iterations;
            retries += report.retries;
        }
        let mean = iterations as f64 / f64::from(steps);
        println!("μ = {friction}: {steps} steps, {mean:.2} iterations a step, {retries} retries");
        assert!(mean < 3.0, "{mean}");
    }
}

#[test]
fn an_impact_in_short_steps_hardens_contact_no_more_than_in_a_whole_one() {
    let (whole, short, speed) = (1e-3, 1e-6, 0.5);
    let mut scene = crossing(MODEL, 5e-5, 1.0);
    scene.rods[1].velocity = Vector3::z() * -speed;
    let mass = scene.rods[1].mass_per_length * 0.02;
    let mut simulation = Simulation::new(&scene, &fixed(whole)).unwrap();
    let (mut touched, mut stiffest) = (false, 0.0_f64);
    for step in 1..=300 {
        let report = simulation.advance(f64::from(step) * short).unwrap();
        touched |= report.contacts > 0;
        stiffest = stiffest.max(simulation.system.contact().unwrap().stiffness());
    }
    assert!(touched);
    // The force that reverses a node at twice its speed within a whole step; within a short step
    // it would be a thousand times that.
    let force = mass * 2.0 * (2.0 * speed) / whole;
    let per_force = ContactParameters::default().stiffness_factor;
    assert!(stiffest < 2.0 * per_force * force);
}

/// Found when the corner of a prescribed motion cut a step. In steps that short, the rounding of
/// sticking positions divided by the step is a slip, whose friction exceeded the allowed residual.
/// Such steps failed, and those after them stayed as short.
#[test]
fn the_tolerance_of_friction_is_never_below_rounding() {
    let mut scene = Scene {
        rods: vec![rod("lying", Vector3::new(7.0, 5.0, RADIUS), Vector3::x())],
        contact: Some(ContactParameters {
            distance_tolerance: 5e-5,
            friction: 0.8,
            slip_tolerance: 1e-5,
            ..ContactParameters::default()
        }),
        ..Scene::default()
    };
    scene.loads.push(weight(Vector3::new(3.0, 1.0, -9.81)));
    scene.planes.push(ground());
    let simulation = run_with(&scene, &fixed(5e-3), 0.2);
    // Every digit counts: the next floating-point number along x gives another residual.
    let positions = simulation.positions().to_vec();
    let mut system = simulation.system;
    let lying = simulation.state.unknowns;
    for step in [5e-3, 1e-6] {
        let stage = Stage {
            step,
            acceleration_step: step,
            keeps_spin: false,
            start: lying.clone(),
            velocity: vec![0.0; lying.len()],
            drag: Vec::new(),
            drag_velocity: Vec::new(),
            resistance: Vec::new(),
            flow_torque: Vec::new(),
            positions: positions.clone(),
            angles: angles_of(&lying),
        };
        system.set_tolerances(fixed(step).force_tolerance, &lying, Some(&stage));
        let mut residual_at = |unknowns: &[f64]| {
            system.evaluate(unknowns, Some(&stage));
            let Imbalance {
                residual, ratio, ..
            } = system.imbalance();
            (system.residual.clone(), residual / ratio)
        };
        let (here, allowed) = residual_at(&lying);
        let mut beside = lying.clone();
        let coordinate = STRIDE * 5;
        beside[coordinate] = beside[coordinate].next_up();
        let (there, _) = residual_at(&beside);
        let change = (there[coordinate] - here[coordinate]).abs();
        assert!(change > 0.0);
        assert!(
            change <= allowed,
            "{step}: {change:e} N against {allowed:e} N"
        );
    }
}
