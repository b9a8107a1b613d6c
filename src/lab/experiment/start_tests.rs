//! Runs that start from the end of others.

use crate::test_support::{advance_to, prepared, ran, simulation};
use rodlab_engine::mechanics::dynamics::Simulation;

/// A stick that flies and tumbles, and whose end is turned about its axis.
const FLYING: &str = r#"
experiment = "scene"
material = { youngs_modulus = "1 MPa", poissons_ratio = 0.5, density = 1000.0 }
time = { end = "20 ms", step = "1 ms" }
output = { interval = "10 ms" }
[[rods]]
name = "stick"
radius = "5 mm"
edges = 6
shape = { kind = "straight", start = [0, 0, 0], end = [0.3, 0, 0] }
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
    let (_, directory) = ran(&prepared("flying", FLYING).unwrap()).unwrap();
    let starting = |more: &str| {
        let from = directory.path();
        simulation(
            "next",
            &format!("start = {{ from = {from:?}{more} }}\n{FLYING}"),
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
    let placed = simulation("flying", FLYING).unwrap();
    let mut flown = simulation("flying", FLYING).unwrap();
    advance_to(&mut flown, 0.02);
    assert!(!same(&placed, &flown));
    let spins = flown.as_start().spins;
    assert!(spins.iter().any(|spin| spin.abs() > 1.0), "{spins:?}");
    assert!(same(&starting(""), &flown));
    assert!(same(&starting(", velocities = true"), &flown));
    assert!(same(&starting(", velocities = false"), &placed));
}
