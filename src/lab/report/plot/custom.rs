//! Custom figure of columns of `summary.csv` or `series.csv`.

use super::PlotError;
use super::curves::{Grouping, curves, in_unit, quantity, varies};
use crate::report::branches::{Branches, PARAMETER};
use crate::report::case_folders::{case_folders, parameter_columns};
use crate::report::labels::Quantity;
use rodlab_files::figure::{AxisScale, Curve, Figure, LinePlot, PlotStyle, styled_line_plots};
use rodlab_files::results::{SERIES, SUMMARY, Table};
use std::path::Path;

/// Columns and axes of a custom figure.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CustomFigure {
    /// Column of the horizontal axis. The default is `time_s` for a series, and the first
    /// parameter for a sweep.
    pub x: Option<String>,
    /// Columns to draw, one plot above the other.
    pub y: Vec<String>,
    /// Column of `summary.csv`; each of its values has its own curve.
    pub group: Option<String>,
    /// Scales of the horizontal and the vertical axis. `None` chooses the scale by the numbers.
    pub scales: Option<[AxisScale; 2]>,
}

/// A custom figure.
///
/// Columns are looked up first in `summary.csv`, where each case is a point, then in `series.csv`,
/// where each case is a curve.
///
/// # Errors
/// [`PlotError`] if columns are unknown, not numeric, or from different tables.
pub fn custom_figure(directory: &Path, figure: &CustomFigure) -> Result<Figure, PlotError> {
    let summary_path = directory.join(SUMMARY);
    let summary = summary_path
        .exists()
        .then(|| Table::read(&summary_path))
        .transpose()?;
    let wanted: Vec<&str> = figure
        .x
        .iter()
        .chain(&figure.y)
        .map(String::as_str)
        .collect();
    let has = |table: &Table, column: &str| table.columns().iter().any(|name| name == column);
    match &summary {
        Some(summary) if wanted.iter().all(|column| has(summary, column)) => {
            over_cases(summary, figure)
        }
        _ => {
            let series = all_series(directory, summary.as_ref(), figure)?;
            let table = &series[0].table;
            let nowhere = |column: &&str| {
                !has(table, column) && !summary.as_ref().is_some_and(|summary| has(summary, column))
            };
            if let Some(column) = wanted.iter().copied().find(nowhere) {
                return Err(unknown(column, &[summary.as_ref(), Some(table)]));
            }
            if let Some(second) = wanted.iter().find(|column| !has(table, column)) {
                let first = wanted.iter().find(|column| has(table, column));
                return Err(PlotError::DifferentTables {
                    first: first.unwrap_or(second).to_string(),
                    first_table: SERIES,
                    second: second.to_string(),
                    second_table: SUMMARY,
                });
            }
            over_outputs(&series, figure)
        }
    }
}

fn unknown(column: &str, tables: &[Option<&Table>]) -> PlotError {
    let mut known: Vec<String> = Vec::new();
    for name in tables.iter().flatten().flat_map(|table| table.columns()) {
        if !known.contains(name) {
            known.push(name.clone());
        }
    }
    PlotError::UnknownColumn {
        column: column.to_owned(),
        known,
    }
}

/// A point for each case.
fn over_cases(summary: &Table, figure: &CustomFigure) -> Result<Figure, PlotError> {
    let first_parameter = || parameter_columns(summary).find(|key| varies(summary, key));
    let x = figure
        .x
        .as_deref()
        .or_else(first_parameter)
        .unwrap_or("case");
    let groups: Vec<&str> = figure.group.as_deref().into_iter().collect();
    if let Some(group) = groups.iter().find(|group| summary.column(group).is_none()) {
        return Err(unknown(group, &[Some(summary)]));
    }
    let grouping = Grouping::of(summary, &groups);
    let across = quantity(summary, x);
    let horizontal = in_unit(numbers(summary, x)?, &across);
    let plot = |y: &String| {
        let shown = quantity(summary, y);
        let values = in_unit(numbers(summary, y)?, &shown);
        Ok(LinePlot::new(
            shown.label(),
            curves(&horizontal, &values, &grouping),
        ))
    };
    let plots = figure
        .y
        .iter()
        .map(plot)
        .collect::<Result<_, PlotError>>()?;
    Ok(drawn(plots, &across.label(), figure.scales))
}

/// The series of a case.
struct Series {
    /// Name of its curve.
    name: String,
    table: Table,
    /// Branches of the case, if it followed a path of equilibria.
    branches: Option<Branches>,
}

/// The series of every case with the name of its curve; cases without a series are left out.
fn all_series(
    directory: &Path,
    summary: Option<&Table>,
    figure: &CustomFigure,
) -> Result<Vec<Series>, PlotError> {
    let with_value = |(key, value): &(String, String)| {
        let numbers = summary.and_then(|summary| summary.numbers(key));
        let numbers = numbers.into_iter().flatten().flatten();
        Quantity::of(key, numbers).with_value(value)
    };
    let mut series = Vec::new();
    for folder in case_folders(directory)? {
        let path = folder.path.join(SERIES);
        if !path.exists() {
            continue;
        }
        let name = match &figure.group {
            None if folder.parameters.is_empty() => folder.name,
            None => {
                let pairs: Vec<String> = folder.parameters.iter().map(with_value).collect();
                pairs.join(", ")
            }
            Some(group) => {
                let value = folder.parameters.iter().find(|(key, _)| key == group);
                with_value(value.ok_or_else(|| unknown(group, &[summary]))?)
            }
        };
        series.push(Series {
            name,
            table: Table::read(&path)?,
            branches: Branches::read(&folder.path)?,
        });
    }
    if series.is_empty() {
        // The later reading of the file reports the fault.
        series.push(Series {
            name: String::new(),
            table: Table::read(&directory.join(SERIES))?,
            branches: None,
        });
    }
    Ok(series)
}

/// A curve for each case.
fn over_outputs(series: &[Series], figure: &CustomFigure) -> Result<Figure, PlotError> {
    let x = figure.x.as_deref().unwrap_or("time_s");
    let plot = |y: &String| {
        let curve = |one: &Series| {
            let places = numbers(&one.table, x)?.into_iter();
            let points = places.zip(numbers(&one.table, y)?);
            let points = points.filter_map(|(x, y)| Some((x?, y))).collect();
            let points = match &one.branches {
                Some(branches) => branches.broken(points),
                None => points,
            };
            Ok(Curve::new(one.name.clone(), points))
        };
        let curves: Vec<Curve> = series.iter().map(curve).collect::<Result<_, PlotError>>()?;
        Ok(LinePlot::new(quantity(&series[0].table, y).label(), curves))
    };
    let plots = figure
        .y
        .iter()
        .map(plot)
        .collect::<Result<_, PlotError>>()?;
    let is_path = series.iter().any(|one| one.branches.is_some());
    let label = match x {
        "time_s" if is_path => PARAMETER.into(),
        x => quantity(&series[0].table, x).label(),
    };
    Ok(drawn(plots, &label, figure.scales))
}

fn numbers(table: &Table, column: &str) -> Result<Vec<Option<f64>>, PlotError> {
    let numbers = table
        .numbers(column)
        .ok_or_else(|| unknown(column, &[Some(table)]))?;
    let cells = table.column(column).into_iter().flatten();
    if numbers
        .iter()
        .zip(cells)
        .any(|(number, cell)| number.is_none() && !cell.is_empty())
    {
        return Err(PlotError::NoNumbers(column.to_owned()));
    }
    Ok(numbers)
}

fn drawn(plots: Vec<LinePlot>, label: &str, scales: Option<[AxisScale; 2]>) -> Figure {
    let points = |plot: &LinePlot| -> Vec<(f64, Option<f64>)> {
        plot.curves
            .iter()
            .flat_map(|curve| curve.points.clone())
            .collect()
    };
    let across = plots.iter().flat_map(points).map(|(x, _)| x);
    let style = PlotStyle {
        horizontal: scales.map_or_else(|| AxisScale::fitting(across), |[x, _]| x),
        vertical: plots
            .iter()
            .map(|plot| match scales {
                Some([_, y]) => y,
                None => AxisScale::fitting(points(plot).into_iter().filter_map(|(_, y)| y)),
            })
            .collect(),
        ..PlotStyle::default()
    };
    styled_line_plots(plots, label, style)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_files::figure::Paper;
    use std::fs;
    use tempfile::TempDir;

    /// A sweep of friction with a series for each case.
    fn sweep() -> TempDir {
        let directory = tempfile::tempdir().unwrap();
        let summary = "case,contact.friction,contact.model,status,force_n\n\
                       a,0.1,imc,finished,1\nb,0.2,ipc,finished,50\n";
        fs::write(directory.path().join(SUMMARY), summary).unwrap();
        for case in ["a", "b"] {
            let folder = directory.path().join("cases").join(case);
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join(SERIES), "time_s,energy_j\n0.0,1.0\n1.0,2.0\n").unwrap();
        }
        directory
    }

    fn figure(x: Option<&str>, y: &str, group: Option<&str>) -> CustomFigure {
        CustomFigure {
            x: x.map(Into::into),
            y: vec![y.into()],
            group: group.map(Into::into),
            scales: None,
        }
    }

    #[test]
    fn outcomes_are_points_and_series_are_curves() {
        let directory = sweep();
        let draw = |figure: &CustomFigure| {
            let figure = custom_figure(directory.path(), figure).unwrap();
            figure.svg(&Paper::default())
        };
        let outcomes = draw(&figure(None, "force_n", None));
        assert!(outcomes.contains("Contact friction") && outcomes.contains("Force in N"));
        let marks = |svg: &str| svg.matches("0Z\" fill=\"#0072b2\"").count();
        assert_eq!(marks(&outcomes), 2);
        let grouped = draw(&figure(
            Some("contact.friction"),
            "force_n",
            Some("contact.model"),
        ));
        assert!(grouped.contains("contact model = ipc"));
        let series = draw(&figure(None, "energy_j", None));
        assert!(series.contains("contact friction = 0.1, contact model = imc"));
        let by_model = draw(&figure(None, "energy_j", Some("contact.model")));
        assert!(by_model.contains("contact model = imc") && !by_model.contains("friction"));
    }

    #[test]
    fn wrong_columns_are_answered_with_what_to_type() {
        let directory = sweep();
        let refuse = |figure: &CustomFigure| {
            let error = custom_figure(directory.path(), figure).unwrap_err();
            assert!(!matches!(error, PlotError::Results(_)));
            error.to_string()
        };
        let message = refuse(&figure(None, "enrgy_j", None));
        assert!(message.contains("did you mean `energy_j`?"), "{message}");
        assert!(message.contains("contact.friction"), "{message}");
        let message = refuse(&figure(Some("contact.model"), "force_n", None));
        assert!(
            message.contains("`contact.model` holds no numbers"),
            "{message}"
        );
        let message = refuse(&figure(Some("time_s"), "force_n", None));
        assert!(
            message.contains(SERIES) && message.contains(SUMMARY),
            "{message}"
        );
        let message = refuse(&figure(None, "force_n", Some("contact.modl")));
        assert!(
            message.contains("did you mean `contact.model`?"),
            "{message}"
        );
    }
}
