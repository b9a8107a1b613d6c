//! Impacts and spurious energy: restitution never exceeds 1, and a run with an enormous gain of
//! energy ends.

use super::free_body_tests::cuboid;
use super::*;
use crate::mechanics::contact::{ContactModel, ContactParameters};
use crate::mechanics::rigid_body::RigidBody;
use crate::mechanics::scene::{FreeBody, RodDescription, Scene, Stiffness};
use crate::mechanics::test_support::{
    SOFT_MODELS, advance_to, contact, fixed_steps, gravity, ground, pin, section, straight_rod,
};
use crate::mechanics::{UnitQuaternion, Vector3};

/// A soft, tilted rod that falls by about 5 cm on a smooth plane.
fn falling(model: ContactModel) -> Scene {
    let rod = RodDescription {
        centreline: (0..=10)
            .map(|k| Vector3::new(4e-3 * f64::from(k), 0.0, 0.05 + 1e-3 * f64::from(k)))
            .collect(),
        radius: 1.2e-3,
        ..straight_rod(10, 0.04)
    };
    Scene {
        rods: vec![rod],
        loads: vec![gravity(9.81)],
        planes: vec![ground()],
        contact: Some(ContactParameters {
            stiffness_factor: if model == ContactModel::ImplicitContact {
                1e5
            } else {
                1.0
            },
            ..contact(model, 2e-4)
        }),
        ..Scene::default()
    }
}

#[test]
fn a_rod_that_bounces_never_has_more_energy_than_it_fell_with() {
    for model in SOFT_MODELS {
        for step in [2e-4, 1e-3, 2e-3] {
            let parameters = fixed_steps(Scheme::ImplicitMidpoint, step);
            let mut simulation = Simulation::new(&falling(model), &parameters).unwrap();
            let start = simulation.energies().total();
            let (mut fastest, mut least) = (0.0_f64, f64::INFINITY);
            while simulation.time() < 0.4 {
                simulation.advance(0.4).unwrap();
                let now = simulation.energies();
                fastest = fastest.max(now.kinetic);
                least = least.min(simulation.positions()[0].z);
                let gained = now.total() - start;
                assert!(
                    gained < 1e-2 * fastest,
                    "{model:?}, steps of {step} s: {gained} J at {} s",
                    simulation.time()
                );
            }
            assert!(least < 1.5e-3, "it came down");
            let remarks = simulation.remarks();
            assert!(
                remarks.iter().all(|text| !text.contains("gained")),
                "{remarks:?}"
            );
        }
    }
}

#[test]
fn a_free_flight_of_the_midpoint_rule_keeps_its_energy_beside_a_plane() {
    let mut scene = falling(ContactModel::ImplicitContact);
    scene.planes[0].point = Vector3::z() * -10.0;
    let parameters = fixed_steps(Scheme::ImplicitMidpoint, 1e-3);
    let mut simulation = Simulation::new(&scene, &parameters).unwrap();
    let start = simulation.energies().total();
    advance_to(&mut simulation, 0.3);
    let now = simulation.energies();
    assert!((now.total() - start).abs() < 1e-9 * now.kinetic);
}

/// A bent strip that falls from its end like a folded chain. The steps of the midpoint rule do not
/// resolve its stretching.
#[test]
fn a_run_that_gains_more_energy_than_it_had_ends() {
    let centreline = (0..=20).map(|k| {
        let angle = 0.15 * f64::from(k);
        Vector3::new(1.0 - libm::cos(angle), 0.0, -libm::sin(angle)) * 0.05
    });
    let rod = RodDescription {
        centreline: centreline.collect(),
        stiffness: section(3000.0, [8e-4; 2], 6e-4),
        radius: 1e-3,
        mass_per_length: 3e-3,
        ..straight_rod(20, 0.2)
    };
    let scene = Scene {
        rods: vec![rod],
        clamps: vec![pin(0, 0)],
        loads: vec![gravity(9.81)],
        ..Scene::default()
    };
    let run = |scheme| {
        let parameters = fixed_steps(scheme, 5e-3);
        let mut simulation = Simulation::new(&scene, &parameters).unwrap();
        while simulation.time() < 2.0 {
            simulation.advance(2.0)?;
        }
        Ok::<_, SimulationError>(simulation.remarks())
    };
    let error = run(Scheme::ImplicitMidpoint).unwrap_err();
    let text = error.to_string();
    assert!(matches!(error, SimulationError::Unphysical(_)), "{text}");
    assert!(text.contains("spurious energy"), "{text}");
    for scheme in [Scheme::ImplicitEuler, Scheme::BackwardDifferences] {
        let remarks = run(scheme).unwrap();
        assert!(
            remarks.iter().all(|text| !text.contains("gained")),
            "{remarks:?}"
        );
    }
}

/// Two soft rings that collide at 1000 m/s: the contacts reported for a step are those at its end.
#[test]
fn surfaces_reported_after_an_impact_overlap_by_no_more_than_is_allowed() {
    let ring = |centre: Vector3, across: Vector3, velocity: Vector3| {
        let nodes = (0..24).map(|k| {
            let angle = std::f64::consts::TAU * f64::from(k) / 24.0;
            centre + (Vector3::x() * libm::cos(angle) + across * libm::sin(angle)) * 0.05
        });
        let (young, radius) = (1e6, 2e-3);
        let area = std::f64::consts::PI * radius * radius;
        RodDescription {
            closed: true,
            velocity,
            ..RodDescription::uniform(
                "ring",
                nodes.collect(),
                Stiffness::circular(young, 0.5, radius),
                radius,
                1000.0 * area,
            )
        }
    };
    let scene = Scene {
        rods: vec![
            ring(Vector3::zeros(), Vector3::y(), Vector3::x() * -500.0),
            ring(
                Vector3::x() * 0.05,
                Vector3::z(),
                Vector3::new(500.0, 50.0, 30.0),
            ),
        ],
        contact: Some(ContactParameters {
            distance_tolerance: 2e-5,
            ..ContactParameters::default()
        }),
        ..Scene::default()
    };
    let parameters = fixed_steps(Scheme::BackwardDifferences, 1e-3);
    let mut simulation = Simulation::new(&scene, &parameters).unwrap();
    while simulation.time() < 5e-3 {
        let report = simulation.advance(5e-3).unwrap();
        let reported = report.nearest.map_or(1.0, |nearest| nearest.ratio());
        assert!(reported > 0.95, "{reported} at {} s", report.time);
        let now = simulation.nearest().map_or(1.0, |nearest| nearest.ratio());
        assert!(now > 0.95, "{now} at {} s", report.time);
    }
}

/// A soft rod, flat above a plane, that falls at 0.1 m/s.
fn landing(model: ContactModel) -> Scene {
    let (radius, young): (f64, f64) = (6e-4, 1e6);
    let area = std::f64::consts::PI * radius * radius;
    let rod = RodDescription {
        centreline: (0..=10)
            .map(|k| Vector3::new(5e-3 * f64::from(k), 0.0, 2.0 * radius))
            .collect(),
        stiffness: section(
            young * area,
            [young * area * radius * radius / 4.0; 2],
            young * area * radius * radius / 6.0,
        ),
        radius,
        mass_per_length: 1000.0 * area,
        velocity: Vector3::z() * -0.1,
        ..straight_rod(10, 0.05)
    };
    Scene {
        rods: vec![rod],
        planes: vec![ground()],
        contact: Some(ContactParameters {
            stiffness_factor: match model {
                ContactModel::ImplicitContact => 1e5,
                _ => 1.0,
            },
            ..contact(model, 6e-6)
        }),
        ..Scene::default()
    }
}

/// The rod moves by δ/20 or δ/60 in a step. When the contacts became stiffer in each of these
/// steps, the rod left the plane with up to 240 times its energy.
#[test]
fn steps_that_resolve_an_impact_add_little_energy() {
    for model in SOFT_MODELS {
        for scheme in [Scheme::ImplicitEuler, Scheme::BackwardDifferences] {
            for step in [3e-6, 1e-6] {
                let parameters = fixed_steps(scheme, step);
                let mut simulation = Simulation::new(&landing(model), &parameters).unwrap();
                let start = simulation.energies().total();
                let mut least = f64::INFINITY;
                while simulation.time() < 6.5e-3 {
                    simulation.advance(6.5e-3).unwrap();
                    least = least.min(simulation.positions()[5].z);
                }
                assert!(least < 6e-4 + 6e-6, "it came down");
                let end = simulation.energies().total() / start;
                assert!(
                    (0.1..1.25).contains(&end),
                    "{model:?}, {scheme:?}, {step} s: {end} of its energy"
                );
            }
        }
    }
}

/// Backward differences extrapolate from the steps before: without a fresh start after the jump, the
/// rod leaves the plane with up to twice its energy, a rod that is hit moves faster than the one
/// that hits it.
#[test]
fn steps_that_do_not_resolve_an_impact_add_no_energy() {
    let struck = |model| {
        let mut scene = landing(model);
        let mut other = scene.rods[0].clone();
        other.name = "other".into();
        let centre = 0.5 * (other.centreline[0] + other.centreline[10]);
        for node in &mut other.centreline {
            let along = *node - centre;
            *node = centre + Vector3::new(0.0, along.x, 2.5e-3);
        }
        scene.rods[0].velocity = Vector3::zeros();
        scene.rods.push(other);
        scene.planes.clear();
        scene
    };
    for model in SOFT_MODELS {
        for step in [1e-5, 3e-5, 1e-4, 3e-4, 1e-3] {
            for (scene, touches) in [(landing(model), 6e-4 + 6e-6), (struck(model), 1.199e-3)] {
                let parameters = fixed_steps(Scheme::BackwardDifferences, step);
                let mut simulation = Simulation::new(&scene, &parameters).unwrap();
                let start = simulation.energies().total();
                let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
                while simulation.time() < 0.03 {
                    simulation.advance(0.03).unwrap();
                    least = least.min(simulation.positions()[5].z);
                    most = most.max(simulation.energies().total() / start);
                }
                assert!(least < touches, "it came down");
                assert!(most < 1.1, "{model:?}, {step} s: {most} of its energy");
            }
        }
    }
}

/// Vertices of a body have no mass of their own: the force that decelerates them is that of the
/// whole body. When their stiffness rose without this force, a ball left the plane with up to 850
/// times its energy.
#[test]
fn bodies_whose_impact_steps_resolve_gain_little_energy() {
    let centre = Vector3::z() * 0.0106;
    let cube = cuboid("box", centre, [0.02; 3]);
    let ball = FreeBody {
        shape: RigidBody::sphere(centre, 0.01),
        ..cube.clone()
    };
    let axes = UnitQuaternion::from_euler_angles(0.5, 0.4, 0.0);
    let higher = Vector3::z() * 0.018;
    let on_corner = FreeBody {
        shape: RigidBody::cuboid(higher, Vector3::repeat(0.02), &axes, 1e-3),
        centre: higher,
        axes,
        ..cube.clone()
    };
    for model in SOFT_MODELS {
        for (body, what) in [(&cube, "box"), (&ball, "ball"), (&on_corner, "corner")] {
            for scheme in [Scheme::ImplicitEuler, Scheme::BackwardDifferences] {
                for step in [3e-6, 1e-5, 1e-4] {
                    let scene = Scene {
                        rods: Vec::new(),
                        free_bodies: vec![FreeBody {
                            velocity: -0.1 * Vector3::z(),
                            ..body.clone()
                        }],
                        ..landing(model)
                    };
                    let parameters = fixed_steps(scheme, step);
                    let mut simulation = Simulation::new(&scene, &parameters).unwrap();
                    let energy = |simulation: &Simulation| {
                        let energies = simulation.energies();
                        energies.kinetic + energies.contact
                    };
                    let start = energy(&simulation);
                    advance_to(&mut simulation, 0.04);
                    let end = energy(&simulation) / start;
                    assert!(
                        (1e-3..1.02).contains(&end),
                        "{what}, {model:?}, {scheme:?}, {step} s: {end} of its energy"
                    );
                }
            }
        }
    }
}
