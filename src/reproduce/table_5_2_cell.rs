//! Table 5.2 in the virtual cell: how well an arm lays a rod, through drivers and camera, beside the plain simulation.

use super::ReproduceError;
use super::cases::Case;
use super::laying::{FRICTIONS, Laying, PATTERNS, RODS, Substrate};
use super::measured_deployments::measured;
use super::page::{Page, PageFigure, number};
use super::virtual_laying::{LaidInCell, LayingError, lay_in_cell};
use rodlab_files::figure::{Curve, LinePlot, Look, plot_to_scale};
use rodlab_vision::Point;
use serde::Serialize;

/// Gap between patterns in the figure, m.
const GAP: f64 = 0.05;

/// A row of the CSV file; lengths in cm, as in the thesis.
#[derive(Serialize)]
struct Row {
    pattern: &'static str,
    /// Whether it was laid and seen, or why not.
    status: String,
    /// By the camera.
    mean_cm: Option<f64>,
    deviation_cm: Option<f64>,
    nearest_mean_cm: Option<f64>,
    /// The plain simulation.
    simulated_mean_cm: Option<f64>,
    thesis_mean_cm: f64,
    thesis_deviation_cm: f64,
    laying_s: Option<f64>,
}

/// Lays the rod along all patterns, and writes table and figure.
pub(super) fn write(page: &mut Page, cases: &[Case<Laying>]) -> Result<(), ReproduceError> {
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
        "Rod #{} of thesis Tab. 5.1, {}, on fabric (friction {}) in the virtual cell of `rodlab cell serve`: planned, laid by the gantry \
         through its drivers, let go, seen by the camera and scored as by `rodlab deploy`. Mean distance from the pattern and standard \
         deviation in cm at equal arc lengths, in the camera's picture, a pixel of which is 0.07 cm; the mean distance to the nearest \
         point; the same as the first in plain simulation, without arm and camera and without letting go; and what the thesis \
         measured. What the rod is longer than its pattern is laid behind it or in front of it. All are laid anew for this page.",
        RODS[rod].number, RODS[rod].name, FRICTIONS[friction]
    ));
    let lines: Vec<Vec<String>> = rows.iter().map(Row::line).collect();
    let header = [
        "pattern",
        "cell",
        "nearest point",
        "plain simulation",
        "thesis",
        "laid in, s",
    ];
    page.table(&header, &lines);
    page.csv(&rows)?;
    if let Some(figure) = figure(cases, &laid) {
        page.figure(&PageFigure::new(
            &format!("{}_laid", page.name()),
            "The rod in the pictures of the camera, beside its patterns",
            figure,
        ))?;
    }
    Ok(())
}

fn row(case: &Case<Laying>, laid: &Result<LaidInCell, LayingError>) -> Row {
    let score = laid.as_ref().ok().map(|laid| &laid.laid.score);
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
    fn line(&self) -> Vec<String> {
        let cell = match self.mean_cm {
            Some(_) => format!(
                "{} ± {}",
                number(self.mean_cm, 2),
                number(self.deviation_cm, 2)
            ),
            None => self.status.replace('|', " "),
        };
        vec![
            self.pattern.into(),
            cell,
            number(self.nearest_mean_cm, 2),
            number(self.simulated_mean_cm, 2),
            format!(
                "{:.2} ± {:.2}",
                self.thesis_mean_cm, self.thesis_deviation_cm
            ),
            number(self.laying_s, 0),
        ]
    }
}

/// The rods beside their patterns, from above.
fn figure(
    cases: &[Case<Laying>],
    laid: &[Result<LaidInCell, LayingError>],
) -> Option<rodlab_files::figure::Figure> {
    let mut curves = ["rod", "pattern"].map(|name| (name, Vec::new()));
    let mut left = 0.0;
    for (_, laid) in cases.iter().zip(laid) {
        let Ok(laid) = laid else { continue };
        let outlines: [&[Point]; 2] = [&laid.laid.score.result, &laid.laid.score.pattern];
        let all = || outlines.iter().flat_map(|outline| outline.iter());
        let least = all().map(|point| point.x).fold(f64::INFINITY, f64::min);
        let most = all().map(|point| point.x).fold(f64::NEG_INFINITY, f64::max);
        let count = laid.laid.score.pattern.len() as f64;
        let middle = laid
            .laid
            .score
            .pattern
            .iter()
            .map(|point| point.y)
            .sum::<f64>()
            / count;
        for ((_, list), outline) in curves.iter_mut().zip(outlines) {
            let placed = outline.iter();
            list.extend(placed.map(|point| (left + point.x - least, Some(point.y - middle))));
            // A gap before the next pattern.
            list.push((left, None));
        }
        left += most - least + GAP;
    }
    if curves[0].1.is_empty() {
        return None;
    }
    let curves = curves.map(|(name, points)| {
        let curve = Curve::new(name, points);
        if name == "pattern" {
            curve.looking(Look::Dashed)
        } else {
            curve
        }
    });
    let plot = LinePlot {
        label: "y in m".into(),
        curves: curves.into(),
    };
    Some(plot_to_scale(plot, "x in m, patterns side by side"))
}
