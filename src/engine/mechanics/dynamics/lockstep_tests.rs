//! Simulations stepped together, compared with the same ones stepped alone.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::contact::ContactModel;
use crate::mechanics::scene::{Inertia, Relaxation, RodDescription, Scene};
use crate::mechanics::test_support::{
    clamp, contact, curved, drag, fixed_steps, line, point_force, section, weight,
};

const EDGES: usize = 9;
/// m.
const SWING: f64 = 0.002;

/// A wire with one or two clamps; its numbers depend on the case.
fn wire(case: usize, curves: bool, ends: usize) -> Scene {
    let part = 0.1 * case as f64;
    let stiffness = section(200.0, [0.002 * (1.0 + part), 0.003], 0.002);
    let nodes = line(Vector3::zeros(), Vector3::x() * (0.4 + 0.01 * part), EDGES);
    let mut rod = RodDescription {
        inertia: match curves {
            true => Inertia::Lumped,
            false => Inertia::Consistent,
        },
        ..RodDescription::uniform("wire", nodes, stiffness, 3e-3, 0.03 * (1.0 + part))
    };
    if curves {
        rod.natural_shape = curved([1.0 + part, -0.5], 0.4);
        rod.retardation_time = 0.01 * part;
        rod.relaxation = Some(Relaxation {
            ratio: 0.5,
            time: 0.2,
        });
    }
    let clamps = [clamp(0, 0), clamp(0, EDGES)];
    Scene {
        rods: vec![rod],
        clamps: clamps[..ends].to_vec(),
        loads: vec![
            weight(Vector3::new(part, 0.0, -9.81)),
            drag(None, 0.02 * part, 1e-5),
            point_force(0, 4, Vector3::y() * (0.05 * part)),
        ],
        ..Scene::default()
    }
}

fn start(scenes: &[Scene], scheme: Scheme) -> Vec<Simulation> {
    let scenes = scenes.iter();
    scenes
        .map(|scene| Simulation::new(scene, &fixed_steps(scheme, 5e-3)).unwrap())
        .collect()
}

/// Takes steps with clamps that oscillate by `swing` metres, each simulation alone or all
/// together.
fn travel(
    simulations: &mut [Simulation],
    steps: usize,
    swing: f64,
    lockstep: Option<&mut Lockstep>,
) {
    let mut lockstep = lockstep;
    for step in 1..=steps {
        let until = 5e-3 * step as f64;
        for (case, simulation) in simulations.iter_mut().enumerate() {
            let angle = 0.3 * step as f64 + case as f64;
            let place = Vector3::new(0.0, swing * angle.sin(), 0.001 * step as f64);
            simulation.carry_clamp(0, place, None, until).unwrap();
        }
        match &mut lockstep {
            Some(lockstep) => {
                let mut pairs: Vec<_> = simulations.iter_mut().map(|own| (own, until)).collect();
                for result in lockstep.advance(&mut pairs, &|| true) {
                    result.unwrap().unwrap();
                }
            }
            None => simulations.iter_mut().for_each(|own| {
                own.advance(until).unwrap();
            }),
        }
        for own in simulations.iter_mut() {
            while own.time() < until {
                own.advance(until).unwrap();
            }
        }
    }
}

/// Steps the cases alone and together, compares the results, and returns the share of steps that
/// were solved together.
fn compare(scenes: &[Scene], scheme: Scheme, steps: usize) -> f64 {
    compare_swings(scenes, scheme, steps, SWING)
}

fn compare_swings(scenes: &[Scene], scheme: Scheme, steps: usize, swing: f64) -> f64 {
    let [mut alone, mut together] = [0, 1].map(|_| start(scenes, scheme));
    let mut lockstep = Lockstep::default();
    travel(&mut alone, steps, swing, None);
    travel(&mut together, steps, swing, Some(&mut lockstep));
    for (case, (alone, together)) in alone.iter().zip(&together).enumerate() {
        // Numbers are printed with all their digits.
        let print = |own: &Simulation| {
            let forces = (0..=EDGES).map(|node| own.reaction(node));
            let forces: Vec<Vector3> = forces.collect();
            let frames = (own.material_directors(), own.twist_rates());
            format!(
                "{:?} {:?} {forces:?} {frames:?} {:?}",
                own.state(),
                own.energies(),
                own.positions()
            )
        };
        assert_eq!(print(alone), print(together), "case {case}, {scheme:?}");
    }
    lockstep.solved as f64 / (steps * scenes.len()) as f64
}

#[test]
fn wires_stepped_together_get_the_bytes_that_they_get_alone() {
    for scheme in [Scheme::ImplicitEuler, Scheme::BackwardDifferences] {
        for (curves, ends) in [(false, 2), (false, 1), (true, 2), (true, 1)] {
            let scenes: Vec<Scene> = (0..11).map(|case| wire(case, curves, ends)).collect();
            let share = compare(&scenes, scheme, 30);
            assert!(share > 0.8, "{share}");
        }
    }
    let scenes: Vec<Scene> = (0..4).map(|case| wire(case, false, 2)).collect();
    let share = compare(&scenes, Scheme::ImplicitMidpoint, 20);
    assert!(share > 0.8, "{share}");
}

#[test]
fn scenes_of_other_kinds_are_stepped_beside_each_other() {
    let mut scenes: Vec<Scene> = (0..6).map(|case| wire(case, false, 1 + case % 2)).collect();
    let mut touching = wire(1, false, 1);
    touching.contact = Some(contact(ContactModel::ImplicitContact, 1e-4));
    scenes.insert(2, touching);
    let share = compare(&scenes, Scheme::ImplicitEuler, 10);
    assert!((0.3..0.6).contains(&share), "{share}");
}

#[test]
fn forces_of_edges_that_turn_far_in_a_step_are_those_of_wires_alone() {
    let scenes: Vec<Scene> = (0..9).map(|case| wire(case, false, 1)).collect();
    let share = compare_swings(&scenes, Scheme::ImplicitEuler, 10, 10.0 * SWING);
    assert!(share > 0.5, "{share}");
}

#[test]
fn forces_from_outside_change_between_steps_together() {
    let scenes: Vec<Scene> = (0..5).map(|case| wire(case, false, 2)).collect();
    let [mut alone, mut together] = [0, 1].map(|_| start(&scenes, Scheme::ImplicitEuler));
    let mut lockstep = Lockstep::default();
    for round in 0..4 {
        let force = Vector3::z() * (0.01 * f64::from(round % 3));
        for own in alone.iter_mut().chain(&mut together) {
            own.set_external_forces(&[force; EDGES + 1], &[0.0; EDGES + 1]);
            own.set_load_factor(0, 1.0 + 0.1 * f64::from(round / 2))
                .unwrap();
        }
        let until = 5e-3 * f64::from(round + 1);
        alone.iter_mut().for_each(|own| {
            own.advance(until).unwrap();
        });
        let mut pairs: Vec<_> = together.iter_mut().map(|own| (own, until)).collect();
        for result in lockstep.advance(&mut pairs, &|| true) {
            result.unwrap().unwrap();
        }
        for (alone, together) in alone.iter().zip(&together) {
            assert_eq!(alone.positions(), together.positions());
            assert_eq!(alone.reaction(0), together.reaction(0));
        }
    }
    assert!(lockstep.solved > 0);
}
