//! Converts a scene to other units: multiplies every quantity of a scenario file by the factor of
//! its dimension.
//!
//! The JSON Schema of scenario files has the dimension of every key, so no key is listed here. If
//! all lengths of a scene are multiplied by L, all times by T and all masses by M, it moves in the
//! same way: L times as far in T times the time. A deviation reveals a dimensional constant
//! somewhere in the code.

use super::experiments::Experiments;
use super::schema_tree::SchemaTree;
use super::units;
use serde_json::Value as Json;
use toml::{Table, Value};

/// Factors of the base quantities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Of lengths.
    pub length: f64,
    /// Of times.
    pub time: f64,
    /// Of masses.
    pub mass: f64,
}

impl Scales {
    /// Factor of a quantity with these powers of length, time and mass.
    pub fn of(&self, [length, time, mass]: [i32; 3]) -> f64 {
        self.length.powi(length) * self.time.powi(time) * self.mass.powi(mass)
    }
}

/// Keys of [continuation] in units of the path parameter, which replaces the time.
const OF_PARAMETER: [&str; 4] = ["from", "to", "step", "largest_step"];

/// The text of a scenario file in SI units, with every quantity multiplied by the factor of its
/// dimension. Numbers in other files, expressions, sweeps and probes are left unchanged.
///
/// # Errors
/// Syntax errors in the TOML text.
pub fn rescaled(
    experiments: Experiments,
    text: &str,
    scales: &Scales,
) -> Result<String, toml::de::Error> {
    let mut file: Table = text.parse()?;
    let root = experiments.schema();
    let rescaler = Rescaler {
        tree: SchemaTree::new(&root),
        scales,
    };
    for (key, value) in &mut file {
        rescaler.rescale_key(&root, key, None, value);
    }
    if let Some(Value::Table(path)) = file.get_mut("continuation") {
        for key in OF_PARAMETER {
            if let Some(value) = path.get_mut(key)
                && let Some(parameter) = in_si_units(value)
            {
                *value = Value::Float(scales.time * parameter);
            }
        }
    }
    Ok(file.to_string())
}

struct Rescaler<'a> {
    tree: SchemaTree<'a>,
    scales: &'a Scales,
}

impl<'a> Rescaler<'a> {
    fn rescale_key(&self, table: &'a Json, key: &str, kind: Option<&str>, value: &mut Value) {
        if let Some(schema) = self.tree.property(table, key, kind) {
            self.rescale(schema, value);
        }
    }

    /// Rescales a value with this schema.
    fn rescale(&self, schema: &'a Json, value: &mut Value) {
        match value {
            Value::Table(table) => {
                let kind = table.get("kind").and_then(Value::as_str).map(str::to_owned);
                for (key, value) in table.iter_mut() {
                    self.rescale_key(schema, key, kind.as_deref(), value);
                }
            }
            Value::Array(items) => {
                for (index, item) in items.iter_mut().enumerate() {
                    if let Some(schema) = self.tree.item(schema, index) {
                        self.rescale(schema, item);
                    }
                }
            }
            number => {
                let factor = self
                    .tree
                    .powers(schema)
                    .map(|powers| self.scales.of(powers));
                if let (Some(factor), Some(si)) = (factor, in_si_units(number)) {
                    *number = Value::Float(si * factor);
                }
            }
        }
    }
}

/// A number, or text with a unit, in SI units; `None` for any other text.
fn in_si_units(value: &Value) -> Option<f64> {
    match value {
        Value::Float(number) => Some(*number),
        Value::Integer(number) => Some(*number as f64),
        Value::String(text) => units::parse_any(text),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment;

    #[test]
    fn every_quantity_is_rescaled_by_its_own_powers() {
        let text = "experiment = 'scene'\n[time]\nstep = 'auto'\nend = '2 s'\n[[rods]]\nradius = '3 mm'\nedges = 7\nshape = { kind = 'straight', start = [0, 0, 0], end = [1, 2, 3] }\n[[clamps]]\nat = 4\nmove = [[1, [5, 0, 0]]]\nturn = [[1, 0.5]]\n[[bodies]]\nshape = { kind = 'sphere', radius = 7 }\n[[loads]]\nkind = 'force'\nforce = [1, 0, 0]\n[fluid]\nviscosity = 1\n";
        let scales = Scales {
            length: 10.0,
            time: 100.0,
            mass: 1000.0,
        };
        let rescaled: Table = experiment::rescaled(text, &scales)
            .unwrap()
            .parse()
            .unwrap();
        let expected: Table = "experiment = 'scene'\n[time]\nstep = 'auto'\nend = 200.0\n[[rods]]\nradius = 0.03\nedges = 7\nshape = { kind = 'straight', start = [0.0, 0.0, 0.0], end = [10.0, 20.0, 30.0] }\n[[clamps]]\nat = 4\nmove = [[100.0, [50.0, 0.0, 0.0]]]\nturn = [[100.0, 0.5]]\n[[bodies]]\nshape = { kind = 'sphere', radius = 70.0 }\n[[loads]]\nkind = 'force'\nforce = [1.0, 0.0, 0.0]\n[fluid]\nviscosity = 1.0\n".parse().unwrap();
        assert_eq!(rescaled, expected);
    }
}
