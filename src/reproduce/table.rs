//! Pages whose figures are drawn from their table alone, and functions for rows.

use super::Result;
use super::artifact::Recipe;
use super::cases::{Case, Run};
use super::page::{Page, PageFigure};
use rodlab_files::figure::{Curve, LinePlot};
use rodlab_files::results::read_whole_rows;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::Path;

/// A page whose figures only show the rows of its table.
pub(super) struct Tabled<R, Row> {
    runs: fn(quick: bool) -> Vec<R>,
    rows: Rows<R, Row>,
    /// Writes the text above the figures; figures within the text are placed by
    /// [`Page::next_figure`].
    write: Write<R, Row>,
    figures: fn(&[Row]) -> Vec<PageFigure>,
}

/// Writer of a page from runs and rows.
type Write<R, Row> = fn(&mut Page, &[Case<R>], &[Row]) -> Result<()>;

/// Conversion of finished runs to rows.
pub(super) enum Rows<R, Row> {
    /// One row per run.
    Row(fn(&Case<R>) -> Row),
    /// Several rows per run.
    Series(fn(&Case<R>) -> Result<Vec<Row>>),
    /// Rows of all runs together.
    All(fn(&[Case<R>]) -> Result<Vec<Row>>),
}

impl<R, Row> Tabled<R, Row> {
    /// Combines runs, their conversion to rows, the text of the page, and its figures.
    pub const fn new(
        runs: fn(quick: bool) -> Vec<R>,
        rows: Rows<R, Row>,
        write: Write<R, Row>,
        figures: fn(&[Row]) -> Vec<PageFigure>,
    ) -> Self {
        Self {
            runs,
            rows,
            write,
            figures,
        }
    }
}

impl<R: Run, Row: Serialize + DeserializeOwned> Recipe for Tabled<R, Row> {
    type Run = R;

    fn runs(&self, quick: bool) -> Vec<R> {
        (self.runs)(quick)
    }

    fn write(&self, page: &mut Page, cases: &[Case<R>]) -> Result<()> {
        let rows: Vec<Row> = match self.rows {
            Rows::Row(row) => cases.iter().map(row).collect(),
            Rows::Series(rows) => {
                let series: Result<Vec<Vec<Row>>, _> = cases.iter().map(rows).collect();
                series?.into_iter().flatten().collect()
            }
            Rows::All(rows) => rows(cases)?,
        };
        page.csv(&rows)?;
        page.hold((self.figures)(&rows));
        (self.write)(page, cases, &rows)?;
        Ok(page.figures()?)
    }

    fn figures_of_table(&self, table: &Path) -> Option<Result<Vec<PageFigure>>> {
        Some(rows_of(table).map(|rows| (self.figures)(&rows)))
    }
}

/// Reads the rows of a table.
pub(super) fn rows_of<Row: DeserializeOwned>(table: &Path) -> Result<Vec<Row>> {
    Ok(read_whole_rows(table)?.rows)
}

/// The mean of values; `None` if there are none.
pub(super) fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let values: Vec<f64> = values.into_iter().collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// The largest of non-negative values; 0 if there are none.
pub(super) fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, f64::max)
}

/// A curve through the points of rows.
pub(super) fn curve<Row, Value: Into<Option<f64>>>(
    name: impl Into<String>,
    rows: impl IntoIterator<Item = Row>,
    point: impl Fn(Row) -> (f64, Value),
) -> Curve {
    let points = rows.into_iter().map(point);
    Curve::new(name, points.map(|(x, y)| (x, y.into())).collect())
}

/// A plot with the name of its vertical axis, which begins with a capital unless it is a symbol.
pub(super) fn plot(label: impl Into<String>, curves: impl IntoIterator<Item = Curve>) -> LinePlot {
    LinePlot::new(with_capital(label.into()), curves)
}

/// A label with a capital if it begins with a word, not with a symbol such as "y in m".
fn with_capital(label: String) -> String {
    let is_letter = |character: char| character.is_ascii_lowercase();
    let letters = label.find(|character| !is_letter(character));
    if letters.unwrap_or(label.len()) < 2 {
        return label;
    }
    let (first, rest) = label.split_at(1);
    first.to_uppercase() + rest
}
