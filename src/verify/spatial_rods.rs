//! Scenario files of rods that bend and twist in space, against Kirchhoff's rod.
//!
//! Other checks build their scenes from plain data; these start with the text of a file, so that
//! they check the interpretation of keys: the sides of a section, the director, the signs of
//! natural curvatures and twist, of forces and moments, the handedness of a helix. The theory uses
//! its own numbers.

use super::check::order;
use super::rods::farthest;
use super::scenario::at_rest;
use super::{Check, Expectation, GroupError};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::kirchhoff::SpatialCantilever;
use std::f64::consts::{PI, TAU};

const KIRCHHOFF: Expectation = Expectation::new(
    "m' = −r' × n, m·dᵢ = Kᵢ (uᵢ − ûᵢ)",
    "Kirchhoff rod, multiple shooting",
);
/// Number of steps of the theory: a multiple of all numbers of edges.
const STEPS: usize = 400;
const GRAVITY: f64 = 9.81;

/// Scenario files of a strip and a spring without loads.
const STRIP: &str = include_str!("scenes/strip.toml");
const SPRING: &str = include_str!("scenes/spring.toml");

/// Loads that are appended to the files.
const WEIGHT: &str = "[[loads]]\nkind = 'gravity'\nacceleration = [0, 0, -9.81]\n";
const WIND: &str =
    "[[loads]]\nkind = 'distributed'\nrod = 'strip'\nforce_per_length = [0.1, -0.3, 0.2]\n";
const MOMENT: &str =
    "[[loads]]\nkind = 'moment'\nrod = 'strip'\nat = 'end'\nmoment = [0, -0.03, 0]\n";
const PULL: &str =
    "[[loads]]\nkind = 'force'\nrod = 'strip'\nat = 'end'\nforce = [-0.05, 0.2, 0.1]\n";
const PULL_OF_SPRING: &str =
    "[[loads]]\nkind = 'force'\nrod = 'spring'\nat = 'end'\nforce = [0.01, -0.02, -0.05]\n";

/// A strip whose natural shape is a helix, initially straight along its first tangent.
const COILED: [&str; 3] = [
    "rods.0.shape={ kind = \"straight\", start = [0, 0, 0], end = [0, 0.8, 0.6] }",
    "rods.0.natural_shape={ kind = \"helix\", centre = [0, 0, 0], radius = \"0.2 m\", pitch = 0.9424777960769379, length = \"0.6 m\" }",
    "rods.0.director=[-0.8, -0.36, 0.48]",
];

/// A scenario, and the theory for it.
struct Case {
    name: &'static str,
    /// Text of its scenario file, with appended loads and overrides.
    file: &'static str,
    loads: &'static [&'static str],
    keys: &'static [&'static str],
    /// Number of edges of the coarser mesh; the finer mesh has twice as many.
    edges: usize,
    theory: SpatialCantilever<fn(f64) -> [f64; 3]>,
    /// Largest distance of a node from the theory, extrapolated from both meshes, relative to the
    /// length.
    bound: f64,
}

/// Checks the order of convergence and the limit of the equilibria of scenario files.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let mut checks = Vec::new();
    for case in cases() {
        checks.extend(case.checks(&[])?);
    }
    Ok(checks)
}

fn cases() -> [Case; 7] {
    let weight = Vector3::new(0.0, 0.0, -1000.0 * GRAVITY * 12e-3 * 4e-3);
    let weight_of_wire = Vector3::new(0.0, 0.0, -8000.0 * GRAVITY * PI * 1e-6);
    let tilted = Vector3::new(0.0, 0.8, 0.6);
    let straight = || strip(Vector3::x(), tilted, |_| [0.0; 3]);
    let of_strip = |name, loads, theory| Case {
        name,
        file: STRIP,
        loads,
        keys: &[],
        edges: 50,
        theory,
        bound: 2e-5,
    };
    let of_spring = |name, loads, theory| Case {
        file: SPRING,
        edges: 100,
        bound: 1e-4,
        ..of_strip(name, loads, theory)
    };
    let own_weight = SpatialCantilever {
        load_per_length: weight,
        ..straight()
    };
    let pulled = SpatialCantilever {
        load_per_length: weight,
        end_force: Vector3::new(-0.05, 0.2, 0.1),
        ..straight()
    };
    let turned = SpatialCantilever {
        load_per_length: Vector3::new(0.1, -0.3, 0.2),
        end_moment: Vector3::new(0.0, -0.03, 0.0),
        ..straight()
    };
    let curved = SpatialCantilever {
        load_per_length: weight,
        ..strip(Vector3::x(), tilted, |_| [1.2, -0.7, 2.5])
    };
    let helical = SpatialCantilever {
        load_per_length: weight,
        ..strip(tilted, Vector3::new(-0.8, -0.36, 0.48), coiled)
    };
    let hanging = SpatialCantilever {
        load_per_length: weight_of_wire,
        ..spring()
    };
    let stretched = SpatialCantilever {
        end_force: Vector3::new(0.01, -0.02, -0.05),
        ..spring()
    };
    [
        of_strip("tilted strip, its weight", &[WEIGHT], own_weight),
        of_strip(
            "tilted strip, weight and end force",
            &[WEIGHT, PULL],
            pulled,
        ),
        of_strip("tilted strip, wind and end moment", &[WIND, MOMENT], turned),
        Case {
            keys: &[
                "rods.0.natural_curvature=[1.2, -0.7]",
                "rods.0.natural_twist=2.5",
            ],
            ..of_strip(
                "strip with natural curvatures and twist, its weight",
                &[WEIGHT],
                curved,
            )
        },
        Case {
            keys: &COILED,
            bound: 1e-4,
            ..of_strip(
                "strip with a helix as natural shape, its weight",
                &[WEIGHT],
                helical,
            )
        },
        of_spring("helical spring, its weight", &[WEIGHT], hanging),
        of_spring("helical spring, end force", &[PULL_OF_SPRING], stretched),
    ]
}

/// A strip of 1 m without load, 12 mm wide along the director and 4 mm thick, E = 1 GPa, ν = 1/2.
fn strip(
    tangent: Vector3,
    director: Vector3,
    natural: fn(f64) -> [f64; 3],
) -> SpatialCantilever<fn(f64) -> [f64; 3]> {
    let (young, width, thickness) = (1e9, 12e-3_f64, 4e-3_f64);
    SpatialCantilever {
        length: 1.0,
        stiffness: [
            young * width * thickness.powi(3) / 12.0,
            young * thickness * width.powi(3) / 12.0,
            young / 3.0 * torsion_constant(width, thickness),
        ],
        stretching: young * width * thickness,
        natural,
        director,
        tangent,
        load_per_length: Vector3::zeros(),
        end_force: Vector3::zeros(),
        end_moment: Vector3::zeros(),
    }
}

/// Natural curvatures of a right-handed helix of radius 0.2 m and pitch 2π · 0.15 m in a frame without twist whose
/// first director is 0.8 n + 0.6 b at the start.
///
/// The curvature vector about which the tangent turns is κ b, and the binormal turns by τ per length against the frame:
/// b = cos(τs) b₀ − sin(τs) n₀, with b₀ = (0.6, 0.8) and n₀ = (0.8, −0.6) in the frame.
fn coiled(s: f64) -> [f64; 3] {
    let [curvature, torsion] = curvature_and_torsion(0.2, 0.15);
    let (sine, cosine) = libm::sincos(torsion * s);
    [
        curvature * (0.6 * cosine - 0.8 * sine),
        curvature * (0.8 * cosine + 0.6 * sine),
        0.0,
    ]
}

/// An unloaded right-handed spring of four turns about −z, starting in the direction of x, of
/// round wire with a radius of 1 mm, E = 0.3 GPa, ν = 1/2. The first director of the rod is the
/// binormal, which turns with τ.
fn spring() -> SpatialCantilever<fn(f64) -> [f64; 3]> {
    let (young, wire, radius, rise) = (0.3e9, 1e-3_f64, SPRING_RADIUS, SPRING_RISE);
    let per_turn = libm::hypot(radius, rise) * TAU;
    let bending = young * PI * wire.powi(4) / 4.0;
    let tangent = Vector3::new(0.0, -radius, -rise).normalize();
    SpatialCantilever {
        length: 4.0 * per_turn,
        stiffness: [bending, bending, 2.0 / 3.0 * bending],
        stretching: young * PI * wire.powi(2),
        natural: |_| {
            let [curvature, torsion] = curvature_and_torsion(SPRING_RADIUS, SPRING_RISE);
            [curvature, 0.0, torsion]
        },
        director: tangent.cross(&-Vector3::x()),
        tangent,
        load_per_length: Vector3::zeros(),
        end_force: Vector3::zeros(),
        end_moment: Vector3::zeros(),
    }
}

const SPRING_RADIUS: f64 = 20e-3;
/// Pitch divided by 2π, m.
const SPRING_RISE: f64 = 15e-3 / TAU;

/// Curvature and torsion of a right-handed helix of radius a and pitch 2πb: a/(a² + b²) and
/// b/(a² + b²).
fn curvature_and_torsion(radius: f64, rise: f64) -> [f64; 2] {
    [radius, rise].map(|part| part / (radius * radius + rise * rise))
}

/// Saint-Venant's J of a rectangle with sides a ≥ b: a b³ (1/3 − 64 b/(π⁵ a) Σ tanh(nπa/2b)/n⁵), n odd.
fn torsion_constant(a: f64, b: f64) -> f64 {
    let odd = (0..40).rev().map(|k| f64::from(2 * k + 1));
    let sum: f64 = odd
        .map(|n| libm::tanh(0.5 * n * PI * a / b) / n.powi(5))
        .sum();
    a * b.powi(3) * (1.0 / 3.0 - 64.0 * b / (PI.powi(5) * a) * sum)
}

impl Case {
    /// Checks order and extrapolated shape, with overrides of the scenario.
    fn checks(&self, overrides: &[&str]) -> Result<[Check; 2], GroupError> {
        let exact = self.theory.points(STEPS).ok_or("no continuous solution")?;
        let coarse = self.equilibrium(self.edges, overrides)?;
        let fine = self.equilibrium(2 * self.edges, overrides)?;
        let farthest = |nodes: &[Vector3]| {
            let points = exact.iter().step_by(STEPS / (nodes.len() - 1));
            farthest(nodes, &points.copied().collect::<Vec<_>>()) / self.theory.length
        };
        let extrapolated: Vec<Vector3> = coarse
            .iter()
            .zip(fine.iter().step_by(2))
            .map(|(coarse, fine)| fine + (fine - coarse) / 3.0)
            .collect();
        let (name, edges) = (self.name, self.edges);
        let of_order = format!("{name}, {edges} to {} edges: order", 2 * edges);
        let of_limit = format!("{name}, extrapolated: farthest node");
        Ok([
            order(of_order, farthest(&coarse) / farthest(&fine)),
            KIRCHHOFF
                .of(of_limit, "L")
                .zero(farthest(&extrapolated), self.bound),
        ])
    }

    /// Nodes at rest, from the clamp.
    fn equilibrium(&self, edges: usize, overrides: &[&str]) -> Result<Vec<Vector3>, GroupError> {
        let text = self.file.to_owned() + &self.loads.concat();
        let mut keys = vec![format!("rods.0.edges={edges}")];
        keys.extend(self.keys.iter().chain(overrides).map(|&key| key.into()));
        let simulation = at_rest(&text, &keys)?;
        let nodes = simulation.positions();
        Ok(nodes.iter().map(|x| x - nodes[0]).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::Verdict;

    /// Reverses each key that has a sign or a side. The shape must then be far from the
    /// theoretical one.
    #[test]
    fn reversed_keys_are_detected() {
        let wrong: [(usize, &[&str]); 16] = [
            (0, &["rods.0.director=[0, 0.8, -0.6]"]),
            (
                0,
                &[
                    "rods.0.cross_section.width=4 mm",
                    "rods.0.cross_section.thickness=12 mm",
                ],
            ),
            (1, &["loads.1.force=[0.05, 0.2, 0.1]"]),
            (1, &["loads.1.force=[-0.05, -0.2, 0.1]"]),
            (2, &["loads.0.force_per_length=[0.102, -0.306, 0.204]"]),
            (2, &["loads.1.moment=[0, 0.03, 0]"]),
            (2, &["loads.1.moment=[0, -0.0306, 0]"]),
            (3, &["rods.0.natural_twist=-2.5"]),
            (3, &["rods.0.natural_curvature=[-1.2, -0.7]"]),
            (3, &["rods.0.natural_curvature=[1.2, 0.7]"]),
            (3, &["rods.0.natural_curvature=[-0.7, 1.2]"]),
            (4, &["rods.0.natural_shape.handedness=left"]),
            (4, &["rods.0.director=[0.8, -0.36, 0.48]"]),
            (5, &["rods.0.shape.handedness=left"]),
            (5, &["loads.0.acceleration=[0, 0, 9.81]"]),
            (6, &["rods.0.shape.handedness=left"]),
        ];
        let cases = cases();
        for (index, overrides) in wrong {
            let [_, limit] = cases[index].checks(overrides).unwrap();
            assert_eq!(limit.verdict(), Verdict::Fail, "{overrides:?}");
            assert!(
                limit.error > 20.0 * limit.bound,
                "{overrides:?}: only {:e}",
                limit.error
            );
        }
    }
}
