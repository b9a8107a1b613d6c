//! Rods in a background flow, in every fluid.

use super::*;
use crate::mechanics::fluid::{BackgroundFlow, FlowKind, FluidModel};
use crate::mechanics::scene::{
    Body, JointKind, LoadKind, NaturalShape, Plane, RodDescription, Scene,
};
use crate::mechanics::test_support::{
    assert_close, assert_close_in, at, clamp, distributed, fixed_steps, gravity, joint, line, run,
    section, steady,
};
use crate::mechanics::{SceneError, Vector3};
use std::f64::consts::PI;

const SCHEMES: [Scheme; 3] = [
    Scheme::ImplicitEuler,
    Scheme::ImplicitMidpoint,
    Scheme::BackwardDifferences,
];
const STOKESLETS: FluidModel = FluidModel::RegularizedStokeslets {
    viscosity: 0.2,
    regularization: 1.02,
    far_field_error: 0.0,
};
const QUADRATIC: FluidModel = FluidModel::Quadratic {
    density: 1000.0,
    normal: 1.2,
    tangential: 0.05,
    added_mass: 1.0,
};
const MODELS: [FluidModel; 3] = [
    STOKESLETS,
    FluidModel::Resistive { viscosity: 0.2 },
    QUADRATIC,
];

/// A naturally straight rod of 10 cm and 3 g.
fn rod(centreline: Vec<Vector3>) -> RodDescription {
    let stiffness = section(1e4, [2e-4; 2], 2e-4);
    RodDescription::uniform("rod", centreline, stiffness, 3e-3, 0.03)
}

fn in_flow(rods: Vec<RodDescription>, fluid: FluidModel, kind: FlowKind) -> Scene {
    Scene {
        rods,
        fluid: Some(fluid),
        flow: Some(BackgroundFlow::steady(kind)),
        spin_drag: true,
        ..Scene::default()
    }
}

/// A bent rod that straightens under a load.
fn bent(velocity: Vector3) -> RodDescription {
    let node = |k: i32| {
        let angle = 0.2 * f64::from(k);
        Vector3::new(libm::sin(angle), 1.0 - libm::cos(angle), 0.2 * angle) * 0.05
    };
    RodDescription {
        velocity,
        natural_shape: NaturalShape::Straight,
        ..rod((0..=10).map(node).collect())
    }
}

#[test]
fn a_uniform_flow_is_a_moving_frame() {
    let velocity = Vector3::new(0.3, -0.2, 0.1);
    let own = Vector3::new(0.1, 0.4, 0.0);
    for model in MODELS {
        let mut scene = in_flow(vec![bent(own)], model, FlowKind::Uniform { velocity });
        scene.loads = vec![distributed(None, Vector3::new(0.05, 0.0, -0.1))];
        let mut still = scene.clone();
        still.flow = None;
        still.rods = vec![bent(own - velocity)];
        for scheme in SCHEMES {
            let [flowing, still] = [&scene, &still].map(|scene| run(scene, scheme, 1e-3, 0.03));
            let shift = velocity * flowing.time();
            let deformed = (still.positions()[0] - scene.rods[0].centreline[0]).norm();
            assert!(deformed > 1e-3, "{deformed}");
            for (a, b) in flowing.positions().iter().zip(still.positions()) {
                let error = (a - b - shift).norm();
                assert!(error < 1e-8, "{model:?} {scheme:?}: {error:e}");
            }
            let forces = flowing.fluid_forces().into_iter().zip(still.fluid_forces());
            for (a, b) in forces {
                assert!((a - b).norm() < 1e-4 * b.norm().max(1e-3), "{a} {b}");
            }
        }
    }
}

#[test]
fn a_rotating_flow_carries_a_straight_rod_around() {
    let rate = 5.0;
    let kind = FlowKind::Rotation {
        point: Vector3::new(0.05, 0.0, 0.0),
        angular_velocity: Vector3::z() * rate,
    };
    for model in [STOKESLETS, FluidModel::Resistive { viscosity: 0.2 }] {
        let mut carried = rod(line(Vector3::zeros(), Vector3::x() * 0.1, 10));
        carried.angular_velocity = Vector3::z() * rate;
        let mut scene = in_flow(vec![carried], model, kind.clone());
        // Inertia would drive it outwards; the rod is light.
        scene.rods[0].mass_per_length = 1e-6;
        for scheme in [Scheme::ImplicitEuler, Scheme::BackwardDifferences] {
            let simulation = run(&scene, scheme, 1e-3, 0.1);
            let along = simulation.positions()[10] - simulation.positions()[0];
            let angle = libm::atan2(along.y, along.x);
            assert_close_in((model, scheme), angle, rate * 0.1, 2e-2);
            let middle = simulation.positions()[5] - Vector3::new(0.05, 0.0, 0.0);
            assert!(middle.norm() < 1e-6, "{middle}");
        }
    }
}

#[test]
fn a_vortex_spins_a_rod_and_a_ball_at_half_its_curl() {
    let rate = 7.0;
    let kinds = [
        FlowKind::Rotation {
            point: Vector3::zeros(),
            angular_velocity: Vector3::z() * rate,
        },
        FlowKind::Shear {
            point: Vector3::zeros(),
            direction: Vector3::x(),
            gradient: -Vector3::y(),
            rate: 2.0 * rate,
        },
    ];
    for (kind, model) in kinds.into_iter().flat_map(|kind| {
        [STOKESLETS, FluidModel::Resistive { viscosity: 0.2 }].map(|model| (kind.clone(), model))
    }) {
        let vertical = rod(line(Vector3::zeros(), Vector3::z() * 0.1, 4));
        let scene = in_flow(vec![vertical.clone()], model, kind.clone());
        let simulation = run(&scene, Scheme::BackwardDifferences, 2e-3, 0.5);
        for spin in &simulation.as_start().spins[..4] {
            assert_close_in(model, *spin, rate, 1e-3);
        }
        // The ball encloses a rod across the axis.
        let across = rod(line(Vector3::zeros(), Vector3::x() * 0.008, 2));
        let mut scene = in_flow(vec![across], model, kind);
        scene.bodies = vec![Body::uniform_ball(at(0, 0), 2e-4, 0.02)];
        let simulation = run(&scene, Scheme::BackwardDifferences, 2e-3, 0.2);
        let [start, end] = [0, 2].map(|node| simulation.velocities()[node]);
        let arm = simulation.positions()[2] - simulation.positions()[0];
        let turning = arm.cross(&(end - start)).z / arm.norm_squared();
        assert_close_in(model, turning, rate, 1e-3);
    }
}

#[test]
fn gusts_follow_their_schedule() {
    let kind = FlowKind::Uniform {
        velocity: Vector3::x(),
    };
    for model in MODELS {
        let straight = rod(line(Vector3::zeros(), Vector3::z() * 0.1, 4));
        let mut scene = in_flow(vec![straight], model, kind.clone());
        let flow = scene.flow.as_mut().unwrap();
        flow.schedule = vec![(0.05, 0.0), (0.051, 1.0)];
        let mut simulation =
            Simulation::new(&scene, &fixed_steps(Scheme::BackwardDifferences, 1e-3)).unwrap();
        while simulation.time() < 0.05 {
            simulation.advance(0.05).unwrap();
        }
        let speed = simulation.velocities()[2].norm();
        assert!(speed < 1e-9, "{model:?}: {speed:e}");
        while simulation.time() < 0.2 {
            simulation.advance(0.2).unwrap();
        }
        assert!(simulation.velocities()[2].x > 0.05, "{model:?}");
    }
}

/// A rod that falls across, and along itself, in water: v = v∞ tanh(t/τ) with v∞² = g m/c and τ =
/// v∞ m/(m g), with the added mass where it falls across.
#[test]
fn rods_fall_with_quadratic_drag_as_in_theory() {
    let (density, normal, tangential, added) = (1000.0, 1.2, 0.05, 1.0);
    let (acceleration, mass, radius) = (9.81, 0.1, 3e-3);
    let displaced = density * PI * radius * radius;
    for (direction, coefficient, inertia) in [
        (
            Vector3::x(),
            density * radius * normal,
            mass + added * displaced,
        ),
        (Vector3::z(), density * PI * radius * tangential, mass),
    ] {
        let mut falling = rod(line(Vector3::zeros(), direction * 0.1, 4));
        falling.mass_per_length = mass;
        let scene = Scene {
            rods: vec![falling],
            loads: vec![gravity(acceleration)],
            fluid: Some(QUADRATIC),
            ..Scene::default()
        };
        let last = (mass * acceleration / coefficient).sqrt();
        let time = last * inertia / (mass * acceleration);
        for (scheme, bound) in SCHEMES.into_iter().zip([5e-3, 1e-4, 1e-4]) {
            let simulation = run(&scene, scheme, 0.01 * time, time);
            let speed = -simulation.velocities()[2].z;
            assert_close_in(scheme, speed, last * libm::tanh(1.0), bound);
        }
    }
}

/// A cantilever and a joined rod come to rest in a flow of water where statics has them.
#[test]
fn a_dynamic_run_settles_at_the_equilibrium_in_a_current() {
    let mut scene = in_flow(
        vec![
            rod(line(Vector3::zeros(), Vector3::z() * 0.1, 8)),
            rod(line(Vector3::z() * 0.1, Vector3::z() * 0.15, 4)),
        ],
        QUADRATIC,
        FlowKind::Profile {
            direction: Vector3::x(),
            along: Vector3::z(),
            speeds: vec![(0.0, 0.05), (0.2, 0.25)],
        },
    );
    scene.joints = vec![joint("joint", [at(0, 8), at(1, 0)], JointKind::Ball)];
    scene.clamps = vec![clamp(0, 0)];
    scene.loads = vec![distributed(None, Vector3::z() * 0.05)];
    let parameters = fixed_steps(Scheme::ImplicitEuler, 5e-3);
    let mut rests = Simulation::new(&scene, &parameters).unwrap();
    rests.find_equilibrium().unwrap();
    scene.loads.push(steady(LoadKind::Drag {
        rod: None,
        translation: 0.3,
        rotation: 0.0,
    }));
    let moves = run(&scene, Scheme::ImplicitEuler, 5e-3, 5.0);
    let tip = rests.positions()[13];
    assert!(tip.x > 5e-3, "{tip}");
    for (a, b) in rests.positions().iter().zip(moves.positions()) {
        assert!((a - b).norm() < 1e-6, "{a} {b}");
    }
    assert_close(rests.fluid_forces()[4].x, moves.fluid_forces()[4].x, 1e-3);
}

#[test]
fn flows_that_are_not_supported_are_refused() {
    let shear = |height: f64| FlowKind::Shear {
        point: Vector3::z() * height,
        direction: Vector3::x(),
        gradient: Vector3::z(),
        rate: 1.0,
    };
    let straight = || vec![rod(line(Vector3::z(), Vector3::x() + Vector3::z(), 4))];
    let at_wall = |height: f64| Scene {
        planes: vec![Plane {
            point: Vector3::zeros(),
            normal: Vector3::z(),
            friction: None,
            directed_friction: None,
        }],
        wall: Some(0),
        spin_drag: false,
        ..in_flow(straight(), STOKESLETS, shear(height))
    };
    let parameters = fixed_steps(Scheme::ImplicitEuler, 1e-3);
    assert!(Simulation::new(&at_wall(0.0), &parameters).is_ok());
    let refusal = |error: Option<SimulationError>| match error {
        Some(SimulationError::BadScene(SceneError::Unsuitable(reason))) => reason,
        other => panic!("{other:?}"),
    };
    let slips = Simulation::new(&at_wall(0.1), &parameters).err();
    assert!(refusal(slips).contains("at rest on the wall"));
    for model in MODELS {
        let scene = in_flow(straight(), model, shear(0.0));
        let mut simulation = Simulation::new(&scene, &parameters).unwrap();
        if model != QUADRATIC {
            let rests = simulation.find_equilibrium().err();
            assert!(refusal(rests).contains("quadratic"));
        }
    }
}
