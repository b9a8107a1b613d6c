//! Rods that forces feed out of sheaths.

use super::*;
use crate::mechanics::Vector3;
use crate::mechanics::scene::{RodDescription, Scene, Sheath};
use crate::mechanics::test_support::{
    MODELS, advance_to, assert_close_in, clamp, contact, drag, fixed_steps, gravity, ground,
    point_force, resumed, run_with, section, simulation_of, straight_rod,
};

/// Length of the rod, its part inside, and its edges, m.
const LENGTH: f64 = 0.6;
const INSIDE: f64 = 0.3;
const EDGES: usize = 30;
const EDGE: f64 = LENGTH / EDGES as f64;

/// A rod along x, pushed out of a sheath by a force (N).
fn pushed_rod(stretching: f64, bending: f64, force: f64) -> Scene {
    let rod = RodDescription {
        stiffness: section(stretching, [bending; 2], 0.8 * bending),
        ..straight_rod(EDGES, LENGTH)
    };
    let sheath = Sheath {
        name: "sheath".into(),
        rod: 0,
        from_end: false,
        inside: INSIDE,
        fed: Vec::new(),
        pushed: vec![(0.0, force)],
        turned: Vec::new(),
    };
    Scene {
        rods: vec![rod],
        sheaths: vec![sheath],
        ..Scene::default()
    }
}

fn fed(simulation: &Simulation) -> f64 {
    simulation.length_outside(0) - (LENGTH - INSIDE)
}

#[test]
fn a_force_accelerates_the_whole_rod() {
    for (scheme, force) in [
        (Scheme::ImplicitEuler, 0.2),
        (Scheme::BackwardDifferences, 0.2),
        (Scheme::ImplicitEuler, -0.2),
    ] {
        let scene = pushed_rod(1e6, 0.01, force);
        let mass = LENGTH * scene.rods[0].mass_per_length;
        let end = 0.2;
        let simulation = run_with(&scene, &fixed_steps(scheme, 1e-3), end);
        let [momentum, _] = simulation.momenta();
        assert_close_in((scheme, force), momentum.x, force * end, 1e-6);
        // Implicit Euler is late by half a step; the rod is stiff enough to move as a whole.
        let late = if scheme == Scheme::ImplicitEuler {
            5e-4
        } else {
            0.0
        };
        let exact = 0.5 * force / mass * end * (end + 2.0 * late);
        assert_close_in((scheme, force), fed(&simulation), exact, 2e-3);
        assert_close_in((scheme, force), simulation.sheath_force(0)[0], force, 1e-6);
    }
}

/// A load across its end bends the rod, which pushes itself out: as for the elastica arm scale of
/// Bosi, Misseroni, Dal Corso and Bigoni (2014), the energies of bending and motion are the work of
/// the load and the push.
#[test]
fn a_bent_rod_leaves_its_sheath_without_loss_of_energy() {
    let (load, push) = (Vector3::y() * 0.3, -0.02);
    let mut scene = pushed_rod(1e5, 0.01, push);
    scene.loads = vec![point_force(0, EDGES, load)];
    let parameters = fixed_steps(Scheme::BackwardDifferences, 1e-4);
    let mut simulation = Simulation::new(&scene, &parameters).unwrap();
    for end in [0.1, 0.15, 0.2] {
        let mut again = resumed(&scene, &parameters, &simulation);
        advance_to(&mut simulation, end);
        advance_to(&mut again, end);
        assert_eq!(simulation.positions(), again.positions());
        let tip = simulation.positions()[EDGES] - Vector3::x() * LENGTH;
        let work = load.dot(&tip) + push * fed(&simulation);
        let energy = simulation.energies().total();
        assert_close_in(end, energy, work, 2e-3);
    }
    // Far from the stop, where energy would be lost.
    let fed = fed(&simulation);
    assert!(2.0 * EDGE < fed && fed < 0.8 * INSIDE, "{fed}");
}

/// A push F compresses the part outside, whose far end is clamped. Inside, the rod is not strained,
/// so that the force N in the rod follows from F = N − N²/2EA. The part that is compressed begins
/// half an edge outside of the mouth.
#[test]
fn a_push_against_a_clamp_compresses_the_part_outside() {
    for strain in [1e-2, 0.1] {
        let stretching = 1e4;
        let mut scene = pushed_rod(stretching, 10.0, strain * stretching);
        scene.clamps = vec![clamp(0, EDGES)];
        scene.loads = vec![drag(None, 300.0, 0.0)];
        let simulation = run_with(&scene, &fixed_steps(Scheme::ImplicitEuler, 2e-3), 1.0);
        let compression = 1.0 - (1.0 - 2.0 * strain).sqrt();
        let outside = LENGTH - INSIDE - 0.5 * EDGE;
        let exact = outside * compression / (1.0 - compression);
        assert_close_in(strain, fed(&simulation), exact, 1e-5);
    }
}

#[test]
fn a_pushed_rod_stops_at_its_last_edge_and_at_what_holds_it() {
    for (force, place, expected) in [
        (2.0, None, INSIDE - EDGE),
        (-2.0, None, INSIDE - LENGTH),
        (-2.0, Some(25), INSIDE - 24.0 * EDGE),
    ] {
        let mut scene = pushed_rod(1e6, 0.01, force);
        if let Some(node) = place {
            let mut held = clamp(0, node);
            let way = Vector3::x() * expected;
            held.motion.translation = vec![(0.0, Vector3::zeros()), (0.3, way)];
            scene.clamps = vec![held];
        }
        let mut simulation = run_with(&scene, &fixed_steps(Scheme::ImplicitEuler, 1e-3), 0.4);
        assert_close_in(place, fed(&simulation), expected, 1e-9);
        advance_to(&mut simulation, 0.45);
        assert_close_in(place, fed(&simulation), expected, 1e-9);
    }
}

/// All contact models agree.
#[test]
fn a_rod_is_pushed_over_the_ground() {
    let found = MODELS.map(|model| {
        let mut scene = pushed_rod(1e5, 0.01, 0.0);
        scene.sheaths[0].pushed = vec![(0.0, 0.0), (0.5, 0.3)];
        let rod = &mut scene.rods[0];
        for (node, place) in rod.centreline.iter_mut().enumerate() {
            let along = LENGTH * node as f64 / EDGES as f64;
            *place = Vector3::new(0.8 * along, 0.0, 0.4 - 0.6 * along);
        }
        rod.first_director = Some(Vector3::y());
        scene.planes = vec![ground()];
        let mut parameters = contact(model, 1e-4);
        parameters.friction = 0.3;
        parameters.slip_tolerance = 1e-3;
        scene.contact = Some(parameters);
        scene.loads = vec![gravity(9.81), drag(None, 5.0, 1e-3)];
        let steps = fixed_steps(Scheme::ImplicitEuler, 2e-3);
        let simulation = run_with(&scene, &steps, 0.6);
        assert_close_in(model, simulation.sheath_force(0)[0], 0.3, 1e-4);
        fed(&simulation)
    });
    assert!(found[0] > 2.0 * EDGE, "{found:?}");
    for other in &found[1..] {
        assert_close_in(found, *other, found[0], 2e-2);
    }
}

#[test]
fn equilibria_of_pushed_rods_are_refused() {
    let mut simulation = simulation_of(&pushed_rod(1e6, 0.01, 1.0));
    let error = simulation.find_equilibrium().map(drop).unwrap_err();
    assert!(error.to_string().contains("pushed"), "{error}");
}
