//! Rods with consistent inertia: accuracy of a swing, conservation, contact, clamps that move and
//! release.

use super::barrier_tests::{DIAMETER, crossing};
use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::scene::{Inertia, RodDescription, Scene};
use crate::mechanics::test_support::{
    MODELS, advance_to, assert_close, assert_close_in, clamp, fixed, free_rods, gravity, run_with,
    straight_rod,
};

fn consistent(rod: RodDescription) -> RodDescription {
    RodDescription {
        inertia: Inertia::Consistent,
        ..rod
    }
}

/// A cantilever of γ = 15.7 released from the horizontal.
fn swinging(edges: usize, inertia: Inertia) -> Scene {
    Scene {
        rods: vec![RodDescription {
            inertia,
            ..straight_rod(edges, 1.0)
        }],
        clamps: vec![clamp(0, 0)],
        loads: vec![gravity(9.81)],
        ..Scene::default()
    }
}

#[test]
fn a_heavy_cantilever_swings_ten_times_nearer_to_its_converged_motion() {
    let tips = |edges: usize, inertia: Inertia| -> Vec<Vector3> {
        let parameters = IntegrationParameters {
            scheme: Scheme::BackwardDifferences,
            ..fixed(1e-3)
        };
        let mut simulation = Simulation::new(&swinging(edges, inertia), &parameters).unwrap();
        let mut tips = Vec::new();
        for tenth in 1..=10 {
            advance_to(&mut simulation, 0.1 * f64::from(tenth));
            tips.push(simulation.positions()[edges]);
        }
        tips
    };
    let converged = tips(120, Inertia::Consistent);
    let error = |inertia: Inertia| {
        let pairs = converged.iter().zip(tips(30, inertia));
        pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
    };
    let (lumped, moving) = (error(Inertia::Lumped), error(Inertia::Consistent));
    println!("{lumped:.2e} m, {moving:.2e} m");
    assert!(moving < 6e-4 && moving < lumped / 10.0, "{moving:e}");
}

#[test]
fn a_heavy_cantilever_hangs_nearer_to_the_elastica() {
    // γ = 15.696; tip of the inextensible elastica (x, drop)/L. The stretch moves it by 3e-5 at most.
    let exact = Vector3::new(0.515_778_977_743_64, 0.0, -0.793_829_887_966_485);
    let error = |inertia: Inertia| {
        let scene = swinging(25, inertia);
        let mut simulation = Simulation::new(&scene, &fixed(1e-3)).unwrap();
        simulation.find_equilibrium().unwrap();
        (simulation.positions()[25] - exact).norm()
    };
    let (lumped, moving) = (error(Inertia::Lumped), error(Inertia::Consistent));
    println!("{lumped:.2e}, {moving:.2e}");
    assert!(moving < 4e-4 && moving < 0.4 * lumped);
}

#[test]
fn the_midpoint_rule_keeps_energy_and_both_momenta() {
    let rod = RodDescription {
        angular_velocity: Vector3::new(0.3, 1.0, 2.0),
        velocity: Vector3::new(0.1, -0.2, 0.05),
        ..consistent(straight_rod(20, 1.0))
    };
    let scene = free_rods(vec![rod]);
    let parameters = IntegrationParameters {
        scheme: Scheme::ImplicitMidpoint,
        force_tolerance: 1e-9,
        displacement_tolerance: 1e-8,
        ..fixed(1e-3)
    };
    let mut simulation = Simulation::new(&scene, &parameters).unwrap();
    let energy = |simulation: &Simulation| {
        let energies = simulation.energies();
        energies.kinetic + energies.elastic()
    };
    let (start, momenta) = (energy(&simulation), simulation.momenta());
    assert_close(
        simulation.energies_of(0).kinetic,
        simulation.energies().kinetic,
        1e-14,
    );
    advance_to(&mut simulation, 0.5);
    assert!((energy(&simulation) / start - 1.0).abs() < 1e-4);
    for (now, before) in simulation.momenta().iter().zip(momenta) {
        assert!((now - before).norm() < 1e-8 * before.norm());
    }
}

#[test]
fn contact_of_every_model_takes_no_momentum() {
    for model in MODELS {
        let mut scene = crossing(model, 0.002, 0.3);
        scene.clamps.clear();
        scene.rods = scene.rods.into_iter().map(consistent).collect();
        scene.rods[1].velocity = Vector3::new(0.3, 0.1, -1.0);
        let mut simulation = Simulation::new(&scene, &fixed(5e-4)).unwrap();
        let energy = |simulation: &Simulation| {
            let energies = simulation.energies();
            energies.kinetic + energies.elastic() + energies.contact
        };
        let (before, start) = (simulation.momenta()[0], energy(&simulation));
        let mut touched = 0;
        while simulation.time() < 0.03 {
            touched += simulation.advance(0.03).unwrap().contacts;
            assert!(simulation.minimum_distance() > 0.95 * DIAMETER, "{model:?}");
            assert!(energy(&simulation) < start * (1.0 + 1e-6), "{model:?}");
        }
        assert!(touched > 0, "{model:?}");
        let change = (simulation.momenta()[0] - before).norm();
        assert!(change < 1e-6 * before.norm(), "{model:?}: {change:e}");
    }
}

#[test]
fn a_clamp_that_jerks_gives_the_momentum_that_the_rod_takes() {
    let mut scene = swinging(20, Inertia::Consistent);
    scene.loads.clear();
    let still = Vector3::zeros();
    scene.clamps[0].motion.translation = vec![(0.01, still), (0.06, Vector3::z() * 0.05)];
    let step = 1e-3;
    let mut simulation = Simulation::new(&scene, &fixed(step)).unwrap();
    let (mut momentum, mut largest) = (Vector3::zeros(), 0.0_f64);
    while simulation.time() < 0.1 {
        let before = simulation.time();
        simulation.advance(0.1).unwrap();
        let taken = simulation.momenta()[0] - momentum;
        momentum += taken;
        let given = simulation.reaction(0) * (simulation.time() - before);
        largest = largest.max(momentum.norm());
        assert!((given - taken).norm() < 1e-6 * largest + 1e-12);
    }
    assert!(largest > 1e-3);
}

#[test]
fn a_short_rod_of_steel_falls() {
    let mut rod = consistent(straight_rod(50, 0.02));
    let factor = 2e11 / 1e8;
    rod.stiffness.stretching *= factor;
    rod.stiffness.bending = rod.stiffness.bending.map(|bending| factor * bending);
    rod.stiffness.twisting *= factor;
    let scene = Scene {
        rods: vec![rod],
        loads: vec![gravity(9.81)],
        ..Scene::default()
    };
    let simulation = run_with(&scene, &fixed(1e-3), 0.1);
    for (node, velocity) in simulation.velocities().iter().enumerate() {
        assert_close_in(node, velocity.z, -0.981, 1e-4);
    }
}

#[test]
fn a_grasp_beside_a_clamp_moves_no_node_and_is_released_without_a_trace() {
    let scene = swinging(20, Inertia::Consistent);
    let mut simulation = Simulation::new(&scene, &fixed(1e-3)).unwrap();
    simulation.find_equilibrium().unwrap();
    let (rest, energies) = (simulation.positions().to_vec(), simulation.energies());
    let apart = |simulation: &Simulation| {
        let pairs = simulation.positions().iter().zip(&rest);
        pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
    };
    for node in [1, 2, 3, 20] {
        let whole = Grasp {
            position: true,
            frame: true,
        };
        let number = simulation.grasp(node, whole).unwrap();
        simulation.find_equilibrium().unwrap();
        let changed = simulation.energies().bending / energies.bending - 1.0;
        assert!(apart(&simulation) < 1e-6 && changed.abs() < 1e-6, "{node}");
        simulation.release(number).unwrap();
        simulation.find_equilibrium().unwrap();
        assert!(apart(&simulation) < 1e-9, "{node}");
    }
}
