//! Complete time steps of 1 ms of towers of boxes at rest, with a rope over the first one, and of a
//! rope on a drum and a pulley, with a crate on its end.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::experiment;
use rodlab::mechanics::dynamics::Simulation;
use std::fmt::Write;
use std::path::Path;

/// Boxes of a tower.
const LEVELS: usize = 5;

/// Towers of five boxes each.
fn towers(count: usize) -> Simulation {
    let mut text = String::from(
        "experiment = \"scene\"\n\
         [material]\nyoungs_modulus = 2e6\npoissons_ratio = 0.5\ndensity = 1000.0\n\
         [[rods]]\nname = \"rope\"\nradius = 0.004\nedges = 40\n\
         shape = { kind = \"straight\", start = [-0.2, 0.01, 0.255], end = [0.2, 0.01, 0.255] }\n\
         [[planes]]\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n\
         [[loads]]\nkind = \"gravity\"\nacceleration = [0, 0, -9.81]\n\
         [contact]\nmodel = \"imc\"\nfriction = 0.4\n\
         [time]\nstep = 1e-3\nend = 10.0\n",
    );
    for tower in 0..count {
        for level in 0..LEVELS {
            let height = 0.025 + 0.05002 * level as f64 + 1e-5;
            let _ = write!(
                text,
                "[[free_bodies]]\nshape = {{ kind = \"box\", size = [0.06, 0.06, 0.05] }}\n\
                 position = [{:?}, {:?}, {height:?}]\ndensity = 300.0\n",
                0.003 * (level % 2) as f64,
                0.1 * tower as f64
            );
        }
    }
    simulation("towers", &text)
}

fn simulation(name: &str, text: &str) -> Simulation {
    let loaded = experiment::from_text(name, text, Path::new(""), &[]).expect("valid");
    let prepared = experiment::prepare(&loaded.scenario).expect("a valid scene");
    Simulation::new(&prepared.scene, &prepared.integration).expect("sound")
}

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("20 steps of 1 ms with free bodies");
    group.sample_size(10);
    let towers = [1, 3, 10].map(|count| (format!("{} boxes", LEVELS * count), towers(count)));
    let hoist = include_str!("../../scenarios/hoist.toml");
    let hoist = ("hoist".to_owned(), simulation("hoist", hoist));
    let start = 0.05;
    for (name, mut simulation) in towers.into_iter().chain([hoist]) {
        while simulation.time() < start {
            simulation.advance(start).expect("converges");
        }
        let state = simulation.state();
        group.bench_function(name, |bencher| {
            bencher.iter_batched(
                || state.clone(),
                |state| {
                    simulation.restore(state).expect("the same scene");
                    for _ in 0..20 {
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
