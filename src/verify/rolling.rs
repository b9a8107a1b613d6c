//! Friction at the surfaces: a cylinder that rolls and slips on an incline and on a belt, and rods and rollers that drive each other.

use super::contact::contact_parameters;
use super::rods::{clamp, force_on, gravity, line, round_rod, run_until, steady, steps_of};
use super::theory::friction::{
    PART_OF_BELT, rolling_acceleration, sliding_acceleration, spinning_acceleration,
};
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::contact::{ContactModel, ContactParameters, FrictionAt};
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_engine::mechanics::rigid_body::RigidBody;
use rodlab_engine::mechanics::scene::{
    Clamp, LoadKind, Motion, Obstacle, Plane, RodDescription, Scene,
};

const ROLLING: Expectation = Expectation::new(
    "a = g sin α/(1 + I/(m h²)) = ⅔ g sin α",
    "Coulomb; rolling without slip",
);
const SLIPPING: Expectation = Expectation::new("a = g (sin α − μ cos α)", "Coulomb");
const SPINNING: Expectation = Expectation::new("ω̇ = μ m g cos α h/I = 2 μ g cos α/h", "Coulomb");
const BELT: Expectation =
    Expectation::new("v = V/(1 + m h²/I) = V/3", "balance of momentum and spin");
const GEARS: Expectation = Expectation::new("ω₂/ω₁ = −h₁/h₂", "rolling without slip");

const GRAVITY: f64 = 9.81;
/// The models that can turn rods, by their names in scenario files.
const MODELS: [(ContactModel, &str); 2] = [
    (ContactModel::ImplicitContact, "imc"),
    (ContactModel::IncrementalPotential, "ipc"),
];
/// Radius of the rods, m, and largest allowed relative error.
const RADIUS: f64 = 5e-3;
const BOUND: f64 = 1e-4;

/// Runs all checks for each model that can turn rods.
pub(super) fn checks() -> Result<Vec<Check>, GroupError> {
    let mut checks = Vec::new();
    for (model, name) in MODELS {
        let (shallow, steep) = (20f64.to_radians(), 45f64.to_radians());
        let [along, _] = on_incline(model, shallow, 0.4)?;
        let row = format!("rod across an incline of 20°, μ = 0.4, {name}: acceleration");
        let expected = rolling_acceleration(GRAVITY, shallow);
        checks.push(ROLLING.of(row, "m/s²").relative(expected, along, BOUND));
        let [along, spin] = on_incline(model, steep, 0.2)?;
        let row = format!("rod across an incline of 45°, μ = 0.2, {name}: acceleration");
        let expected = sliding_acceleration(GRAVITY, steep, 0.2);
        checks.push(SLIPPING.of(row, "m/s²").relative(expected, along, BOUND));
        let row = format!("rod across an incline of 45°, μ = 0.2, {name}: rate of spin");
        let expected = spinning_acceleration(GRAVITY, steep, 0.2, RADIUS);
        checks.push(SPINNING.of(row, "rad/s²").relative(expected, -spin, BOUND));
        let speed = 0.1;
        let row = format!("rod on a belt of 0.1 m/s, {name}: speed in the end");
        let found = on_belt(model, speed)?;
        checks.push(
            BELT.of(row, "m/s")
                .relative(PART_OF_BELT * speed, found, BOUND),
        );
        for (driver, large) in [("rod", 8e-3), ("roller", 20e-3)] {
            let row = format!("rod driven by a {driver} of {large} m, {name}: ratio of rates");
            let found = driven(model, driver == "rod", large)?;
            checks.push(GEARS.of(row, "").relative(-large / RADIUS, found, BOUND));
        }
    }
    Ok(checks)
}

fn at_surface(model: ContactModel, friction: f64) -> ContactParameters {
    ContactParameters {
        friction_at: FrictionAt::Surface,
        distance_tolerance: 0.01 * RADIUS,
        ..contact_parameters(model, friction)
    }
}

/// A rod along x, 10 cm long, with its axis at a height (m).
fn rod_at(height: f64, radius: f64) -> RodDescription {
    let end = |x: f64| Vector3::new(x, 0.0, height);
    round_rod(line(end(-0.05), end(0.05), 2), 1e8, radius)
}

/// Velocity of the middle node along y (m/s), and angle of the first edge, rad.
fn state(simulation: &Simulation) -> [f64; 2] {
    [simulation.velocities()[1].y, simulation.edge_angles()[0]]
}

/// Mean rate of the angle of the first edge over the next step, which ends at a given time, rad/s.
fn spin(simulation: &mut Simulation, step: f64) -> Result<f64, GroupError> {
    let before = state(simulation)[1];
    let end = simulation.time() + step;
    run_until(simulation, end)?;
    Ok((state(simulation)[1] - before) / step)
}

/// Acceleration along the incline (m/s²) and of the spin (rad/s²) of a rod across it.
fn on_incline(model: ContactModel, incline: f64, friction: f64) -> Result<[f64; 2], GroupError> {
    let scene = Scene {
        rods: vec![rod_at(RADIUS + 2e-5, RADIUS)],
        loads: vec![steady(LoadKind::Gravity {
            acceleration: GRAVITY * Vector3::new(0.0, libm::sin(incline), -libm::cos(incline)),
        })],
        planes: vec![Plane {
            point: Vector3::zeros(),
            normal: Vector3::z(),
            friction: None,
            directed_friction: None,
        }],
        contact: Some(at_surface(model, friction)),
        ..Scene::default()
    };
    let step = 5e-4;
    let mut simulation = Simulation::new(&scene, &steps_of(step))?;
    let mut rates = Vec::new();
    for start in [0.05, 0.15] {
        run_until(&mut simulation, start)?;
        let rate = spin(&mut simulation, step)?;
        rates.push([state(&simulation)[0], rate]);
    }
    Ok(std::array::from_fn(|k| (rates[1][k] - rates[0][k]) / 0.1))
}

/// Final rolling speed of a rod laid on a belt, m/s.
fn on_belt(model: ContactModel, speed: f64) -> Result<f64, GroupError> {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let corners = corners.map(|[x, y]| Vector3::new(x, y - 0.1, 0.0)).to_vec();
    let belt = RigidBody::of_mesh(corners, vec![[0, 1, 2], [0, 2, 3]], false)
        .map_err(|fault| fault.to_string())?;
    let scene = Scene {
        rods: vec![rod_at(RADIUS + 2e-5, RADIUS)],
        loads: vec![gravity(GRAVITY)],
        obstacles: vec![Obstacle {
            name: "belt".into(),
            body: belt,
            motion: Motion {
                translation: vec![(0.0, Vector3::zeros()), (1.0, Vector3::y() * speed)],
                ..Motion::default()
            },
            ..Obstacle::default()
        }],
        contact: Some(at_surface(model, 0.4)),
        ..Scene::default()
    };
    let mut simulation = Simulation::new(&scene, &steps_of(5e-4))?;
    run_until(&mut simulation, 0.2)?;
    Ok(state(&simulation)[0])
}

/// Ratio of the spin rate of a rod on pins to that of a rod of a given radius (m), or of a roller,
/// that turns under it.
fn driven(model: ContactModel, by_rod: bool, large: f64) -> Result<f64, GroupError> {
    let rate = if by_rod { 3.0 } else { -2.0 };
    let pin = |node: usize| Clamp {
        holds_frame: false,
        ..clamp(node)
    };
    let mut scene = Scene {
        rods: vec![rod_at(large + RADIUS + 2e-5, RADIUS)],
        clamps: vec![pin(0), pin(2)],
        loads: vec![steady(force_on(1, Vector3::z() * -0.5))],
        contact: Some(at_surface(model, 0.4)),
        ..Scene::default()
    };
    let turning = Motion {
        angular_velocity: rate,
        ..Motion::default()
    };
    if by_rod {
        scene.rods.push(RodDescription {
            name: "driver".into(),
            radius: large,
            ..rod_at(0.0, RADIUS)
        });
        scene.clamps.extend([0, 2].map(|node| Clamp {
            rod: 1,
            motion: turning.clone(),
            ..clamp(node)
        }));
    } else {
        let ends = [-1.0, 1.0].map(|side| Vector3::x() * side);
        scene.obstacles.push(Obstacle {
            name: "roller".into(),
            body: RigidBody::capsule(ends, large),
            motion: Motion {
                axis: Some(Vector3::x()),
                ..turning
            },
            ..Obstacle::default()
        });
    }
    let step = 1e-3;
    let mut simulation = Simulation::new(&scene, &steps_of(step))?;
    run_until(&mut simulation, 1.0)?;
    Ok(spin(&mut simulation, step)? / rate)
}
