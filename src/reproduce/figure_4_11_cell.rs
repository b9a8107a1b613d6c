//! Figure 4.11 in the virtual cell: seven folds through drivers and camera.

use super::folds::SCENARIOS;
use super::folds_in_cell::{FRICTION, PARTS, Row, folded, id, scenarios};
use super::page::{Heading, Page, PageFigure, number};
use super::recipe::AnyRecipe;
use super::table::{FiguresOfTable, rows_of};
use super::{ReproduceError, ReproduceOptions};
use crate::figure::{Curve, LinePlot, Look, line_plots};
use std::path::PathBuf;

/// Rough time of a fold, s.
const COST: f64 = 30.0;
/// What a sheet that is held by a moment is to slide by at most, mm.
const BOUND: f64 = 2.0;

/// The page of these folds.
pub(super) struct FoldsInCell;

impl FoldsInCell {
    fn write(
        heading: Heading,
        quick: bool,
        options: &ReproduceOptions,
        report: &(dyn Fn(&str) + Sync),
    ) -> Result<Vec<PathBuf>, ReproduceError> {
        let mut rows = Vec::new();
        for scenario in scenarios(quick) {
            let (row, was_known) = folded(scenario, options)?;
            let how = if was_known {
                "had been folded before".to_owned()
            } else {
                format!("{:.1} s of wall time", row.wall_time_s)
            };
            report(&format!("{}: {}, {how}", id(scenario), row.status));
            rows.push(row);
        }
        let mut page = Page::begin_of_tasks(heading, options, "one sheet was folded")?;
        describe(&mut page, &rows)?;
        Ok(page.finish()?)
    }
}

impl AnyRecipe for FoldsInCell {
    fn cost(&self, quick: bool) -> f64 {
        COST * scenarios(quick).len() as f64
    }

    fn figures_of_table(&self) -> Option<FiguresOfTable> {
        Some(|table| Ok(figures(&rows_of::<Row>(table)?)))
    }

    fn make(
        &self,
        heading: Heading,
        options: &ReproduceOptions,
        report: &(dyn Fn(&str) + Sync),
    ) -> Result<Vec<PathBuf>, ReproduceError> {
        Self::write(heading, options.quick, options, report)
    }

    #[cfg(test)]
    fn make_shortened(
        &self,
        heading: Heading,
        _count: usize,
        options: &ReproduceOptions,
        report: &(dyn Fn(&str) + Sync),
    ) -> Result<Vec<PathBuf>, ReproduceError> {
        Self::write(heading, true, options, report)
    }

    #[cfg(test)]
    fn ids(&self, quick: bool) -> Vec<String> {
        scenarios(quick).iter().map(id).collect()
    }
}

fn describe(page: &mut Page, rows: &[Row]) -> Result<(), ReproduceError> {
    page.text(&format!(
        "The seven scenarios of thesis sec. 4.6.3, each folded by the arm of a virtual cell (`rodlab cell serve --paper`) through its drivers, as \
         `rodlab fold --feedback {PARTS}` does: the camera looks where the sheet lies, the arm takes its edge, and after each of {PARTS} parts of the \
         way the camera looks how far the sheet has slid; where that is more than 0.3 mm the next part is planned anew (Algorithm 5). The \
         table has a friction of {FRICTION}. The arm is 20 ms late and runs 20 ms behind; a pixel is 0.73 mm.",
    ));
    page.text(
        "Sheets that can be are held by as little moment as keeps the friction demand below 0.85 of the friction. Three folds are too tight for that at \
         any moment (fig4.11): they are tried without one, by the least sum of λ. Sliding and errors are those of the simulated sheet until the \
         gripper lets go; beside them, what camera and joints say.",
    );
    let header = [
        "scenario",
        "edge",
        "slid at most, mm",
        "slid at the end, mm",
        "as seen, mm",
        "error of the fold, mm",
        "as seen, mm",
        "parts planned anew",
        "what came of it",
    ];
    let line = |row: &Row| {
        let known = SCENARIOS.iter().find(|known| known.id == row.scenario);
        vec![
            known.map_or_else(String::new, |known| known.name.to_owned()),
            row.way.clone(),
            number(Some(row.largest_sliding_mm), 2),
            number(Some(row.final_sliding_mm), 2),
            number(row.seen_sliding_mm, 2),
            number(row.fold_length_error_mm, 2),
            number(row.seen_fold_length_error_mm, 2),
            row.planned_anew.to_string(),
            row.status.replace('|', " "),
        ]
    };
    page.table(&header, &rows.iter().map(line).collect::<Vec<_>>());
    page.csv(rows)?;
    for figure in figures(rows) {
        page.figure(&figure)?;
    }
    Ok(())
}

/// How far sheets slide that are held by a moment; the others are far beyond.
fn figures(rows: &[Row]) -> Vec<PageFigure> {
    let place = |row: &Row| {
        let index = SCENARIOS.iter().position(|known| known.id == row.scenario);
        index.map(|index| index as f64 + 1.0)
    };
    let marks = |name: &str, value: &dyn Fn(&Row) -> Option<f64>| {
        let held = rows.iter().filter(|row| row.way == "held");
        let points = held.filter_map(|row| Some((place(row)?, value(row))));
        Curve::new(name, points.collect()).looking(Look::Marks)
    };
    let last = rows.iter().filter_map(place).fold(1.0, f64::max);
    let bound = vec![(1.0, Some(BOUND)), (last.max(2.0), Some(BOUND))];
    let plot = LinePlot {
        label: "slid in mm".into(),
        curves: vec![
            marks("at most", &|row| Some(row.largest_sliding_mm)),
            marks("at the end, as seen", &|row| row.seen_sliding_mm),
            Curve::new("2 mm", bound).looking(Look::Dashed),
        ],
    };
    vec![PageFigure::new(
        "fig4.11-cell_sliding",
        "How far sheets slide that an arm folds in the virtual cell, where a moment can hold them",
        line_plots([plot], "scenario, in the order of the table"),
    )]
}
