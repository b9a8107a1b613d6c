//! Table 5.4 in the virtual cell: success rates of cables placed in clips and of tied knots,
//! through drivers and camera, compared with the plain simulation.

use super::applications::{Application, TASKS, TRIALS};
use super::prelude::*;
use super::table_5_4::knots;
use super::virtual_laying::{LaidInCell, place_in_cell};
use super::virtual_tying::tie_in_cell;
use rodlab_lab::experiment::laid_outlines;
use rodlab_workcell::task::TieScore;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "tab5.4-cell",
    title: "Table 5.4 in the virtual cell: cables placed and knots tied through drivers and camera",
    recipe: &Free::new(Application::of_table_5_4_in_cell, write),
};

/// Status of a finished trial that the camera has measured.
const DONE: &str = "done and seen";

/// A row of the CSV file; lengths in cm.
#[derive(Serialize)]
struct Row {
    task: &'static str,
    scheme: &'static str,
    seed: u64,
    /// Status: laid and measured, or the reason for the failure.
    status: String,
    /// Whether the trial succeeded according to the camera.
    succeeded: bool,
    pegs: Option<usize>,
    pegs_passed: Option<usize>,
    rod_determinant: Option<u64>,
    rod_signature: Option<i64>,
    mean_cm: Option<f64>,
    /// Whether the trial succeeded in the plain simulation.
    simulated_success: bool,
    simulated_pegs_passed: Option<usize>,
    simulated_mean_cm: Option<f64>,
}

/// Outcome of a trial in the cell, or the reason for its failure.
enum Trial {
    Placed(LaidInCell),
    Tied(TieScore),
    Failed(String),
}

impl Trial {
    fn of(case: &Case<Application>) -> Result<Self> {
        let is_knot = case.outcome().is_some_and(|laid| laid.knot.is_some());
        Ok(match is_knot {
            true => tie_in_cell(case)?.map_or_else(Self::Failed, Self::Tied),
            false => match place_in_cell(case)? {
                Ok(placed) => Self::Placed(placed),
                Err(error) => Self::Failed(error.to_string()),
            },
        })
    }
}

/// Places the cable in all trials, and writes table and figures.
fn write(page: &mut Page, cases: &[Case<Application>]) -> Result<()> {
    let done = cases.iter().map(Trial::of);
    let done: Vec<Trial> = done.collect::<Result<_, _>>()?;
    let trials = || cases.iter().zip(&done);
    let rows: Vec<Row> = trials().map(|(case, trial)| row(case, trial)).collect();
    page.text(
        "The trials of `tab5.4` in the virtual cell, with the same rods, clips and friction: planned, executed by \
         gantries through their drivers, released, photographed by the camera and judged by its picture, as by `rodlab \
         place scenarios/cable_placement_u.toml` and `rodlab tie`. The hands have jitter that the joint encoders do \
         not see, as in the plain simulation: 1 mm and 0.5° root mean square in each direction. The free end is laid \
         by hand where the pattern begins. A cable is placed when, from above, it leaves each peg on the side on which \
         its pattern does, and lies on none of them; a knot is tied when the rod has the determinant and the signature \
         of the knot that was drawn, judged by which strand is seen on top. Knots are tied by the optimal scheme only.",
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
        "pegs passed, least to most; determinants and signatures",
        "off the pattern, cm",
        "plain simulation, cm",
    ];
    page.lines(&header, &lines.flatten().collect::<Vec<_>>());
    for row in rows.iter().filter(|row| row.status != DONE) {
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

fn row(case: &Case<Application>, trial: &Trial) -> Row {
    let placed = match trial {
        Trial::Placed(placed) => Some(placed),
        _ => None,
    };
    let tied = match trial {
        Trial::Tied(score) => Some(score),
        _ => None,
    };
    let simulated = case.outcome();
    let cm = |metres: f64| 1e2 * metres;
    let pegs = placed.and_then(|laid| laid.pegs);
    let knot = tied.and_then(|score| score.seen);
    let undecided = tied.and_then(|score| score.undecided.as_ref());
    Row {
        task: TASKS[case.run.task].id,
        scheme: case.run.scheme(),
        seed: case.run.seed,
        status: match (trial, undecided) {
            (Trial::Failed(words), _) | (_, Some(words)) => words.clone(),
            _ => DONE.into(),
        },
        succeeded: pegs.is_some_and(|pegs| pegs.are_all())
            || tied.is_some_and(|score| score.tied == Some(true)),
        pegs: pegs.map(|pegs| pegs.count),
        pegs_passed: pegs.map(|pegs| pegs.passed),
        rod_determinant: knot.map(|knot| knot.determinant),
        rod_signature: knot.map(|knot| knot.signature),
        mean_cm: placed.map(|laid| cm(laid.score.by_arc_length.mean_m)),
        simulated_success: case.has_succeeded(),
        simulated_pegs_passed: simulated.and_then(|laid| laid.pegs).map(|pegs| pegs.passed),
        simulated_mean_cm: simulated.and_then(|laid| laid.mean_error_m).map(cm),
    }
}

/// A line of the table for the trials of a task with a scheme; `None` if there are none.
fn line(task: usize, is_optimal: bool, rows: &[&Row]) -> Option<Vec<String>> {
    let first = rows.first()?;
    let of = |succeeded: fn(&Row) -> bool| {
        let count = rows.iter().filter(|row| succeeded(row)).count();
        format!("{count} of {}", rows.len())
    };
    let passed = || rows.iter().filter_map(|row| row.pegs_passed);
    let found = match (passed().min(), passed().max()) {
        (Some(least), Some(most)) => {
            let pegs = rows.iter().find_map(|row| row.pegs).unwrap_or(0);
            format!("{least} to {most} of {pegs}")
        }
        _ => knots(
            rows.iter()
                .map(|row| row.rod_determinant.zip(row.rod_signature)),
        ),
    };
    let mean = |error: fn(&&Row) -> Option<f64>| number(mean(rows.iter().filter_map(error)), 2);
    Some(vec![
        TASKS[task].name.to_owned(),
        first.scheme.to_owned(),
        of(|row| row.succeeded),
        of(|row| row.simulated_success),
        format!(
            "{} of {TRIALS}",
            TASKS[task].measured[usize::from(is_optimal)]
        ),
        found,
        mean(|row| row.mean_cm),
        mean(|row| row.simulated_mean_cm),
    ])
}

/// Draws the outlines of all trials of a task as measured by the camera, from above.
fn figure(task: usize, trials: &[(&Case<Application>, &Trial)]) -> Result<Option<PageFigure>> {
    let mut curves = ["optimal", "intuitive"].map(|name| (name, Vec::new()));
    for (case, trial) in trials {
        let Trial::Placed(placed) = trial else {
            continue;
        };
        let lies = placed.score.result.iter();
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
    // Ten superimposed knots are not readable.
    if curves.iter().all(|(_, points)| points.is_empty()) {
        return Ok(None);
    }
    let mut curves: Vec<Curve> = curves
        .into_iter()
        .map(|(name, points)| Curve::new(name, points))
        .collect();
    curves.push(Curve::new("pattern", outlines.pattern).looking(Look::Dashed));
    curves.push(Curve::new("pegs", outlines.pegs).looking(Look::Bare));
    let plot = plot("y in m", curves);
    let (name, id) = (TASKS[task].name, TASKS[task].id);
    Ok(Some(PageFigure::new(
        &format!("tab5.4-cell_{id}"),
        &format!("{name}: the cable in the pictures of the camera"),
        plot_to_scale(plot, "x in m"),
    )))
}
