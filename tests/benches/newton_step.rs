//! One Newton iteration (assembly and solve) of a free rod of 67 edges.

mod free_rod;

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;

fn newton_step(criterion: &mut Criterion) {
    let (mut system, unknowns, stage) = free_rod::free_rod();
    let mut direction = vec![0.0; unknowns.len()];
    criterion.bench_function("newton iteration, 67 edges", |bencher| {
        bencher.iter(|| {
            system.linearize(black_box(&unknowns), Some(&stage));
            system.factor().expect("regular");
            system.direction(&mut direction).expect("regular");
        });
    });
}

criterion_group!(benches, newton_step);
criterion_main!(benches);
