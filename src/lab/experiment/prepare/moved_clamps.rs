//! Clamps that are displaced from where their rods are placed.
//!
//! Natural shape, masses and lengths follow from the rod as placed. The rod then starts displaced:
//! clamp i, at xᵢ, is displaced by dᵢ and rotated by the rotation vector θᵢ, and a point x of the
//! rod moves to
//!
//! ```text
//! Σ wᵢ (xᵢ + dᵢ + R(θᵢ)(x − xᵢ)),      frames turn by R(Σ wᵢ θᵢ)
//! ```
//!
//! with weights w along the rod that are 1 at their own clamp and 0 at the next ones, vary
//! smoothly between them, and add up to 1. A rod that is held at one place moves as a rigid body.
//! The run begins from this configuration, or finds the equilibrium from it.

use crate::run::PreparedRun;
use crate::scenario::{Issue, KeyPath, Scenario};
use rodlab_engine::mechanics::dynamics::Simulation;
use rodlab_engine::mechanics::scene::{Scene, Start};
use rodlab_engine::mechanics::{Vector3, rotation};

/// A clamp of a rod, with its place.
struct Moved {
    /// Node along the rod.
    node: usize,
    at: Vector3,
    offset: Vector3,
    turn: Vector3,
}

/// Moves the rods of displaced clamps with them.
///
/// # Errors
/// Rods that cannot be moved, with the key of their clamp.
pub fn carry(run: &mut PreparedRun, scenario: &Scenario) -> Result<(), Issue> {
    let Some(first) = scenario.clamps.iter().position(|one| one.is_elsewhere()) else {
        return Ok(());
    };
    let fault = |index: usize, message: &str| {
        let clamp = &scenario.clamps[index];
        let key = if clamp.offset == [0.0; 3] {
            "rotation"
        } else {
            "offset"
        };
        Issue::new(KeyPath::from("clamps").index(index).key(key), message)
    };
    // Clamps built by the kind of experiment come first.
    let built = run.scene.clamps.len() - scenario.clamps.len();
    for (index, clamp) in scenario.clamps.iter().enumerate() {
        let rod = run.scene.clamps[built + index].rod;
        if clamp.is_elsewhere() && run.scene.rods[rod].closed {
            return Err(fault(index, "the rod is closed; allowed: open rods"));
        }
        let is_joined = |scene: &Scene| {
            let mut nodes = scene.joints.iter().flat_map(|joint| joint.nodes);
            nodes.any(|node| node.rod == rod)
        };
        if clamp.is_elsewhere() && is_joined(&run.scene) {
            return Err(fault(
                index,
                "the rod is joined to others; allowed: rods without joints",
            ));
        }
    }
    let simulation = Simulation::new(&run.scene, &run.integration);
    let simulation = simulation.map_err(|error| fault(first, &error.to_string()))?;
    let mut start = simulation.as_start();
    let mut first_node = 0;
    for (rod, description) in run.scene.rods.iter().enumerate() {
        let nodes = description.centreline.len();
        let places = run.scene.clamps.iter().enumerate();
        let mut clamps: Vec<Moved> = places
            .filter(|(_, clamp)| clamp.rod == rod)
            .map(|(index, clamp)| {
                let typed = index
                    .checked_sub(built)
                    .map(|index| &scenario.clamps[index]);
                let [offset, turn] = typed.map_or([Vector3::zeros(); 2], |typed| {
                    [typed.offset, typed.rotation].map(Vector3::from)
                });
                Moved {
                    node: clamp.node,
                    at: start.positions[first_node + clamp.node],
                    offset,
                    turn,
                }
            })
            .collect();
        let is_moved =
            |clamp: &Moved| clamp.offset != Vector3::zeros() || clamp.turn != Vector3::zeros();
        if clamps.iter().any(is_moved) {
            clamps.sort_by_key(|clamp| clamp.node);
            carry_rod(&mut start, first_node, nodes, &clamps);
        }
        first_node += nodes;
    }
    run.scene.start = Some(start);
    Ok(())
}

/// Moves one rod with its clamps, which are sorted by node.
fn carry_rod(start: &mut Start, first: usize, nodes: usize, clamps: &[Moved]) {
    let turn_at = |place: f64| -> Vector3 {
        let parts = weights(clamps, place);
        parts
            .iter()
            .map(|(clamp, weight)| clamp.turn * *weight)
            .sum()
    };
    let before: Vec<Vector3> = start.positions[first..first + nodes].to_vec();
    for node in 0..nodes {
        let parts = weights(clamps, node as f64);
        let moved = parts.iter().map(|(clamp, weight)| {
            let turned = rotation::from_vector(clamp.turn) * (before[node] - clamp.at);
            (clamp.at + clamp.offset + turned) * *weight
        });
        start.positions[first + node] = moved.sum();
    }
    for node in 0..nodes {
        let index = first + node;
        if node + 1 < nodes {
            let turn = rotation::from_vector(turn_at(node as f64 + 0.5));
            start.directors[index] = turn * start.directors[index];
        }
        if node > 0 && node + 1 < nodes {
            // Component about the tangent; whole turns are included.
            let along = (before[node + 1] - before[node - 1]).normalize();
            let apart = turn_at(node as f64 + 0.5) - turn_at(node as f64 - 0.5);
            start.twist[index] += apart.dot(&along);
        }
        if let Some(wall) = &mut start.walls[index] {
            let turn = rotation::from_vector(turn_at(node as f64));
            *wall = wall.map(|axis| turn * axis);
        }
    }
}

/// The clamps on either side of a place along the rod, counted in nodes, with their weights.
fn weights(clamps: &[Moved], place: f64) -> Vec<(&Moved, f64)> {
    let after = clamps.partition_point(|clamp| (clamp.node as f64) < place);
    match (
        after.checked_sub(1).map(|before| &clamps[before]),
        clamps.get(after),
    ) {
        (Some(one), Some(other)) => {
            let [start, end] = [one, other].map(|clamp| clamp.node as f64);
            let u = (place - start) / (end - start);
            let weight = u * u * (3.0 - 2.0 * u);
            vec![(one, 1.0 - weight), (other, weight)]
        }
        (Some(only), None) | (None, Some(only)) => vec![(only, 1.0)],
        (None, None) => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use crate::test_support::simulation;
    use rodlab_engine::mechanics::Vector3;
    use rodlab_engine::mechanics::dynamics::Simulation;

    const ARC: &str = r#"kind = "arc", start = [0, 0, 0], tangent = [1, 0, 0], normal = [0, 0, -1], radius = 0.1, angle = "90 deg""#;
    const LINE: &str = r#"kind = "straight", start = [0, 0, 0], end = [0.15, 0, 0]"#;

    /// A wire with its clamps.
    fn wire(shape: &str, clamps: &str) -> Result<Simulation, String> {
        let text = format!(
            r#"experiment = "scene"
material = {{ youngs_modulus = "10 MPa", poissons_ratio = 0.5, density = 1100.0 }}
loads = [{{ kind = "gravity", acceleration = [0, 0, -9.81] }}]
time = {{ mode = "static" }}
rods = [{{ name = "wire", radius = "1 mm", edges = 40, director = [0, 0, 1], shape = {{ {shape} }} }}]
clamps = [{clamps}]
"#
        );
        simulation("wire", &text)
    }

    #[test]
    fn a_rod_that_is_held_at_one_end_moves_as_a_rigid_body() {
        let placed = wire(ARC, r#"{ rod = "wire", at = "start" }"#).unwrap();
        let moved = wire(
            ARC,
            r#"{ rod = "wire", at = "start", offset = ["1 cm", 0, 0], rotation = [0, 0, "90 deg"] }"#,
        );
        let moved = moved.unwrap();
        for (one, other) in placed.positions().iter().zip(moved.positions()) {
            let expected = Vector3::new(0.01 - one.y, one.x, one.z);
            assert!((expected - other).norm() < 1e-15);
        }
        // The energy does not change.
        assert!((placed.energies().elastic() - moved.energies().elastic()).abs() < 1e-20);
    }

    #[test]
    fn turns_about_the_tangent_are_twist_and_whole_turns_count() {
        let clamps = r#"{ rod = "wire", at = "start" }, { rod = "wire", at = "end", rotation = ["-450 deg", 0, 0] }"#;
        let mut wire = wire(LINE, clamps).unwrap();
        wire.find_equilibrium().unwrap();
        // The half vertices at the clamps do not count.
        let twist: f64 = wire.as_start().twist.iter().sum();
        let expected = -2.5 * std::f64::consts::PI * 39.0 / 40.0;
        assert!((twist / expected - 1.0).abs() < 0.01, "{twist} {expected}");
    }

    #[test]
    fn an_offset_is_that_of_a_rod_placed_there() {
        let at = |x: f64, z: f64| {
            let clamps = format!(
                r#"{{ rod = "wire", at = "start" }}, {{ rod = "wire", at = "end", offset = [{x}, 0, {z}] }}"#
            );
            let mut wire = wire(ARC, &clamps).unwrap();
            wire.find_equilibrium().unwrap();
            wire.positions()[40]
        };
        let moved = at(-0.02, 0.03) - at(0.0, 0.0);
        assert!((moved - Vector3::new(-0.02, 0.0, 0.03)).norm() < 1e-15);
    }

    #[test]
    fn clamps_that_cannot_be_elsewhere_are_refused() {
        for (clamp, expected) in [
            (
                r#"hold = "position", rotation = [0, 0, 1]"#,
                "the clamp holds no frame",
            ),
            (
                r#"hold = "frame", offset = [0, 0, 1]"#,
                "the clamp holds no position",
            ),
        ] {
            let error = wire(
                ARC,
                &format!(r#"{{ rod = "wire", at = "start", {clamp} }}"#),
            )
            .err()
            .unwrap();
            assert!(error.contains(expected), "{error}");
        }
    }
}
