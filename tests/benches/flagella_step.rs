//! Complete time steps of 1 ms of M bundling flagella in contact: fluid, contact, Newton's method.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::experiment;
use rodlab::mechanics::dynamics::{Simulation, StepSize};
use std::path::Path;

/// The scenario of `count` flagella with a contact model, advanced with large steps to `time` (s),
/// when the rods touch in many places.
fn touching(count: usize, contact: &str, time: f64) -> Simulation {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/flagella_base.toml");
    let set = [
        format!("flagella.count={count}"),
        format!("contact.model={contact}"),
    ];
    let loaded = experiment::load(&path, &set).expect("a valid scenario");
    let mut prepared = experiment::prepare(&loaded.scenario).expect("a valid scene");
    prepared.integration.step = StepSize::Auto {
        tolerance: 0.02,
        maximum: 0.01,
    };
    let mut large_steps = Simulation::new(&prepared.scene, &prepared.integration).expect("sound");
    while large_steps.time() < time {
        large_steps.advance(time).expect("converges");
    }
    prepared.integration.step = StepSize::Fixed(1e-3);
    let mut simulation = Simulation::new(&prepared.scene, &prepared.integration).expect("sound");
    simulation
        .restore(large_steps.state())
        .expect("the same scene");
    // Let the effect of the change of the step decay.
    for _ in 0..20 {
        simulation.advance(f64::INFINITY).expect("converges");
    }
    simulation
}

fn flagella_step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step of 1 ms in contact");
    group.sample_size(10);
    for (count, contact, time) in [
        (2, "imc", 12.0),
        (2, "ipc", 12.0),
        (10, "imc", 25.0),
        (10, "ipc", 25.0),
    ] {
        let mut simulation = touching(count, contact, time);
        let name = format!("M = {count}, {}", contact.to_uppercase());
        let (mut steps, mut contacts, mut iterations) = (0, 0, 0);
        group.bench_function(&name, |bencher| {
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

criterion_group!(benches, flagella_step);
criterion_main!(benches);
