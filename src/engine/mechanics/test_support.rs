//! Helpers of the tests of mechanics: small parts of scenes, their simulations, and comparisons of
//! numbers.
//!
//! Parts are the simplest of their kind; tests vary them with struct update syntax.

use super::Vector3;
use super::contact::{ContactModel, ContactParameters};
use super::dynamics::{IntegrationParameters, Scheme, Simulation, StepSize};
use super::fluid::{BackgroundFlow, FlowKind};
use super::rigid_body::RigidBody;
use super::scene::{
    Body, Clamp, HingeSpring, Joint, JointKind, Load, LoadKind, Motion, NaturalShape, Obstacle,
    Plane, RodDescription, RodNode, Scene, Spring, Stiffness, Strength,
};
use super::statics::{PathMethod, PathPlan};
use std::f64::consts::PI;
use std::fmt::Debug;

/// Every scheme.
pub(crate) const SCHEMES: [Scheme; 3] = [
    Scheme::ImplicitEuler,
    Scheme::ImplicitMidpoint,
    Scheme::BackwardDifferences,
];

/// The contact models with a force law of the gap.
pub(crate) const SOFT_MODELS: [ContactModel; 2] = [
    ContactModel::ImplicitContact,
    ContactModel::IncrementalPotential,
];

/// Every contact model.
pub(crate) const MODELS: [ContactModel; 3] = [
    ContactModel::ImplicitContact,
    ContactModel::IncrementalPotential,
    ContactModel::Complementarity,
];

/// Stiffness of a cross-section: EA (N), EI₁ and EI₂, GJ (N m²).
pub(crate) fn section(stretching: f64, bending: [f64; 2], twisting: f64) -> Stiffness {
    Stiffness {
        stretching,
        bending,
        twisting,
    }
}

/// A stress-free shape of constant curvatures (1/m) and twist (rad/m).
pub(crate) fn curved(curvature: [f64; 2], twist: f64) -> NaturalShape {
    NaturalShape::Curved { curvature, twist }
}

/// The nodes of so many equal edges between two points.
pub(crate) fn line(from: Vector3, to: Vector3, edges: usize) -> Vec<Vector3> {
    let node = |k: usize| from + (to - from) * (k as f64 / edges as f64);
    (0..=edges).map(node).collect()
}

/// A rod of `edges` edges along x from the origin, E = 100 MPa, radius 5 mm, density 1000.
pub(crate) fn straight_rod(edges: usize, length: f64) -> RodDescription {
    let (young, radius, density) = (1e8, 5e-3, 1000.0);
    let area = PI * radius * radius;
    let centreline = (0..=edges)
        .map(|k| Vector3::x() * (length * k as f64 / edges as f64))
        .collect();
    RodDescription {
        first_director: Some(Vector3::y()),
        ..RodDescription::uniform(
            "rod",
            centreline,
            Stiffness::circular(young, 0.5, radius),
            radius,
            density * area,
        )
    }
}

/// A bent and twisted cantilever with unequal stiffnesses under weight.
pub(crate) fn cantilever() -> Scene {
    let mut rod = straight_rod(10, 0.3);
    rod.stiffness = section(200.0, [1e-3, 2.5e-3], 1.2e-3);
    rod.natural_shape = curved([2.0, 1.0], 1.5);
    Scene {
        rods: vec![rod],
        clamps: vec![clamp(0, 0)],
        loads: vec![
            gravity(2.0),
            point_force(0, 10, Vector3::new(0.0, 2e-3, 0.0)),
        ],
        ..Scene::default()
    }
}

/// A rod that is pulled over the ground, on which it lies already, by one end.
pub(crate) fn pulled(model: ContactModel) -> Scene {
    let mut scene = cantilever();
    scene.rods[0] = moved(scene.rods[0].clone(), Vector3::z() * 5.05e-3);
    scene.clamps[0].motion.translation =
        vec![(0.0, Vector3::zeros()), (1.0, Vector3::new(0.0, 0.4, 0.0))];
    scene.planes = vec![ground()];
    scene.contact = Some(rubbing(model));
    scene
}

/// Contact with friction that is smoothed over a wide range of slips.
pub(crate) fn rubbing(model: ContactModel) -> ContactParameters {
    ContactParameters {
        friction: 0.3,
        slip_tolerance: 1e-2,
        ..contact(model, 1e-4)
    }
}

/// A rod in another place, straight by nature.
pub(crate) fn moved(mut rod: RodDescription, by: Vector3) -> RodDescription {
    rod.centreline.iter_mut().for_each(|node| *node += by);
    rod.natural_shape = NaturalShape::Straight;
    rod
}

/// A rod that lies across another one, over which its clamp pulls it.
pub(crate) fn crossed(model: ContactModel) -> Scene {
    let mut scene = cantilever();
    let lower = moved(scene.rods[0].clone(), Vector3::zeros());
    let mut upper = moved(scene.rods[0].clone(), Vector3::zeros());
    for (node, place) in upper.centreline.iter_mut().enumerate() {
        *place = Vector3::new(0.17, -0.13 + 0.03 * node as f64, 0.01005);
    }
    upper.first_director = Some(Vector3::z());
    upper.name = "upper".into();
    scene.rods = vec![lower, upper];
    scene.clamps.push(clamp(1, 0));
    scene.clamps[1].motion.translation =
        vec![(0.0, Vector3::zeros()), (1.0, Vector3::new(0.3, 0.2, -0.1))];
    scene.contact = Some(rubbing(model));
    scene
}

/// A growing shear of a rate, 1/s, oblique to the cantilever.
pub(crate) fn sheared(rate: f64) -> BackgroundFlow {
    BackgroundFlow {
        kind: FlowKind::Shear {
            point: Vector3::new(0.0, 0.02, 0.01),
            direction: Vector3::new(0.0, 0.6, 0.8),
            gradient: Vector3::new(0.8, 0.48, -0.36),
            rate,
        },
        schedule: vec![(0.0, 0.5), (1.0, 3.0)],
    }
}

/// Rods without supports or loads.
pub(crate) fn free_rods(rods: Vec<RodDescription>) -> Scene {
    Scene {
        rods,
        ..Scene::default()
    }
}

/// A node of a rod.
pub(crate) fn at(rod: usize, node: usize) -> RodNode {
    RodNode { rod, node }
}

/// A clamp at rest that holds position and frame of a node.
pub(crate) fn clamp(rod: usize, node: usize) -> Clamp {
    Clamp {
        rod,
        node,
        holds_position: true,
        holds_frame: true,
        motion: Motion::default(),
    }
}

/// A clamp at rest that holds the position of a node alone.
pub(crate) fn pin(rod: usize, node: usize) -> Clamp {
    Clamp {
        holds_frame: false,
        ..clamp(rod, node)
    }
}

/// A joint that does not break.
pub(crate) fn joint(name: &str, nodes: [RodNode; 2], kind: JointKind) -> Joint {
    Joint {
        name: name.into(),
        nodes,
        kind,
        strength: Strength::default(),
    }
}

/// A hinge without a spring.
pub(crate) fn hinge(axis: Vector3) -> JointKind {
    JointKind::Hinge { axis, spring: None }
}

/// A hinge with a spring of a stiffness (N m/rad) that rests at an angle, rad.
pub(crate) fn sprung_hinge(axis: Vector3, stiffness: f64, rest_angle: f64) -> JointKind {
    let spring = HingeSpring {
        stiffness,
        rest_angle,
    };
    JointKind::Hinge {
        axis,
        spring: Some(spring),
    }
}

/// A spring of a stiffness (N/m) with its placed length as rest length, without torsional stiffness, unbreakable.
pub(crate) fn spring(name: &str, nodes: [RodNode; 2], stiffness: f64) -> Spring {
    Spring {
        name: name.into(),
        nodes,
        stiffness,
        turning: None,
        rest_length: None,
        only: None,
        strength: Strength::default(),
    }
}

/// A body of a mass (kg) with its centre at its node, without contact.
pub(crate) fn body(name: &str, at: RodNode, mass: f64, inertia: Option<[f64; 3]>) -> Body {
    Body {
        name: name.into(),
        at,
        mass,
        offset: Vector3::zeros(),
        inertia,
        ball: None,
    }
}

/// A load that does not change.
pub(crate) fn steady(kind: LoadKind) -> Load {
    Load {
        kind,
        schedule: Vec::new(),
    }
}

/// Weight by an acceleration of free fall, m/s².
pub(crate) fn weight(acceleration: Vector3) -> Load {
    steady(LoadKind::Gravity { acceleration })
}

/// Weight along −z by an acceleration of free fall, m/s².
pub(crate) fn gravity(acceleration: f64) -> Load {
    weight(Vector3::z() * -acceleration)
}

/// A dead force on a node, N.
pub(crate) fn point_force(rod: usize, node: usize, force: Vector3) -> Load {
    steady(LoadKind::Force { rod, node, force })
}

/// A moment of fixed direction on an edge, N m.
pub(crate) fn moment_on(rod: usize, edge: usize, moment: Vector3) -> Load {
    steady(LoadKind::Moment { rod, edge, moment })
}

/// A dead force per length on one rod or on all, N/m.
pub(crate) fn distributed(rod: Option<usize>, force_per_length: Vector3) -> Load {
    steady(LoadKind::Distributed {
        rod,
        force_per_length,
    })
}

/// Linear drag on one rod or on all by coefficients of velocity (N s/m²) and spin (N s).
pub(crate) fn drag(rod: Option<usize>, translation: f64, rotation: f64) -> Load {
    steady(LoadKind::Drag {
        rod,
        translation,
        rotation,
    })
}

/// The half space below z = 0, with the friction of the contact model.
pub(crate) fn ground() -> Plane {
    Plane {
        point: Vector3::zeros(),
        normal: Vector3::z(),
        friction: None,
        directed_friction: None,
    }
}

/// A resting body near rods, with the friction of the contact model.
pub(crate) fn obstacle(name: &str, body: RigidBody) -> Obstacle {
    Obstacle {
        name: name.into(),
        body,
        ..Obstacle::default()
    }
}

/// Contact by a model with a tolerance of distances, m.
pub(crate) fn contact(model: ContactModel, distance_tolerance: f64) -> ContactParameters {
    ContactParameters {
        model,
        distance_tolerance,
        ..ContactParameters::default()
    }
}

/// Steps of one size (s) with a scheme.
pub(crate) fn fixed_steps(scheme: Scheme, step: f64) -> IntegrationParameters {
    IntegrationParameters {
        scheme,
        ..fixed(step)
    }
}

/// Steps of one size (s) with the scheme that is the default.
pub(crate) fn fixed(step: f64) -> IntegrationParameters {
    IntegrationParameters {
        step: StepSize::Fixed(step),
        ..IntegrationParameters::default()
    }
}

/// A path of some points over a parameter from 0 to 1.
pub(crate) fn short_path() -> PathPlan {
    PathPlan {
        from: 0.0,
        to: 1.0,
        step: 0.1,
        largest_step: 0.1,
        method: PathMethod::Arclength,
        switch_branches: false,
        most_points: 10,
    }
}

/// The simulation of a scene at its start, with default parameters.
pub(crate) fn simulation_of(scene: &Scene) -> Simulation {
    Simulation::new(scene, &IntegrationParameters::default()).unwrap()
}

/// The simulation of a scene in its equilibrium.
pub(crate) fn at_rest(scene: &Scene) -> Simulation {
    let mut simulation = simulation_of(scene);
    simulation.find_equilibrium().unwrap();
    simulation
}

/// Steps until a time, s.
pub(crate) fn advance_to(simulation: &mut Simulation, end: f64) {
    while simulation.time() < end {
        simulation.advance(end).unwrap();
    }
}

/// A simulation of a scene, run to a time (s) with some parameters.
pub(crate) fn run_with(scene: &Scene, parameters: &IntegrationParameters, end: f64) -> Simulation {
    let mut simulation = Simulation::new(scene, parameters).unwrap();
    advance_to(&mut simulation, end);
    simulation
}

/// A simulation of a scene, run to a time (s) with steps of a size (s).
pub(crate) fn run(scene: &Scene, scheme: Scheme, step: f64, end: f64) -> Simulation {
    run_with(scene, &fixed_steps(scheme, step), end)
}

/// Another simulation of a scene, restored from the state of `from`.
pub(crate) fn resumed(
    scene: &Scene,
    parameters: &IntegrationParameters,
    from: &Simulation,
) -> Simulation {
    let mut simulation = Simulation::new(scene, parameters).unwrap();
    simulation.restore(from.state()).unwrap();
    simulation
}

/// Largest distance between nodes with the same index, m.
pub(crate) fn farthest(a: &[Vector3], b: &[Vector3]) -> f64 {
    assert_eq!(a.len(), b.len());
    let distances = a.iter().zip(b).map(|(a, b)| (a - b).norm());
    distances.fold(0.0, f64::max)
}

/// Asserts that a number is within the relative `tolerance` of the expected one.
#[track_caller]
pub(crate) fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert_close_in((), found, expected, tolerance);
}

/// Asserts the same, with the case in the message.
#[track_caller]
pub(crate) fn assert_close_in(case: impl Debug, found: f64, expected: f64, tolerance: f64) {
    let error = found / expected - 1.0;
    assert!(
        error.abs() < tolerance,
        "{case:?}: {found} is off {expected} by {error:.2e} of it"
    );
}

/// The rows of numbers of a table of the reference solutions; `None`, with a note, if it is
/// absent.
pub(crate) fn reference_rows(file: &str) -> Option<Vec<Vec<f64>>> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/reference/");
    let Ok(text) = std::fs::read_to_string(format!("{folder}{file}")) else {
        println!("skipped: {file} is not here");
        return None;
    };
    let numbers = |line: &str| line.split(',').map(str::parse).collect();
    let rows = text.lines().map(numbers);
    Some(rows.filter_map(Result::ok).collect())
}
