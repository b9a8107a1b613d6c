//! Equilibria of a heavy cantilever of 100 edges, from the straight rod, also if it tapers, and
//! from an equilibrium after its weight has changed by a hundredth. The last search is done by
//! descent and for the nearest equilibrium.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::experiment;
use rodlab::mechanics::dynamics::Simulation;
use std::path::Path;

fn simulation() -> Simulation {
    prepared(&[])
}

/// The cantilever, four times as thin at its end.
fn tapered() -> Simulation {
    prepared(&["rods.beam.profile={ arc_length = [0, 1], radius = [0.005, 0.00125] }"])
}

fn prepared(keys: &[&str]) -> Simulation {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/heavy_cantilever.toml");
    let keys = ["rods.beam.edges=100"].iter().chain(keys);
    let keys: Vec<String> = keys.map(|key| (*key).to_owned()).collect();
    let loaded = experiment::load(&path, &keys).expect("a valid scenario");
    let prepared = experiment::prepare(&loaded.scenario).expect("a valid scene");
    Simulation::new(&prepared.scene, &prepared.integration).expect("sound")
}

fn equilibrium(criterion: &mut Criterion) {
    for (name, simulation) in [
        (
            "equilibrium of 100 edges, from straight",
            simulation as fn() -> Simulation,
        ),
        (
            "equilibrium of 100 edges that taper, from straight",
            tapered,
        ),
    ] {
        criterion.bench_function(name, |bencher| {
            bencher.iter_batched(
                simulation,
                |mut simulation| simulation.find_equilibrium().expect("converges"),
                criterion::BatchSize::SmallInput,
            );
        });
    }

    // Extra weight on every node, alternately added and removed.
    let weight = nalgebra::Vector3::new(0.0, 0.0, -7.7e-5);
    let forces = [vec![weight; 101], vec![-weight; 101]];
    let moments = vec![0.0; 101];
    let mut simulation = simulation();
    simulation.find_equilibrium().expect("converges");
    let mut turn = forces.iter().cycle();
    criterion.bench_function(
        "equilibrium of 100 edges, from a nearby one, downhill",
        |bencher| {
            bencher.iter(|| {
                simulation.set_external_forces(turn.next().expect("endless"), &moments);
                simulation.find_equilibrium().expect("converges")
            });
        },
    );
    criterion.bench_function(
        "equilibrium of 100 edges, from a nearby one, nearest",
        |bencher| {
            bencher.iter(|| {
                simulation.set_external_forces(turn.next().expect("endless"), &moments);
                simulation.find_nearby_equilibrium().expect("converges")
            });
        },
    );
}

criterion_group!(benches, equilibrium);
criterion_main!(benches);
