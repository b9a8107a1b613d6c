//! Figure 4.11 in the virtual cell: seven folds through drivers and camera, compared with the
//! plain simulation.

use super::folds::{Folded, METHODS, SCENARIOS, Scenario};
use super::folds_in_cell::{FRICTION, FoldedInCell, PARTS, fold_in_cell};
use super::prelude::*;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "fig4.11-cell",
    title: "Figure 4.11 in the virtual cell: seven folds through drivers and camera",
    recipe: &Tabled::new(Folded::of_cell, Rows::Series(rows), write, figures),
};

/// Allowed sliding of a sheet, mm.
const BOUND: f64 = 2.0;

/// A row of the CSV file; lengths in mm.
#[derive(Serialize, Deserialize)]
pub(super) struct Row {
    scenario: String,
    /// Method of holding the edge: `held` by a moment, or `closed` without one, as in fig4.11.
    way: String,
    /// `folded`, or the reason for the failure.
    status: String,
    /// Largest sliding of the simulated sheet while it was held.
    largest_sliding_mm: Option<f64>,
    /// Final sliding of the simulated sheet.
    final_sliding_mm: Option<f64>,
    /// Final sliding according to the camera; `None` if the edge then covered the free end.
    seen_sliding_mm: Option<f64>,
    /// Error of the fold length of the simulated sheet.
    fold_length_error_mm: Option<f64>,
    /// Error of the fold length according to camera and joints.
    seen_fold_length_error_mm: Option<f64>,
    /// Number of replanned parts.
    #[serde(alias = "planned_anew")]
    replanned: usize,
    /// Sliding in the plain simulation.
    simulated_sliding_mm: Option<f64>,
    simulated_fold_length_error_mm: Option<f64>,
}

/// Folds all sheets in the cell, and writes table and figure.
fn write(page: &mut Page, _: &[Case<Folded>], rows: &[Row]) -> Result<()> {
    page.text(&format!(
        "The seven scenarios of thesis sec. 4.6.3, each folded by the gantry of the virtual cell (`rodlab cell serve \
         --paper`) through its drivers, as `rodlab fold --feedback {PARTS}` does: the camera locates the sheet, the \
         arm grasps its edge, and after each of {PARTS} parts of the path the camera measures how far the free end has \
         slid; if this is more than 0.3 mm, the next part is replanned (Algorithm 5). The table has a friction of \
         {FRICTION}; the arm has a latency of 20 ms and a lag of 20 ms; a pixel is 0.73 mm. All sheets were folded for \
         this page."
    ));
    page.text(
        "Where possible, the edge is held by the smallest moment that keeps the friction demand \
         below 0.85 of the friction. Three folds are too tight for any moment (fig4.11): they are \
         tried without a moment, by the least sum of λ. Sliding and errors are those of the \
         simulated sheet until the gripper releases it; beside them are the final values by camera \
         and joints, and those of the plain simulation, without arm and camera. Where the edge \
         finally covers the free end, the camera cannot measure how far this has slid, nor how \
         long the fold is: such entries are `not seen`, and the last column states the last \
         sighting.",
    );
    let scenario = |row: &Row| SCENARIOS.iter().find(|known| known.id == row.scenario);
    let way = |row: &Row| METHODS.iter().find(|known| known.id == row.way);
    page.table(columns! { row in rows;
        "scenario" => scenario(row).map_or("", |known| known.name),
        "method" => way(row).map_or("", |known| known.name),
        "slid at most, mm" => number(row.largest_sliding_mm, 2),
        "slid at the end, mm" => number(row.final_sliding_mm, 2),
        "by camera, mm" => row.seen(row.seen_sliding_mm),
        "plain simulation, at most, mm" => number(row.simulated_sliding_mm, 2),
        "error of the fold, mm" => number(row.fold_length_error_mm, 2),
        "by camera, mm" => row.seen(row.seen_fold_length_error_mm),
        "plain simulation, mm" => number(row.simulated_fold_length_error_mm, 2),
        "parts replanned" => row.replanned.to_string(),
        "outcome" => row.status.replace('|', " "),
    });
    Ok(())
}

fn rows(case: &Case<Folded>) -> Result<Vec<Row>> {
    let folded = fold_in_cell(case)?;
    let mm = |metres: f64| 1e3 * metres;
    let known = folded.as_ref().ok();
    let ended = known.filter(|folded| folded.ended.is_ok());
    let score = ended.and_then(|folded| folded.record.score.as_ref());
    let looks = known.map_or(&[][..], |folded| &folded.record.looks);
    let seen = looks.last().and_then(|look| look.slid_m);
    let simulated = case.outcome();
    let error = |folded: &FoldedInCell| folded.held.edge[0] - folded.target - folded.held.sliding;
    Ok(vec![Row {
        scenario: SCENARIOS[case.run.scenario].id.into(),
        way: METHODS[case.run.method].id.into(),
        status: match &folded {
            Ok(folded) => match (&folded.ended, score) {
                (Ok(()), Some(score)) if score.is_end_hidden => format!(
                    "folded; the free end was seen last after part {} of {PARTS}, when it had slid by {:.2} mm",
                    score.last_seen_part,
                    mm(score.last_seen_sliding_m)
                ),
                (Ok(()), _) => "folded".into(),
                (Err(error), _) => error.to_string(),
            },
            Err(error) => error.to_string(),
        },
        largest_sliding_mm: known.map(|folded| mm(folded.held.largest_sliding)),
        final_sliding_mm: known.map(|folded| mm(folded.held.sliding)),
        seen_sliding_mm: seen.map(mm),
        fold_length_error_mm: known
            .filter(|_| score.is_some())
            .map(|folded| mm(error(folded))),
        seen_fold_length_error_mm: score.and_then(|score| score.fold_length_error_m.map(mm)),
        replanned: looks.iter().filter(|look| look.is_replanned).count(),
        simulated_sliding_mm: simulated.map(|folded| mm(folded.largest_sliding_m)),
        simulated_fold_length_error_mm: simulated
            .and_then(|folded| folded.fold_length_error_m)
            .map(mm),
    }])
}

impl Row {
    /// Camera measurement of a folded sheet as text, in mm.
    fn seen(&self, value: Option<f64>) -> String {
        match value {
            None if self.status.starts_with("folded") => "not seen".to_owned(),
            value => number(value, 2),
        }
    }
}

/// Sliding of sheets that are held by a moment. The others slide much farther.
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
    let ends = [0.5, Scenario::compared().count() as f64 + 0.5];
    let bound = ends.map(|end| (end, Some(BOUND))).to_vec();
    let plot = plot(
        "Slide in mm",
        [
            marks("largest, simulated", &|row| row.largest_sliding_mm),
            marks("at the end, measured by the camera", &|row| {
                row.seen_sliding_mm
            }),
            Curve::new("2 mm", bound).looking(Look::Dashed),
        ],
    );
    vec![PageFigure::new(
        "fig4.11-cell_sliding",
        "Sliding of sheets that an arm folds in the virtual cell: exact values of the simulation, and measurements with \
         pixels of 0.73 mm. A column is empty if no moment can hold the sheet",
        named_plots([plot], Scenario::compared()),
    )]
}
