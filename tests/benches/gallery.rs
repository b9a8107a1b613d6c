//! Twenty steps of scenes of the gallery, at least one for each kind of force, from half a second on.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::experiment;
use rodlab::mechanics::dynamics::Simulation;
use std::path::{Path, PathBuf};

const SCENES: [&str; 13] = [
    "bent_wire",
    "block_and_tackle",
    "fishing_rod",
    "gripper",
    "guidewire",
    "guyed_mast",
    "hoist",
    "mooring_line",
    "ring_on_rope",
    "snake",
    "tendon_arm",
    "tube",
    "tumbling_filament",
];
/// Time at which the measured steps begin, s.
const START: f64 = 0.5;
const STEPS: usize = 20;

fn simulation(scenarios: &Path, name: &str) -> Simulation {
    let path = scenarios.join(name).with_extension("toml");
    let text = std::fs::read_to_string(&path).expect("a shipped scenario");
    let loaded = experiment::from_text(name, &text, scenarios, &[]).expect("valid");
    let prepared = experiment::prepare(&loaded.scenario).expect("a valid scene");
    Simulation::new(&prepared.scene, &prepared.integration).expect("sound")
}

fn steps(criterion: &mut Criterion) {
    let scenarios = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let mut group = criterion.benchmark_group("20 steps of the gallery");
    group.sample_size(10);
    for name in SCENES {
        let mut simulation = simulation(&scenarios, name);
        while simulation.time() < START {
            simulation.advance(START).expect("converges");
        }
        let state = simulation.state();
        group.bench_function(name, |bencher| {
            bencher.iter_batched(
                || state.clone(),
                |state| {
                    simulation.restore(state).expect("the same scene");
                    for _ in 0..STEPS {
                        simulation.advance(f64::INFINITY).expect("converges");
                    }
                },
                criterion::BatchSize::SmallInput,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, steps);
criterion_main!(benches);
