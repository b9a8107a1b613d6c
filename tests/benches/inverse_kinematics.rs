//! Inverse kinematics of the arms that come with the program. Poses are spread over the reach of
//! an arm, and each is solved from its home position. A pose takes far less than a millisecond.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::cell::Cell;
use std::path::Path;

fn inverse_kinematics(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("inverse kinematics");
    for name in ["two_sawyers", "seven_joints", "six_joints"] {
        let path = format!("scenarios/cells/{name}.toml");
        let cell = Cell::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).expect("a cell");
        let arm = &cell.arms[0];
        let targets: Vec<_> = (0..1000)
            .map(|k| arm.chain.hand(&arm.chain.start(100_000 + k)))
            .collect();
        let mut next = targets.iter().cycle();
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let target = next.next().expect("a cycle has no end");
                arm.chain
                    .reach(target, &arm.home)
                    .expect("a reachable pose")
            });
        });
    }
    group.finish();
}

criterion_group!(benches, inverse_kinematics);
criterion_main!(benches);
