//! Complete time steps of 1 ms of two cables that fall on a ring of more and more triangles.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::experiment;
use rodlab::mechanics::Vector3;
use rodlab::mechanics::dynamics::Simulation;
use rodlab::mechanics::rigid_body::RigidBody;
use std::f64::consts::TAU;
use std::path::Path;

/// Large and small radius of the ring, m.
const RADII: [f64; 2] = [0.04, 0.01];

/// An upright ring of `around` times `across` pairs of triangles.
fn ring(around: usize, across: usize) -> RigidBody {
    let vertex = |i: usize, j: usize| {
        let [a, b] = [(i, around), (j, across)].map(|(k, n)| TAU * k as f64 / n as f64);
        let reach = RADII[0] + RADII[1] * libm::cos(b);
        let height = RADII[1] * libm::sin(b);
        Vector3::new(reach * libm::cos(a), -height, reach * libm::sin(a))
    };
    let index = |i: usize, j: usize| i % around * across + j % across;
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for i in 0..around {
        for j in 0..across {
            vertices.push(vertex(i, j));
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            let [a, b, c, d] = corners.map(|(i, j)| index(i, j));
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    RigidBody::of_mesh(vertices, faces, true).expect("a closed surface")
}

/// `scenarios/mesh_obstacle.toml` with 300 edges and another ring.
fn cables(ring: RigidBody) -> Simulation {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let text = std::fs::read_to_string(directory.join("mesh_obstacle.toml")).expect("a scenario");
    let set = ["rods.0.edges=150", "rods.1.edges=150"].map(String::from);
    let loaded = experiment::from_text("mesh", &text, &directory, &set).expect("valid");
    let mut prepared = experiment::prepare(&loaded.scenario).expect("a valid scene");
    prepared.scene.obstacles[0].body = ring;
    Simulation::new(&prepared.scene, &prepared.integration).expect("sound")
}

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step of 1 ms of cables on a mesh");
    group.sample_size(10);
    let start = 0.1;
    let sizes = [[16, 12], [100, 50], [500, 100]];
    for (smooth, [around, across]) in [false, true]
        .into_iter()
        .flat_map(|s| sizes.map(|n| (s, n)))
    {
        let ring = ring(around, across);
        let (ring, kind) = match smooth {
            true => (ring.smoothed(1.0), "smooth "),
            false => (ring, ""),
        };
        let mut simulation = cables(ring);
        while simulation.time() < start {
            simulation.advance(start).expect("converges");
        }
        let state = simulation.state();
        let name = format!("{kind}{} triangles, 20 steps", 2 * around * across);
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
