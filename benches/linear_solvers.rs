//! Factorisation and solution of Newton systems of the sizes met with one, two and ten rods.

use criterion::{Criterion, criterion_group, criterion_main};
use rodlab::linalg::{BandedFactor, BandedSymmetric, HALF_BANDWIDTH};
use std::hint::black_box;

/// A diagonally dominant band with the pattern of a rod: windows of 11 unknowns at multiples of 4.
fn rod_band(dimension: usize) -> BandedSymmetric {
    let mut band = BandedSymmetric::new(dimension);
    for first in (0..dimension).step_by(4) {
        let window = first..dimension.min(first + HALF_BANDWIDTH + 1);
        for j in window.clone() {
            for i in j..window.end {
                band.add(i, j, ((i * 31 + j * 17) as f64).sin());
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
        let right_hand_side: Vec<f64> = (0..dimension).map(|i| (i as f64).cos()).collect();
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

criterion_group!(benches, banded);
criterion_main!(benches);
