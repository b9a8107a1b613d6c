//! Lengths from the start of a curve on.

/// The sums of the first steps: of none, of one, of two, and so on to that of all.
pub fn sums(steps: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let sums = steps.into_iter().scan(0.0, |sum, step| {
        *sum += step;
        Some(*sum)
    });
    std::iter::once(0.0).chain(sums).collect()
}
