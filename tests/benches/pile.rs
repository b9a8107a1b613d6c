//! Complete time steps of 1 ms of piles of rods with friction, while they collapse and when they
//! are nearly at rest, with each contact model; and of hairs before and while some of them touch.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::experiment;
use rodlab::mechanics::dynamics::Simulation;
use std::path::Path;

/// The first rods of a scenario, at its start.
fn first_of(name: &str, rods: usize, model: &str) -> Simulation {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let text = std::fs::read_to_string(directory.join(format!("{name}.toml"))).expect("a scenario");
    let set = [
        format!("parameters.n={rods}"),
        format!("contact.model={model}"),
    ];
    let loaded = experiment::from_text(name, &text, &directory, &set).expect("valid");
    let prepared = experiment::prepare(&loaded.scenario).expect("a valid scene");
    Simulation::new(&prepared.scene, &prepared.integration).expect("sound")
}

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step of 1 ms");
    group.sample_size(10);
    let all = ["imc", "ipc", "complementarity"];
    for (name, scenario, rods, start, models) in [
        ("50 rods falling in", "pile", 50, 0.08, &all[..]),
        ("50 rods nearly at rest", "pile", 50, 0.3, &all[..]),
        ("200 rods falling in", "pile", 200, 0.15, &all[..2]),
        ("200 hairs apart", "hair", 200, 0.01, &all[..1]),
        ("2,000 hairs apart", "hair", 2000, 0.01, &all[..1]),
        (
            "2,000 hairs of which some touch",
            "hair",
            2000,
            0.09,
            &all[..1],
        ),
    ] {
        for model in models {
            let mut simulation = first_of(scenario, rods, model);
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
