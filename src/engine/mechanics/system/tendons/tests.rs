//! Forces and Jacobians of tendons against differences.

use crate::mechanics::Vector3;
use crate::mechanics::scene::{CoulombFriction, Eyelet, Pull, RodDescription, Scene, Tendon};
use crate::mechanics::system::System;
use crate::mechanics::test_support::{at, clamp, section};

fn eyelet(rod: usize, node: usize, offset: [f64; 2]) -> Eyelet {
    Eyelet::OnRod {
        at: at(rod, node),
        offset,
    }
}

/// A twisted arc, clamped at its start, and a free ring, with a tendon through both.
fn scene(pull: Pull) -> Scene {
    let of_arc = |k: i32| {
        let angle = 0.3 * f64::from(k);
        Vector3::new(libm::sin(angle), 1.0 - libm::cos(angle), 0.1 * f64::from(k))
    };
    let of_ring = |k: i32| {
        let angle = 1.1 * f64::from(k);
        Vector3::new(libm::cos(angle), 3.0 + libm::sin(angle), 0.2)
    };
    let stiffness = section(30.0, [1.0, 2.0], 1.5);
    let rod = |name: &str, centreline: Vec<Vector3>| {
        RodDescription::uniform(name, centreline, stiffness, 0.01, 1.0)
    };
    let eyelets = vec![
        Eyelet::Fixed(Vector3::new(0.2, -0.3, 0.5)),
        eyelet(0, 1, [0.2, 0.1]),
        eyelet(0, 2, [0.15, -0.2]),
        eyelet(0, 4, [-0.1, 0.2]),
        eyelet(1, 0, [0.1, 0.1]),
        eyelet(1, 3, [0.0, 0.0]),
    ];
    Scene {
        rods: vec![
            RodDescription {
                twist: 0.8,
                ..rod("arc", (0..5).map(of_arc).collect())
            },
            RodDescription {
                closed: true,
                ..rod("ring", (0..5).map(of_ring).collect())
            },
        ],
        clamps: vec![clamp(0, 0)],
        tendons: vec![
            Tendon {
                name: "long".into(),
                eyelets,
                pull,
                friction: None,
            },
            Tendon {
                name: "short".into(),
                eyelets: vec![eyelet(0, 3, [0.1, 0.0]), eyelet(1, 2, [0.0, 0.0])],
                pull: Pull::Tension(vec![(0.0, 0.7)]),
                friction: None,
            },
        ],
        ..Scene::default()
    }
}

fn stretching() -> Pull {
    Pull::Stretching {
        stiffness: 3.0,
        rest_length: Some(4.0),
        taken_in: vec![(0.0, 0.1)],
    }
}

#[test]
fn forces_and_jacobians_of_tendons_are_derivatives_of_their_energy() {
    for pull in [Pull::Tension(vec![(0.0, 1.3)]), stretching()] {
        let mut system = System::new(&scene(pull.clone())).unwrap();
        // Away from the reference frames, where parallel transport has a holonomy.
        let mut unknowns = system.assembly.unknowns.clone();
        for (k, unknown) in unknowns.iter_mut().enumerate() {
            if !system.assembly.held[k] {
                *unknown += 0.05 * libm::sin(1.7 * k as f64);
            }
        }
        system.linearize(&unknowns, None);
        assert!(system.is_symmetric());
        assert!(system.tendon_tensions(0)[0] > 0.5, "{pull:?}");
        let (residual, jacobian) = (system.residual.clone(), system.dense_matrix());
        let step = 1e-5;
        let free: Vec<usize> = (0..unknowns.len())
            .filter(|&k| !system.assembly.held[k])
            .collect();
        let mut at = |k: usize, by: f64| {
            let mut moved = unknowns.clone();
            moved[k] += by;
            system.evaluate(&moved, None);
            (system.potential(&moved), system.residual.clone())
        };
        for &column in &free {
            let ((above, forces_above), (below, forces_below)) =
                (at(column, step), at(column, -step));
            let slope = (above - below) / (2.0 * step);
            let missed = (slope - residual[column]).abs();
            assert!(
                missed < 1e-7 * (1.0 + slope.abs()),
                "{pull:?} {column}: {missed:e}"
            );
            for &row in &free {
                let slope = (forces_above[row] - forces_below[row]) / (2.0 * step);
                let missed = (slope - jacobian[(row, column)]).abs();
                assert!(
                    missed < 1e-7 * (1.0 + slope.abs()),
                    "{pull:?} {row} {column}: {missed:e}, {slope}"
                );
            }
        }
    }
}

/// With friction the tension depends on angles and on what slides, so that no energy exists.
#[test]
fn jacobians_of_tendons_with_friction_are_derivatives_of_their_forces() {
    let stretching = |rest_length: f64| Pull::Stretching {
        stiffness: 10.0,
        rest_length: Some(rest_length),
        taken_in: Vec::new(),
    };
    let pulls = [Pull::Tension(vec![(0.0, 1.3)]), stretching(4.0)];
    for (pull, presliding) in pulls.iter().flat_map(|pull| [(pull, 10.0), (pull, 0.05)]) {
        let mut scene = scene(pull.clone());
        scene.tendons[0].friction = Some(CoulombFriction {
            coefficient: 0.4,
            presliding: Some(presliding),
        });
        let mut system = System::new(&scene).unwrap();
        let mut unknowns = system.assembly.unknowns.clone();
        for (k, unknown) in unknowns.iter_mut().enumerate() {
            if !system.assembly.held[k] {
                *unknown += 0.05 * libm::sin(1.7 * k as f64);
            }
        }
        system.linearize(&unknowns, None);
        assert!(!system.is_symmetric());
        let [first, last] = system.tendon_tensions(0);
        assert!((last - first).abs() > 0.01, "{first} {last}");
        assert!(pull.stretches() || first == 1.3, "{first}");
        let stretched = system.tendon_length(0) / 4.0;
        assert!(!pull.stretches() || stretched > 1.05, "{stretched}");
        let jacobian = system.dense_matrix();
        let step = 1e-6;
        let held = system.assembly.held.clone();
        let free: Vec<usize> = (0..unknowns.len()).filter(|&k| !held[k]).collect();
        let mut at = |k: usize, by: f64| {
            let mut moved = unknowns.clone();
            moved[k] += by;
            system.evaluate(&moved, None);
            system.residual.clone()
        };
        for &column in &free {
            let (above, below) = (at(column, step), at(column, -step));
            for &row in &free {
                let slope = (above[row] - below[row]) / (2.0 * step);
                let missed = (slope - jacobian[(row, column)]).abs();
                assert!(
                    missed < 1e-6 * (1.0 + slope.abs()),
                    "{presliding} {row} {column}: {missed:e}, {slope}"
                );
            }
        }
    }
}

#[test]
fn a_slack_tendon_exerts_no_force() {
    let pull = Pull::Stretching {
        stiffness: 3.0,
        rest_length: Some(100.0),
        taken_in: Vec::new(),
    };
    let mut without = scene(pull.clone());
    without.tendons.remove(0);
    let [with, without] = [&scene(pull), &without].map(|scene| {
        let mut system = System::new(scene).unwrap();
        let unknowns = system.assembly.unknowns.clone();
        system.linearize(&unknowns, None);
        (system.residual.clone(), system.dense_matrix())
    });
    assert_eq!(with, without);
}

#[test]
fn tendons_without_two_eyelets_on_the_scene_or_without_length_are_refused() {
    let faulty = |eyelets: Vec<Eyelet>| {
        let mut scene = scene(stretching());
        scene.tendons[0].eyelets = eyelets;
        scene
    };
    let shortened = Pull::Stretching {
        stiffness: 3.0,
        rest_length: None,
        taken_in: vec![(0.0, 0.0), (1.0, 100.0)],
    };
    for scene in [
        faulty(vec![eyelet(0, 1, [0.0, 0.0])]),
        faulty(vec![eyelet(0, 1, [0.0, 0.0]), eyelet(0, 9, [0.0, 0.0])]),
        faulty(vec![eyelet(2, 0, [0.0, 0.0]), eyelet(0, 0, [0.0, 0.0])]),
        scene(shortened),
    ] {
        let error = System::new(&scene).map(drop).unwrap_err().to_string();
        assert!(error.contains("tendon `long`"), "{error}");
    }
}
