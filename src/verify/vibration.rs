//! Small vibrations of a cantilever, from the eigenproblem of its stiffness and mass matrices.

use super::rods::{RADIUS, STIFFNESS_RATIO, clamp, line, unit_rod};
use super::theory::beam::{cantilever_wave_number, fixed_free_wave_number};
use super::{Check, Expectation, GroupError};
use crate::mechanics::Vector3;
use crate::mechanics::dynamics::{IntegrationParameters, Simulation, SimulationError};
use crate::mechanics::scene::Scene;

const BENDING: Expectation = Expectation {
    formula: "cos βL cosh βL = −1, ω = β² √(EI/ρA)",
    source: "Euler–Bernoulli",
};
const TORSION: Expectation = Expectation {
    formula: "ω = π/2L √(GJ/ρJ)",
    source: "wave equation",
};
const AXIAL: Expectation = Expectation {
    formula: "ω = π/2L √(EA/ρA)",
    source: "wave equation",
};
const BOUND: f64 = 5e-3;
const EDGES: usize = 50;

/// First three bending modes, first torsional and first axial mode.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let modes = Modes::of_cantilever()?;
    let mut checks = Vec::new();
    // Bending modes come in pairs, one in either plane.
    let bending = modes.frequencies(Motion::Bending);
    for mode in 1..=3 {
        checks.push(BENDING.relative(
            format!("cantilever, bending mode {mode}: ω"),
            "rad/s",
            cantilever_wave_number(mode).powi(2),
            bending[2 * mode - 2],
            BOUND,
        ));
    }
    // ρJ of the unit rod is h²/2, its EA 4/h².
    let torsion = fixed_free_wave_number(1) * (2.0 / STIFFNESS_RATIO).sqrt() / RADIUS;
    let got = modes.frequencies(Motion::Torsion)[0];
    checks.push(TORSION.relative(
        "cantilever, first torsional mode: ω",
        "rad/s",
        torsion,
        got,
        BOUND,
    ));
    let axial = fixed_free_wave_number(1) * 2.0 / RADIUS;
    let got = modes.frequencies(Motion::Axial)[0];
    checks.push(AXIAL.relative(
        "cantilever, first axial mode: ω",
        "rad/s",
        axial,
        got,
        BOUND,
    ));
    Ok(checks)
}

/// How a mode moves mostly.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    Bending,
    Torsion,
    Axial,
}

/// Angular frequencies of all modes of a rod along x, ascending, with the motion that holds most of their
/// kinetic energy.
struct Modes(Vec<(f64, Motion)>);

impl Modes {
    fn of_cantilever() -> Result<Self, SimulationError> {
        let scene = Scene {
            rods: vec![unit_rod(line(Vector3::zeros(), Vector3::x(), EDGES))],
            clamps: vec![clamp(0)],
            ..Scene::default()
        };
        let mut simulation = Simulation::new(&scene, &IntegrationParameters::default())?;
        let (mut matrix, masses) = (simulation.stiffness_matrix(), simulation.masses());
        let unknowns = simulation.free_unknowns();
        // K v = ω² M v with u = √M v becomes an ordinary symmetric eigenproblem.
        for i in 0..masses.len() {
            for j in 0..masses.len() {
                matrix[(i, j)] /= (masses[i] * masses[j]).sqrt();
            }
        }
        let eigen = matrix.symmetric_eigen();
        let mut modes: Vec<_> = eigen
            .eigenvalues
            .iter()
            .zip(eigen.eigenvectors.column_iter())
            .map(|(&squared, vector)| {
                let mut energy = [0.0; 4];
                for (&unknown, amplitude) in unknowns.iter().zip(vector.iter()) {
                    energy[unknown % 4] += amplitude * amplitude;
                }
                let motion = if energy[3] > 0.5 {
                    Motion::Torsion
                } else if energy[0] > 0.5 {
                    Motion::Axial
                } else {
                    Motion::Bending
                };
                (squared.max(0.0).sqrt(), motion)
            })
            .collect();
        modes.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(Self(modes))
    }

    fn frequencies(&self, motion: Motion) -> Vec<f64> {
        let own = self.0.iter().filter(|mode| mode.1 == motion);
        own.map(|mode| mode.0).collect()
    }
}
