//! Columns that flutter.

use super::benchmark::{Benchmark, Measure, Quantity};
use rodlab_engine::mechanics::kirchhoff::numerics::bisect;
use rodlab_files::results::BranchKind;

/// Frequencies at which the determinant is compared.
const FREQUENCIES: usize = 4000;
/// A frequency above that of flutter.
const HIGHEST_FREQUENCY: f64 = 20.0;

pub(super) static BECKS_COLUMN: Benchmark = Benchmark {
    name: "validation/becks-column",
    title: "Beck's column, which flutters",
    about: "A column is clamped at its foot and pushed by a force P that stays along the tangent at its top. It never \
            buckles; at P = 20.05 EI/L² two frequencies merge, and oscillations grow. The load is where growth \
            begins along the path of the straight column.",
    source: "Beck 1952, Z. angew. Math. Phys. 3, 225, with 20.05",
    means: "the load at which two roots ω of p² + 2ω² + p ω sinh a sin b + 2ω² cosh a cos b = 0 merge, with p = P \
            L²/EI, a² and b² = √(p²/4 + ω²) ∓ p/2",
    scene: include_str!("scenes/becks-column.toml"),
    edges: [20, 40, 80],
    quantities: &[Quantity::new("critical force P L²/EI").published(20.05, 5e-3)],
    exact: || vec![bisect(15.0, 25.0, least_determinant)],
    measure: Measure::Critical(BranchKind::Flutter),
};

/// The least value of the frequency determinant between its first two roots, which is negative
/// below the critical load, refined by a parabola.
fn least_determinant(load: f64) -> f64 {
    let step = HIGHEST_FREQUENCY / FREQUENCIES as f64;
    let at = |k: usize| determinant(load, k as f64 * step);
    let least = (1..FREQUENCIES).min_by(|&a, &b| at(a).total_cmp(&at(b)));
    let least = least.expect("there are frequencies");
    let [before, here, after] = [at(least - 1), at(least), at(least + 1)];
    let (slope, bend) = (0.5 * (after - before), after - 2.0 * here + before);
    here - 0.5 * slope * slope / bend
}

/// Vanishes if the column vibrates at the frequency ω, in units of √(EI/ρA)/L².
fn determinant(load: f64, frequency: f64) -> f64 {
    let square = frequency * frequency;
    let root = (0.25 * load * load + square).sqrt();
    let [a, b] = [root - 0.5 * load, root + 0.5 * load].map(f64::sqrt);
    let coupled = load * frequency * libm::sinh(a) * libm::sin(b);
    let product = 2.0 * square * libm::cosh(a) * libm::cos(b);
    load * load + 2.0 * square + coupled + product
}
