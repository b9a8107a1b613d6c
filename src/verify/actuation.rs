//! Rods that bend, twist and lengthen by themselves, from scenario files.

use super::theory::swimmer::Swimmer;
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_engine::mechanics::fluid::DragCoefficients;
use rodlab_lab::experiment;
use std::f64::consts::{PI, TAU};
use std::path::Path;

const ARC: Expectation = Expectation {
    formula: "x = sin(κL)/κ, z = −(1 − cos κL)/κ",
    source: "arc of a circle",
};
const FREE: Expectation = Expectation {
    formula: "M = EI (κ − κ̃) = 0",
    source: "no load, no stress",
};
const TWIST: Expectation = Expectation {
    formula: "θ = τ̃ L",
    source: "no load, no stress",
};
const LENGTH: Expectation = Expectation {
    formula: "x = (1 + e) L",
    source: "no load, no stress",
};
const SWIMMER: Expectation = Expectation {
    formula: "U = (ζ⊥/ζ∥ − 1) ∫ ⟨ẏ y'⟩ dx/L",
    source: "Gray and Hancock 1955, finite length",
};

/// Natural strains of the file of three rods when they have grown.
const CURVATURE: f64 = 10.0;
const TURNS_PER_LENGTH: f64 = 5.0;
const GROWTH: f64 = 0.25;
/// Their length, m.
const THREE: f64 = 0.3;
/// Polygons of 60 edges that turn by κh = 0.05: a circle larger by (κh)²/24.
const ARC_BOUND: f64 = 2e-4;
const EXACT: f64 = 1e-6;

/// Rods without load take their natural shape, at rest and after they have moved there; a filament swims.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let text = include_str!("scenes/actuated_rods.toml");
    let grown = [
        format!("actuation.0.values=[[0, {CURVATURE}]]"),
        format!("actuation.1.values=[[0, \"{TURNS_PER_LENGTH} turn/m\"]]"),
        format!("actuation.2.values=[[0, {GROWTH}]]"),
    ];
    let mut at_rest = simulation(text, &grown)?;
    at_rest.find_equilibrium()?;
    let mut moved = simulation(text, &[])?;
    run(&mut moved, 3.0)?;
    let mut checks = three_rods("at rest", &at_rest);
    checks.extend(three_rods("moved there", &moved));
    checks.push(swimmer()?);
    Ok(checks)
}

fn simulation(text: &str, overrides: &[String]) -> Result<Simulation, GroupError> {
    let loaded = experiment::from_text("scene", text, Path::new(""), overrides)?;
    let prepared = experiment::prepare(&loaded.scenario).map_err(|issues| loaded.locate(issues))?;
    Ok(Simulation::new(&prepared.scene, &prepared.integration)?)
}

fn run(simulation: &mut Simulation, until: f64) -> Result<(), GroupError> {
    while simulation.time() < until {
        simulation.advance(until)?;
    }
    Ok(())
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
    let name = |what: &str| format!("{what}, {how}");
    vec![
        ARC.scaled(
            name("cantilever of natural curvature: distance of its end"),
            "L",
            0.0,
            (ends[0] - arc).norm() / THREE,
            1.0,
            ARC_BOUND,
        ),
        FREE.scaled(
            name("cantilever of natural curvature: largest moment"),
            "EI κ̃",
            0.0,
            largest / (bending * CURVATURE),
            1.0,
            EXACT,
        ),
        TWIST.relative(
            name("rod of natural twist: angle of its end"),
            "rad",
            TURNS_PER_LENGTH * TAU * (THREE - 0.5 * THREE / 60.0),
            simulation.total_twist(1),
            EXACT,
        ),
        LENGTH.relative(
            name("rod that lengthens: its end"),
            "m",
            (1.0 + GROWTH) * THREE,
            ends[2].x,
            EXACT,
        ),
    ]
}

/// Speed over whole cycles, once the start is forgotten.
fn swimmer() -> Result<Check, GroupError> {
    let mut simulation = simulation(include_str!("scenes/swimmer.toml"), &[])?;
    let centre = |simulation: &Simulation| {
        let inner: Vector3 = simulation.positions()[1..120].iter().sum();
        let ends = simulation.positions()[0] + simulation.positions()[120];
        (inner + 0.5 * ends).x / 120.0
    };
    let (start, end) = (3.0, 6.0);
    run(&mut simulation, start)?;
    let before = centre(&simulation);
    run(&mut simulation, end)?;
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
    Ok(SWIMMER.relative(
        "swimming filament, 2.5 waves: speed",
        "m/s",
        expected,
        got,
        0.02,
    ))
}
