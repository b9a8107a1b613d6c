//! Factorisation and solution of Newton systems with the sizes that occur for one, two and ten
//! rods.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::linalg::{BandedFactor, BandedSymmetric, CoupledSystem, Element, HALF_BANDWIDTH};
use std::hint::black_box;

/// A diagonally dominant band with the pattern of a rod: windows of 11 unknowns at multiples of 4.
fn rod_band(dimension: usize) -> BandedSymmetric {
    let mut band = BandedSymmetric::new(dimension);
    for first in (0..dimension).step_by(4) {
        let window = first..dimension.min(first + HALF_BANDWIDTH + 1);
        for j in window.clone() {
            for i in j..window.end {
                band.add(i, j, libm::sin((i * 31 + j * 17) as f64));
            }
            band.add(j, j, 10.0);
        }
    }
    band
}

fn banded(criterion: &mut Criterion) {
    for dimension in [267, 2720] {
        let band = rod_band(dimension);
        let mut factor = BandedFactor::new(dimension);
        let right_hand_side: Vec<f64> = (0..dimension).map(|i| libm::cos(i as f64)).collect();
        let mut x = right_hand_side.clone();
        criterion.bench_function(&format!("banded factor {dimension}"), |bencher| {
            bencher.iter(|| factor.factor(black_box(&band)).unwrap());
        });
        criterion.bench_function(&format!("banded solve {dimension}"), |bencher| {
            bencher.iter(|| {
                x.copy_from_slice(&right_hand_side);
                factor.solve(black_box(&mut x));
            });
        });
    }
}

/// Pairs of edges in contact, for neighbouring rods of 68 nodes wound around each other.
fn contacts(rods: usize, count: usize) -> Vec<Element> {
    (0..count)
        .map(|k| {
            let rod = k % rods;
            let other = (rod + 1 + (k / rods) % 2) % rods;
            let edge = (7 * k / rods) % 66;
            let nodes = [
                0,
                1,
                68 * (other as i64 - rod as i64),
                68 * (other as i64 - rod as i64) + 1,
            ];
            let first = (68 * rod + edge) as i64;
            std::array::from_fn(|i| 4 * (first + nodes[i / 3]) as usize + i % 3)
        })
        .collect()
}

fn coupled(criterion: &mut Criterion) {
    for (rods, count) in [(2, 60), (10, 600)] {
        let dimension = 272 * rods;
        let band = rod_band(dimension);
        let elements = contacts(rods, count);
        let held = vec![false; dimension];
        let matrix = std::array::from_fn(|i| std::array::from_fn(|j| libm::cos((i * j) as f64)));
        let right_hand_side: Vec<f64> = (0..dimension).map(|i| libm::cos(i as f64)).collect();
        let mut x = right_hand_side.clone();
        criterion.bench_function(&format!("coupled new {dimension}+{count}"), |bencher| {
            bencher.iter(|| {
                CoupledSystem::new(dimension, black_box(&elements), &held, &[], &[], true)
            });
        });
        for (symmetric, name) in [(true, "symmetric"), (false, "general")] {
            let mut system = CoupledSystem::new(dimension, &elements, &held, &[], &[], symmetric);
            println!("{} blocks in the factor", system.factor_blocks());
            let name = |step: &str| format!("coupled {step} {name} {dimension}+{count}");
            criterion.bench_function(&name("assemble"), |bencher| {
                bencher.iter(|| {
                    system.assemble(black_box(&band));
                    for index in 0..count {
                        system.add_element(index, &matrix);
                    }
                });
            });
            criterion.bench_function(&name("factor"), |bencher| {
                bencher.iter(|| system.factor().unwrap());
            });
            criterion.bench_function(&name("solve"), |bencher| {
                bencher.iter(|| {
                    x.copy_from_slice(&right_hand_side);
                    system.solve(black_box(&mut x)).unwrap();
                });
            });
        }
    }
}

criterion_group!(benches, banded, coupled);
criterion_main!(benches);
