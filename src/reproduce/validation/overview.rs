//! The table of all published cases.

use super::BENCHMARKS;
use super::benchmark::{BenchmarkRun, Row, digits, figures_of_cases};
use crate::reproduce::page::stem;
use crate::reproduce::prelude::*;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "validation",
    title: "Published cases",
    recipe: &Tabled::new(runs, Rows::All(rows), write, figures_of_cases),
};

/// The runs of all cases.
fn runs(quick: bool) -> Vec<BenchmarkRun> {
    let runs = BENCHMARKS.iter().map(|benchmark| benchmark.runs(quick));
    runs.collect::<Vec<_>>().concat()
}

/// The rows of all cases.
fn rows(cases: &[Case<BenchmarkRun>]) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for benchmark in BENCHMARKS.iter() {
        let own = cases
            .iter()
            .filter(|case| case.run.benchmark.name == benchmark.name);
        let own: Vec<Case<BenchmarkRun>> = own.cloned().collect();
        rows.extend(benchmark.rows(&own)?);
    }
    Ok(rows)
}

/// Writes a line for each quantity at the finest mesh.
fn write(page: &mut Page, _: &[Case<BenchmarkRun>], rows: &[Row]) -> Result<()> {
    page.text(
        "Cases from the literature, with values by means that share nothing with the engine: closed forms, and \
         solutions of the boundary value problem by shooting. Errors are those of the finest of three meshes. A page for each \
         case has its source, its scenario, all meshes and the published values. `rodlab reproduce validation` makes them all again. \
         Three real wires, with the errors of a photograph that was not fitted, are on the page `identification` of the guide.",
    );
    let finest: Vec<&Row> = BENCHMARKS
        .iter()
        .flat_map(|benchmark| {
            let own = || rows.iter().filter(|row| row.case == stem(benchmark.name));
            let most = own().map(|row| row.edges).max();
            own().filter(move |row| Some(row.edges) == most)
        })
        .collect();
    page.table(columns! { row in finest;
        "case" => format!("[{0}]({0}/README.md)", row.case),
        "quantity" => row.quantity.as_str(),
        "published" => row.published.map(|value| value.to_string()).unwrap_or_default(),
        "exact" => digits(row.exact),
        "rodlab" => digits(row.value),
        "edges" => row.edges.to_string(),
        "error" => format!("{:.1e}", row.error),
        "order" => number(row.order, 2),
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares exact values, which do not depend on the engine, with those of the papers.
    #[test]
    fn exact_values_are_those_published() {
        for benchmark in BENCHMARKS.iter() {
            for (quantity, exact) in benchmark.quantities.iter().zip((benchmark.exact)()) {
                assert!(exact.is_finite(), "{}", benchmark.name);
                if let Some((published, accuracy)) = quantity.published {
                    // The published bend with eight straight elements has an error of 0.7 %;
                    // stretching moves a tip by 1e-4.
                    let coarse = 8e-3 * published * f64::from(benchmark.name.contains("bend-of"));
                    let bound = accuracy.max(1.5e-4) + coarse;
                    assert!(
                        (exact - published).abs() < bound,
                        "{}: {exact} {published}",
                        benchmark.name
                    );
                }
            }
        }
    }
}
