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
use std::f64::consts::{PI, TAU};

const ROLLING: Expectation = Expectation::new(
    "a = g sin α/(1 + I/(m h²)) = ⅔ g sin α",
    "Coulomb; rolling without slip",
);
const SLIPPING: Expectation = Expectation::new("a = g (sin α − μ cos α)", "Coulomb");
const SPINNING: Expectation = Expectation::new("ω̇ = μ m g cos α h/I = 2 μ g cos α/h", "Coulomb");
const BELT: Expectation =
    Expectation::new("v = V/(1 + m h²/I) = V/3", "balance of momentum and spin");
const GEARS: Expectation = Expectation::new("ω₂/ω₁ = −h₁/h₂", "rolling without slip");

const TROUGH: Expectation =
    Expectation::new("T = 2π √(3 (R − h)/2g) (1 + φ²/16)", "rolling without slip");

const GRAVITY: f64 = 9.81;
/// A driver of rods.
const PRISM: &str = "smooth prism of 24 faces";
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
        for (driver, large) in [("rod", 8e-3), ("roller", 20e-3), (PRISM, 20e-3)] {
            let row = format!("rod driven by a {driver} of {large} m, {name}: ratio of rates");
            let found = driven(model, driver, large)?;
            checks.push(GEARS.of(row, "").relative(-large / RADIUS, found, BOUND));
        }
        let row = format!("rod in a smooth mesh of a trough, {name}: half of its period");
        let [expected, found] = in_trough(model)?;
        checks.push(TROUGH.of(row, "s").relative(expected, found, BOUND));
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

/// Part of a cylinder of a radius (m) around the x axis, from `start` by `count` angles `step`
/// (rad), as a smooth mesh that rods touch from both sides.
fn shell(radius: f64, start: f64, step: f64, count: usize) -> Result<RigidBody, GroupError> {
    let closes = (step * count as f64 - TAU).abs() < 1e-9;
    let columns = if closes { count } else { count + 1 };
    let corner = |k: usize| {
        let (sine, cosine) = libm::sincos(start + step * (k % columns) as f64);
        let side = if k < columns { -1.0 } else { 1.0 };
        Vector3::new(side, radius * sine, -radius * cosine)
    };
    let faces = (0..count).flat_map(|k| {
        let next = (k + 1) % columns;
        [[k, columns + k, columns + next], [k, columns + next, next]]
    });
    let body = RigidBody::of_mesh(
        (0..2 * columns).map(corner).collect(),
        faces.collect(),
        false,
    );
    let body = body.map_err(|fault| fault.to_string())?;
    Ok(body.smoothed(0.5))
}

/// Half of the period of a rod that rolls in a trough of facets of 0.1 rad: in theory, and in a
/// motion.
fn in_trough(model: ContactModel) -> Result<[f64; 2], GroupError> {
    let (radius, tilt) = (0.5, 0.2);
    let arm = radius - RADIUS;
    let mut rod = rod_at(0.0, RADIUS);
    let place = Vector3::new(0.0, libm::sin(tilt), -libm::cos(tilt)) * (arm - 2e-5);
    rod.centreline.iter_mut().for_each(|node| *node += place);
    let scene = Scene {
        rods: vec![rod],
        loads: vec![gravity(GRAVITY)],
        obstacles: vec![Obstacle {
            name: "trough".into(),
            body: shell(radius, -0.45, 0.1, 9)?,
            ..Obstacle::default()
        }],
        contact: Some(at_surface(model, 0.4)),
        ..Scene::default()
    };
    let mut simulation = Simulation::new(&scene, &steps_of(5e-4))?;
    let mut crossings = Vec::new();
    let mut before = (0.0, simulation.positions()[1].y);
    while crossings.len() < 2 && simulation.time() < 2.0 {
        simulation.advance(2.0)?;
        let now = (simulation.time(), simulation.positions()[1].y);
        if before.1 * now.1 <= 0.0 {
            let part = before.1 / (before.1 - now.1);
            crossings.push(before.0 + (now.0 - before.0) * part);
        }
        before = now;
    }
    let [first, second] = crossings[..] else {
        return Err(GroupError::from(
            "the rod does not roll through the trough".to_owned(),
        ));
    };
    let expected = PI * (1.5 * arm / GRAVITY).sqrt() * (1.0 + tilt * tilt / 16.0);
    Ok([expected, second - first])
}

/// Ratio of the spin rate of a rod on pins to that of a rod of a given radius (m), or of a roller,
/// that turns under it.
fn driven(model: ContactModel, driver: &str, large: f64) -> Result<f64, GroupError> {
    let by_rod = driver == "rod";
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
        let body = match driver {
            PRISM => shell(large, 0.0, TAU / 24.0, 24)?,
            _ => RigidBody::capsule(ends, large),
        };
        scene.obstacles.push(Obstacle {
            name: "roller".into(),
            body,
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
