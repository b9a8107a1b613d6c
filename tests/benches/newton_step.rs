//! One Newton iteration (assembly and linear solve) of a free rod of 67 edges, and its parts.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::mechanics::Vector3;
use rodlab::mechanics::scene::{NaturalShape, RodDescription, Scene, Stiffness};
use rodlab::mechanics::system::{Stage, System};
use std::hint::black_box;

/// A free helix of 67 edges with the flagellum's cross-section.
fn free_rod() -> Scene {
    let node = |k: usize| {
        let turn = 0.37 * k as f64;
        Vector3::new(0.01 * turn.cos(), 0.01 * turn.sin(), 0.003 * k as f64)
    };
    let (young, radius, density) = (3e6, 1e-3, 1000.0);
    let area = std::f64::consts::PI * radius * radius;
    let second_moment = 0.25 * area * radius * radius;
    Scene {
        rods: vec![RodDescription {
            name: "rod".into(),
            centreline: (0..68).map(node).collect(),
            closed: false,
            end_tangents: [None, None],
            first_director: None,
            twist: 0.0,
            natural_shape: NaturalShape::Straight,
            stiffness: Stiffness {
                stretching: young * area,
                bending: [young * second_moment; 2],
                twisting: young / 3.0 * 2.0 * second_moment,
            },
            radius,
            mass_per_length: density * area,
            rotational_inertia_per_length: density * 2.0 * second_moment,
            velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            held: false,
        }],
        ..Scene::default()
    }
}

fn newton_step(criterion: &mut Criterion) {
    let mut system = System::new(&free_rod()).expect("a valid scene");
    let start = system.assembly.unknowns.clone();
    let unknowns: Vec<f64> = start
        .iter()
        .enumerate()
        .map(|(k, q)| q + 1e-5 * (k as f64).sin())
        .collect();
    let stage = Stage {
        step: 1e-3,
        start: start.clone(),
        velocity: vec![0.0; start.len()],
        drag: Vec::new(),
        resistance: Vec::new(),
        positions: vec![Vector3::zeros(); start.len() / 4],
    };
    let mut direction = vec![0.0; start.len()];
    let mut group = criterion.benchmark_group("free rod of 67 edges");
    group.bench_function("newton iteration", |bencher| {
        bencher.iter(|| {
            system.linearize(black_box(&unknowns), Some(&stage));
            system.factor().expect("regular");
            system.direction(&mut direction).expect("regular");
        });
    });
    group.bench_function("assembly", |bencher| {
        bencher.iter(|| system.linearize(black_box(&unknowns), Some(&stage)));
    });
    group.bench_function("residual only", |bencher| {
        bencher.iter(|| system.evaluate(black_box(&unknowns), Some(&stage)));
    });
    group.finish();
}

criterion_group!(benches, newton_step);
criterion_main!(benches);
