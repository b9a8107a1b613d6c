//! A published case with its scenario, quantities and exact values.

use crate::reproduce::cases::{Run, prepared};
use crate::reproduce::page::stem;
use crate::reproduce::prelude::*;
use rodlab_engine::mechanics::Vector3;
use rodlab_files::results::{BranchKind, read_branches, read_nodes};
use rodlab_lab::run::PreparedRun;
use std::iter::repeat;

/// A published case.
pub(super) struct Benchmark {
    /// Name of the benchmark: `validation/` and the name of its folder.
    pub name: &'static str,
    /// Title of the benchmark.
    pub title: &'static str,
    /// Description of the loads and of the comparison.
    pub about: &'static str,
    /// Source of the published values.
    pub source: &'static str,
    /// Method that finds the exact values.
    pub means: &'static str,
    /// The scenario, with the number of edges as `parameters.edges`.
    pub scene: &'static str,
    /// Numbers of edges, each twice the previous one.
    pub edges: [usize; 3],
    /// What is compared.
    pub quantities: &'static [Quantity],
    /// The exact values.
    pub exact: fn() -> Vec<f64>,
    /// Method that measures the values.
    pub measure: Measure,
}

/// What is compared.
pub(super) struct Quantity {
    /// Name of the quantity, with its unit.
    pub name: &'static str,
    /// Published value, with half a unit of its last digit or its stated error.
    pub published: Option<(f64, f64)>,
    /// Scale of relative errors; `None` for the exact value.
    pub scale: Option<f64>,
}

impl Quantity {
    /// A quantity without a published value. Errors are relative to the exact value.
    pub const fn new(name: &'static str) -> Self {
        Self {
            name,
            published: None,
            scale: None,
        }
    }

    /// Sets the published value with its accuracy.
    pub const fn published(mut self, value: f64, accuracy: f64) -> Self {
        self.published = Some((value, accuracy));
        self
    }

    /// Sets the scale of relative errors.
    pub const fn over(mut self, scale: f64) -> Self {
        self.scale = Some(scale);
        self
    }
}

/// Method that measures values.
pub(super) enum Measure {
    /// From the last node of the last output.
    Tip(fn(&Vector3) -> Vec<f64>),
    /// The parameters of the first critical points of a kind.
    Critical(BranchKind),
    /// From the results of the run.
    Run(fn(&Case<BenchmarkRun>) -> Result<Vec<f64>>),
}

/// A case at a number of edges.
#[derive(Clone, Copy)]
pub(super) struct BenchmarkRun {
    /// The case.
    pub benchmark: &'static Benchmark,
    /// The number of edges of each rod.
    pub edges: usize,
}

/// A row of the table: a quantity at a number of edges.
#[derive(Serialize, Deserialize)]
pub(super) struct Row {
    pub case: String,
    pub quantity: String,
    pub edges: usize,
    pub value: f64,
    pub exact: f64,
    pub error: f64,
    /// Observed order of convergence, from the previous number of edges.
    pub order: Option<f64>,
    pub published: Option<f64>,
    pub published_accuracy: Option<f64>,
    pub cpu_time_s: Option<f64>,
}

impl Run for BenchmarkRun {
    fn id(&self) -> String {
        format!("validation_{}_{}", stem(self.benchmark.name), self.edges)
    }

    fn prepare(&self) -> PreparedRun {
        let edges = format!("parameters.edges={}", self.edges);
        prepared(&self.id(), self.benchmark.scene, &[edges])
    }

    fn extent(&self) -> String {
        format!("rods of at most {} edges were loaded", self.edges)
    }

    fn cost(&self) -> f64 {
        0.02 * self.edges as f64
    }

    #[cfg(test)]
    fn shortened(&self) -> Self {
        Self {
            edges: self.benchmark.edges[0],
            ..*self
        }
    }
}

impl Benchmark {
    /// Returns the runs; the quick version omits the finest one.
    pub fn runs(&'static self, quick: bool) -> Vec<BenchmarkRun> {
        let edges = self.edges.iter().take(if quick { 2 } else { 3 });
        let run = |&edges: &usize| BenchmarkRun {
            benchmark: self,
            edges,
        };
        edges.map(run).collect()
    }

    /// Returns a row for each quantity of each run.
    pub fn rows(&self, cases: &[Case<BenchmarkRun>]) -> Result<Vec<Row>> {
        let exact = (self.exact)();
        let mut rows: Vec<Row> = Vec::new();
        for case in cases {
            let values = self.values(case)?;
            for (index, quantity) in self.quantities.iter().enumerate() {
                let error = (values[index] - exact[index]) / quantity.scale.unwrap_or(exact[index]);
                let before = rows.len().checked_sub(self.quantities.len());
                let ratio = before.map(|before| rows[before].error / error);
                rows.push(Row {
                    case: stem(self.name).into(),
                    quantity: quantity.name.into(),
                    edges: case.run.edges,
                    value: values[index],
                    exact: exact[index],
                    error,
                    order: ratio.filter(|ratio| *ratio > 0.0).map(libm::log2),
                    published: quantity.published.map(|(value, _)| value),
                    published_accuracy: quantity.published.map(|(_, accuracy)| accuracy),
                    cpu_time_s: case.record.cpu_time,
                });
            }
        }
        Ok(rows)
    }

    /// Reads the quantities of a run; NaN if the run ended before they were defined.
    fn values(&self, case: &Case<BenchmarkRun>) -> Result<Vec<f64>> {
        let values = match self.measure {
            Measure::Tip(of) => {
                let outputs = read_nodes(&case.directory, case.run.edges + 1)?;
                let tip = outputs.last().and_then(|output| output.positions.last());
                tip.map(of)
            }
            Measure::Critical(kind) => {
                let points = read_branches(&case.directory)?;
                let critical = points.iter().filter(|point| point.kind == kind);
                let parameters = critical.map(|point| point.parameter);
                let count = self.quantities.len();
                Some(parameters.chain(repeat(f64::NAN)).take(count).collect())
            }
            Measure::Run(of) => Some(of(case)?),
        };
        Ok(values.unwrap_or_else(|| vec![f64::NAN; self.quantities.len()]))
    }
}

/// Six significant digits.
pub(super) fn digits(value: f64) -> String {
    let before = libm::log10(value.abs().max(1.0)) as usize + 1;
    format!("{value:.*}", 6usize.saturating_sub(before))
}

/// Plots errors over the number of edges, one curve for each quantity. Quantities with names such
/// as "30°: twist" have a panel for each angle.
pub(super) fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let mut names: Vec<&str> = Vec::new();
    for row in rows {
        if !names.contains(&row.quantity.as_str()) {
            names.push(&row.quantity);
        }
    }
    let mut angles: Vec<Option<&str>> = names.iter().map(|name| angle(name)).collect();
    angles.dedup();
    let panel = |of: &Option<&str>| {
        let own = || rows.iter().filter(|row| angle(&row.quantity) == *of);
        let names = names.iter().filter(|name| angle(name) == *of);
        let curves = names.map(|wanted| {
            let rows = own().filter(|row| row.quantity == *wanted && row.error != 0.0);
            let point = |row: &Row| (row.edges as f64, row.error.abs());
            curve(legend(wanted), rows, point).looking(Look::Marked)
        });
        let label = match of {
            Some(angle) => format!("Relative error, {angle}"),
            None => "Relative error".to_owned(),
        };
        plot(label, curves.chain(second_order(own())))
    };
    let panels: Vec<_> = angles.iter().map(panel).collect();
    let style = PlotStyle {
        horizontal: AxisScale::Logarithmic,
        vertical: vec![AxisScale::Logarithmic; panels.len()],
        ..PlotStyle::default()
    };
    let figure = styled_line_plots(panels, "Number of edges", style);
    let caption = "Relative error over the number of edges; dashed: convergence of second order";
    vec![PageFigure::new("errors", caption, figure)]
}

/// Angle in the name of a quantity.
fn angle(name: &str) -> Option<&str> {
    name.split_once(": ").map(|(angle, _)| angle)
}

/// Name of a quantity in a legend: without its angle, and without its unit, which its relative
/// error does not have.
fn legend(name: &str) -> &str {
    const UNITS: [&str; 6] = ["mm", "s", "degrees", "rad", "10⁻⁴", "√(g/L)"];
    let name = name.split_once(": ").map_or(name, |(_, name)| name);
    match name.rsplit_once(", ") {
        Some((words, unit)) if UNITS.contains(&unit) => words,
        _ => name,
    }
}

/// A line of slope −2 from the largest error of the coarsest mesh over the range of the meshes.
fn second_order<'a>(rows: impl Iterator<Item = &'a Row>) -> Option<Curve> {
    let rows: Vec<&Row> = rows.collect();
    let edges = || rows.iter().map(|row| row.edges);
    let (first, last) = (edges().min()?, edges().max()?);
    let of_first = rows.iter().filter(|row| row.edges == first);
    let error = largest(of_first.map(|row| row.error.abs()));
    let line = curve("second order", [first, last], |edges| {
        (edges as f64, error * (first as f64 / edges as f64).powi(2))
    });
    Some(line.looking(Look::Dashed))
}

#[cfg(test)]
mod tests {
    use super::super::BENCHMARKS;
    use super::*;

    #[test]
    fn curves_of_a_panel_have_different_names() {
        for benchmark in BENCHMARKS {
            let names = benchmark.quantities.iter().map(|quantity| quantity.name);
            let mut named: Vec<_> = names.map(|name| (angle(name), legend(name))).collect();
            named.sort_unstable();
            named.dedup();
            let different = named.len();
            assert_eq!(different, benchmark.quantities.len(), "{}", benchmark.name);
        }
    }
}
