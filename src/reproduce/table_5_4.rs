//! Table 5.4: success rates of cables placed in clips and of knots: simulation and measurement.

use super::applications::{Application, TASKS, TRIALS, Task};
use super::prelude::*;
use rodlab_files::figure::Figure;
use rodlab_lab::experiment::{FigureError, LaidOutlines, Outline, laid_outlines};
use std::collections::BTreeMap;

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "tab5.4",
    title: "Table 5.4: cables placed in clips, and knots tied on the table",
    recipe: &Free::new(Application::of_table_5_4, write),
};

/// A row of the CSV file; lengths in cm.
#[derive(Serialize)]
struct Row {
    task: &'static str,
    scheme: &'static str,
    seed: u64,
    status: String,
    succeeded: bool,
    pegs: Option<usize>,
    pegs_passed: Option<usize>,
    pattern_determinant: Option<u64>,
    pattern_signature: Option<i64>,
    rod_determinant: Option<u64>,
    rod_signature: Option<i64>,
    mean_cm: Option<f64>,
    largest_cm: Option<f64>,
    simulated_s: f64,
    wall_time_s: f64,
    cpu_time_s: Option<f64>,
}

/// Writes table and figures.
fn write(page: &mut Page, cases: &[Case<Application>]) -> Result<()> {
    page.text(
        "A gripper lays a USB cable (rod #5 of thesis Tab. 5.1: L_gb = 8.01 cm, 3.6 mm thick) along a U of 70 cm and \
         an S of 74 cm, on steel of friction 0.2, which cannot hold it in its bends: the U needs 2.1 and the S 2.9. \
         Clips hold it, 11 along the U and 12 along the S, each a pair of pegs of 8 mm thickness and 6 mm height with \
         round tops, 8 mm apart. The thesis shows its fixtures in a photograph only; the shape and size of these were \
         chosen here. The gripper deviates from its path at random, by 1 mm root mean square in each direction, ten \
         times the repeatability stated by the maker of the thesis' robot, and by 0.5° about each axis; ten seeds make \
         ten trials. When the pattern is laid, the gripper releases the cable, which then moves freely for 3 s.",
    );
    page.text(
        "A trial succeeds when the cable passes every peg as its pattern does: seen from above, no \
         peg is between the cable and the pattern (the closed curve of both does not go around a \
         peg), and beside each peg the cable is below its top.",
    );
    page.text(
        "The trefoil is tied with the thick pink rod (#4: L_gb = 2.86 cm, 6.4 mm thick) on a table \
         of friction 0.4. It is laid along a pattern that is longer than the rod by 23 cm; where \
         the rod returns to the first crossing it lies over itself. Then a second gripper grasps \
         the strand at the planned place of the next crossing, if the rod is within 1.5 cm of it, \
         and lifts it by 2.6 cm; the first one moves the end along the rest of the pattern, under \
         that strand and over the next one, and both release the rod. A trial succeeds when the \
         rod then has the determinant and the signature of the knot that was drawn, 3 and −2, \
         whether its ends are joined above or below the table. The second gripper has a jitter of \
         its own. Rods do not slip out of these grippers; the thesis names slipping as the cause \
         of its failures.",
    );
    page.text(
        "The reef knot is tied with the thick pink rod and the green one (#2: L_gb = 3.2 cm, 3.2 \
         mm thick), as in the thesis, which shows its patterns and moves in photographs only; \
         those here were chosen. One gripper lays the thick rod along a bight and releases it, and \
         the other one lays the green rod along a bight over it. Then the first gripper lifts the \
         thick rod by 2.6 cm, the second moves the end of the green rod under the thick rod and, 9 \
         cm farther on, over it, and releases the green rod; the first grasps the end of the thick \
         rod at its planned place, again within 1.5 cm, and moves it over the green rod and under \
         it, while the second lifts the green rod. A trial succeeds when the rods then have the \
         determinant and the signature of the reef knot that was drawn, 9 and 0 (a granny knot: 9 \
         and ±4; none: 1 and 0), the end of each joined to the start of the other, above the table \
         as well as below.",
    );
    let rows: Vec<Row> = cases.iter().map(row).collect();
    let lines = TASKS
        .iter()
        .enumerate()
        .flat_map(|(task, _)| [false, true].map(|is_optimal| line(task, is_optimal, cases)));
    let header = [
        "task",
        "scheme",
        "successes, simulated",
        "measured",
        "pegs passed, least to most; determinants and signatures",
        "off the pattern, cm",
    ];
    page.lines(&header, &lines.collect::<Vec<_>>());
    let wall: f64 = rows.iter().map(|row| row.wall_time_s).sum();
    page.text(&format!(
        "All {} trials took {wall:.0} s of wall time. Run one by itself with `rodlab run \
         scenarios/cable_placement_s.toml`, `scenarios/tied_trefoil.toml` or `scenarios/tied_reef.toml`, and look at \
         it with `rodlab view`.",
        rows.len()
    ));
    page.csv(&rows)?;
    for task in 0..TASKS.len() {
        for figure in figures(task, cases)? {
            page.figure(&figure)?;
        }
    }
    Ok(())
}

fn row(case: &Case<Application>) -> Row {
    let run = &case.run;
    let outcome = case.outcome();
    let pegs = outcome.and_then(|laid| laid.pegs);
    let knot = outcome.and_then(|laid| laid.knot);
    let cm = |metres: f64| 1e2 * metres;
    Row {
        task: TASKS[run.task].id,
        scheme: run.scheme(),
        seed: run.seed,
        status: case.status().into(),
        succeeded: case.has_succeeded(),
        pegs: pegs.map(|pegs| pegs.count),
        pegs_passed: pegs.map(|pegs| pegs.passed),
        pattern_determinant: knot.and_then(|knot| Some(knot.pattern?.determinant)),
        pattern_signature: knot.and_then(|knot| Some(knot.pattern?.signature)),
        rod_determinant: knot.and_then(|knot| Some(knot.rod?.determinant)),
        rod_signature: knot.and_then(|knot| Some(knot.rod?.signature)),
        mean_cm: outcome.and_then(|laid| laid.mean_error_m).map(cm),
        largest_cm: outcome.and_then(|laid| laid.largest_error_m).map(cm),
        simulated_s: case.record.outcome.simulated_time,
        wall_time_s: case.record.wall_time,
        cpu_time_s: case.record.cpu_time,
    }
}

/// The trials of a task with a scheme.
fn trials(
    task: usize,
    is_optimal: bool,
    cases: &[Case<Application>],
) -> impl Iterator<Item = &Case<Application>> {
    let wanted = (task, is_optimal);
    cases
        .iter()
        .filter(move |case| (case.run.task, case.run.is_optimal) == wanted)
}

fn line(task: usize, is_optimal: bool, cases: &[Case<Application>]) -> Vec<String> {
    let of = || trials(task, is_optimal, cases);
    let succeeded = of().filter(|case| case.has_succeeded()).count();
    let pegs = || of().filter_map(|case| case.outcome()?.pegs);
    let passed = || pegs().map(|pegs| pegs.passed);
    let found = match (passed().min(), passed().max(), pegs().next()) {
        (Some(least), Some(most), Some(pegs)) => format!("{least} to {most} of {}", pegs.count),
        _ => {
            let knots_of = of().filter_map(|case| case.outcome()?.knot);
            knots(knots_of.map(|knot| Some((knot.rod?.determinant, knot.rod?.signature))))
        }
    };
    let errors = of().filter_map(|case| Some(1e2 * case.outcome()?.mean_error_m?));
    vec![
        TASKS[task].name.to_owned(),
        if is_optimal { "optimal" } else { "intuitive" }.to_owned(),
        format!("{succeeded} of {}", of().count()),
        format!(
            "{} of {TRIALS}",
            TASKS[task].measured[usize::from(is_optimal)]
        ),
        found,
        number(mean(errors), 2),
    ]
}

/// Knots of rods by determinant and signature, with their counts.
pub(super) fn knots(found: impl Iterator<Item = Option<(u64, i64)>>) -> String {
    let mut counts: BTreeMap<Option<(u64, i64)>, usize> = BTreeMap::new();
    for knot in found {
        *counts.entry(knot).or_default() += 1;
    }
    let words = counts.iter().map(|(knot, count)| match knot {
        Some((determinant, signature)) => format!("{determinant}, {signature} in {count}"),
        None => format!("undecided in {count}"),
    });
    words.collect::<Vec<_>>().join("; ")
}

/// Draws a task from above: pegs, pattern, and the rods after all trials; for knots, after the
/// first trial.
fn figures(task: usize, cases: &[Case<Application>]) -> Result<Vec<PageFigure>> {
    let mut laid = Vec::new();
    for (is_optimal, name) in [(true, "optimal"), (false, "intuitive")] {
        for case in trials(task, is_optimal, cases) {
            if let Some(outlines) = outlines(case)? {
                // Ten superimposed knots are not readable.
                if !outlines.pegs.is_empty() || case.run.seed == 1 {
                    laid.push((name, outlines));
                }
            }
        }
    }
    let Some(Task { name, id, .. }) = TASKS.get(task) else {
        return Ok(Vec::new());
    };
    let id = format!("tab5.4_{id}");
    let is_of_two = laid.iter().any(|(_, outlines)| outlines.rods.len() > 1);
    if !is_of_two {
        let caption = format!("{name}: the rods on the table, from above");
        let rods = ["optimal", "intuitive"].map(|scheme| (scheme, of_scheme(scheme, 0, &laid)));
        let figure = picture(rods, laid.last().map(|(_, outlines)| outlines));
        return Ok(figure
            .map(|figure| PageFigure::new(&id, &caption, figure))
            .into_iter()
            .collect());
    }
    let of = |scheme: &str| {
        let rods = [("first rod", 0), ("second rod", 1)];
        let rods = rods.map(|(name, rod)| (name, of_scheme(scheme, rod, &laid)));
        let shown = laid.iter().find(|(name, _)| *name == scheme);
        let figure = picture(rods, shown.map(|(_, outlines)| outlines))?;
        let caption = format!("{name}, {scheme} scheme, seed 1: the rods on the table, from above");
        Some(PageFigure::new(&format!("{id}_{scheme}"), &caption, figure))
    };
    Ok(["optimal", "intuitive"]
        .into_iter()
        .filter_map(of)
        .collect())
}

/// The outlines of a rod, given by its number, with a scheme. There are gaps between trials.
fn of_scheme(scheme: &str, rod: usize, laid: &[(&str, LaidOutlines)]) -> Outline {
    let mut lying = Outline::new();
    for (name, outlines) in laid {
        if let Some(outline) = outlines.rods.get(rod).filter(|_| *name == scheme) {
            lying.extend(outline.iter().copied());
            lying.extend(outline.last().map(|(x, _)| (*x, None)));
        }
    }
    lying
}

/// Rods with the patterns and pegs of a trial.
fn picture(rods: [(&str, Outline); 2], trial: Option<&LaidOutlines>) -> Option<Figure> {
    let trial = trial?;
    let mut curves: Vec<Curve> = rods.map(|(name, outline)| Curve::new(name, outline)).into();
    let name = if trial.rods.len() == 1 {
        "pattern"
    } else {
        "patterns"
    };
    curves.push(Curve::new(name, trial.pattern.clone()).looking(Look::Dashed));
    if !trial.pegs.is_empty() {
        curves.push(Curve::new("pegs", trial.pegs.clone()).looking(Look::Bare));
    }
    let plot = plot("y in m", curves);
    Some(plot_to_scale(plot, "x in m"))
}

fn outlines(case: &Case<Application>) -> Result<Option<LaidOutlines>> {
    match laid_outlines(&case.directory) {
        Ok(outlines) => Ok(outlines),
        Err(FigureError::Results(error)) => Err(error.into()),
        // Embedded scenarios can be read.
        Err(FigureError::Scenario(_)) => Ok(None),
    }
}
