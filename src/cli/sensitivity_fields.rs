//! `rodlab sensitivity --field`: derivatives of probes with respect to fields along rods.

use super::prelude::*;
use clap::builder::PossibleValuesParser;
use rodlab_files::figure::Paper;
use rodlab_lab::sensitivity::{Field, FieldDerivatives, FieldRow, Source, field_derivatives};

/// Name of the table.
const TABLE: &str = "fields.csv";
/// Name of the figure.
const FIGURE: &str = "fields.svg";

/// Fields, and when they change.
#[derive(Debug, Args)]
pub struct FieldArguments {
    /// Differentiate with respect to a field: one derivative per node, at about the cost of one run
    #[arg(long = "field", value_name = "FIELD", value_delimiter = ',', conflicts_with_all = ["keys", "check"],
          value_parser = PossibleValuesParser::new(Field::ALL.map(Field::name)))]
    fields: Vec<String>,
    /// Divide the motion into N equal parts, and differentiate with respect to the fields of each
    /// part
    #[arg(long, value_name = "N", default_value_t = 1, requires = "fields",
          value_parser = clap::value_parser!(u16).range(1..=1000))]
    parts: u16,
}

impl FieldArguments {
    /// Whether no field was requested.
    pub fn are_empty(&self) -> bool {
        self.fields.is_empty()
    }

    /// Differentiates probes with respect to the fields. Prints the result, and writes a table and
    /// a figure to `out`.
    pub fn differentiate(
        &self,
        source: Source<'_>,
        probes: &[String],
        out: Option<&Path>,
        json: bool,
    ) -> Result<(), Failure> {
        let names = self.fields.iter();
        let fields: Vec<Field> = names.filter_map(|name| Field::named(name)).collect();
        let found = field_derivatives(source, probes, &fields, usize::from(self.parts), &|| true)?;
        let mut paths = Vec::new();
        if let Some(directory) = out {
            let mut files = vec![(TABLE, found.to_csv().into_bytes())];
            if let Some(figure) = found.figure() {
                files.push((FIGURE, figure.svg(&Paper::default()).into_bytes()));
            }
            paths.extend(files.iter().map(|(name, _)| directory.join(name)));
            write_files(directory, files)?;
        }
        if json {
            return print_json(&as_json(&found));
        }
        print(&as_text(&found))?;
        match paths.is_empty() {
            true => Ok(()),
            false => print_paths(&paths),
        }
    }
}

/// Formats sums and largest derivatives, in one block for each column.
fn as_text(found: &FieldDerivatives) -> String {
    let mut text = match found.time {
        0.0 => "in equilibrium\n".to_owned(),
        time => format!("at t = {time} s, after {} steps\n", found.steps),
    };
    let names = found.components.iter().map(name);
    let width = names.map(|name| name.len()).max().unwrap_or(0).max(5);
    for (column, label) in found.columns.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "\n{label} = {:.6e}", found.values[column]);
        let _ = writeln!(
            text,
            "  {:<width$}{:>16}{:>16}  at",
            "field", "all together", "largest"
        );
        for (component, of) in found.components.iter().enumerate() {
            let _ = write!(
                text,
                "  {:<width$}{:>16.6e}",
                name(of),
                found.sum(component, column)
            );
            let _ = match found.largest(component, column) {
                Some(row) => {
                    let derivative = row.derivatives[component][column];
                    writeln!(text, "{derivative:>16.6e}  {}", place(found, row))
                }
                None => writeln!(text, "{:>16}", "-"),
            };
        }
    }
    text
}

fn name((name, unit): &(String, Option<&str>)) -> String {
    match unit {
        Some(unit) => format!("{name} ({unit})"),
        None => format!("{name} (relative)"),
    }
}

fn place(found: &FieldDerivatives, row: &FieldRow) -> String {
    let FieldRow {
        rod,
        node,
        arc_length,
        part,
        ..
    } = row;
    let mut text = format!("node {node} of `{rod}`, s = {arc_length:.4} m");
    if found.ends.len() > 1 {
        let _ = write!(text, ", until {:.4} s", found.ends[*part]);
    }
    text
}

fn as_json(found: &FieldDerivatives) -> serde_json::Value {
    let of_component = |column: usize| {
        let entry = |(component, (name, unit)): (usize, &(String, Option<&'static str>))| {
            let rows = found.rows.iter();
            let derivatives = rows.map(|row| row.derivatives[component][column]);
            serde_json::json!({
                "field": name,
                "unit": unit,
                "sum": found.sum(component, column),
                "derivatives": derivatives.collect::<Vec<f64>>(),
            })
        };
        let entries = found.components.iter().enumerate().map(entry);
        entries.collect::<Vec<_>>()
    };
    let columns = found.columns.iter().enumerate().map(|(column, name)| {
        serde_json::json!({
            "column": name,
            "value": found.values[column],
            "fields": of_component(column),
        })
    });
    let places = found.rows.iter().map(|row| {
        serde_json::json!({
            "rod": row.rod,
            "node": row.node,
            "arc_length_m": row.arc_length,
            "until_s": found.ends[row.part],
        })
    });
    serde_json::json!({
        "time_s": found.time,
        "steps": found.steps,
        "places": places.collect::<Vec<_>>(),
        "columns": columns.collect::<Vec<_>>(),
    })
}
