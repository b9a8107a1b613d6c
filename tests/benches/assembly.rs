//! Residual and Jacobian of a free rod of 67 edges.

mod free_rod;

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;

fn assembly(criterion: &mut Criterion) {
    let (mut system, unknowns, stage) = free_rod::free_rod();
    let mut group = criterion.benchmark_group("assembly, 67 edges");
    group.bench_function("residual and Jacobian", |bencher| {
        bencher.iter(|| system.linearize(black_box(&unknowns), Some(&stage)));
    });
    group.bench_function("residual", |bencher| {
        bencher.iter(|| system.evaluate(black_box(&unknowns), Some(&stage)));
    });
    group.finish();
}

criterion_group!(benches, assembly);
criterion_main!(benches);
