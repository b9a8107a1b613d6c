//! Joined and held rods in a viscous fluid, from scenario files, against dense solutions.

use super::scenario::moved;
use super::theory::stokeslet::{forces, forces_of_rods};
use super::{Check, Expectation, GroupError};
use nalgebra::{Matrix2, Vector2};
use rodlab_engine::mechanics::Vector3;

const GLIDE: Expectation = Expectation::new("U = F/R", "Cortez 2001, dense solution");
const BESIDE: Expectation = Expectation::new(
    "R (U, ω) = (F, 0), wall at rest",
    "Cortez 2001, dense solution",
);
const BOUND: f64 = 1e-3;

/// Length of the filaments, m. The viscosity is 1 Pa s.
const LENGTH: f64 = 0.01;
/// Number of edges of a filament.
const EDGES: usize = 20;
/// Radius of the filaments, m.
const RADIUS: f64 = 1e-4;
/// Regularisation, m.
const REGULARIZATION: f64 = 1.02 * RADIUS;
/// Distance of the filament from the rod next to it, m.
const GAP: f64 = 5.0 * RADIUS;
/// Force per length along the filament, N/m.
const PULL: f64 = 1e-3;

/// Filaments that are pulled along their axes: of two pieces, and next to a held rod.
pub(super) fn checks() -> Result<Vec<Check>, GroupError> {
    let nodes = filament(0.0);
    let drag: f64 = forces(&nodes, &[Vector3::x(); EDGES + 1], REGULARIZATION, 1.0)
        .iter()
        .map(|force| force.x)
        .sum();
    let name = "filament of two joined pieces, L/r = 100, pulled along: speed";
    Ok(vec![
        GLIDE
            .of(name, "m/s")
            .relative(PULL * LENGTH / drag, speed(&scene(""))?, BOUND),
        BESIDE
            .of("the same beside a held rod, five radii away: speed", "m/s")
            .relative(speed_beside_wall(&nodes), speed(&scene(WALL))?, BOUND),
    ])
}

/// Nodes of the filament, shifted sideways.
fn filament(y: f64) -> Vec<Vector3> {
    (0..=EDGES)
        .map(|k| Vector3::new(LENGTH * k as f64 / EDGES as f64, y, 0.0))
        .collect()
}

/// Speed along its axis of a rigid filament next to a filament at rest. Since there is no torque,
/// it also rotates about its middle.
fn speed_beside_wall(nodes: &[Vector3]) -> f64 {
    let all = [nodes.to_vec(), filament(GAP)].concat();
    let middle = Vector3::x() * (0.5 * LENGTH);
    let wrench = |motion: &dyn Fn(&Vector3) -> Vector3| {
        let still = vec![Vector3::zeros(); nodes.len()];
        let velocities = [nodes.iter().map(motion).collect(), still].concat();
        let rods = [nodes.len(), nodes.len()];
        let forces = forces_of_rods(&rods, &all, &velocities, REGULARIZATION, 1.0);
        let torque = nodes
            .iter()
            .zip(&forces)
            .map(|(x, f)| (x - middle).cross(f).z);
        let force = forces[..nodes.len()].iter().map(|force| force.x).sum();
        Vector2::new(force, torque.sum::<f64>())
    };
    let along = wrench(&|_| Vector3::x());
    // Lengths are in units of the filament length, so that both columns have the same order of
    // magnitude.
    let turning = wrench(&|x| Vector3::z().cross(&(x - middle)) / LENGTH);
    let resistance = Matrix2::from_columns(&[along, turning]);
    let motion = resistance.lu().solve(&Vector2::new(PULL * LENGTH, 0.0));
    motion.expect("a resistance is regular").x
}

const WALL: &str = r#"
[[rods]]
name = "wall"
held = true
radius = "0.1 mm"
edges = 20
shape = { kind = "straight", start = [0, "0.5 mm", 0], end = ["10 mm", "0.5 mm", 0] }
"#;

/// Two pieces of a filament connected by a joint, and an optional rod next to them.
fn scene(beside: &str) -> String {
    let pull = |rod: &str| {
        format!(
            "[[loads]]\nkind = \"distributed\"\nrod = \"{rod}\"\nforce_per_length = [{PULL}, 0, 0]\n"
        )
    };
    format!(
        r#"
experiment = "scene"
title = "A filament of two pieces"
[material]
youngs_modulus = "10 GPa"
poissons_ratio = 0.5
density = 1000.0
[[rods]]
name = "a"
radius = "0.1 mm"
edges = 8
shape = {{ kind = "straight", start = [0, 0, 0], end = ["4 mm", 0, 0] }}
[[rods]]
name = "b"
radius = "0.1 mm"
edges = 12
shape = {{ kind = "straight", start = ["4 mm", 0, 0], end = ["10 mm", 0, 0] }}
{beside}
[[joints]]
kind = "rigid"
rods = ["a", "b"]
at = ["end", "start"]
{}{}
[fluid]
model = "rss"
viscosity = "1 Pa s"
[time]
scheme = "implicit-euler"
step = "0.1 ms"
end = "5 ms"
"#,
        pull("a"),
        pull("b")
    )
}

/// Speed along x at the middle of the filament in the steady state.
fn speed(text: &str) -> Result<f64, GroupError> {
    Ok(moved(text, &[], 5e-3)?.velocities()[11].x)
}
