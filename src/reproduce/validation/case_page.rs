//! The page of a published case.

use super::benchmark::{Benchmark, BenchmarkRun, Row, digits, figures};
use super::peers::{Section, verdict};
use crate::reproduce::artifact::Recipe;
use crate::reproduce::page::stem;
use crate::reproduce::prelude::*;
use crate::reproduce::table::rows_of;
use std::path::Path;

impl Recipe for &'static Benchmark {
    type Run = BenchmarkRun;

    fn runs(&self, quick: bool) -> Vec<BenchmarkRun> {
        Benchmark::runs(self, quick)
    }

    fn write(&self, page: &mut Page, cases: &[Case<BenchmarkRun>]) -> Result<()> {
        let benchmark = *self;
        let rows = benchmark.rows(cases)?;
        page.csv(&rows)?;
        let peers = Section::of(benchmark, cases, page.is_quick())?;
        let better = verdict(&rows, &peers.rows);
        if !better.is_empty() {
            page.text(&better);
        }
        let scene = format!("{}.toml", stem(benchmark.name));
        page.file(&scene, benchmark.scene.as_bytes())?;
        page.text(benchmark.about);
        page.text(&format!("Source: {}.", benchmark.source));
        page.text(&format!("Exact values: {}.", benchmark.means));
        page.text(&format!(
            "`rodlab run {scene} --set parameters.edges=80` in this folder makes a run."
        ));
        let mut table = columns! { row in &rows;
            "quantity" => row.quantity.as_str(),
            "edges" => row.edges.to_string(),
            "program" => "rodlab",
            "value" => digits(row.value),
            "exact" => digits(row.exact),
            "error" => format!("{:.1e}", row.error),
            "order" => number(row.order, 2),
            "processor time, s" => number(row.cpu_time_s, 3),
        };
        table.lines.extend(peers.cells());
        page.table(table);
        peers.write(page, stem(benchmark.name))?;
        let published = rows.iter().take(benchmark.quantities.len());
        let published: Vec<&Row> = published.filter(|row| row.published.is_some()).collect();
        if !published.is_empty() {
            page.table(columns! { row in published;
                "quantity" => row.quantity.as_str(),
                "published" => row.published.map(|value| value.to_string()).unwrap_or_default(),
                "to" => row.published_accuracy.map(|value| value.to_string()).unwrap_or_default(),
                "exact" => digits(row.exact),
            });
        }
        for figure in figures(&rows) {
            page.figure(&figure)?;
        }
        Ok(())
    }

    fn figures_of_table(&self, table: &Path) -> Option<Result<Vec<PageFigure>>> {
        Some(rows_of(table).map(|rows| figures(&rows)))
    }
}
