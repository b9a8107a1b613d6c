//! Table 4.1: time of planning folds.

use super::folds::{Folded, SCENARIOS};
use super::prelude::*;
use rodlab_lab::experiment::planned_fold;
use rodlab_planning::plan::fold::{Algorithm, FoldPlanner, Objective};
use std::time::Instant;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "tab4.1",
    title: "Table 4.1: time of planning folds",
    recipe: &Tabled::new(
        Folded::of_table_4_1,
        Rows::Series(|case| Ok(row(case).into_iter().collect())),
        write,
        |rows| vec![figure(rows)],
    ),
};

/// Times of the thesis, s: of its own method (two are missing in the printed table), and of the
/// other method that it compares.
const THESIS: [(Option<f64>, f64); 7] = [
    (Some(3.28), 59.46),
    (None, 51.15),
    (Some(1.80), 68.14),
    (Some(2.28), 47.30),
    (None, 80.07),
    (Some(4.19), 77.28),
    (Some(11.73), 43.20),
];
/// Friction of the table in the plans with moments.
const FRICTION: f64 = 0.12;
/// Number of timings of a plan, of which the fastest is used.
const TIMES: usize = 3;

/// A row of the CSV file; times in ms.
#[derive(Serialize, Deserialize)]
struct Row {
    scenario: String,
    manifold_ms: f64,
    plan_ms: f64,
    held_manifold_ms: Option<f64>,
    held_plan_ms: Option<f64>,
}

/// Writes the table.
fn write(page: &mut Page, _: &[Case<Folded>], rows: &[Row]) -> Result<()> {
    page.text(
        "Wall time of plans, on the machine and with the threads of the manifest, beside those of the thesis (one \
         Intel i9-9900KF). The exact manifold of a sheet is computed once; each plan then consists of the grid search, \
         the continuous refinement and the exact solution of all its folds. Plans with a moment use a separate \
         manifold. The thesis' numbers are as printed; two of the seven of its own method are missing there.",
    );
    page.table(columns! { (row, (own, other)) in rows.iter().zip(THESIS);
        "scenario" => row.scenario.clone(),
        "manifold, ms" => number(row.manifold_ms, 0),
        "plan, ms" => number(row.plan_ms, 1),
        "manifold with moments, ms" => number(row.held_manifold_ms, 0),
        "plan, ms" => number(row.held_plan_ms, 1),
        "thesis, s" => number(own, 2),
        "Petrík et al. in the thesis, s" => number(other, 2),
    });
    Ok(())
}

/// Times of all plans, s.
fn figure(rows: &[Row]) -> PageFigure {
    let marks = |name: &str, time: fn(usize, &Row) -> Option<f64>| {
        let numbered = rows.iter().enumerate();
        let point = |(index, row): (usize, &Row)| ((index + 1) as f64, time(index, row));
        curve(name, numbered, point).looking(Look::Marks)
    };
    let curves = [
        marks("plan", |_, row| Some(1e-3 * row.plan_ms)),
        marks("plan and manifold", |_, row| {
            Some(1e-3 * (row.manifold_ms + row.plan_ms))
        }),
        marks("plan with moments and its manifold", |_, row| {
            Some(1e-3 * (row.held_manifold_ms? + row.held_plan_ms?))
        }),
        marks("thesis", |index, _| THESIS.get(index)?.0),
        marks("Petrík et al. in the thesis", |index, _| {
            Some(THESIS.get(index)?.1)
        }),
    ];
    let plot = plot("Wall time in s", curves);
    let style = PlotStyle {
        vertical: vec![AxisScale::Logarithmic],
        names: rows.iter().map(|row| row.scenario.clone()).collect(),
        ..PlotStyle::default()
    };
    PageFigure::new(
        "tab4.1_times",
        "Time of planning a fold, here and in the thesis",
        styled_line_plots([plot], "", style),
    )
}

/// The plan of a case, recomputed and timed.
fn row(case: &Case<Folded>) -> Option<Row> {
    let scenario = &SCENARIOS[case.run.scenario];
    let (sheet, target) = planned_fold(&case.directory)?;
    let timed = |algorithm: Algorithm| {
        let begin = Instant::now();
        let planner = FoldPlanner::new(sheet, algorithm);
        let manifold = begin.elapsed();
        let plans = (0..TIMES).map(|_| {
            let begin = Instant::now();
            let is_planned = planner.poses(target).is_ok();
            (begin.elapsed(), is_planned)
        });
        let (plan, is_planned) = plans.min()?;
        let times = [manifold, plan].map(|time| 1e3 * time.as_secs_f64());
        is_planned.then_some(times)
    };
    let [manifold_ms, plan_ms] = timed(Algorithm::Optimal(Objective::Sum))?;
    let held = timed(Algorithm::Held { friction: FRICTION });
    Some(Row {
        scenario: scenario.name.into(),
        manifold_ms,
        plan_ms,
        held_manifold_ms: held.map(|[manifold, _]| manifold),
        held_plan_ms: held.map(|[_, plan]| plan),
    })
}
