//! Small vibrations of straight rods, from the eigenproblem of their stiffness and mass matrices.
//! The rods come from scenario files, so that the default of `rods.inertia` is checked.

use super::scenario::{prepared, simulation};
use super::theory::beam::{
    cantilever_wave_number, fixed_free_wave_number, free_wave_number, stretched_frequency,
};
use super::{Check, Expectation, GroupError};
use std::f64::consts::TAU;

const CLAMPED: Expectation =
    Expectation::new("cos βL cosh βL = −1, ω = β² √(EI/ρA)", "Euler–Bernoulli");
const FREE: Expectation =
    Expectation::new("cos βL cosh βL = 1, ω = β² √(EI/ρA)", "Euler–Bernoulli");
const TORSION: Expectation = Expectation::new("ω = (2n − 1) π/2L √(G/ρ)", "wave equation");
const AXIAL: Expectation = Expectation::new("ω = π/2L √(E/ρ)", "wave equation");
const STRING: Expectation = Expectation::new(
    "f = (n/2L) √(T/μ), corrected for EI and clamps",
    "Timoshenko",
);
/// Error bound for fourth-order convergence with 50 edges.
const BOUND: f64 = 1e-5;
/// Error bound of axial waves. With the mass matrix for fourth-order bending, these waves have an
/// error of second order, (kh)²/24.
const AXIAL_BOUND: f64 = 5e-5;
/// Error bound of the string with 100 edges. The error is of second order, since waves of tension
/// have the error (kh)²/24, too, and the bends at the clamps are only five edges long.
const STRING_BOUND: f64 = 1e-3;

const FREE_ROD: &str = include_str!("scenes/free_rod.toml");
const CANTILEVER: &str = concat!(
    include_str!("scenes/free_rod.toml"),
    "[[clamps]]\nrod = \"rod\"\nat = \"start\"\n"
);
const STRETCHED_STRING: &str = include_str!("scenes/stretched_string.toml");

/// Speed of axial waves √(E/ρ) in the rods of the files, m/s.
const AXIAL_SPEED: f64 = 1000.0;
/// Radius of gyration √(I/A) of these rods, half their radius, m.
const GYRATION: f64 = 5e-3;

/// Checks the first three modes of bending (clamped, free and stretched) and of torsion, and the
/// first axial mode.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let clamped = Modes::of(CANTILEVER, &[])?;
    let free = Modes::of(FREE_ROD, &[])?;
    let mut checks = Vec::new();
    let cases = [
        (
            "cantilever",
            CLAMPED,
            &clamped,
            cantilever_wave_number as fn(usize) -> f64,
        ),
        ("free rod", FREE, &free, free_wave_number),
    ];
    for (name, expectation, modes, wave_number) in cases {
        // Bending modes come in pairs, one in each plane.
        let bending = modes.frequencies(Motion::Bending);
        for mode in 1..=3 {
            let name = format!("{name}, bending mode {mode}: ω");
            let expected = wave_number(mode).powi(2) * GYRATION * AXIAL_SPEED;
            let got = bending[2 * mode - 2];
            checks.push(expectation.of(name, "rad/s").relative(expected, got, BOUND));
        }
    }
    let torsion = clamped.frequencies(Motion::Torsion);
    for mode in 1..=3 {
        // G = E/3 with Poisson's ratio one half.
        let name = format!("cantilever, torsional mode {mode}: ω");
        let expected = fixed_free_wave_number(mode) * AXIAL_SPEED / 3f64.sqrt();
        let got = torsion[mode - 1];
        checks.push(TORSION.of(name, "rad/s").relative(expected, got, BOUND));
    }
    let name = "cantilever, first axial mode: ω";
    let expected = fixed_free_wave_number(1) * AXIAL_SPEED;
    let got = clamped.frequencies(Motion::Axial)[0];
    checks.push(AXIAL.of(name, "rad/s").relative(expected, got, AXIAL_BOUND));
    checks.extend(stretched_string(&[])?);
    Ok(checks)
}

/// The first modes of a string with an initial tension.
fn stretched_string(overrides: &[String]) -> Result<Vec<Check>, GroupError> {
    let prepared = prepared(STRETCHED_STRING, overrides)?;
    let rod = &prepared.scene.rods[0];
    // The stretched string has less mass per length, and a piece of it bends like the shorter
    // stress-free piece.
    let stretch = 1.0 + rod.pretension / rod.stiffness.stretching;
    let bending = rod.stiffness.bending[0] * stretch;
    let mass = rod.mass_per_length / stretch;
    let modes = Modes::of(STRETCHED_STRING, overrides)?.frequencies(Motion::Bending);
    let check = |mode: usize| {
        let expected = stretched_frequency(mode, rod.pretension, bending, mass, 1.0);
        STRING
            .of(format!("stretched string, mode {mode}: f"), "Hz")
            .relative(expected / TAU, modes[2 * mode - 2] / TAU, STRING_BOUND)
    };
    Ok((1..=3).map(check).collect())
}

/// Dominant motion of a mode.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    Bending,
    Torsion,
    Axial,
}

/// Angular frequencies of all modes of a rod along x, ascending, with the motion that has most of
/// their kinetic energy. Rigid-body modes are not included.
struct Modes(Vec<(f64, Motion)>);

impl Modes {
    /// Computes the modes of a scenario file with one rod and some overrides.
    fn of(text: &str, overrides: &[String]) -> Result<Self, GroupError> {
        let mut simulation = simulation(text, overrides)?;
        let (stiffness, masses) = (simulation.stiffness_matrix(), simulation.mass_matrix());
        let unknowns = simulation.free_unknowns();
        // K v = ω² M v with M = L Lᵀ and u = Lᵀ v becomes an ordinary symmetric eigenproblem.
        let factor = masses.cholesky().ok_or("a mass is not positive")?.unpack();
        let half = factor.solve_lower_triangular(&stiffness);
        let half = half.ok_or("a mass is zero")?.transpose();
        let matrix = factor.solve_lower_triangular(&half);
        let eigen = matrix.ok_or("a mass is zero")?.symmetric_eigen();
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
        let fastest = modes.last().map_or(0.0, |mode| mode.0);
        // Due to rounding, the rigid-body frequencies are about √ε times the fastest one.
        modes.retain(|mode| mode.0 > 1e-6 * fastest);
        Ok(Self(modes))
    }

    fn frequencies(&self, motion: Motion) -> Vec<f64> {
        let own = self.0.iter().filter(|mode| mode.1 == motion);
        own.map(|mode| mode.0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative errors of the first three bending modes and of the first torsional mode.
    fn errors(text: &str, edges: usize, inertia: &str, exact: fn(usize) -> f64) -> [f64; 4] {
        let keys = [
            format!("rods.0.edges={edges}"),
            format!("rods.0.inertia={inertia}"),
        ];
        let modes = Modes::of(text, &keys).unwrap();
        let bending = modes.frequencies(Motion::Bending);
        let torsion = modes.frequencies(Motion::Torsion)[0];
        let of_torsion = fixed_free_wave_number(1) * AXIAL_SPEED / 3f64.sqrt();
        std::array::from_fn(|mode| match mode {
            3 => torsion / of_torsion - 1.0,
            _ => bending[2 * mode] / (exact(mode + 1).powi(2) * GYRATION * AXIAL_SPEED) - 1.0,
        })
    }

    #[test]
    fn consistent_inertia_is_of_fourth_order_and_lumped_of_second() {
        for (inertia, order) in [("consistent", 4.0), ("lumped", 2.0)] {
            let clamped = [15, 30].map(|n| errors(CANTILEVER, n, inertia, cantilever_wave_number));
            let unclamped = [15, 30].map(|n| errors(FREE_ROD, n, inertia, free_wave_number));
            println!("{inertia}: {clamped:?} {unclamped:?}");
            let largest =
                |errors: &[f64]| errors.iter().fold(0.0, |m: f64, error| m.max(error.abs()));
            let of_bending = [clamped, unclamped].map(|meshes| meshes.map(|e| largest(&e[..3])));
            let of_torsion = clamped.map(|errors| errors[3].abs());
            for [coarse, fine] in [of_bending[0], of_bending[1], of_torsion] {
                let found = libm::log2(coarse / fine);
                assert!(found > order - 0.2, "{inertia}: {found}");
                assert!(inertia != "lumped" || found < 2.2, "{found}");
            }
        }
    }

    #[test]
    fn a_stretched_string_of_lumped_masses_is_of_second_order() {
        let of = |edges: usize| {
            let keys = [
                format!("rods.0.edges={edges}"),
                "rods.0.inertia=lumped".into(),
            ];
            stretched_string(&keys).unwrap()
        };
        for (coarse, fine) in of(40).iter().zip(of(80)) {
            let found = libm::log2(coarse.error / fine.error);
            println!("{}: {:e} {found}", fine.name, fine.error);
            assert!((1.8..2.2).contains(&found), "{found}");
            // The remaining errors of both meshes without the second-order part.
            let limit = (4.0 * fine.got - coarse.got) / 3.0;
            assert!((limit / fine.expected - 1.0).abs() < 1.5e-4, "{limit}");
        }
    }

    #[test]
    fn a_ring_is_left_to_lumped_masses_by_default() {
        // The nodes of a strongly bent rod are outside its centreline, and consistent masses
        // increase this error.
        let text = FREE_ROD.replace(
            "kind = \"straight\", start = [0, 0, 0], end = [1, 0, 0]",
            "kind = \"ring\", centre = [0, 0, 0], normal = [0, 0, 1], radius = 1.0",
        );
        // The lowest in-plane mode of a ring is an ellipse: ω² = 36/5 EI/ρA R⁴.
        let exact = 7.2_f64.sqrt() * GYRATION * AXIAL_SPEED;
        let off = |inertia: &str| {
            let keys = [
                "rods.0.edges=25".into(),
                format!("rods.0.inertia={inertia}"),
            ];
            let modes = Modes::of(&text, &keys).unwrap();
            let nearest = modes.0.iter().map(|mode| (mode.0 / exact - 1.0).abs());
            nearest.fold(f64::INFINITY, f64::min)
        };
        println!("{:e} {:e}", off("lumped"), off("consistent"));
        assert_eq!(off("auto"), off("lumped"));
        assert!(off("lumped") < 0.5 * off("consistent"));
    }
}
