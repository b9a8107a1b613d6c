//! Runs of joined rods that start from the end of another run.

use super::*;
use crate::mechanics::scene::{
    CoulombFriction, Joint, JointKind, RodDescription, Scene, Start, Strength,
};
use crate::mechanics::test_support::{
    advance_to, at, at_rest, body, clamp, fixed_steps, gravity, joint, line, section, sprung_hinge,
};
use crate::mechanics::{SceneError, Vector3};

fn rod(name: &str, from: Vector3, along: [f64; 3], edges: usize) -> RodDescription {
    let stiffness = section(1e3, [1e-3, 2e-3], 1e-3);
    let nodes = line(from, from + Vector3::from(along), edges);
    RodDescription::uniform(name, nodes, stiffness, 2e-3, 0.01)
}

/// A clamped mast with an arm welded to it, a flap on a hinge with a spring, a body that swings at
/// the flap, a rod welded to the middle of the arm, and a bead that slides along the mast.
fn scene() -> Scene {
    let mast = rod("mast", Vector3::zeros(), [0.0, 0.0, 0.2], 10);
    let [ring, top] = [mast.centreline[6], mast.centreline[10]];
    let arm = rod("arm", top, [0.1, 0.05, 0.02], 6);
    let [middle, end] = [arm.centreline[3], arm.centreline[6]];
    let mut flap = rod("flap", end, [0.06, -0.04, 0.0], 4);
    flap.velocity = Vector3::new(0.0, 0.1, 0.2);
    let kinds = [
        ("weld", [at(1, 0), at(0, 10)], JointKind::Rigid),
        (
            "hinge",
            [at(2, 0), at(1, 6)],
            sprung_hinge(Vector3::new(0.6, 0.0, 0.8), 2e-3, 0.3),
        ),
        ("cross", [at(3, 0), at(1, 3)], JointKind::Rigid),
        ("ring", [at(4, 0), at(0, 6)], JointKind::FREE_SLIDE),
    ];
    Scene {
        rods: vec![
            mast,
            arm,
            flap,
            rod("brace", middle, [0.0, 0.0, -0.06], 3),
            rod("bead", ring, [0.02, 0.0, -0.01], 1),
        ],
        joints: kinds
            .map(|(name, nodes, kind)| joint(name, nodes, kind))
            .into(),
        bodies: vec![body("weight", at(2, 4), 2e-3, Some([1e-6, 2e-6, 2.5e-6]))],
        clamps: vec![clamp(0, 0)],
        loads: vec![gravity(3.0)],
        ..Scene::default()
    }
}

const END: f64 = 0.08;
const STEP: f64 = 5e-4;
const EULER: Scheme = Scheme::ImplicitEuler;

/// Largest distance of the nodes at the end of a run in one piece from those of a run in two.
fn apart(scene: &Scene, scheme: Scheme, step: f64) -> f64 {
    let parameters = fixed_steps(scheme, step);
    let mut whole = Simulation::new(scene, &parameters).unwrap();
    advance_to(&mut whole, END);
    let started = Scene {
        start: Some(whole.as_start()),
        ..scene.clone()
    };
    let mut second = Simulation::new(&started, &parameters).unwrap();
    for (one, other) in whole.positions().iter().zip(second.positions()) {
        assert!((one - other).norm() < 1e-12);
    }
    // The velocities of the tips of bodies are those of their rotation, not of the last step.
    let [begun, before] = [&second, &whole].map(|simulation| simulation.energies().total());
    let kinetic = whole.energies().kinetic;
    assert!(
        (begun - before).abs() < 1e-5 * kinetic,
        "{begun} {before} {kinetic}"
    );
    advance_to(&mut whole, 2.0 * END);
    advance_to(&mut second, END);
    let pairs = whole.positions().iter().zip(second.positions());
    pairs
        .map(|(one, other)| (one - other).norm())
        .fold(0.0, f64::max)
}

#[test]
fn frames_bodies_and_sliding_nodes_go_on_from_the_end_of_another_run() {
    let moved = {
        let mut simulation = simulation_of_scene();
        let placed = simulation.positions().to_vec();
        advance_to(&mut simulation, END);
        let pairs = simulation.positions().iter().zip(&placed);
        pairs
            .map(|(now, before)| (now - before).norm())
            .fold(0.0, f64::max)
    };
    assert!(moved > 0.01, "{moved}");
    // A state has angular velocities, a scheme those of the tips of bodies in its last step.
    let [coarse, fine] = [STEP, 0.25 * STEP].map(|step| apart(&scene(), EULER, step));
    assert!(coarse < 1e-6 && fine < 0.4 * coarse, "{coarse:e} {fine:e}");
    // Backward differences begin with steps of lower order.
    let difference = apart(&scene(), Scheme::BackwardDifferences, STEP);
    assert!(difference < 2e-4, "{difference:e}");
}

#[test]
fn friction_of_a_sliding_node_begins_unmobilised() {
    let mut scene = scene();
    scene.joints[3].kind = JointKind::Slide {
        friction: Some(CoulombFriction {
            coefficient: 0.05,
            presliding: Some(1e-6),
        }),
    };
    let difference = apart(&scene, EULER, STEP);
    assert!(difference < 2e-6, "{difference:e}");
}

fn simulation_of_scene() -> Simulation {
    Simulation::new(&scene(), &fixed_steps(EULER, STEP)).unwrap()
}

#[test]
fn a_clamp_holds_the_frame_of_a_joint_as_the_other_run_left_it() {
    let mut scene = scene();
    scene.clamps.push(clamp(0, 10));
    let difference = apart(&scene, EULER, STEP);
    assert!(difference < 1e-6, "{difference:e}");
}

#[test]
fn an_equilibrium_of_joined_rods_starts_from_the_end_of_another_run() {
    let mut scene = scene();
    scene.joints.pop();
    scene.rods.pop();
    let rest = at_rest(&scene);
    scene.start = Some(Start {
        velocities: Vec::new(),
        spins: Vec::new(),
        turning: Vec::new(),
        ..rest.as_start()
    });
    let mut again = Simulation::new(&scene, &IntegrationParameters::default()).unwrap();
    let report = again.find_equilibrium().unwrap();
    assert!(report.newton_iterations <= 2, "{report:?}");
    for (one, other) in rest.positions().iter().zip(again.positions()) {
        assert!((one - other).norm() < 1e-8);
    }
}

#[test]
fn a_state_without_the_frames_or_with_a_broken_slide_is_refused() {
    let refused = |start: Start| {
        let scene = Scene {
            start: Some(start),
            ..scene()
        };
        match Simulation::new(&scene, &fixed_steps(EULER, STEP)) {
            Err(SimulationError::BadScene(SceneError::Unsuitable(reason))) => reason,
            other => panic!("{:?}", other.err()),
        }
    };
    let start = simulation_of_scene().as_start();
    let mut without = start.clone();
    without.walls.fill(None);
    assert!(refused(without).contains("no rotations of rigid joints"));
    let mut broken = start;
    let bead = broken.positions.len() - 2;
    for place in &mut broken.positions[bead..] {
        place.x += 0.02;
    }
    assert!(refused(broken).contains("beside its rod"));
}

#[test]
fn a_slide_with_a_strength_starts_unbroken() {
    let mut scene = scene();
    let weak: &mut Joint = scene.joints.last_mut().unwrap();
    weak.strength = Strength::of_force(1.0);
    let difference = apart(&scene, EULER, STEP);
    assert!(difference < 1e-6, "{difference:e}");
}
