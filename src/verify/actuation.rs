//! Actuated rods that bend, twist and lengthen, from scenario files.

use super::rods::run_until;
use super::scenario::{at_rest, moved, simulation};
use super::theory::swimmer::Swimmer;
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_engine::mechanics::fluid::DragCoefficients;
use std::f64::consts::{PI, TAU};

const ARC: Expectation = Expectation::new("x = sin(κL)/κ, z = −(1 − cos κL)/κ", "arc of a circle");
const FREE: Expectation = Expectation::new("M = EI (κ − κ̃) = 0", "no load, no stress");
const TWIST: Expectation = Expectation::new("θ = τ̃ L", "no load, no stress");
const LENGTH: Expectation = Expectation::new("x = (1 + e) L", "no load, no stress");
const SWIMMER: Expectation = Expectation::new(
    "U = (ζ⊥/ζ∥ − 1) ∫ ⟨ẏ y'⟩ dx/L",
    "Gray and Hancock 1955, finite length",
);

/// Curvature of the grown rods in the file of three rods, 1/m.
const CURVATURE: f64 = 10.0;
const TURNS_PER_LENGTH: f64 = 5.0;
const GROWTH: f64 = 0.25;
/// Length of these rods, m.
const THREE: f64 = 0.3;
/// Error bound for polygons of 60 edges that turn by κh = 0.05: their circle is larger by
/// (κh)²/24.
const ARC_BOUND: f64 = 2e-4;
const EXACT: f64 = 1e-6;

/// Unloaded rods take their natural shape, in the static solution and after motion; a filament
/// swims.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let text = include_str!("scenes/actuated_rods.toml");
    let grown = [
        format!("actuation.0.values=[[0, {CURVATURE}]]"),
        format!("actuation.1.values=[[0, \"{TURNS_PER_LENGTH} turn/m\"]]"),
        format!("actuation.2.values=[[0, {GROWTH}]]"),
    ];
    let at_rest = at_rest(text, &grown)?;
    let moved = moved(text, &[], 3.0)?;
    let mut checks = three_rods("at rest", &at_rest);
    checks.extend(three_rods("moved there", &moved));
    checks.push(swimmer()?);
    Ok(checks)
}

fn three_rods(how: &str, simulation: &Simulation) -> Vec<Check> {
    let positions = simulation.positions();
    let ends = [60, 121, 182].map(|node| positions[node]);
    let (sine, cosine) = libm::sincos(CURVATURE * THREE);
    let arc = Vector3::new(sine, 0.0, cosine - 1.0) / CURVATURE;
    let bending = 1e9 * PI * 2e-3_f64.powi(4) / 4.0;
    let moments = simulation.resultants();
    let moments = moments[..61].iter().flatten();
    let largest = moments.fold(0.0, |most, found| f64::max(most, found.bending_moment));
    let quantity =
        |expectation: Expectation, what: &str, unit| expectation.of(format!("{what}, {how}"), unit);
    let end = "cantilever of natural curvature: distance of its end";
    let moment = "cantilever of natural curvature: largest moment";
    let twist = TURNS_PER_LENGTH * TAU * (THREE - 0.5 * THREE / 60.0);
    vec![
        quantity(ARC, end, "L").zero((ends[0] - arc).norm() / THREE, ARC_BOUND),
        quantity(FREE, moment, "EI κ̃").zero(largest / (bending * CURVATURE), EXACT),
        quantity(TWIST, "rod of natural twist: angle of its end", "rad").relative(
            twist,
            simulation.total_twist(1),
            EXACT,
        ),
        quantity(LENGTH, "rod that lengthens: position of its end", "m").relative(
            (1.0 + GROWTH) * THREE,
            ends[2].x,
            EXACT,
        ),
    ]
}

/// Speed over whole cycles, after the initial transient.
fn swimmer() -> Result<Check, GroupError> {
    let mut simulation = simulation(include_str!("scenes/swimmer.toml"), &[])?;
    let centre = |simulation: &Simulation| {
        let inner: Vector3 = simulation.positions()[1..120].iter().sum();
        let ends = simulation.positions()[0] + simulation.positions()[120];
        (inner + 0.5 * ends).x / 120.0
    };
    let (start, end) = (3.0, 6.0);
    run_until(&mut simulation, start)?;
    let before = centre(&simulation);
    run_until(&mut simulation, end)?;
    let got = (centre(&simulation) - before) / (end - start);
    let (length, radius) = (0.1, 1e-3_f64);
    let drag = DragCoefficients::slender_cylinder(5.0, length, radius)?;
    let theory = Swimmer {
        length,
        bending_stiffness: 1e6 * PI * radius.powi(4) / 4.0,
        drag_across: drag.across,
        drag_along: drag.along,
        curvature: 8.0,
        wave_number: TAU / 0.04,
        angular_frequency: TAU,
    };
    let expected = theory.speed().ok_or("no waves fit the filament")?;
    let name = "swimming filament, 2.5 waves: speed";
    Ok(SWIMMER.of(name, "m/s").relative(expected, got, 0.02))
}
