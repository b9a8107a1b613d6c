//! The Princeton beam: a thin beam that bends in both planes and twists.

use super::benchmark::{Benchmark, BenchmarkRun, Measure, Quantity};
use crate::reproduce::prelude::*;
use nalgebra::Rotation3;
use rodlab_engine::mechanics::kirchhoff::numerics::runge_kutta;
use rodlab_engine::mechanics::{Matrix3, Vector3};
use rodlab_files::results::Table;

/// Height of the section, m.
const HEIGHT: f64 = 0.0123777;
/// Thickness of the section, m.
const THICKNESS: f64 = 0.0032024;
/// Length, m.
const LENGTH: f64 = 0.508;
/// Young's modulus, Pa.
const YOUNGS_MODULUS: f64 = 71.7e9;
/// Shear modulus, Pa.
const SHEAR_MODULUS: f64 = YOUNGS_MODULUS / 2.62;
/// Force, N.
const FORCE: f64 = 13.345;
/// Angles of the force, degrees.
const ANGLES: [f64; 3] = [30.0, 45.0, 60.0];

/// Steps of the Runge–Kutta method.
const STEPS: usize = 400;
/// Number of load increments.
const LOAD_PARTS: usize = 10;
const MOST_ITERATIONS: usize = 20;
/// Step of difference quotients, rad.
const DIFFERENCE: f64 = 1e-6;

pub(super) static PRINCETON_BEAM: Benchmark = Benchmark {
    name: "validation/princeton-beam",
    title: "The Princeton beam",
    about: "A cantilever of aluminium, 508 mm long with a section of 12.3777 mm × 3.2024 mm, E = 71.7 GPa and ν = \
            0.31, carries a force of 13.345 N at its end, at an angle from the stiff direction of the section. It \
            bends in both planes and twists. The twist is the angle of the end section in the view along the beam. \
            The published values are those of shear-flexible beam elements in ANSYS; their accuracy here is the \
            difference from solid elements of the same paper. They follow within 0.1 % from a torsional stiffness \
            that is 3.5 % larger.",
    source: "Dowell and Traybar 1975, experiments; Obrezkov, Mikkola and Matikainen 2022, Nonlinear Dynamics 109, with \
             the values of ANSYS, as listed in a test of the ANCF beam of the program EXUDYN",
    means: "shooting of the rod without shear from the free end, with Saint-Venant's torsion constant",
    scene: include_str!("scenes/princeton-beam.toml"),
    edges: [20, 40, 80],
    quantities: &[
        Quantity::new("30°: stiff deflection, mm").published(16.6587, 0.255),
        Quantity::new("30°: soft deflection, mm").published(117.736, 3.99),
        Quantity::new("30°: twist, degrees"),
        Quantity::new("45°: stiff deflection, mm").published(15.1862, 0.336),
        Quantity::new("45°: soft deflection, mm").published(156.467, 2.92),
        Quantity::new("45°: twist, degrees"),
        Quantity::new("60°: stiff deflection, mm").published(11.5784, 0.307),
        Quantity::new("60°: soft deflection, mm").published(181.862, 1.89),
        Quantity::new("60°: twist, degrees"),
    ],
    exact: || {
        let ends = ANGLES.map(|angle| {
            let (sin, cos) = libm::sincos(angle.to_radians());
            free_end(FORCE * Vector3::new(0.0, sin, -cos)).unwrap_or([Vector3::repeat(f64::NAN); 2])
        });
        ends.iter()
            .flat_map(|[tip, director]| compared(tip, director))
            .collect()
    },
    measure: Measure::Run(measured),
};

/// Deflections in the stiff and the soft direction, mm, and twist, degrees, of an end with its first director.
fn compared(tip: &Vector3, director: &Vector3) -> [f64; 3] {
    let twist = libm::atan2(director.y, director.z);
    [-1e3 * tip.z, 1e3 * tip.y, twist.to_degrees()]
}

/// Reads the ends of the beams of a run, which are beside each other.
fn measured(case: &Case<BenchmarkRun>) -> Result<Vec<f64>> {
    let table = Table::read(&case.directory.join("end_state.csv"))?;
    let column = |name| table.numbers(name).unwrap_or_default();
    let columns = [
        "x_m",
        "y_m",
        "z_m",
        "director_x",
        "director_y",
        "director_z",
    ]
    .map(column);
    let nodes = case.run.edges + 1;
    let vector = |first: usize, row: usize| {
        Vector3::from_fn(|k, _| {
            let value = columns[first + k].get(row).copied().flatten();
            value.unwrap_or(f64::NAN)
        })
    };
    let values = (0..ANGLES.len()).flat_map(|beam| {
        let [start, end] = [beam * nodes, (beam + 1) * nodes - 1];
        // The last edge is not bent and not twisted at its end.
        compared(&(vector(0, end) - vector(0, start)), &vector(3, end - 1))
    });
    Ok(values.collect())
}

/// Finds the end of the beam, m, and its first director, under a dead force at the end, N; `None`
/// if Newton's method does not converge.
///
/// With the directors dᵢ, the tangent d₃, and moments Kᵢ uᵢ about the directors,
///
/// ```text
/// r' = (1 + n·d₃/EA) d₃,  dᵢ' = u × dᵢ,  m' = −r' × n,  m(L) = 0
/// ```
///
/// is integrated from the free end, whose rotation from the clamp is the unknown.
fn free_end(force: Vector3) -> Option<[Vector3; 2]> {
    let clamp = Matrix3::from_columns(&[Vector3::z(), -Vector3::y(), Vector3::x()]);
    let mut rotation = Vector3::zeros();
    for part in 1..=LOAD_PARTS {
        let force = force * (part as f64 / LOAD_PARTS as f64);
        let misfit = |rotation: &Vector3| {
            let (_, frame) = clamped_end(&force, Rotation3::new(*rotation) * clamp);
            let turned = frame * clamp.transpose();
            0.5 * Vector3::new(
                turned.m32 - turned.m23,
                turned.m13 - turned.m31,
                turned.m21 - turned.m12,
            )
        };
        let mut iterations = 0..MOST_ITERATIONS;
        loop {
            let here = misfit(&rotation);
            if here.norm() < 1e-11 {
                break;
            }
            iterations.next()?;
            let columns: [Vector3; 3] = std::array::from_fn(|axis| {
                let change = DIFFERENCE * Vector3::ith(axis, 1.0);
                let [ahead, behind] = [rotation + change, rotation - change].map(|r| misfit(&r));
                (ahead - behind) / (2.0 * DIFFERENCE)
            });
            rotation -= Matrix3::from_columns(&columns).lu().solve(&here)?;
        }
    }
    let frame = Rotation3::new(rotation) * clamp;
    let (place, _) = clamped_end(&force, frame);
    Some([-place, frame.column(0).into()])
}

/// Place of the clamped end from the free end, and the directors there, for those at the free end.
fn clamped_end(force: &Vector3, free: Matrix3) -> (Vector3, Matrix3) {
    let [area, shape] = [HEIGHT * THICKNESS, THICKNESS / HEIGHT];
    let torsion =
        HEIGHT * THICKNESS.powi(3) / 3.0 * (1.0 - 0.63 * shape * (1.0 - shape.powi(4) / 12.0));
    let stiffness = Vector3::new(
        YOUNGS_MODULUS * area * THICKNESS * THICKNESS / 12.0,
        YOUNGS_MODULUS * area * HEIGHT * HEIGHT / 12.0,
        SHEAR_MODULUS * torsion,
    );
    let mut start = [0.0; 15];
    start[..9].copy_from_slice(free.as_slice());
    let states = runge_kutta(LENGTH, 0.0, start, STEPS, |_, state: &[f64; 15]| {
        let frame = Matrix3::from_column_slice(&state[..9]);
        let moment = Vector3::from_column_slice(&state[9..12]);
        let tangent = frame.column(2);
        let along = tangent * (1.0 + force.dot(&tangent) / (YOUNGS_MODULUS * area));
        let darboux = frame * (frame.transpose() * moment).component_div(&stiffness);
        let mut rates = [0.0; 15];
        rates[..9].copy_from_slice((darboux.cross_matrix() * frame).as_slice());
        rates[9..12].copy_from_slice((-along.cross(force)).as_slice());
        rates[12..].copy_from_slice(along.as_slice());
        rates
    });
    let end = &states[STEPS];
    (
        Vector3::from_column_slice(&end[12..]),
        Matrix3::from_column_slice(&end[..9]),
    )
}
