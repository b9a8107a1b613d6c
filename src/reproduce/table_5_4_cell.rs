//! Table 5.4 in the virtual cell: how often cables are placed in clips through drivers and camera, beside the plain simulation.

use super::ReproduceError;
use super::applications::{Application, TASKS, TRIALS};
use super::cases::Case;
use super::page::{Page, PageFigure, number};
use super::virtual_laying::{LaidInCell, LayingError, place_in_cell};
use crate::experiment::laid_outlines;
use crate::figure::{Curve, LinePlot, Look, plot_to_scale};
use serde::Serialize;

/// A row of the CSV file; lengths in cm.
#[derive(Serialize)]
struct Row {
    task: &'static str,
    scheme: &'static str,
    seed: u64,
    /// Whether it was laid and seen, or why not.
    status: String,
    pegs: Option<usize>,
    /// By the camera.
    pegs_passed: Option<usize>,
    mean_cm: Option<f64>,
    /// The plain simulation.
    simulated_pegs_passed: Option<usize>,
    simulated_mean_cm: Option<f64>,
}

/// Places the cable in all trials, and writes table and figures.
pub(super) fn write(page: &mut Page, cases: &[Case<Application>]) -> Result<(), ReproduceError> {
    let placed = cases.iter().map(place_in_cell);
    let placed: Vec<Result<LaidInCell, LayingError>> = placed.collect::<Result<_, _>>()?;
    let trials = || cases.iter().zip(&placed);
    let rows: Vec<Row> = trials().map(|(case, placed)| row(case, placed)).collect();
    page.text(
        "The trials of `tab5.4` in the virtual cell, with the same cable, clips and friction: planned, laid by the gantry through its \
         drivers, let go, seen by the camera and judged by its picture, as by `rodlab place scenarios/cable_placement_u.toml`. The hand \
         trembles without the arm knowing, as in the plain simulation beside: 1 mm and 0.5° root mean square in each direction. A \
         person lays the free end where the pattern begins. A trial succeeds when the cable, from above, leaves each peg on the side on \
         which its pattern does, and lies on none of them.",
    );
    let lines = TASKS.iter().enumerate().flat_map(|(task, _)| {
        let of = |is_optimal| {
            let wanted = (task, is_optimal);
            let trials = trials().zip(&rows);
            let of = trials.filter(|((case, _), _)| (case.run.task, case.run.is_optimal) == wanted);
            of.map(|(_, row)| row).collect::<Vec<_>>()
        };
        [false, true].map(|is_optimal| line(task, is_optimal, &of(is_optimal)))
    });
    let header = [
        "task",
        "scheme",
        "successes, cell",
        "plain simulation",
        "measured",
        "pegs passed, least to most",
        "off the pattern, cm",
        "plain simulation, cm",
    ];
    page.table(&header, &lines.flatten().collect::<Vec<_>>());
    for row in rows.iter().filter(|row| row.pegs_passed.is_none()) {
        page.text(&format!(
            "{}, {}, seed {}: {}.",
            row.task, row.scheme, row.seed, row.status
        ));
    }
    page.csv(&rows)?;
    for task in 0..TASKS.len() {
        let of = trials().filter(|(case, _)| case.run.task == task);
        if let Some(figure) = figure(task, &of.collect::<Vec<_>>())? {
            page.figure(&figure)?;
        }
    }
    Ok(())
}

fn row(case: &Case<Application>, placed: &Result<LaidInCell, LayingError>) -> Row {
    let laid = placed.as_ref().ok().map(|placed| &placed.laid);
    let simulated = case.outcome();
    let cm = |metres: f64| 1e2 * metres;
    let pegs = laid.and_then(|laid| laid.pegs);
    Row {
        task: TASKS[case.run.task].id,
        scheme: case.run.scheme(),
        seed: case.run.seed,
        status: match placed {
            Ok(_) => "placed and seen".into(),
            Err(error) => error.to_string(),
        },
        pegs: pegs.map(|pegs| pegs.count),
        pegs_passed: pegs.map(|pegs| pegs.passed),
        mean_cm: laid.map(|laid| cm(laid.score.by_arc_length.mean_m)),
        simulated_pegs_passed: simulated.and_then(|laid| laid.pegs).map(|pegs| pegs.passed),
        simulated_mean_cm: simulated.and_then(|laid| laid.mean_error_m).map(cm),
    }
}

/// The trials of a task by a scheme; `None` where there are none.
fn line(task: usize, is_optimal: bool, rows: &[&Row]) -> Option<Vec<String>> {
    let pegs = rows.iter().find_map(|row| row.pegs)?;
    let all = |passed: fn(&Row) -> Option<usize>| {
        let all = rows.iter().filter(|row| passed(row) == Some(pegs)).count();
        format!("{all} of {}", rows.len())
    };
    let passed = || rows.iter().filter_map(|row| row.pegs_passed);
    let mean = |error: fn(&Row) -> Option<f64>| {
        let errors: Vec<f64> = rows.iter().filter_map(|row| error(row)).collect();
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        number(Some(mean).filter(|mean| mean.is_finite()), 2)
    };
    Some(vec![
        TASKS[task].name.to_owned(),
        rows.first()?.scheme.to_owned(),
        all(|row| row.pegs_passed),
        all(|row| row.simulated_pegs_passed),
        format!(
            "{} of {TRIALS}",
            TASKS[task].measured[usize::from(is_optimal)]
        ),
        format!(
            "{} to {} of {pegs}",
            passed().min().unwrap_or(0),
            passed().max().unwrap_or(0)
        ),
        mean(|row| row.mean_cm),
        mean(|row| row.simulated_mean_cm),
    ])
}

/// What the camera saw of all trials of a task, from above.
fn figure(
    task: usize,
    trials: &[(&Case<Application>, &Result<LaidInCell, LayingError>)],
) -> Result<Option<PageFigure>, ReproduceError> {
    let mut curves = [(true, "optimal"), (false, "intuitive")].map(|(_, name)| (name, Vec::new()));
    for (case, placed) in trials {
        let Ok(placed) = placed else { continue };
        let lies = placed.laid.score.result.iter();
        let list = &mut curves[usize::from(!case.run.is_optimal)].1;
        list.extend(lies.map(|point| (point.x, Some(point.y))));
        list.extend(list.last().map(|(x, _)| (*x, None)));
    }
    let Some((first, _)) = trials.first() else {
        return Ok(None);
    };
    let Ok(Some(outlines)) = laid_outlines(&first.directory) else {
        return Ok(None);
    };
    let mut curves: Vec<Curve> = curves
        .into_iter()
        .map(|(name, points)| Curve::new(name, points))
        .collect();
    curves.push(Curve::new("pattern", outlines.pattern).looking(Look::Dashed));
    curves.push(Curve::new("pegs", outlines.pegs).looking(Look::Bare));
    let plot = LinePlot {
        label: "y in m".into(),
        curves,
    };
    let (name, id) = (TASKS[task].name, TASKS[task].id);
    Ok(Some(PageFigure::new(
        &format!("tab5.4-cell_{id}"),
        &format!("{name}: the cable in the pictures of the camera"),
        plot_to_scale(plot, "x in m"),
    )))
}
