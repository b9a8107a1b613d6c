//! Whole time steps of 1 ms of a pile of 50 rods with friction, while it falls in and nearly at rest, by each contact model.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::experiment;
use rodlab::mechanics::dynamics::Simulation;
use std::path::Path;

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step of 1 ms of a pile of 50 rods");
    group.sample_size(10);
    for (name, start) in [("falling in", 0.08), ("nearly at rest", 0.3)] {
        for model in ["imc", "ipc", "complementarity"] {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/pile.toml");
            let loaded = experiment::load(&path, &[format!("contact.model={model}")])
                .expect("a valid scenario");
            let prepared = experiment::prepare(&loaded.scenario).expect("a valid scene");
            let mut simulation =
                Simulation::new(&prepared.scene, &prepared.integration).expect("sound");
            while simulation.time() < start {
                simulation.advance(start).expect("converges");
            }
            let state = simulation.state();
            let (mut steps, mut contacts, mut iterations) = (0, 0, 0);
            group.bench_function(format!("{name}, {model}"), |bencher| {
                bencher.iter_batched(
                    || state.clone(),
                    |state| {
                        simulation.restore(state).expect("the same scene");
                        for _ in 0..5 {
                            let report = simulation.advance(f64::INFINITY).expect("converges");
                            steps += 1;
                            contacts += report.contacts;
                            iterations += report.newton_iterations;
                        }
                    },
                    criterion::BatchSize::SmallInput,
                );
            });
            let per_step = |total: usize| total as f64 / f64::from(steps);
            println!(
                "{name}, {model}: {:.2} iterations and {:.1} contacts a step; times are of 5 steps",
                per_step(iterations),
                per_step(contacts)
            );
        }
    }
    group.finish();
}

criterion_group!(benches, steps);
criterion_main!(benches);
