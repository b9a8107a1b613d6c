//! A swinging heavy cantilever of 50 edges with steps of 10 ms: time per simulated second.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::experiment;
use rodlab::mechanics::dynamics::{IntegrationParameters, Simulation, StepSize};
use std::path::Path;

fn cantilever(criterion: &mut Criterion) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/heavy_cantilever.toml");
    let loaded = experiment::load(&path, &[]).expect("a valid scenario");
    let prepared = experiment::prepare(&loaded.scenario).expect("a valid scene");
    let parameters = IntegrationParameters {
        step: StepSize::Fixed(1e-2),
        ..prepared.integration
    };
    criterion.bench_function("cantilever, one simulated second", |bencher| {
        bencher.iter_batched(
            || Simulation::new(&prepared.scene, &parameters).expect("sound"),
            |mut simulation| {
                let mut iterations = 0;
                while simulation.time() < 1.0 {
                    iterations += simulation
                        .advance(1.0)
                        .expect("converges")
                        .newton_iterations;
                }
                iterations
            },
            criterion::BatchSize::SmallInput,
        );
    });
}

criterion_group!(benches, cantilever);
criterion_main!(benches);
