//! Table 5.2 in the virtual cell: accuracy of a rod laid by an arm, through drivers and camera,
//! compared with the plain simulation.

use super::laid_outlines::in_panels;
use super::laying::{FRICTIONS, Laying, PATTERNS, RODS, Substrate};
use super::measured_deployments::measured;
use super::prelude::*;
use super::virtual_laying::{LaidInCell, LayingError, lay_in_cell};
use rodlab_files::figure::Figure;
use rodlab_vision::Point;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "tab5.2-cell",
    title: "Table 5.2 in the virtual cell: through drivers and camera",
    recipe: &Free::new(Laying::of_cell, write),
};

/// A row of the CSV file; lengths in cm, as in the thesis.
#[derive(Serialize)]
struct Row {
    pattern: &'static str,
    /// Status: laid and measured, or the reason for the failure.
    status: String,
    /// Mean distance according to the camera.
    mean_cm: Option<f64>,
    deviation_cm: Option<f64>,
    nearest_mean_cm: Option<f64>,
    /// Mean distance in the plain simulation.
    simulated_mean_cm: Option<f64>,
    thesis_mean_cm: f64,
    thesis_deviation_cm: f64,
    laying_s: Option<f64>,
}

/// Lays the rod along all patterns, and writes table and figure.
fn write(page: &mut Page, cases: &[Case<Laying>]) -> Result<()> {
    let laid = cases.iter().map(lay_in_cell);
    let laid: Vec<Result<LaidInCell, LayingError>> = laid.collect::<Result<_, _>>()?;
    let rows: Vec<Row> = cases
        .iter()
        .zip(&laid)
        .map(|(case, laid)| row(case, laid))
        .collect();
    let rod = cases.first().map_or(1, |case| case.run.rod);
    let friction = cases.first().map_or(0, |case| case.run.friction);
    page.text(&format!(
        "Rod #{} of thesis Tab. 5.1, {}, on fabric (friction {}) in the virtual cell of `rodlab cell serve`: planned, \
         laid by the gantry through its drivers, released, photographed by the camera and scored as by `rodlab \
         deploy`. Mean distance from the pattern and standard deviation in cm at equal arc lengths, in the camera's \
         picture, a pixel of which is 0.07 cm; the mean distance to the nearest point; the first value in plain \
         simulation, without arm, camera and release; and the values measured in the thesis. Where the rod is longer \
         than its pattern, the rest is laid behind or in front of it. All rods were laid for this page.",
        RODS[rod].number, RODS[rod].name, FRICTIONS[friction]
    ));
    page.table(columns! { row in &rows;
        "pattern" => row.pattern,
        "cell" => row.cell(),
        "nearest point" => number(row.nearest_mean_cm, 2),
        "plain simulation" => number(row.simulated_mean_cm, 2),
        "thesis" => format!("{:.2} ± {:.2}", row.thesis_mean_cm, row.thesis_deviation_cm),
        "laid in, s" => number(row.laying_s, 0),
    });
    page.csv(&rows)?;
    if let Some(figure) = figure(&laid) {
        page.figure(&PageFigure::new(
            &format!("{}_laid", page.name()),
            "The rod in the pictures of the camera, beside its patterns",
            figure,
        ))?;
    }
    Ok(())
}

fn row(case: &Case<Laying>, laid: &Result<LaidInCell, LayingError>) -> Row {
    let score = laid.as_ref().ok().map(|laid| &laid.score);
    let (thesis_mean_cm, thesis_deviation_cm) = measured(&case.run, Substrate::Fabric);
    let cm = |metres: f64| 1e2 * metres;
    Row {
        pattern: PATTERNS[case.run.pattern].name,
        status: match laid {
            Ok(_) => "laid".into(),
            Err(error) => error.to_string(),
        },
        mean_cm: score.map(|score| cm(score.by_arc_length.mean_m)),
        deviation_cm: score.map(|score| cm(score.by_arc_length.deviation_m)),
        nearest_mean_cm: score.map(|score| cm(score.by_nearest_point.mean_m)),
        simulated_mean_cm: case.mean_error_cm(),
        thesis_mean_cm,
        thesis_deviation_cm,
        laying_s: laid.as_ref().ok().map(|laid| laid.duration),
    }
}

impl Row {
    /// Distance according to the camera, or the reason why there is none, as text.
    fn cell(&self) -> String {
        match self.mean_cm {
            Some(mean) => format!("{mean:.2} ± {}", number(self.deviation_cm, 2)),
            None => self.status.replace('|', " "),
        }
    }
}

/// Draws the rods with their patterns, from above.
fn figure(laid: &[Result<LaidInCell, LayingError>]) -> Option<Figure> {
    let places = |points: &[Point]| points.iter().map(|point| [point.x, point.y]).collect();
    let outlines = |laid: &Result<LaidInCell, LayingError>| match laid {
        Ok(laid) => {
            let score = &laid.score;
            vec![(0, places(&score.result)), (1, places(&score.pattern))]
        }
        Err(_) => Vec::new(),
    };
    let laid = laid.iter().map(outlines);
    in_panels(&["rod", "pattern"], &laid.collect::<Vec<_>>())
}
