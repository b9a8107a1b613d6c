//! Rods whose section varies: steps inside edges, and tapers. The rods come from scenario files.

use super::check::order;
use super::continuation::{critical_on_path, growing};
use super::frequencies::frequencies;
use super::rods::force_on;
use super::scenario::{prepared, simulation};
use super::theory::sections::{
    Part, conical_column_load, stepped_compliance, stepped_frequency, tapered_compliance,
};
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::Simulation;
use std::f64::consts::PI;

const STEPPED_ROD: &str = include_str!("scenes/stepped_rod.toml");
const TAPERED_ROD: &str = include_str!("scenes/tapered_rod.toml");

const STEPS: Expectation = Expectation::new("w/F = ∫ x²/EI dx", "Euler–Bernoulli");
const TAPER: Expectation = Expectation::new("w/F = (L³/3EI₀) r₀/r₁", "Euler–Bernoulli");
const TENSION: Expectation = Expectation::new("u/F = L/(π E r₀ r₁)", "∫ dx/EA");
const TORSION: Expectation = Expectation::new("θ/M = ∫ dx/GJ", "Saint-Venant");
const MODES: Expectation = Expectation::new("M = V = 0 of transfer matrices", "Euler–Bernoulli");
const DINNIK: Expectation = Expectation::new("tan(kL/ab) = −k/b, P = k² EI₁/a⁴", "Dinnik 1929");

/// Allowed relative error of deflections, frequencies and loads with 50 edges, which is of second
/// order.
const BOUND: f64 = 1e-3;
/// Allowed relative error of what sums over sections exactly.
const EXACT: f64 = 1e-9;
/// Edges of the scenario files.
const EDGES: usize = 50;

/// Young's modulus of the cone, Pa, and its radii, m; both rods are 1 m long.
const YOUNG: f64 = 1e9;
const RADII: [f64; 2] = [2e-3, 1e-3];

/// Checks deflections, frequencies and a buckling load.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let parts = parts();
    let exact = stepped_compliance(&parts);
    let [coarse, fine] = [EDGES / 2, EDGES].map(|edges| tip_compliance(STEPPED_ROD, edges));
    let (coarse, fine) = (coarse?, fine?);
    let name = "rod with a tube from inside an edge on: deflection per force at its end";
    let mut checks = vec![
        STEPS.of(name, "m/N").relative(exact, fine, BOUND),
        order(
            "the same, 25 to 50 edges: order",
            (coarse - exact) / (fine - exact),
        ),
    ];
    let found = frequencies(&mut simulation(STEPPED_ROD, &[])?)?;
    for mode in 1..=3 {
        // Modes come in pairs, one in each plane; those of torsion and stretching are faster.
        let name = format!("rod with a tube, mode {mode}: ω");
        let expected = stepped_frequency(&parts, mode);
        let got = found[2 * mode - 2];
        // The error is that of the edge length over the wavelength, squared.
        let bound = BOUND * (mode * mode) as f64;
        checks.push(MODES.of(name, "rad/s").relative(expected, got, bound));
    }
    let exact = tapered_compliance(YOUNG, 1.0, RADII);
    let got = tip_compliance(TAPERED_ROD, EDGES)?;
    let name = "cone: deflection per force at its end";
    checks.push(TAPER.of(name, "m/N").relative(exact, got, BOUND));
    checks.extend(stretched_and_twisted()?);
    let exact = conical_column_load(YOUNG, 1.0, RADII);
    let loads = [EDGES / 2, EDGES].map(|edges| critical_load(edges, 1.3 * exact));
    let [coarse, fine] = loads;
    let (coarse, fine) = (coarse?, fine?);
    checks.push(
        DINNIK
            .of("cone as a column, clamped and free: critical load", "N")
            .relative(exact, fine, BOUND),
    );
    checks.push(order(
        "the same, 25 to 50 edges: order",
        (coarse - exact) / (fine - exact),
    ));
    Ok(checks)
}

/// The parts of the stepped rod.
fn parts() -> [Part; 2] {
    let [radius, outer, inner] = [6e-3f64, 4e-3, 3e-3];
    let tube = |power: i32| outer.powi(power) - inner.powi(power);
    [
        Part {
            length: 0.413,
            bending: 1e9 * 0.25 * PI * radius.powi(4),
            mass_per_length: 1000.0 * PI * radius.powi(2),
        },
        Part {
            length: 1.0 - 0.413,
            bending: 3e9 * 0.25 * PI * tube(4),
            mass_per_length: 2000.0 * PI * tube(2),
        },
    ]
}

/// Displacement of an unknown per force on it, in the direction of that unknown.
fn compliance(simulation: &mut Simulation, unknown: usize) -> Result<f64, GroupError> {
    let place = simulation.free_unknowns();
    let place = place.iter().position(|own| *own == unknown);
    let place = place.ok_or("the unknown is held")?;
    let inverse = simulation.stiffness_matrix().try_inverse();
    let inverse = inverse.ok_or("the stiffness matrix is singular")?;
    Ok(inverse[(place, place)])
}

fn tip_compliance(text: &str, edges: usize) -> Result<f64, GroupError> {
    let mut simulation = simulation(text, &[format!("rods.0.edges={edges}")])?;
    compliance(&mut simulation, 4 * edges + 2)
}

/// The cone pulled along its axis at its end, and twisted at its last edge, whose angle is that in
/// its middle.
fn stretched_and_twisted() -> Result<[Check; 2], GroupError> {
    let mut cone = simulation(TAPERED_ROD, &[])?;
    let [thick, thin] = RADII;
    let length = 1.0 - 0.5 / EDGES as f64;
    let end = thick + (thin - thick) * length;
    // G = E/3; ∫ dx/r⁴ = l (r₀² + r₀ r + r²)/(3 r₀³ r³).
    let integral =
        length * (thick * thick + thick * end + end * end) / (3.0 * (thick * end).powi(3));
    let twisted = integral / (YOUNG / 3.0 * 0.5 * PI);
    let stretched = 1.0 / (PI * YOUNG * thick * thin);
    let got = [4 * EDGES, 4 * (EDGES - 1) + 3].map(|unknown| compliance(&mut cone, unknown));
    let [got_stretched, got_twisted] = got;
    Ok([
        TENSION
            .of("cone: stretch per tension", "m/N")
            .relative(stretched, got_stretched?, EXACT),
        TORSION
            .of("cone: rotation of the last edge per moment", "rad/N m")
            .relative(twisted, got_twisted?, EXACT),
    ])
}

/// Load at which the cone buckles, N.
fn critical_load(edges: usize, end: f64) -> Result<f64, GroupError> {
    let mut scene = prepared(TAPERED_ROD, &[format!("rods.0.edges={edges}")])?.scene;
    scene.loads = vec![growing(force_on(edges, -Vector3::x()))];
    Ok(critical_on_path(&scene, end)?)
}
