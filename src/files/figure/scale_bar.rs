//! Scale bars: round lengths with their labels.

/// The largest of 1, 2, 5 times a power of ten that is not above `limit`.
pub(super) fn round_length_below(limit: f64) -> f64 {
    let power = libm::pow(10f64, libm::log10(limit).floor());
    let factor = [5.0, 2.0]
        .into_iter()
        .find(|factor| factor * power <= limit)
        .unwrap_or(1.0);
    factor * power
}

pub(super) fn length_label(length: f64) -> String {
    let (factor, unit) = match length {
        length if length >= 1.0 => (1.0, "m"),
        length if length >= 0.01 => (100.0, "cm"),
        length if length >= 1e-3 => (1e3, "mm"),
        _ => (1e6, "µm"),
    };
    // Round lengths have one digit; the rest is round-off.
    format!("{} {unit}", (length * factor * 1e3).round() / 1e3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_bars_have_round_lengths() {
        for (limit, length, label) in [
            (0.073, 0.05, "5 cm"),
            (0.0021, 0.002, "2 mm"),
            (1.7, 1.0, "1 m"),
            (4.9e-4, 2e-4, "200 µm"),
        ] {
            let round = round_length_below(limit);
            assert!((round - length).abs() < 1e-12 * length);
            assert_eq!(length_label(round), label);
        }
    }
}
