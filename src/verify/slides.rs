//! Nodes that slide along rods, from scenario files, against closed forms.

use super::check::order;
use super::rods::run_until;
use super::scenario::{at_rest, simulation};
use super::theory::friction::{sliding_acceleration, speed_on_hoop_squared};
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::Simulation;
use std::f64::consts::{FRAC_PI_2, PI};

const FALL: Expectation = Expectation::new("s = ½ g sin α t²", "Galileo");
const KEPT: Expectation = Expectation::new("E(t) = E(0)", "conservation");
const THROUGH: Expectation = Expectation::new("a = g (sin α − μ cos α)", "Coulomb");
const RING: Expectation = Expectation::new(
    "(L−2c) sin α + 2d cos α = D, c = 4λ sin²(θ/4), d = 2λ sin(θ/2), θ = π/2 − α, λ² = EI/T, 2T cos α = W",
    "statics, elastica",
);

const RUBBED: Expectation = Expectation::new("s = ½ g (sin α − μ cos α) t²", "Coulomb");
const HOOP: Expectation =
    Expectation::new("dv²/dφ = 2gR (cos φ − μ sin φ) − 2μ v²", "Newton, Coulomb");

/// Checks a shuttle on an incline, beads with friction, a rod in fixed eyelets, and a ring on a
/// slack rope.
pub fn checks() -> Result<Vec<Check>, GroupError> {
    let mut checks = Vec::from(incline()?);
    checks.extend([rubbed_incline()?, hoop()?, eyelets()?]);
    checks.extend(ring_on_rope()?);
    Ok(checks)
}

const SHUTTLE: &str = include_str!("scenes/shuttle_on_incline.toml");
const GRAVITY: f64 = 9.81;

fn rubbed_incline() -> Result<Check, GroupError> {
    let (friction, end) = (0.5, 0.4);
    let slide = "kind = \"slide\"";
    let text = SHUTTLE.replace(slide, &format!("{slide}\nfriction = {friction}"));
    let mut simulation = simulation(&text, &[])?;
    run_until(&mut simulation, end)?;
    let acceleration = sliding_acceleration(GRAVITY, libm::asin(0.8), friction);
    let place = simulation.positions()[81];
    let name = "shuttle sliding down a wire with friction 0.5: distance";
    let expected = 0.5 * acceleration * end * end;
    Ok(RUBBED
        .of(name, "m")
        .relative(expected, place.norm() - 0.05, 1e-9))
}

fn hoop() -> Result<Check, GroupError> {
    let mut simulation = simulation(include_str!("scenes/bead_on_hoop.toml"), &[])?;
    let angle = |simulation: &Simulation| {
        let place = simulation.positions()[81];
        libm::atan2(-place.z, -place.x)
    };
    while angle(&simulation) < FRAC_PI_2 && simulation.time() < 0.4 {
        simulation.advance(0.4)?;
    }
    let expected = speed_on_hoop_squared(GRAVITY, 0.2, 0.3, angle(&simulation));
    let found = simulation.velocities()[81].norm();
    let name = "bead sliding down a quarter of a hoop with friction 0.3: speed";
    Ok(HOOP.of(name, "m/s").relative(expected.sqrt(), found, 1e-3))
}

/// As long as the middle of the rod is between the eyelets, both press in the same direction.
fn eyelets() -> Result<Check, GroupError> {
    let mut simulation = simulation(include_str!("scenes/rod_in_eyelets.toml"), &[])?;
    let mut speed_at = |time: f64| -> Result<f64, GroupError> {
        run_until(&mut simulation, time)?;
        Ok(simulation.velocities()[4].x)
    };
    let (early, late) = (speed_at(0.05)?, speed_at(0.1)?);
    let expected = sliding_acceleration(10.0, libm::asin(0.6), 0.2);
    let name = "rod sliding down through two fixed eyelets with friction 0.2: acceleration";
    Ok(THROUGH
        .of(name, "m/s²")
        .relative(expected, (late - early) / 0.05, 1e-5))
}

fn incline() -> Result<[Check; 2], GroupError> {
    let mut simulation = simulation(SHUTTLE, &[])?;
    let energy = |simulation: &Simulation| simulation.energies().total();
    let (start, end) = (energy(&simulation), 0.4);
    let mut worst = 0.0_f64;
    while simulation.time() < end {
        simulation.advance(end)?;
        worst = worst.max((energy(&simulation) - start).abs());
    }
    let place = simulation.positions()[81];
    let kinetic = simulation.energies().kinetic;
    let name = "shuttle sliding down a wire over fifty of its edges, midpoint rule: distance";
    Ok([
        FALL.of(name, "m")
            .relative(0.5 * GRAVITY * 0.8 * end * end, place.norm() - 0.05, 1e-9),
        KEPT.of("the same: energy error over its kinetic energy", "J")
            .scaled(0.0, worst, kinetic, 1e-9),
    ])
}

/// Length of the rope, m.
const LENGTH: f64 = 1.0;
/// Distance of the posts, m.
const SPAN: f64 = 0.8;
/// Height of the second post above the first, m.
const RISE: f64 = 0.2;
/// Bending stiffness EI, N m².
const BENDING: f64 = 64e9 * PI * 1.6e-15 / 4.0;
/// Stretching stiffness EA, N.
const STRETCHING: f64 = 64e9 * PI * 4e-8;
/// Weight, N.
const WEIGHT: f64 = 0.02;

fn ring_on_rope() -> Result<[Check; 2], GroupError> {
    let file = include_str!("scenes/ring_on_rope.toml");
    let expected = ring_at_rest();
    let place = |edges: usize| -> Result<Vector3, GroupError> {
        let text = file
            .replace("edges = 80", &format!("edges = {edges}"))
            .replace("\"start\", 40", &format!("\"start\", {}", edges / 2));
        Ok(at_rest(&text, &[])?.positions()[edges + 1])
    };
    let fine = place(80)?;
    let off = (place(40)?.z - expected.z) / (fine.z - expected.z);
    let name = "ring on a slack rope between posts of different heights: distance from its rest position over the \
                length of the rope";
    let distance = (fine - expected).norm();
    Ok([
        RING.of(name, "m").scaled(0.0, distance, LENGTH, 1e-3),
        order("the same, height, 40 to 80 edges: order", off),
    ])
}

/// Rest position of the ring, m. The tensions on both sides are equal, and so are the angles α
/// with the vertical. At the ring the rope turns by θ = π/2 − α to become horizontal, with tan ϑ/4
/// ∝ e^(−s/λ). This shortens the rope by c and shifts its line by d.
fn ring_at_rest() -> Vector3 {
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    let bend = |angle: f64| {
        let tension = WEIGHT / (2.0 * libm::cos(angle));
        let (size, turn) = ((BENDING / tension).sqrt(), FRAC_PI_2 - angle);
        let shortening = 4.0 * size * libm::sin(0.25 * turn).powi(2);
        let aside = 2.0 * size * libm::sin(0.5 * turn);
        (LENGTH * (1.0 + tension / STRETCHING), shortening, aside)
    };
    for _ in 0..80 {
        let angle = 0.5 * (low + high);
        let (length, shortening, aside) = bend(angle);
        let reach = (length - 2.0 * shortening) * libm::sin(angle) + 2.0 * aside * libm::cos(angle);
        if reach < SPAN {
            low = angle;
        } else {
            high = angle;
        }
    }
    let (length, shortening, aside) = bend(low);
    let (sine, cosine) = (libm::sin(low), libm::cos(low));
    let arm = 0.5 * (length - RISE / cosine) - shortening;
    Vector3::new(
        arm * sine + aside * cosine,
        0.0,
        aside * sine - arm * cosine,
    )
}
