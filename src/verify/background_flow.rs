//! Rods in a flow of the fluid, and quadratic drag, against closed forms and an independent
//! solution.

use super::rods::run_until;
use super::scenario::{at_rest, moved, simulation};
use super::theory::cable::Cable;
use super::theory::filament::{
    buckling_growth, buckling_load, growth_while_turning, load_while_turning,
};
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use std::f64::consts::{FRAC_PI_2, PI};

const LINE: Expectation = Expectation::new("cot φ = cot φ₀ + γ t", "Jeffery 1922, r → ∞");
const ORBIT: Expectation = Expectation::new(
    "T = 2π/γ (r + 1/r), r² = 1 + 2C/S, C φ' + S φ' = −γ (C sin² φ + S/2)",
    "Jeffery 1922, balance of moments",
);
const BUCKLED: Expectation = Expectation::new(
    "λ y = y + ξ y' − r (1/4 − ξ²) y''/2 − (r/η) y'''', η = ξ_∥ ε L⁴/B",
    "Young and Shelley 2007, Galerkin",
);
const TURNED: Expectation = Expectation::new(
    "dy/dc = −c/(1 + c²) (y + ξ y' − r (1/4 − ξ²) y''/2) − (r/η) y'''', c = γ t + cot φ₀",
    "Becker and Shelley 2001, Galerkin",
);
const CARRIED: Expectation = Expectation::new("x = p + exp(ω t) (x₀ − p)", "rigid rotation");
const FALL: Expectation = Expectation::new("v² = 2 m g/(ρ d C)", "Morison et al. 1950");
const CABLE: Expectation = Expectation::new("d(T t)/ds = w z − f(t)", "Berteaux 1976, Runge–Kutta");

/// Checks rods in shear and rotation, rods that sink, and a cable in a current.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let mut checks = filaments_in_shear()?;
    checks.push(dumbbell()?);
    checks.push(buckling()?);
    checks.push(buckling_while_turning()?);
    checks.push(vortex()?);
    checks.extend(falling_rods()?);
    checks.extend(cable()?);
    Ok(checks)
}

fn filaments_in_shear() -> Result<Vec<Check>, GroupError> {
    let mut checks = Vec::new();
    for model in ["rss", "resistive"] {
        let overrides = [format!("fluid.model = \"{model}\"")];
        let text = include_str!("scenes/filament_in_shear.toml");
        let simulation = moved(text, &overrides, 0.3)?;
        let positions = simulation.positions();
        let along = positions[20] - positions[0];
        let name = format!("stiff filament across a shear flow, {model}: angle after 3/γ");
        let found = libm::atan2(along.y, along.x);
        checks.push(
            LINE.of(name, "rad")
                .relative(libm::atan(1.0 / 3.0), found, 1e-3),
        );
    }
    Ok(checks)
}

/// The dumbbell turns from across the flow to across the flow in half a period.
fn dumbbell() -> Result<Check, GroupError> {
    let (viscosity, rate, reach, ball, radius, edges) = (1.0, 10.0, 0.03, 8e-3, 3e-4, 20);
    let length: f64 = 2.0 * reach;
    let across = 4.0 * PI * viscosity / (libm::log(2.0 * length / radius) - 0.5);
    let edge = length / f64::from(edges);
    let mut resisting = 2.0 * 6.0 * PI * viscosity * ball * reach * reach;
    for node in 1..edges {
        let place = f64::from(node) * edge - reach;
        if reach - place.abs() > ball {
            resisting += across * edge * place * place;
        }
    }
    let spinning = 2.0 * 8.0 * PI * viscosity * ball.powi(3);
    let ratio = (1.0 + 2.0 * resisting / spinning).sqrt();
    let half_period = PI / rate * (ratio + 1.0 / ratio);
    let mut simulation = simulation(include_str!("scenes/dumbbell_in_shear.toml"), &[])?;
    let (mut angle, mut time) = (FRAC_PI_2, 0.0);
    loop {
        simulation.advance(3.0)?;
        let along = simulation.positions()[20] - simulation.positions()[0];
        // The bar turns clockwise, by less than a turn.
        let mut next = libm::atan2(along.y, along.x);
        if next > FRAC_PI_2 + 0.1 {
            next -= 2.0 * PI;
        }
        let now = simulation.time();
        if next <= -FRAC_PI_2 {
            time += (now - time) * (angle + FRAC_PI_2) / (angle - next);
            break;
        }
        if now >= 3.0 {
            return Err(format!("the bar has turned to {next} rad only").into());
        }
        (angle, time) = (next, now);
    }
    let name = "two balls on a bar tumble in a shear flow, resistive: half of the period";
    Ok(ORBIT.of(name, "s").relative(half_period, time, 2e-3))
}

/// The filament of the scenes that buckle, in 1 Pa s: its ratio ξ_∥/ξ_⊥, and the rate (1/s) of a
/// flow for η = 1.
fn slender_filament() -> [f64; 2] {
    let (length, radius, modulus): (f64, f64, f64) = (0.01, 1e-4, 20e6);
    let logarithm = libm::log(2.0 * length / radius);
    let [along, across] = [2.0 * PI / (logarithm - 1.5), 4.0 * PI / (logarithm - 0.5)];
    let stiffness = modulus * PI * radius.powi(4) / 4.0;
    [along / across, stiffness / (along * length.powi(4))]
}

/// Logarithm of the growth of the deflection of the middle from the chord between two times, s.
fn growth_of_bend(text: &str, overrides: &[String], times: [f64; 2]) -> Result<f64, GroupError> {
    let mut simulation = simulation(text, overrides)?;
    let mut logarithms = [0.0; 2];
    for (logarithm, time) in logarithms.iter_mut().zip(times) {
        run_until(&mut simulation, time)?;
        let x = simulation.positions();
        let bend = x[20] - (x[0] + x[40]) * 0.5;
        *logarithm = libm::log(bend.norm());
    }
    Ok(logarithms[1] - logarithms[0])
}

/// η at which the bend of the simulated filament neither grows nor decays, near the theoretical
/// load, from the growth found and expected at 0.9 and 1.1 times this load.
fn load_found(
    load: f64,
    found: impl Fn(f64) -> Result<f64, GroupError>,
    expected: impl Fn(f64) -> f64,
) -> Result<f64, GroupError> {
    let etas = [0.9 * load, 1.1 * load];
    let found = [found(etas[0])?, found(etas[1])?];
    let exact = etas.map(expected);
    // The growth changes in proportion to η near the load.
    let slope = (exact[1] - exact[0]) / (etas[1] - etas[0]);
    let shift = (found[0] + found[1] - exact[0] - exact[1]) / 2.0;
    Ok(load - shift / slope)
}

/// A slightly bent filament whose bend grows or decays exponentially.
fn buckling() -> Result<Check, GroupError> {
    let [ratio, unit] = slender_filament();
    let load = buckling_load(ratio);
    // λ, after higher modes have decayed.
    let growth = |eta: f64| -> Result<f64, GroupError> {
        let rate = eta * unit;
        let text = include_str!("scenes/filament_in_extension.toml");
        let times = [1.0 / rate, 3.0 / rate];
        Ok(growth_of_bend(text, &[format!("fluid.flow.rate = {rate:e}")], times)? / 2.0)
    };
    let found = load_found(load, growth, |eta| buckling_growth(eta, ratio))?;
    let name =
        "filament compressed by an extensional flow, resistive, 40 edges: rate at which it buckles";
    Ok(BUCKLED
        .of(name, "1/s")
        .relative(load * unit, found * unit, 5e-3))
}

/// A slightly bent filament that a shear flow turns from cot φ = −4 to −3, where higher modes have
/// decayed, and on to φ = π/2, where the compression ends. At the critical rate of the flow, its
/// bend is then as large as at −3.
fn buckling_while_turning() -> Result<Check, GroupError> {
    const COTANGENTS: [i32; 3] = [-4, -3, 0];
    let [ratio, unit] = slender_filament();
    let load = load_while_turning(ratio, COTANGENTS);
    let growth = |eta: f64| {
        let rate = eta * unit;
        let overrides = [
            format!("fluid.flow.rate = {rate:e}"),
            format!("time.step = {:e}", 0.02 / rate),
        ];
        let text = include_str!("scenes/filament_through_compression.toml");
        let times = [1, 2].map(|k| f64::from(COTANGENTS[k] - COTANGENTS[0]) / rate);
        growth_of_bend(text, &overrides, times)
    };
    let found = load_found(load, growth, |eta| {
        growth_while_turning(eta, ratio, COTANGENTS)
    })?;
    let name = "filament turning in a shear flow, resistive, 40 edges: rate at which compression keeps its bend";
    Ok(TURNED
        .of(name, "1/s")
        .relative(load * unit, found * unit, 5e-3))
}

fn vortex() -> Result<Check, GroupError> {
    let text = include_str!("scenes/rod_in_vortex.toml");
    let mut simulation = simulation(text, &[])?;
    let placed = simulation.positions().to_vec();
    run_until(&mut simulation, 0.3)?;
    let (point, turned) = (Vector3::new(1e-3, 2e-3, 0.0), 3.0);
    let (sine, cosine) = libm::sincos(turned);
    let mut worst = 0.0_f64;
    for (x, placed) in simulation.positions().iter().zip(&placed) {
        let arm = placed - point;
        let exact = Vector3::new(
            cosine * arm.x - sine * arm.y,
            sine * arm.x + cosine * arm.y,
            arm.z,
        );
        worst = worst.max((x - point - exact).norm());
    }
    let name =
        "curved rod in a rotating fluid, rss: largest distance from its place after three radians";
    Ok(CARRIED.of(name, "m").scaled(0.0, worst, 5e-3, 2e-3))
}

fn falling_rods() -> Result<Vec<Check>, GroupError> {
    let (radius, density, acceleration) = (2e-3, 1000.0, 9.81);
    let weight = 8000.0 * PI * radius * radius * acceleration;
    let upright = "rods.0.shape.end = [0, 0, 0.2]".to_owned();
    let mut checks = Vec::new();
    for (how, overrides, coefficient) in [
        ("across", vec![], density * radius * 1.2),
        ("along", vec![upright], density * PI * radius * 0.02),
    ] {
        let simulation = moved(include_str!("scenes/falling_rod.toml"), &overrides, 3.0)?;
        let speed = -simulation.velocities()[2].z;
        let expected = (weight / coefficient).sqrt();
        // It approaches the last speed exponentially.
        let name = format!("rod sinking in water, moving {how} itself: speed after 3 s");
        let inertia = weight / acceleration
            + if how == "across" {
                density * PI * radius * radius
            } else {
                0.0
            };
        let expected = expected * libm::tanh(3.0 * weight / (inertia * expected));
        checks.push(FALL.of(name, "m/s").relative(expected, speed, 1e-4));
    }
    Ok(checks)
}

fn cable() -> Result<Vec<Check>, GroupError> {
    let simulation = at_rest(include_str!("scenes/cable_in_current.toml"), &[])?;
    let found = simulation.positions()[100];
    let radius = 1e-3;
    let cable = Cable {
        length: 1.0,
        diameter: 2.0 * radius,
        weight_per_length: 2000.0 * PI * radius * radius * 9.81,
        weight: 5e-3 * 9.81,
        density: 1000.0,
        normal: 1.2,
        tangential: 0.05,
        velocity: Vector3::x() * 0.2,
    };
    let expected = cable.end(1000);
    let name = |what: &str| format!("cable with a weight in a current, 100 edges: {what}");
    Ok(vec![
        CABLE
            .of(name("drift of its end"), "m")
            .relative(expected.x, found.x, 1e-3),
        CABLE
            .of(name("depth of its end"), "m")
            .relative(-expected.z, -found.z, 1e-3),
    ])
}
