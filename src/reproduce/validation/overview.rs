//! The table of all published cases.

use super::BENCHMARKS;
use super::benchmark::{BenchmarkRun, Row, digits};
use super::peers::{MODULES, PeerRow, Section, best_of_peers, verdict};
use crate::reproduce::page::stem;
use crate::reproduce::prelude::*;
use std::collections::BTreeSet;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "validation",
    title: "Published cases",
    recipe: &Tabled::new(runs, Rows::All(rows), write, figures),
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
fn write(page: &mut Page, cases: &[Case<BenchmarkRun>], rows: &[Row]) -> Result<()> {
    let mut peers = Vec::new();
    for benchmark in BENCHMARKS.iter() {
        let own = |case: &&Case<BenchmarkRun>| case.run.benchmark.name == benchmark.name;
        let own: Vec<Case<BenchmarkRun>> = cases.iter().filter(own).cloned().collect();
        peers.extend(Section::of(benchmark, &own, page.is_quick())?.rows);
    }
    list_better(page, rows, &peers);
    page.text(
        "Cases from the literature, with values by means that share nothing with the engine: closed forms, \
         shooting, and small solvers of their own. Errors are those of the finest of three meshes. A page for each \
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
    page.table(columns! { row in &finest;
        "case" => format!("[{0}]({0}/README.md)", row.case),
        "quantity" => row.quantity.as_str(),
        "published" => row.published.map(|value| value.to_string()).unwrap_or_default(),
        "exact" => digits(row.exact),
        "rodlab" => digits(row.value),
        "edges" => row.edges.to_string(),
        "error" => format!("{:.1e}", row.error),
        "order" => number(row.order, 2),
    });
    page.text("[PAPER.md](PAPER.md) describes method and proof.");
    compare(page, &finest, &peers)?;
    page.text("Published cases that are left out, because a value that is certain or found by other means is missing:");
    page.text(LEFT_OUT);
    Ok(())
}

/// Cases without a certain value.
const LEFT_OUT: &str = "\
- Rodenborn et al. 2013, Proc. Natl. Acad. Sci. 110, E338: no table of the measured thrust, torque and drag of helices was \
  found. [helix-in-flow](helix-in-flow/README.md) has a similar helix with exact values.
- Jawed, Khouri, Da, Grinspun and Reis 2015, Phys. Rev. Lett. 115, 168101: the speed at which a rotating flagellum buckles depends \
  on the model of the flow, and there is no independent solution with the same one.
- The time in which flagella bundle depends on how they begin, and long bundles are chaotic.
- Jawed, Da, Joo, Grinspun and Reis 2014, Proc. Natl. Acad. Sci. 111, 14663: patterns of a rod on a moving belt are given by \
  diagrams. [coiling](coiling/README.md) is a rod on a floor at rest.
- Audoly, Clauvelin and Neukirch 2007, Phys. Rev. Lett. 99, 164301: the traction T = EI/2R² of a loop of \
  radius R is the limit of thin rods, to which the page [fig2.7](../fig2.7/README.md) extrapolates.";

/// Plots the largest error of each case at each of its meshes.
fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let mut cases: Vec<&String> = rows.iter().map(|row| &row.case).collect();
    cases.dedup();
    let error = |case: &str, mesh: usize| {
        let own = || rows.iter().filter(|row| row.case == case);
        let meshes: BTreeSet<usize> = own().map(|row| row.edges).collect();
        let edges = *meshes.iter().nth(mesh)?;
        let own = own().filter(|row| row.edges == edges);
        Some(largest(own.map(|row| row.error.abs())))
    };
    let meshes = ["coarse mesh", "middle mesh", "fine mesh"];
    let curves = meshes.into_iter().enumerate().map(|(mesh, name)| {
        let places = cases.iter().enumerate();
        let point = |(place, case): (usize, &&String)| ((place + 1) as f64, error(case, mesh));
        curve(name, places, point).looking(Look::Marks)
    });
    let plot = plot("Largest relative error", curves);
    let style = PlotStyle {
        vertical: vec![AxisScale::Logarithmic],
        names: cases.iter().map(|case| (*case).clone()).collect(),
        ..PlotStyle::default()
    };
    let figure = styled_line_plots([plot], "", style);
    let caption = "Largest relative error of each case at its three meshes";
    vec![PageFigure::new("errors", caption, figure)]
}

/// Lists the cases in which another program is better.
fn list_better(page: &mut Page, rows: &[Row], peers: &[PeerRow]) {
    let better = BENCHMARKS.iter().filter_map(|benchmark| {
        let case = stem(benchmark.name);
        let own: Vec<PeerRow> = peers
            .iter()
            .filter(|row| row.case == case)
            .cloned()
            .collect();
        let words = verdict(rows, &own);
        (!words.is_empty()).then(|| format!("- [{case}]({case}/README.md): {words}"))
    });
    let better: Vec<String> = better.collect();
    if !better.is_empty() {
        page.text("Other programs are better than rodlab in these cases:");
        page.text(&better.join("\n"));
    }
}

/// Compares errors and times of the finest meshes with those of other programs.
fn compare(page: &mut Page, finest: &[&Row], peers: &[PeerRow]) -> Result<()> {
    page.text(
        "The same by other programs that `pip` installs, each at its finest mesh. Their scripts are beside the pages of the \
         cases, the modules that they import beside this table. They run with the Python that `RODLAB_PYTHON` names, or with `python3`. A program that is not installed is \
         left out. Times are processor times of a run, without imports and compilation of Python.",
    );
    let mut lines = Vec::new();
    for row in finest {
        let best = best_of_peers(row, peers);
        if best.is_empty() {
            continue;
        }
        let own = ("rodlab", row.edges, row.error, row.cpu_time_s);
        let others = best.into_iter().map(|peer| {
            let program = peer.program.as_str();
            (program, peer.edges, peer.error, Some(peer.cpu_time_s))
        });
        for (program, edges, error, time) in std::iter::once(own).chain(others) {
            lines.push(vec![
                row.case.clone(),
                row.quantity.clone(),
                program.into(),
                edges.to_string(),
                format!("{error:.1e}"),
                number(time, 3),
            ]);
        }
    }
    if !lines.is_empty() {
        let header = [
            "case",
            "quantity",
            "program",
            "edges",
            "error",
            "processor time, s",
        ];
        page.lines(&header, &lines);
    }
    for (name, text) in MODULES {
        page.file(name, text.as_bytes())?;
    }
    if !peers.is_empty() {
        page.csv_as("peers.csv", peers)?;
    }
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
