//! Columns of our CSV files in words.

/// Endings of column names and the units that they stand for; longer ones first.
const UNITS: [(&str, &str); 16] = [
    ("_rad_per_s", "rad/s"),
    ("_rad_per_m", "rad/m"),
    ("_m_per_s", "m/s"),
    ("_per_m", "1/m"),
    ("_bytes", "bytes"),
    ("_radii", "radii"),
    ("_n_m2", "N m²"),
    ("_rad", "rad"),
    ("_n_m", "N m"),
    ("_deg", "°"),
    ("_pa", "Pa"),
    ("_hz", "Hz"),
    ("_s", "s"),
    ("_m", "m"),
    ("_n", "N"),
    ("_j", "J"),
];

/// The name of a column in words with its unit: `min_distance_m` is "Min distance in m". Keys of scenario
/// files stay as they are.
pub(super) fn label(column: &str) -> String {
    if column.contains('.') {
        return column.to_owned();
    }
    let known = UNITS
        .iter()
        .find_map(|(ending, unit)| Some((column.strip_suffix(ending)?, unit)));
    match known {
        Some((name, unit)) if !name.is_empty() => format!("{} in {unit}", sentence(name)),
        _ => sentence(column),
    }
}

/// Words with a capital at the beginning and without underscores.
fn sentence(name: &str) -> String {
    let words = name.replace('_', " ");
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_words_with_units() {
        for (column, expected) in [
            ("min_distance_m", "Min distance in m"),
            ("velocity_x_m_per_s", "Velocity x in m/s"),
            ("steps", "Steps"),
            ("contact.friction", "contact.friction"),
            ("time_s", "Time in s"),
            ("newton_iterations_mean", "Newton iterations mean"),
        ] {
            assert_eq!(label(column), expected);
        }
    }
}
