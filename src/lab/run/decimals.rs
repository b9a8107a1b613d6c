//! Numbers as readable text, for scenes of any size.

/// A number with the given decimals, or with a power of ten if these would show less than one
/// digit. This keeps lengths in metres and times in seconds readable in scenes of micrometres.
pub fn decimals(number: f64, decimals: usize) -> String {
    let shown = libm::pow(10.0, 1.0 - decimals as f64);
    if number == 0.0 || number.abs() >= shown || !number.is_finite() {
        format!("{number:.decimals$}")
    } else {
        format!("{number:.3e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_numbers_keep_their_digits() {
        let shown = [0.3, 1.25e-5, 5e-7, 0.0].map(|number| decimals(number, 6));
        assert_eq!(shown, ["0.300000", "0.000013", "5.000e-7", "0.000000"]);
    }
}
