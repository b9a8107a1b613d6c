//! Runs that start from the end of others.

use crate::test_support::{advance_to, prepared, ran, simulation};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::Simulation;

/// A stick; the keys of its rod continue.
const STICK: &str = r#"
experiment = "scene"
material = { youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }
time = { end = "20 ms", step = "1 ms" }
output = { interval = "10 ms" }
[[rods]]
name = "stick"
radius = "5 mm"
edges = 6
shape = { kind = "straight", start = [0, 0, 0], end = [0.3, 0, 0] }
"#;

/// A stick that flies and tumbles, and whose end is turned about its axis.
const FLYING: &str = r#"
velocity = [0.5, 0, 0.2]
angular_velocity = [0, 1, 2]
[[loads]]
kind = "moment"
rod = "stick"
at = "end"
moment = [1e-4, 0, 0]
"#;

#[test]
fn rods_keep_the_velocities_that_they_had_or_start_with_their_own() {
    let flying = format!("{STICK}{FLYING}");
    let (_, directory) = ran(&prepared("flying", &flying).unwrap()).unwrap();
    let starting = |more: &str| {
        let from = directory.path();
        simulation(
            "next",
            &format!("start = {{ from = {from:?}{more} }}\n{flying}"),
        )
        .unwrap()
    };
    let same = |one: &Simulation, other: &Simulation| {
        let pairs = one.velocities().iter().zip(other.velocities());
        let farthest = pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        let [spins, others] = [one, other].map(|simulation| simulation.as_start().spins);
        let pairs = spins.iter().zip(&others);
        let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        farthest < 1e-12 && off < 1e-9
    };
    let placed = simulation("flying", &flying).unwrap();
    let mut flown = simulation("flying", &flying).unwrap();
    advance_to(&mut flown, 0.02);
    assert!(!same(&placed, &flown));
    let spins = flown.as_start().spins;
    assert!(spins.iter().any(|spin| spin.abs() > 1.0), "{spins:?}");
    assert!(same(&starting(""), &flown));
    assert!(same(&starting(", velocities = true"), &flown));
    assert!(same(&starting(", velocities = false"), &placed));
}

/// A stick with a flap on a hinge, a rod welded to both, a weight, and a ring that slides on it.
const JOINED: &str = r#"
[[rods]]
name = "flap"
radius = "5 mm"
edges = 3
shape = { kind = "straight", start = [0.3, 0, 0], end = [0.3, 0.1, 0] }
[[rods]]
name = "post"
radius = "5 mm"
edges = 3
shape = { kind = "straight", start = [0.15, 0, 0], end = [0.15, 0, 0.1] }
[[rods]]
name = "ring"
radius = "5 mm"
edges = 1
shape = { kind = "straight", start = [0.1, 0, 0], end = [0.1, 0.02, 0] }
[[joints]]
kind = "hinge"
axis = [0, 0.6, 0.8]
rods = ["stick", "flap"]
at = ["end", "start"]
[[joints]]
kind = "rigid"
rods = ["stick", "post"]
at = [3, "start"]
[[joints]]
kind = "slide"
rods = ["ring", "stick"]
at = ["start", 2]
[[bodies]]
rod = "flap"
at = "end"
mass = "5 g"
shape = { kind = "disk", radius = "3 cm", thickness = "2 mm" }
[[clamps]]
rod = "stick"
at = "start"
[[loads]]
kind = "gravity"
acceleration = [0, 50, -98.1]
"#;

#[test]
fn joined_rods_and_bodies_continue_where_they_were() {
    let joined = format!("{STICK}{JOINED}");
    let (_, directory) = ran(&prepared("joined", &joined).unwrap()).unwrap();
    let from = directory.path();
    let next = |text: &str| simulation("next", &format!("start = {{ from = {from:?} }}\n{text}"));
    let started = next(&joined).unwrap();
    let mut whole = simulation("joined", &joined).unwrap();
    let placed = whole.as_start();
    advance_to(&mut whole, 0.02);
    let [now, ended] = [started.as_start(), whole.as_start()];
    let farthest = |one: &[Vector3], other: &[Vector3]| {
        let pairs = one.iter().zip(other);
        pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
    };
    assert!(farthest(&placed.positions, &ended.positions) > 1e-3);
    assert!(farthest(&now.positions, &ended.positions) < 1e-12);
    assert!(farthest(&now.velocities, &ended.velocities) < 1e-9);
    for (one, other) in now.walls.iter().zip(&ended.walls) {
        let [one, other] = [one, other].map(|wall| wall.unwrap_or_default());
        assert!(farthest(&one, &other) < 1e-9, "{one:?} {other:?}");
    }
    for (one, other) in now.turning.iter().zip(&ended.turning) {
        let [one, other] = [one, other].map(|spin| spin.unwrap_or_default());
        assert!((one - other).norm() < 1e-6, "{one} {other}");
    }
    assert!(ended.turning.iter().flatten().any(|spin| spin.norm() > 0.1));
    // A joint that the earlier run did not have.
    let more = "[[joints]]\nkind = \"ball\"\nrods = [\"ring\", \"post\"]\nat = [\"end\", 1]\n";
    let refused = next(&format!("{joined}{more}")).err().unwrap();
    assert!(refused.contains("apart"), "{refused}");
}
