//! Invariance of results under rotation of the axes and renumbering of nodes and rods.

use super::rods::{clamp, farthest, force_on, gravity, line, steady, steps_of, unit_rod};
use super::{Check, Expectation, GroupError};
use nalgebra::{Rotation3, Unit};
use rodlab_engine::mechanics::contact::ContactParameters;
use rodlab_engine::mechanics::dynamics::{IntegrationParameters, Simulation, SimulationError};
use rodlab_engine::mechanics::scene::{Clamp, LoadKind, NaturalShape, RodDescription, Scene};
use rodlab_engine::mechanics::{Matrix3, Vector3};

const RIGID_MOTION: Expectation =
    Expectation::new("x(R scene + c) = R x(scene) + c", "frame indifference");
const RELABELLING: Expectation =
    Expectation::new("x(renumbered scene) = renumbered x(scene)", "symmetry");
const BOUND: f64 = 1e-9;
const EDGES: usize = 24;
const STEP: f64 = 5e-3;

/// Checks a rigid motion, reversed nodes and swapped rods, each for twenty time steps of two rods.
pub fn checks(_full: bool) -> Result<Vec<Check>, GroupError> {
    let mut checks = invariance(&two_rods(), "two rods")?;
    checks.extend(invariance(&touching_rods(), "two rods in contact")?);
    Ok(checks)
}

/// Compares a scene of two rods with the moved and the renumbered scene.
fn invariance(scene: &Scene, name: &str) -> Result<Vec<Check>, GroupError> {
    let original = run(scene)?;
    let rotation =
        Rotation3::from_axis_angle(&Unit::new_normalize(Vector3::new(1.0, 2.0, -0.7)), 1.1);
    let (turn, shift) = (*rotation.matrix(), Vector3::new(0.3, -0.8, 0.5));
    let moved = run(&moved(scene, &turn, &shift))?;
    let expected: Vec<Vector3> = original.iter().map(|x| turn * x + shift).collect();
    let reversed_nodes: Vec<Vector3> = run(&reversed(scene))?
        .chunks(EDGES + 1)
        .flat_map(|rod| rod.iter().rev().copied())
        .collect();
    let mut swapped_rods = run(&swapped(scene))?;
    swapped_rods.rotate_left(EDGES + 1);
    Ok(vec![
        RIGID_MOTION
            .of(format!("{name} turned and shifted: farthest node"), "m")
            .zero(farthest(&expected, &moved), BOUND),
        RELABELLING
            .of(format!("{name}, nodes in reverse: farthest node"), "m")
            .zero(farthest(&original, &reversed_nodes), BOUND),
        RELABELLING
            .of(format!("{name}, swapped: farthest node"), "m")
            .zero(farthest(&original, &swapped_rods), BOUND),
    ])
}

/// A clamped curved rod with the cross-section of a ribbon, and a free twisted rod, both loaded.
fn two_rods() -> Scene {
    let arc = |k: usize| {
        let angle = 1.2 * k as f64 / EDGES as f64;
        Vector3::new(libm::sin(angle), 1.0 - libm::cos(angle), 0.1 * angle)
    };
    let mut ribbon = unit_rod((0..=EDGES).map(arc).collect());
    ribbon.natural_shape = NaturalShape::AsPlaced;
    ribbon.stiffness.bending = [3.0, 1.0];
    ribbon.first_director = Some(Vector3::z());
    let mut twisted = unit_rod(line(
        Vector3::new(0.0, 0.5, 0.2),
        Vector3::new(1.0, 0.5, 0.2),
        EDGES,
    ));
    twisted.twist = 2.0;
    twisted.velocity = Vector3::new(0.1, 0.0, 0.3);
    twisted.angular_velocity = Vector3::new(0.0, 1.0, 2.0);
    Scene {
        rods: vec![ribbon, twisted],
        clamps: vec![clamp(0)],
        loads: vec![
            gravity(5.0),
            steady(force_on(EDGES, Vector3::new(0.5, -1.0, 2.0))),
        ],
        ..Scene::default()
    }
}

/// A rod that falls across another one whose ends are held; they touch and slide from the first
/// step on.
fn touching_rods() -> Scene {
    let thick = 0.01;
    let contact = ContactParameters {
        distance_tolerance: 1e-3,
        friction: 0.3,
        slip_tolerance: 0.1,
        ..ContactParameters::default()
    };
    let rod = |start, end| RodDescription {
        radius: thick,
        ..unit_rod(line(start, end, EDGES))
    };
    let lower = rod(Vector3::zeros(), Vector3::x());
    let height = 2.0 * thick + 0.5 * contact.distance_tolerance;
    let mut upper = rod(
        Vector3::new(0.33, -0.3, height),
        Vector3::new(0.72, 0.6, height),
    );
    upper.velocity = Vector3::new(0.5, 0.2, -0.3);
    Scene {
        rods: vec![lower, upper],
        clamps: vec![clamp(0), clamp(EDGES)],
        loads: vec![gravity(5.0)],
        contact: Some(contact),
        ..Scene::default()
    }
}

fn run(scene: &Scene) -> Result<Vec<Vector3>, SimulationError> {
    let parameters = IntegrationParameters {
        force_tolerance: 1e-11,
        displacement_tolerance: 1e-9,
        ..steps_of(STEP)
    };
    let mut simulation = Simulation::new(scene, &parameters)?;
    for step in 1..=20 {
        simulation.advance(f64::from(step) * STEP)?;
    }
    Ok(simulation.positions().to_vec())
}

/// The scene turned by `turn` and shifted.
fn moved(scene: &Scene, turn: &Matrix3, shift: &Vector3) -> Scene {
    let mut scene = scene.clone();
    for rod in &mut scene.rods {
        for x in &mut rod.centreline {
            *x = turn * *x + shift;
        }
        rod.velocity = turn * rod.velocity;
        rod.angular_velocity = turn * rod.angular_velocity;
        rod.first_director = rod.first_director.map(|d| turn * d);
    }
    for load in &mut scene.loads {
        if let LoadKind::Gravity {
            acceleration: vector,
        }
        | LoadKind::Force { force: vector, .. } = &mut load.kind
        {
            *vector = turn * *vector;
        }
    }
    scene
}

/// Every rod numbered from its other end.
fn reversed(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    for rod in &mut scene.rods {
        // Parallel transport of the first director gives that on the last edge.
        rod.first_director = last_director(rod);
        rod.centreline.reverse();
    }
    for clamp in &mut scene.clamps {
        clamp.node = EDGES - clamp.node;
    }
    for load in &mut scene.loads {
        if let LoadKind::Force { node, .. } = &mut load.kind {
            *node = EDGES - *node;
        }
    }
    scene
}

/// First director on the last edge of a rod in its initial state.
fn last_director(rod: &RodDescription) -> Option<Vector3> {
    let alone = Scene {
        rods: vec![rod.clone()],
        ..Scene::default()
    };
    let simulation = Simulation::new(&alone, &IntegrationParameters::default()).ok()?;
    simulation.material_directors().get(EDGES - 1).copied()
}

/// The rods in the other order.
fn swapped(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.rods.reverse();
    for Clamp { rod, .. } in &mut scene.clamps {
        *rod = 1 - *rod;
    }
    for load in &mut scene.loads {
        if let LoadKind::Force { rod, .. } = &mut load.kind {
            *rod = 1 - *rod;
        }
    }
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_falling_rod_touches() {
        let mut simulation =
            Simulation::new(&touching_rods(), &IntegrationParameters::default()).unwrap();
        assert!(simulation.advance(STEP).unwrap().contacts > 0);
    }
}
