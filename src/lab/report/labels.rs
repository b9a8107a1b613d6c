//! Labels of columns of the CSV files, with units.

use crate::experiment::unit;

/// Suffixes of column names and their units; longer ones first.
const UNITS: [(&str, &str); 17] = [
    ("_rad_per_s", "rad/s"),
    ("_rad_per_m", "rad/m"),
    ("_n_per_m", "N/m"),
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

/// Units of scenario files that take prefixes, and the prefixes in ascending order.
const PREFIXES: [(&str, &[(&str, f64)]); 4] = [
    ("m", &[("µm", 1e-6), ("mm", 1e-3), ("m", 1.0)]),
    (
        "Pa",
        &[("Pa", 1.0), ("kPa", 1e3), ("MPa", 1e6), ("GPa", 1e9)],
    ),
    ("s", &[("µs", 1e-6), ("ms", 1e-3), ("s", 1.0)]),
    ("N", &[("µN", 1e-6), ("mN", 1e-3), ("N", 1.0), ("kN", 1e3)]),
];

/// Tables of scenario files whose name does not describe their keys.
const SILENT: [&str; 5] = ["material", "rod", "rods", "loads", "clamps"];

/// A column as it appears in a figure.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Quantity {
    /// Name of the quantity in words, in small letters.
    pub name: String,
    /// Unit of the quantity; empty for a pure number.
    pub unit: String,
    /// The size of that unit, in the unit of the column.
    pub size: f64,
}

impl Quantity {
    /// The quantity of a column with these values. `min_distance_m` becomes the min distance in m;
    /// the key `rods.beam.radius` becomes the radius of beam, in mm if its values are of that
    /// size.
    pub fn of(column: &str, values: impl Iterator<Item = f64>) -> Self {
        if !column.contains('.') {
            let known = UNITS
                .iter()
                .find_map(|(ending, unit)| Some((column.strip_suffix(ending)?, unit)));
            let (name, unit) = match known {
                Some((name, unit)) if !name.is_empty() => (name, *unit),
                _ => (column, ""),
            };
            let name = match name {
                "newton_iterations_mean" => "mean Newton iterations per step".into(),
                "newton_iterations_mean_with_contact" => {
                    "mean Newton iterations per step with contact".into()
                }
                name => name.replace('_', " "),
            };
            return Self {
                name,
                unit: unit.into(),
                size: 1.0,
            };
        }
        let unit = unit(column)
            .unwrap_or_default()
            .replace("^2", "²")
            .replace("^3", "³");
        let largest = values.map(f64::abs).fold(0.0, f64::max);
        let prefixes = PREFIXES.iter().find(|(known, _)| *known == unit);
        // A fraction of a metre or a second is easier to read than hundreds of the next prefix.
        let fitting = prefixes.and_then(|(_, prefixes)| {
            let fits = |(_, size): &&(&str, f64)| largest >= if *size == 1.0 { 0.1 } else { *size };
            prefixes.iter().rev().find(fits).or(prefixes.first())
        });
        let (unit, size) = fitting.map_or((unit.as_str(), 1.0), |(unit, size)| (unit, *size));
        Self {
            name: name_of_key(column),
            unit: unit.into(),
            size,
        }
    }

    /// Name of the quantity with a capital.
    pub fn title(&self) -> String {
        sentence(&self.name)
    }

    /// The label of an axis.
    pub fn label(&self) -> String {
        let name = self.title();
        if self.unit.is_empty() {
            name
        } else {
            format!("{name} in {}", self.unit)
        }
    }

    /// A cell of the column with the name of the quantity, as shown in a legend.
    pub fn with_value(&self, cell: &str) -> String {
        let Self { name, unit, size } = self;
        let space = if unit.is_empty() { "" } else { " " };
        match cell.parse::<f64>() {
            Ok(number) if number.is_finite() => {
                format!("{name} = {}{space}{unit}", four_digits(number / size))
            }
            _ => format!("{name} = {cell}"),
        }
    }
}

/// A key of a scenario file in words: the quantity and its owner.
fn name_of_key(key: &str) -> String {
    let mut steps: Vec<&str> = key
        .split('.')
        .filter(|step| step.parse::<usize>().is_err())
        .collect();
    let name = steps.pop().unwrap_or_default();
    let name = match name {
        "youngs_modulus" => "Young's modulus".into(),
        "poissons_ratio" => "Poisson's ratio".into(),
        name => name.replace('_', " "),
    };
    let table = steps.first().copied().unwrap_or_default();
    if !SILENT.contains(&table) && !table.is_empty() {
        return format!("{} {name}", table.replace('_', " "));
    }
    match steps.get(1) {
        Some(owner) => format!("{name} of {owner}"),
        None => name,
    }
}

/// A number with four digits.
fn four_digits(number: f64) -> String {
    let rounded: f64 = format!("{number:.3e}")
        .parse()
        .expect("a number as written");
    format!("{rounded}")
}

/// Words with a capital at the beginning.
fn sentence(words: &str) -> String {
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
        for (column, largest, expected) in [
            ("min_distance_m", 1.0, "Min distance in m"),
            ("velocity_x_m_per_s", 1.0, "Velocity x in m/s"),
            ("steps", 1.0, "Steps"),
            ("time_s", 1.0, "Time in s"),
            (
                "newton_iterations_mean",
                1.0,
                "Mean Newton iterations per step",
            ),
            ("contact.friction", 0.3, "Contact friction"),
            ("rods.beam.radius", 0.0055, "Radius of beam in mm"),
            ("rod.radius", 0.0016, "Radius in mm"),
            ("rods.0.radius", 0.2, "Radius in m"),
            ("material.youngs_modulus", 1e8, "Young's modulus in MPa"),
            ("flagella.count", 3.0, "Flagella count"),
        ] {
            let quantity = Quantity::of(column, [largest].into_iter());
            assert_eq!(quantity.label(), expected);
        }
    }

    #[test]
    fn values_are_shown_shortly_in_their_unit() {
        let radius = Quantity::of("rods.beam.radius", [0.0055, 0.001].into_iter());
        assert_eq!(radius.with_value("0.0055"), "radius of beam = 5.5 mm");
        let friction = Quantity::of("contact.friction", [0.3].into_iter());
        assert_eq!(
            friction.with_value("0.13572088083"),
            "contact friction = 0.1357"
        );
        let model = Quantity::of("contact.model", std::iter::empty());
        assert_eq!(model.with_value("imc"), "contact model = imc");
    }
}
