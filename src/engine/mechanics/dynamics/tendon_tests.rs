//! Tendons: backbones that they bend and twist, blocks, winches.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::scene::{
    CoulombFriction, Eyelet, Pull, RodDescription, Scene, Start, Tendon,
};
use crate::mechanics::test_support::{
    MODELS, assert_close, assert_close_in, at, at_rest, body, clamp, contact, drag, fixed_steps,
    free_rods, gravity, moved, resumed, run, run_with, section, short_path, straight_rod,
};
use std::f64::consts::{PI, TAU};

const LENGTH: f64 = 0.3;
const BENDING: f64 = 0.01;
const TWISTING: f64 = 8e-3;
/// Distance of tendons from the backbone, m.
const OFFSET: f64 = 0.01;

fn tendon(eyelets: Vec<Eyelet>, pull: Pull) -> Tendon {
    Tendon {
        name: "tendon".into(),
        eyelets,
        pull,
        friction: None,
    }
}

fn tension(force: f64) -> Pull {
    Pull::Tension(vec![(0.0, force)])
}

fn stretching(stiffness: f64, rest_length: f64) -> Pull {
    Pull::Stretching {
        stiffness,
        rest_length: Some(rest_length),
        taken_in: Vec::new(),
    }
}

/// A backbone along x with its first director along y. A tendon runs from the wall through eyelets
/// at all nodes, and turns around the backbone at a rate, rad/m.
fn backbone(edges: usize, turning: f64, pull: Pull) -> Scene {
    let rod = RodDescription {
        stiffness: section(1e8, [BENDING; 2], TWISTING),
        ..straight_rod(edges, LENGTH)
    };
    let offset = |node: usize| {
        let angle = turning * LENGTH * node as f64 / edges as f64;
        [OFFSET * libm::cos(angle), OFFSET * libm::sin(angle)]
    };
    let on_rod = (1..=edges).map(|node| Eyelet::OnRod {
        at: at(0, node),
        offset: offset(node),
    });
    let wall = Eyelet::Fixed(Vector3::y() * OFFSET);
    Scene {
        rods: vec![rod],
        clamps: vec![clamp(0, 0)],
        tendons: vec![tendon([wall].into_iter().chain(on_rod).collect(), pull)],
        ..Scene::default()
    }
}

/// The rod's force and the tendon's balance each other, so that the moment T d bends the backbone
/// to a circle however large T is: κ = T d/EI.
#[test]
fn a_tendon_beside_a_backbone_bends_it_to_an_arc() {
    let force = 5.0;
    let curvature = force * OFFSET / BENDING;
    let exact = Vector3::new(
        libm::sin(curvature * LENGTH) / curvature,
        (1.0 - libm::cos(curvature * LENGTH)) / curvature,
        0.0,
    );
    let tip = |edges: usize, pull: Pull| {
        let simulation = at_rest(&backbone(edges, 0.0, pull));
        assert_close(simulation.tendon_tension(0), force, 1e-6);
        simulation.positions()[edges]
    };
    let [coarse, fine] = [20, 40].map(|edges| tip(edges, tension(force)));
    let error = |tip: Vector3| (tip - exact).norm() / LENGTH;
    assert!(error(fine) < 1e-3, "{:e}", error(fine));
    let extrapolated = error((fine * 4.0 - coarse) / 3.0);
    assert!(extrapolated < 4e-5, "{extrapolated:e}");

    // A tendon that stretches gives the same where its tension is the same.
    let simulation = at_rest(&backbone(40, 0.0, tension(force)));
    let rest_length = simulation.tendon_length(0) / (1.0 + force / 400.0);
    let stretched = tip(40, stretching(400.0, rest_length));
    assert!(
        (stretched - fine).norm() < 1e-8 * LENGTH,
        "{stretched} {fine}"
    );
}

/// In a backbone without weight each piece takes the strains of least energy by itself. For a
/// tendon that turns at the rate α, in the frame that turns with it, with the curvature k towards
/// the tendon and the twist τ,
///
/// w = ½ EI k² + ½ GJ τ² + T √((1 − d k)² + d² (τ + α)²).
#[test]
fn a_helical_tendon_bends_and_twists_a_backbone_as_in_theory() {
    let (force, turning) = (5.0, TAU / LENGTH);
    let (mut bent, mut twisted) = (0.0, 0.0);
    for _ in 0..200 {
        let along = 1.0 - OFFSET * bent;
        let around = OFFSET * (twisted + turning);
        let stretch = libm::hypot(along, around);
        bent = force * OFFSET * along / (stretch * BENDING);
        twisted = -force * OFFSET * around / (stretch * TWISTING);
    }
    let found = |edges: usize| {
        let simulation = at_rest(&backbone(edges, turning, tension(force)));
        let middle = simulation.resultants()[edges / 2].expect("two edges");
        [middle.curvature, middle.twist]
    };
    let (coarse, fine) = (found(40), found(80));
    for (k, exact) in [bent, twisted].into_iter().enumerate() {
        assert_close(fine[k], exact, 1.5e-3);
        assert_close((4.0 * fine[k] - coarse[k]) / 3.0, exact, 1e-5);
    }
}

const GRAVITY: f64 = 9.81;

/// Masses (kg) that hang from ropes, each at the start of a light rod below a point.
fn weights(points: &[Vector3], masses: &[f64], tendon: Tendon) -> Scene {
    let rod = |point: &Vector3| RodDescription {
        mass_per_length: 1e-3,
        end_tangents: [None; 2],
        first_director: None,
        centreline: (0..3)
            .map(|k| point - Vector3::z() * (0.01 * f64::from(k)))
            .collect(),
        ..straight_rod(2, 0.02)
    };
    let bodies = masses.iter().enumerate();
    Scene {
        rods: points.iter().map(rod).collect(),
        bodies: bodies
            .map(|(rod, mass)| body("weight", at(rod, 0), mass - 2e-5, None))
            .collect(),
        loads: vec![gravity(GRAVITY)],
        tendons: vec![tendon],
        ..Scene::default()
    }
}

fn on_rod(rod: usize) -> Eyelet {
    Eyelet::OnRod {
        at: at(rod, 0),
        offset: [0.0; 2],
    }
}

/// A rope over two fixed pulleys: a = g (m₁ − m₂)/(m₁ + m₂). A rope that carries the first mass by
/// a movable pulley: a₁ = g (m₁ − 2 m₂)/(m₁ + 4 m₂), a₂ = 2 a₁.
#[test]
fn weights_on_blocks_and_tackle_accelerate_as_in_theory() {
    let stiffness = 1e4;
    let [one, two] = [0.3, 0.1];
    let [left, right] = [Vector3::zeros(), Vector3::x()];
    let places = [left, right].map(|point| point - Vector3::z());
    let fixed = [left, right].map(Eyelet::Fixed);
    let over_two = vec![on_rod(0), fixed[0], fixed[1], on_rod(1)];
    let movable = vec![fixed[0], on_rod(0), fixed[0], fixed[1], on_rod(1)];
    for (eyelets, parts, sign) in [(over_two, 1.0, 1.0), (movable, 2.0, 1.0)] {
        let down = GRAVITY * (one - parts * two) / (one + parts * parts * two);
        let force = two * (GRAVITY + parts * down);
        let length = if parts == 1.0 { 3.0 } else { 4.0 };
        let rope = tendon(
            eyelets,
            stretching(stiffness, length / (1.0 + force / stiffness)),
        );
        let scene = weights(&places, &[one, two], rope);
        let end = 0.3;
        for (scheme, bound) in [
            (Scheme::BackwardDifferences, 1e-6),
            (Scheme::ImplicitMidpoint, 1e-6),
            (Scheme::ImplicitEuler, 1e-6),
        ] {
            let simulation = run(&scene, scheme, 1e-3, end);
            let speeds = [0, 3].map(|node| simulation.velocities()[node].z);
            assert_close_in((parts, scheme), speeds[0], -sign * down * end, bound);
            assert_close_in((parts, scheme), speeds[1], sign * parts * down * end, bound);
            assert_close(simulation.tendon_tension(0), force, 1e-5);
            assert_close(simulation.tendon_length(0), length, 1e-9);
        }
    }
}

/// Taking in rope over a fixed pulley lifts a weight by the same length, with all contact models.
#[test]
fn a_winch_lifts_a_weight_by_the_length_it_takes_in() {
    let (mass, stiffness, taken) = (0.2, 1e3, 0.25);
    let pull = Pull::Stretching {
        stiffness,
        rest_length: Some(2.0),
        taken_in: vec![(0.0, 0.0), (1.0, taken)],
    };
    let fixed = [Vector3::x(), Vector3::zeros()].map(Eyelet::Fixed);
    let rope = tendon(vec![fixed[0], fixed[1], on_rod(0)], pull);
    for model in MODELS {
        let mut scene = weights(&[-Vector3::z()], &[mass], rope.clone());
        scene.contact = Some(contact(model, 1e-4));
        let parameters = fixed_steps(Scheme::ImplicitEuler, 0.02);
        let simulation = run_with(&scene, &parameters, 6.0);
        let force = mass * GRAVITY;
        let stretched = (2.0 - taken) * (1.0 + force / stiffness);
        assert_close(simulation.tendon_tension(0), force, 1e-5);
        assert_close(-simulation.positions()[0].z, stretched - 1.0, 1e-6);

        let half_way = run_with(&scene, &parameters, 0.5);
        let mut again = resumed(&scene, &parameters, &half_way);
        let mut on = half_way;
        while on.time() < 0.8 {
            on.advance(0.8).unwrap();
            again.advance(0.8).unwrap();
        }
        assert_eq!(on.positions(), again.positions());
    }
}

/// A weight on a rope over a bollard, by which it turns by a quarter of a turn: it moves with
/// a = T e^(∓μφ)/m − g, and rests in between.
#[test]
fn a_rope_over_a_bollard_holds_more_than_its_pull() {
    let (mass, friction) = (0.2, 0.3);
    let fixed = [Vector3::x(), Vector3::zeros()].map(Eyelet::Fixed);
    let moved = |force: f64, end: f64| {
        let mut rope = tendon(vec![fixed[0], fixed[1], on_rod(0)], tension(force));
        rope.friction = Some(CoulombFriction {
            coefficient: friction,
            presliding: Some(1e-6),
        });
        let scene = weights(&[-Vector3::z()], &[mass], rope);
        let parameters = fixed_steps(Scheme::ImplicitEuler, 1e-3);
        let simulation = run_with(&scene, &parameters, end);
        let half_way = run_with(&scene, &parameters, 0.5 * end);
        let mut again = resumed(&scene, &parameters, &half_way);
        while again.time() < end {
            again.advance(end).unwrap();
        }
        let mut on = half_way;
        while on.time() < end {
            on.advance(end).unwrap();
        }
        assert_eq!(on.positions(), again.positions());
        simulation
    };
    let weight = mass * GRAVITY;
    let held = libm::exp(friction * std::f64::consts::FRAC_PI_2);
    for (force, ratio) in [
        (1.5 * held * weight, 1.0 / held),
        (0.5 * weight / held, held),
    ] {
        let end = 0.2;
        let simulation = moved(force, end);
        // What moves before it slides is less than the presliding length.
        let speed = (force * ratio / mass - GRAVITY) * end;
        assert_close(simulation.velocities()[0].z, speed, 5e-3);
        assert_close(simulation.tendon_end_tension(0), force * ratio, 5e-4);
    }
    for force in [0.9 * held * weight, weight, 1.1 * weight / held] {
        let simulation = moved(force, 1.0);
        let off = simulation.positions()[0].z + 1.0;
        assert!(off.abs() < 2e-4, "{force}: {off}");
    }
}

/// A weight on a movable pulley, around which a rope that stretches turns by half a turn: the part
/// that a winch takes in carries W/(1 + e^(−μπ)) as it rises and W/(1 + e^(μπ)) as it sinks; the
/// rest carries the remainder.
#[test]
fn a_winch_that_lifts_by_a_pulley_with_friction_carries_more_than_half() {
    let (mass, friction, stiffness) = (0.2, 0.15, 500.0);
    let weight = mass * GRAVITY;
    let part = 1.0 / (1.0 + libm::exp(-friction * PI));
    for (rate, carried) in [(0.02, part), (-0.02, 1.0 - part), (0.0, 0.5)] {
        let fixed = Eyelet::Fixed(Vector3::zeros());
        let rest_length = 2.0 / (1.0 + 0.5 * weight / stiffness);
        let mut rope = tendon(
            vec![fixed, on_rod(0), fixed],
            Pull::Stretching {
                stiffness,
                rest_length: Some(rest_length),
                taken_in: vec![(0.0, 0.0), (2.0, 2.0 * rate)],
            },
        );
        rope.friction = Some(CoulombFriction {
            coefficient: friction,
            presliding: Some(1e-5),
        });
        let scene = weights(&[-Vector3::z()], &[mass], rope);
        let simulation = run_with(&scene, &fixed_steps(Scheme::ImplicitEuler, 2e-3), 2.0);
        let [first, last] = [
            simulation.tendon_tension(0),
            simulation.tendon_end_tension(0),
        ];
        assert_close(first, carried * weight, 1e-3);
        assert_close(first + last, weight, 1e-3);
        // The weight moves by half of what the winch takes in.
        let risen = simulation.positions()[0].z + 1.0;
        let stretch = 0.5 * weight / stiffness * rest_length;
        assert!((risen - rate).abs() < 0.1 * stretch, "{rate}: {risen}");
    }
}

/// Without friction both laws of a tendon that stretches agree, taut and slack.
#[test]
fn a_tendon_that_stretches_with_little_friction_is_as_without() {
    let ended = |coefficient: Option<f64>| {
        let mut scene = backbone(6, 0.4, stretching(400.0, 0.9 * LENGTH));
        scene.loads = vec![drag(None, 0.5, 1e-4)];
        scene.tendons[0].friction = coefficient.map(|coefficient| CoulombFriction {
            coefficient,
            presliding: None,
        });
        let simulation = run(&scene, Scheme::BackwardDifferences, 1e-3, 0.05);
        (
            simulation.positions().to_vec(),
            simulation.energies().total(),
        )
    };
    let [(free, energy), (rubbing, other)] = [None, Some(1e-9)].map(ended);
    let pairs = free.iter().zip(&rubbing);
    let apart = pairs
        .map(|(one, other)| (one - other).norm())
        .fold(0.0, f64::max);
    assert!(apart < 1e-8, "{apart:e}");
    assert_close(energy, other, 1e-6);
}

/// Along a backbone T' = −μ κ T and κ = T d/EI, so that κ = κ₀/(1 + μ κ₀ s), a logarithmic spiral:
/// the tip turns by ln(1 + μ κ₀ L)/μ. When the tension falls again, the backbone stays bent.
#[test]
fn friction_leaves_a_backbone_less_bent_and_keeps_it_bent() {
    let (force, friction) = (5.0, 0.3);
    let curvature = force * OFFSET / BENDING;
    let tip = |course: Vec<(f64, f64)>, edges: usize, end: f64| {
        let mut scene = backbone(edges, 0.0, Pull::Tension(course));
        scene.tendons[0].friction = Some(CoulombFriction {
            coefficient: friction,
            presliding: Some(1e-5),
        });
        scene.loads = vec![drag(None, 0.5, 1e-4)];
        let simulation = run_with(&scene, &fixed_steps(Scheme::ImplicitEuler, 0.25), end);
        let nodes = simulation.positions();
        let last = nodes[edges] - nodes[edges - 1];
        libm::atan2(last.y, last.x)
    };
    // So slowly that the drag hardly delays it.
    let pulled = vec![(0.0, 0.0), (20.0, force)];
    let [coarse, fine] = [10, 20].map(|edges| tip(pulled.clone(), edges, 20.0));
    // The tip is that of the last vertex, half an edge before the end.
    let turned = |length: f64| libm::log1p(friction * curvature * length) / friction;
    assert_close(fine, turned(LENGTH * 19.5 / 20.0), 1e-2);
    assert_close(coarse, turned(LENGTH * 9.5 / 10.0), 2e-2);
    let halved = [&pulled[..], &[(40.0, 0.5 * force)]].concat();
    let kept = tip(halved, 20, 40.0);
    let without = 0.5 * curvature * LENGTH * 19.5 / 20.0;
    assert!(
        kept > 1.05 * without && kept < fine,
        "{kept} {without} {fine}"
    );
}

/// Two free rods in a plane, without twist, that a stretched tendon pulls together.
#[test]
fn tendons_between_free_rods_conserve_momenta() {
    let across = RodDescription {
        centreline: (0..5)
            .map(|k| Vector3::new(0.3, 0.05 * f64::from(k), 0.0))
            .collect(),
        first_director: Some(Vector3::z()),
        ..straight_rod(4, 0.2)
    };
    let rods = vec![straight_rod(4, 0.2), moved(across, Vector3::y() * 0.1)];
    let eyelets = [at(0, 0), at(1, 1), at(0, 4), at(1, 4)];
    let eyelets = eyelets.map(|at| Eyelet::OnRod {
        at,
        offset: [0.0; 2],
    });
    let mut scene = free_rods(rods);
    scene.tendons = vec![tendon(eyelets.into(), stretching(2.0, 0.5))];
    let simulation = run(&scene, Scheme::ImplicitMidpoint, 2e-4, 0.05);
    let [momentum, turning] = simulation.momenta();
    let speed = simulation
        .velocities()
        .iter()
        .map(|v| v.norm())
        .fold(0.0, f64::max);
    assert!(speed > 0.1, "{speed}");
    let mass = 2.0 * 0.2 * straight_rod(4, 0.2).mass_per_length;
    assert!(momentum.norm() < 1e-9 * mass * speed, "{momentum}");
    assert!(turning.norm() < 1e-9 * mass * speed * 0.2, "{turning}");
}

#[test]
fn friction_of_tendons_is_refused_where_it_is_not_determined() {
    let mut scene = backbone(4, 0.0, tension(1.0));
    let law = CoulombFriction {
        coefficient: 0.1,
        presliding: Some(1e-5),
    };
    scene.tendons[0].friction = Some(law);
    let parameters = IntegrationParameters::default();
    let mut simulation = Simulation::new(&scene, &parameters).unwrap();
    let error = simulation.find_equilibrium().unwrap_err().to_string();
    assert!(error.contains("friction of tendons"), "{error}");
}

#[test]
fn tendons_that_stretch_are_refused_where_their_slack_or_rest_length_is_unclear() {
    let scene = |pull: Pull| backbone(4, 0.0, pull);
    let as_placed = Pull::Stretching {
        stiffness: 100.0,
        rest_length: None,
        taken_in: Vec::new(),
    };
    let parameters = IntegrationParameters::default();
    let refusal = |scene: &Scene| Simulation::new(scene, &parameters).map(drop).unwrap_err();
    let started = |pull: Pull| {
        let rod = &scene(pull.clone()).rods[0];
        let start = Start {
            positions: rod.centreline.clone(),
            directors: vec![Vector3::y(); 5],
            twist: vec![0.0; 5],
            walls: vec![Some([Vector3::x(), Vector3::y()]), None, None, None, None],
            ..Start::default()
        };
        Scene {
            start: Some(start),
            ..scene(pull)
        }
    };
    let error = refusal(&started(as_placed)).to_string();
    assert!(error.contains("needs the rest length"), "{error}");
    assert!(Simulation::new(&started(tension(1.0)), &parameters).is_ok());

    let path = |pull: Pull| {
        let simulation = Simulation::new(&scene(pull), &parameters).unwrap();
        simulation.path(short_path()).map(drop)
    };
    let error = path(stretching(100.0, 0.3)).unwrap_err();
    assert!(
        error.to_string().contains("tendons that stretch"),
        "{error}"
    );
    assert!(path(tension(1.0)).is_ok());
}
