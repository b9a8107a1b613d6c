//! Regularised Stokeslet segments: assembly of the exact operator and a product for 2 and 10
//! helices of 68 nodes; and the complete drag for a time series in which 2 to 100 helices rotate
//! and sway.
//!
//! One thread is used unless `RAYON_NUM_THREADS` is set: `RAYON_NUM_THREADS=2 cargo bench --bench
//! rss`.

use criterion::{BenchmarkId, Criterion, criterion_group};
use rodlab::mechanics::fluid::{Filament, FlowOperator, Fluid, FluidModel};
use rodlab::mechanics::{Matrix3, Vector3};
use std::f64::consts::PI;

const NODES: usize = 68;
const STEP: f64 = 1e-3;

fn filaments(count: usize) -> Vec<Filament> {
    (0..count)
        .map(|k| Filament {
            first_node: k * NODES,
            nodes: NODES,
            closed: false,
            radius: 1e-3,
        })
        .collect()
}

/// Helices of the thesis on a regular polygon of the given side, rotating at 15 rad/s; their tips
/// sway by a centimetre.
fn helices(count: usize, side: f64, time: f64) -> Vec<Vector3> {
    let polygon = side / (2.0 * libm::sin(PI / count as f64));
    let mut nodes = Vec::with_capacity(count * NODES);
    for k in 0..count {
        let place = 2.0 * PI * k as f64 / count as f64;
        for i in 0..NODES {
            let height = i as f64 / (NODES - 1) as f64;
            let angle = 8.0 * PI * height + 15.0 * time;
            let sway = 0.01 * height * height * libm::cos(2.0 * time + place);
            let centre = Vector3::new(libm::cos(place), libm::sin(place), 0.0) * (polygon + sway);
            nodes.push(
                centre
                    + Vector3::new(
                        0.01 * libm::cos(angle),
                        0.01 * libm::sin(angle),
                        0.2 * height,
                    ),
            );
        }
    }
    nodes
}

fn operator(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("rss");
    for count in [2, 10] {
        let nodes = count * NODES;
        let positions = helices(count, 0.03, 0.0);
        let mut operator = FlowOperator::new(&filaments(count), 1.02);
        group.bench_function(BenchmarkId::new("assembly", nodes), |bencher| {
            bencher.iter(|| operator.assemble(&positions));
        });
        let densities = vec![1.0; 3 * nodes];
        let mut velocities = vec![0.0; 3 * nodes];
        group.bench_function(BenchmarkId::new("product", nodes), |bencher| {
            bencher.iter(|| operator.multiply(&densities, &mut velocities));
        });
    }
    group.finish();
}

fn drag(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("rss");
    let model = FluidModel::RegularizedStokeslets {
        viscosity: 0.1,
        regularization: 1.02,
        far_field_error: 1e-4,
    };
    for (name, side) in [("drag apart", 0.03), ("drag bundled", 0.003)] {
        for count in [2, 5, 10, 20, 50, 100] {
            let nodes = count * NODES;
            let mut fluid = Fluid::new(&model, &filaments(count)).expect("a good description");
            let mut forces = vec![Vector3::zeros(); nodes];
            let mut resistance = vec![Matrix3::zeros(); nodes];
            let mut before = helices(count, side, 0.0);
            let mut time = 0.0;
            group.bench_function(BenchmarkId::new(name, nodes), |bencher| {
                bencher.iter(|| {
                    time += STEP;
                    let now = helices(count, side, time);
                    let velocities: Vec<_> = now
                        .iter()
                        .zip(&before)
                        .map(|(a, b)| (a - b) / STEP)
                        .collect();
                    before = now;
                    fluid
                        .drag(&before, &velocities, &[], &mut forces, &mut resistance)
                        .expect("a solution")
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, operator, drag);

fn main() {
    if std::env::var_os("RAYON_NUM_THREADS").is_none() {
        rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build_global()
            .expect("the first use of the pool");
    }
    benches();
    Criterion::default().configure_from_args().final_summary();
}
