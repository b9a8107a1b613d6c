//! Complete time steps of 2.5 ms of tightened overhand knots of 301 nodes in contact.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::experiment;
use rodlab::mechanics::dynamics::Simulation;
use std::path::Path;

/// Simulated time at which the steps are measured, s; by then the knots have settled and are being
/// pulled.
const START: f64 = 10.0;

/// The overhand knot of a scenario at [`START`].
fn pulled(name: &str) -> Simulation {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenarios")
        .join(name)
        .with_extension("toml");
    let loaded = experiment::load(&path, &[]).expect("a valid scenario");
    let prepared = experiment::prepare(&loaded.scenario).expect("a valid scene");
    let mut simulation = Simulation::new(&prepared.scene, &prepared.integration).expect("sound");
    while simulation.time() < START {
        simulation.advance(START).expect("converges");
    }
    simulation
}

fn knot_step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step of 2.5 ms of a knot pulled tight");
    for name in ["overhand_n1", "overhand_n4"] {
        let mut simulation = pulled(name);
        let start = simulation.state();
        let (mut steps, mut contacts, mut iterations) = (0, 0, 0);
        group.bench_function(name, |bencher| {
            simulation.restore(start.clone()).expect("the same scene");
            bencher.iter(|| {
                let report = simulation.advance(f64::INFINITY).expect("converges");
                steps += 1;
                contacts += report.contacts;
                iterations += report.newton_iterations;
            });
        });
        let per_step = |total: usize| total as f64 / f64::from(steps);
        println!(
            "{name}: {:.2} iterations and {:.1} contacts a step over {steps} steps",
            per_step(iterations),
            per_step(contacts)
        );
    }
    group.finish();
}

criterion_group!(benches, knot_step);
criterion_main!(benches);
