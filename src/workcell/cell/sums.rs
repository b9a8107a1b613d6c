//! Cumulative lengths along a curve.

/// Cumulative sums of the steps, from 0 (no step) to the sum of all.
pub fn sums(steps: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let sums = steps.into_iter().scan(0.0, |sum, step| {
        *sum += step;
        Some(*sum)
    });
    std::iter::once(0.0).chain(sums).collect()
}
