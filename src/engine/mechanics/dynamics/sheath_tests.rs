//! Rods that are fed out of sheaths.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::scene::{RodDescription, Scene, Sheath};
use crate::mechanics::test_support::{
    MODELS, advance_to, assert_close, assert_close_in, at_rest, clamp, contact, curved, drag,
    farthest, fixed_steps, gravity, ground, moment_on, point_force, resumed, run_with, section,
    short_path, straight_rod,
};

const BENDING: f64 = 0.01;
const TWISTING: f64 = 8e-3;
/// Length of the rod, and of its part inside, m.
const LENGTH: f64 = 0.6;
const INSIDE: f64 = 0.3;

fn sheath(inside: f64, fed: Vec<(f64, f64)>) -> Sheath {
    Sheath {
        name: "sheath".into(),
        rod: 0,
        from_end: false,
        inside,
        fed,
        pushed: Vec::new(),
        turned: Vec::new(),
    }
}

/// A rod along x with a part in a sheath.
fn fed_rod(edges: usize, sheath: Sheath) -> Scene {
    let rod = RodDescription {
        stiffness: section(1e6, [BENDING; 2], TWISTING),
        ..straight_rod(edges, LENGTH)
    };
    Scene {
        rods: vec![rod],
        sheaths: vec![sheath],
        ..Scene::default()
    }
}

/// A moment M at the end bends the part outside to an arc, and the sheath must hold the rod back by
/// M²/2EI, wherever the mouth is between two nodes.
#[test]
fn a_moment_bends_the_part_outside_to_an_arc_and_pushes_the_rod_out() {
    let moment = 0.05;
    let curvature = moment / BENDING;
    for (inside, fed) in [(0.3, 0.0), (0.295, 0.0), (0.293, 0.011), (0.3, -0.017)] {
        let outside = LENGTH - inside + fed;
        let mouth = Vector3::x() * inside;
        let exact = Vector3::new(
            libm::sin(curvature * outside) / curvature,
            (1.0 - libm::cos(curvature * outside)) / curvature,
            0.0,
        );
        let error = |edges: usize| {
            let mut scene = fed_rod(edges, sheath(inside, vec![(0.0, fed)]));
            scene.loads = vec![moment_on(0, edges - 1, Vector3::z() * moment)];
            let simulation = at_rest(&scene);
            assert_close(simulation.length_outside(0), outside, 1e-12);
            let [force, turning] = simulation.sheath_force(0);
            let expected = -0.5 * moment * curvature;
            assert_close_in((inside, fed, edges), force, expected, 2e-3);
            assert!(turning.abs() < 1e-9);
            (simulation.positions()[edges] - mouth - exact).norm() / outside
        };
        let errors = [30, 60].map(error);
        assert!(errors[0] < 3.2e-3, "{inside} {fed}: {errors:?}");
        assert!(errors[1] < 8e-4, "{inside} {fed}: {errors:?}");
    }
}

/// Along the rod M²/2EI + T is constant: P sin θ at an end that a dead load P has turned by θ.
#[test]
fn a_load_across_the_end_pushes_the_rod_out() {
    let load = 0.6;
    for inside in [INSIDE, 0.293] {
        let mut forces = Vec::new();
        for edges in [40, 80] {
            let mut scene = fed_rod(edges, sheath(inside, Vec::new()));
            scene.loads = vec![point_force(0, edges, Vector3::y() * load)];
            let simulation = at_rest(&scene);
            let nodes = simulation.positions();
            let last = (nodes[edges] - nodes[edges - 1]).normalize();
            forces.push(simulation.sheath_force(0)[0] / (-load * last.y));
        }
        assert!((forces[1] - 1.0).abs() < 1e-3, "{forces:?}");
        // The error depends on the place of the mouth between two nodes, here the same.
        if inside == INSIDE {
            let extrapolated = (4.0 * forces[1] - forces[0]) / 3.0;
            assert!((extrapolated - 1.0).abs() < 1e-4, "{forces:?}");
        }
    }
}

/// The force is the derivative of the potential of the equilibrium over the length fed out.
#[test]
fn the_force_of_a_sheath_is_the_derivative_of_the_potential() {
    let (load, edges) = (Vector3::new(0.2, 0.5, 0.3), 30);
    let at = |fed: f64, from_end: bool| {
        let mut scene = fed_rod(edges, sheath(INSIDE, vec![(0.0, fed)]));
        scene.rods[0].natural_shape = curved([3.0, -2.0], 1.5);
        scene.rods[0].stiffness = section(300.0, [BENDING, 2.0 * BENDING], TWISTING);
        scene.rods[0].twist = 1.5 * LENGTH * 29.0 / 30.0;
        if from_end {
            scene.rods[0].centreline.reverse();
            scene.sheaths[0].from_end = true;
        }
        let tip = if from_end { 0 } else { edges };
        scene.loads = vec![point_force(0, tip, load)];
        let simulation = at_rest(&scene);
        let elastic = simulation.energies().total();
        let potential = elastic - load.dot(&simulation.positions()[tip]);
        (potential, simulation.sheath_force(0))
    };
    let step = 1e-5;
    for from_end in [false, true] {
        for fed in [-0.013, -0.001, 0.0053, 0.0089, 0.012] {
            let slope = (at(fed + step, from_end).0 - at(fed - step, from_end).0) / (2.0 * step);
            let (_, [force, _]) = at(fed, from_end);
            assert_close_in((fed, from_end), force, slope, 2e-6);
        }
    }
}

/// A rod that is turned in the sheath and held at its other end is twisted over the part outside.
#[test]
fn turning_in_the_sheath_twists_the_part_outside() {
    let edges = 30;
    for (inside, turned) in [(0.3, 0.4), (0.293, 0.4), (0.285, 9.0)] {
        for from_end in [false, true] {
            let mut scene = fed_rod(edges, sheath(inside, vec![(0.0, 0.0)]));
            scene.sheaths[0].turned = vec![(0.0, 0.0), (1.0, turned)];
            let mut tip = edges;
            if from_end {
                scene.rods[0].centreline.reverse();
                scene.sheaths[0].from_end = true;
                tip = 0;
            }
            scene.clamps = vec![clamp(0, tip)];
            scene.loads = vec![drag(None, 1.0, 1e-3)];
            // Stiff enough not to buckle.
            scene.rods[0].stiffness = section(1e6, [0.1; 2], TWISTING);
            let parameters = fixed_steps(Scheme::ImplicitEuler, 0.05);
            let simulation = run_with(&scene, &parameters, 3.0);
            let [_, moment] = simulation.sheath_force(0);
            let expected = TWISTING * turned / (LENGTH - inside);
            assert_close_in((inside, turned, from_end), moment, expected, 1e-6);
        }
    }
}

/// What is fed out, also with a soft curved tip, is the equilibrium of a rod that was placed with
/// that length outside; and drawn in again, it is the first one.
#[test]
fn a_rod_that_is_fed_slowly_stays_in_equilibrium() {
    let edges = 24;
    let course = vec![(0.0, 0.0), (1.0, 0.09), (4.0, 0.09), (5.0, 0.0)];
    let scene = |fed: Vec<(f64, f64)>| {
        let mut scene = fed_rod(edges, sheath(0.4, fed));
        scene.rods[0].natural_shape = curved([0.0, 4.0], 0.0);
        scene.loads = vec![gravity(2.0), drag(None, 0.5, 1e-4)];
        scene
    };
    let parameters = fixed_steps(Scheme::ImplicitEuler, 0.05);
    let mut simulation = Simulation::new(&scene(course.clone()), &parameters).unwrap();
    advance_to(&mut simulation, 4.0);
    let out = at_rest(&scene(vec![(0.0, 0.09)]));
    let off = farthest(simulation.positions(), out.positions());
    assert!(off < 1e-6 * LENGTH, "{off:e}");
    let [force, expected] = [&simulation, &out].map(|one| one.sheath_force(0)[0]);
    assert_close(force, expected, 1e-4);

    let half_way = run_with(&scene(course.clone()), &parameters, 0.55);
    let mut again = resumed(&scene(course.clone()), &parameters, &half_way);
    let mut on = half_way;
    advance_to(&mut on, 1.2);
    advance_to(&mut again, 1.2);
    assert_eq!(on.positions(), again.positions());

    advance_to(&mut simulation, 9.0);
    let back = at_rest(&scene(vec![(0.0, 0.0)]));
    let off = farthest(simulation.positions(), back.positions());
    assert!(off < 1e-6 * LENGTH, "{off:e}");
}

/// Lengths of edges stay natural, and the whole rod is accelerated by the sheath.
#[test]
fn a_sheath_moves_the_mass_of_the_rod() {
    let (edges, speed, end) = (30, 0.5, 0.4);
    let corners = (0..=20).map(|k| {
        let time = end * f64::from(k) / 20.0;
        (time, 0.5 * speed / end * time * time)
    });
    let scene = fed_rod(edges, sheath(INSIDE, corners.collect()));
    let mass = LENGTH * scene.rods[0].mass_per_length;
    let mut simulation =
        Simulation::new(&scene, &fixed_steps(Scheme::ImplicitEuler, 1e-3)).unwrap();
    let mut impulse = 0.0;
    while simulation.time() < end {
        let before = simulation.time();
        simulation.advance(end).unwrap();
        impulse += simulation.sheath_force(0)[0] * (simulation.time() - before);
    }
    let [momentum, _] = simulation.momenta();
    assert_close(momentum.x, mass * 0.975 * speed, 2e-3);
    assert_close(impulse, momentum.x, 1e-6);
}

/// A rod that is fed down to the ground, with all contact models.
#[test]
fn a_rod_is_fed_onto_the_ground() {
    let edges = 24;
    let tips = MODELS.map(|model| {
        let mut scene = fed_rod(edges, sheath(0.35, vec![(0.0, 0.0), (1.0, 0.15)]));
        let rod = &mut scene.rods[0];
        for (node, place) in rod.centreline.iter_mut().enumerate() {
            let along = LENGTH * node as f64 / edges as f64;
            *place = Vector3::new(0.6 * along, 0.0, 0.6 - 0.8 * along);
        }
        rod.first_director = Some(Vector3::y());
        scene.planes = vec![ground()];
        scene.contact = Some(contact(model, 1e-4));
        scene.loads = vec![gravity(9.81)];
        let simulation = run_with(&scene, &fixed_steps(Scheme::ImplicitEuler, 0.01), 3.0);
        simulation.positions()[edges]
    });
    for tip in &tips[1..] {
        assert!((tip - tips[0]).norm() < 2e-3, "{tips:?}");
    }
    assert!((tips[0].z - 5e-3).abs() < 2e-4, "{tips:?}");
}

#[test]
fn sheaths_that_cannot_hold_their_rods_are_refused() {
    let refusal = |scene: Scene| {
        let made = Simulation::new(&scene, &IntegrationParameters::default());
        made.map(drop).unwrap_err().to_string()
    };
    let fed = |inside: f64, fed: f64| fed_rod(30, sheath(inside, vec![(0.0, 0.0), (1.0, fed)]));
    let clamped = Scene {
        clamps: vec![clamp(0, 12)],
        ..fed(INSIDE, 0.0)
    };
    let bent = {
        let mut scene = fed(INSIDE, 0.0);
        scene.rods[0].centreline[7].y = 1e-3;
        scene
    };
    let twice = {
        let mut scene = fed(INSIDE, 0.0);
        scene.sheaths.push(scene.sheaths[0].clone());
        scene
    };
    let twisted = {
        let mut scene = fed(INSIDE, 0.0);
        scene.rods[0].twist = 1.0;
        scene
    };
    for (scene, expected) in [
        (fed(0.7, 0.0), "the length of its rod"),
        (fed(0.3, 0.29), "one edge of its rod stays inside"),
        (fed(0.01, 0.0), "one edge of its rod"),
        (clamped, "at node 12 of its rod"),
        (bent, "node 7 is 0.001"),
        (twice, "another sheath"),
        (twisted, "natural twist"),
    ] {
        let error = refusal(scene);
        assert!(error.contains(expected), "{expected}: {error}");
        assert!(error.contains("sheath `sheath`"), "{error}");
    }
    // A clamp that stays outside is none of its business.
    let held = Scene {
        clamps: vec![clamp(0, 30)],
        ..fed(INSIDE, 0.1)
    };
    assert!(Simulation::new(&held, &IntegrationParameters::default()).is_ok());

    let parameters = IntegrationParameters::default();
    let simulation = Simulation::new(&fed(INSIDE, 0.1), &parameters).unwrap();
    let error = simulation.path(short_path()).map(drop).unwrap_err();
    assert!(error.to_string().contains("sheaths"), "{error}");
}
