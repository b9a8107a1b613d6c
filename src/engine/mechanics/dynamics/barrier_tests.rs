//! Incremental potential contact in motion: nothing ever crosses, and other results agree with the
//! implicit contact model.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactModel, ContactParameters};
use crate::mechanics::scene::{NaturalShape, RodDescription, Scene};
use crate::mechanics::test_support::{
    clamp, contact, drag, fixed, gravity, ground, resumed, run_with, straight_rod,
};

pub(super) const RADIUS: f64 = 5e-3;
pub(super) const DIAMETER: f64 = 2.0 * RADIUS;
pub(super) const TOLERANCE: f64 = 5e-5;
pub(super) const BARRIER: ContactModel = ContactModel::IncrementalPotential;
const PENALTY: ContactModel = ContactModel::ImplicitContact;

fn parameters(model: ContactModel, friction: f64) -> ContactParameters {
    ContactParameters {
        friction,
        slip_tolerance: 1e-5,
        stiffness_factor: if model == BARRIER { 1.0 } else { 1e5 },
        ..contact(model, TOLERANCE)
    }
}

/// A rod of 10 edges and 20 cm along `direction`, its middle at `middle`.
pub(super) fn rod(name: &str, middle: Vector3, direction: Vector3) -> RodDescription {
    RodDescription {
        name: name.into(),
        centreline: (0..=10)
            .map(|k| middle + direction * (0.02 * (f64::from(k) - 5.0)))
            .collect(),
        first_director: Some(Vector3::z()),
        natural_shape: NaturalShape::Straight,
        ..straight_rod(10, 0.2)
    }
}

/// A rod clamped at both ends, and another across it, `gap` above.
pub(super) fn crossing(model: ContactModel, gap: f64, friction: f64) -> Scene {
    // The rods cross neither at nodes nor at right angles, so that the contact is between two
    // edges.
    let across = Vector3::new(0.3, 1.0, 0.0).normalize();
    let middle = Vector3::new(0.006, 0.004, DIAMETER + gap);
    Scene {
        rods: vec![
            rod("lower", Vector3::zeros(), Vector3::x()),
            rod("upper", middle, across),
        ],
        clamps: vec![clamp(0, 0), clamp(0, 10)],
        contact: Some(parameters(model, friction)),
        ..Scene::default()
    }
}

#[test]
fn a_rod_shot_at_another_never_passes_through() {
    // At 20 m/s a free rod moves four diameters within a step of 2 ms.
    for (step, speed) in [(1e-4, 20.0), (2e-3, 20.0), (1e-2, 5.0)] {
        let mut scene = crossing(BARRIER, 0.01, 0.0);
        scene.rods[1].velocity = Vector3::z() * -speed;
        let mut simulation = Simulation::new(&scene, &fixed(step)).unwrap();
        let (mut least, mut touched) = (f64::INFINITY, 0);
        for _ in 0..40 {
            touched += simulation.advance(f64::INFINITY).unwrap().contacts;
            least = least.min(simulation.minimum_distance());
        }
        println!("step {step}: {:.6} diameters", least / DIAMETER);
        assert!(touched > 0);
        assert!(least > DIAMETER);
        let height = |rod: usize| simulation.positions()[11 * rod + 5].z;
        assert!(height(1) > height(0) + 0.9 * DIAMETER, "they changed sides");
    }
}

/// The ends of the upper rod are lowered by 3 mm and moved along the lower one by 1 mm, against some drag.
pub(super) fn pressed(model: ContactModel, friction: f64) -> Simulation {
    let mut scene = crossing(model, 0.5 * TOLERANCE, friction);
    for node in [0, 10] {
        let mut end = clamp(1, node);
        end.motion.translation = vec![
            (0.0, Vector3::zeros()),
            (0.5, Vector3::new(1e-3, 0.0, -3e-3)),
        ];
        scene.clamps.push(end);
    }
    scene.loads.push(drag(None, 5.0, 1e-3));
    run_with(&scene, &fixed(1e-2), 1.0)
}

#[test]
fn barrier_and_penalty_agree_on_pressed_rods() {
    for friction in [0.0, 0.3] {
        let (barrier, penalty) = (pressed(BARRIER, friction), pressed(PENALTY, friction));
        assert!(barrier.minimum_distance() > DIAMETER);
        let nodes = barrier.positions().iter().zip(penalty.positions());
        let apart = nodes.fold(0.0, |most, (a, b)| f64::max(most, (a - b).norm()));
        let total =
            |simulation: &Simulation| -> Vector3 { simulation.contact_forces()[11..].iter().sum() };
        let (of_barrier, of_penalty) = (total(&barrier), total(&penalty));
        let difference = (of_barrier - of_penalty).norm() / of_penalty.norm();
        println!("friction {friction}: {apart:.2e} m, forces {difference:.1e} of {of_penalty:?}");
        assert!(apart < TOLERANCE);
        // The gaps may differ by the tolerance, while the rods are bent by 3 mm.
        assert!(difference < TOLERANCE / 3e-3);
    }
}

#[test]
fn contacts_continue_bit_for_bit() {
    for model in [BARRIER, PENALTY, ContactModel::Complementarity] {
        let mut scene = crossing(model, 0.002, 0.3);
        scene.rods[1].velocity = Vector3::new(0.3, 0.1, -2.0);
        let steps = |simulation: &mut Simulation, count: usize| {
            let reports = (0..count).map(|_| simulation.advance(1.0).unwrap());
            reports.map(|report| report.contacts).sum::<usize>()
        };
        let mut through = Simulation::new(&scene, &fixed(5e-4)).unwrap();
        assert!(steps(&mut through, 5) > 0, "they touch before the restart");
        let mut restored = resumed(&scene, &fixed(5e-4), &through);
        steps(&mut through, 20);
        steps(&mut restored, 20);
        assert_eq!(through.positions(), restored.positions());
        assert_eq!(through.velocities(), restored.velocities());
    }
}

/// Eight stacked rods, each across the one below, that fall on a plane.
fn heap(model: ContactModel) -> Scene {
    let rods = (0..8).map(|k| {
        let (angle, height) = (2.4 * f64::from(k), (1.5 * f64::from(k) + 1.0) * DIAMETER);
        let direction = Vector3::new(libm::cos(angle), libm::sin(angle), 0.0);
        let middle = Vector3::new(0.01 * libm::sin(5.0 * angle), 0.0, height);
        rod(&format!("rod{k}"), middle, direction)
    });
    Scene {
        rods: rods.collect(),
        planes: vec![ground()],
        loads: vec![gravity(9.81)],
        contact: Some(parameters(model, 0.3)),
        ..Scene::default()
    }
}

/// Contacts that have opened keep their place in the factors. Rounding is the same after a restart
/// only if the checkpoint holds these places.
#[test]
fn heaps_continue_bit_for_bit_while_contacts_open_and_close() {
    let scene = heap(PENALTY);
    let mut through = Simulation::new(&scene, &fixed(2e-3)).unwrap();
    let state = (0..200).find_map(|_| {
        through.advance(1.0).unwrap();
        let state = through.state();
        let coupled = state
            .contact
            .as_ref()
            .map_or(0, |memory| memory.coupled.len());
        (coupled > through.contacts().len() + 2).then_some(state)
    });
    let mut restored = Simulation::new(&scene, &fixed(2e-3)).unwrap();
    restored.restore(state.expect("contacts open")).unwrap();
    for _ in 0..10 {
        through.advance(1.0).unwrap();
        restored.advance(1.0).unwrap();
        assert_eq!(through.positions(), restored.positions());
    }
}

#[test]
fn rods_that_touch_at_the_start_are_named() {
    let error = |gap: f64| Simulation::new(&crossing(BARRIER, gap, 0.0), &fixed(1e-3)).err();
    // The barrier begins 0.005 δ outside the surfaces.
    let standoff = 0.005 * TOLERANCE;
    assert!(error(1.001 * standoff).is_none());
    let SimulationError::BadScene(message) = error(0.999 * standoff).unwrap() else {
        panic!("not a bad scene");
    };
    let message = message.to_string();
    assert!(
        message.starts_with("edge 5 of rod `lower` and edge 4 of rod `upper` touch"),
        "{message}"
    );
}

#[test]
fn a_clamp_driven_through_a_held_rod_ends_the_run() {
    let mut scene = crossing(BARRIER, 0.01, 0.0);
    scene.rods[0].held = true;
    scene.clamps = (0..=10)
        .map(|node| {
            let mut clamp = clamp(1, node);
            clamp.motion.translation = vec![(0.0, Vector3::zeros()), (1.0, Vector3::z() * -0.1)];
            clamp
        })
        .collect();
    let mut simulation = Simulation::new(&scene, &fixed(1e-2)).unwrap();
    let error = loop {
        match simulation.advance(1.0) {
            Ok(_) => assert!(simulation.minimum_distance() > DIAMETER),
            Err(error) => break error,
        }
    };
    assert!(
        error.to_string().contains("passes through a contact"),
        "{error}"
    );
    assert!((simulation.time() - 0.1).abs() < 1e-3);
}

#[test]
fn a_clamp_pushes_a_free_rod_along() {
    let mut scene = crossing(BARRIER, 0.01, 0.0);
    let drive = vec![(0.0, Vector3::zeros()), (1.0, Vector3::z() * 0.2)];
    for clamp in &mut scene.clamps {
        clamp.motion.translation = drive.clone();
    }
    for step in [1e-3, 5e-2] {
        let mut simulation = Simulation::new(&scene, &fixed(step)).unwrap();
        while simulation.time() < 1.0 {
            simulation.advance(1.0).unwrap();
            assert!(simulation.minimum_distance() > DIAMETER);
        }
        let height = |rod: usize| simulation.positions()[11 * rod + 5].z;
        assert!(height(1) > height(0) + 0.99 * DIAMETER && height(0) > 0.15);
    }
}

#[test]
fn a_rod_falls_on_a_floor_and_stays_above_it() {
    for scheme in [Scheme::ImplicitEuler, Scheme::ImplicitMidpoint] {
        let scene = Scene {
            rods: vec![rod("rod", Vector3::z() * 0.02, Vector3::x())],
            planes: vec![ground()],
            loads: vec![gravity(9.81)],
            contact: Some(parameters(BARRIER, 0.2)),
            ..Scene::default()
        };
        let parameters = IntegrationParameters {
            scheme,
            ..fixed(1e-3)
        };
        let mut simulation = Simulation::new(&scene, &parameters).unwrap();
        let mut touched = 0;
        while simulation.time() < 0.2 {
            touched += simulation.advance(0.2).unwrap().contacts;
            let lowest = simulation.positions().iter().map(|x| x.z);
            assert!(lowest.fold(f64::INFINITY, f64::min) > RADIUS);
        }
        assert!(touched > 0);
    }
}
