//! Common parts of the pages of inversions: the series, their plot, and the table of inversion
//! points.

use super::inversion::Inversion;
use super::prelude::*;
use rodlab_files::figure::Figure;
use rodlab_lab::experiment::KnotRow;

/// Label of the axis of l̄_k.
pub(super) const TIGHTNESS: &str = "l̄_{k} = (L − l_{c})/h";

/// A row of the CSV file.
#[derive(Serialize, Deserialize)]
pub(super) struct Row {
    case: String,
    unknotting_number: usize,
    radius_m: f64,
    friction: f64,
    /// l̄_k.
    length_normalized: f64,
    /// F̄.
    force_normalized: f64,
    /// H̄ = H/W.
    height_normalized: Option<f64>,
    loop_height_m: Option<f64>,
    braid_width_m: Option<f64>,
    time_s: f64,
}

/// The series of the runs as rows of the page, each with the name of its run.
pub(super) fn rows(
    cases: &[Case<Inversion>],
    name: impl Fn(usize, &Inversion) -> String,
) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for (index, case) in cases.iter().enumerate() {
        let Inversion {
            unknotting_number,
            radius,
            friction,
            ..
        } = case.run;
        let row = |(time_s, knot): (f64, KnotRow)| Row {
            case: name(index, &case.run),
            unknotting_number,
            radius_m: radius,
            friction,
            length_normalized: knot.length_normalized,
            force_normalized: knot.force_normalized,
            height_normalized: knot.height_normalized,
            loop_height_m: knot.loop_height_m,
            braid_width_m: knot.braid_width_m,
            time_s,
        };
        rows.extend(Inversion::pulled_rows(case)?.into_iter().map(row));
    }
    Ok(rows)
}

/// The rows of each run.
pub(super) fn runs_of(rows: &[Row]) -> Vec<&[Row]> {
    rows.chunk_by(|a, b| a.case == b.case).collect()
}

/// Traction and height of the loop over l̄_k, with one curve for each run.
pub(super) fn figure(name: &str, runs: &[&[Row]]) -> PageFigure {
    PageFigure::new(
        name,
        "Traction and height of the loop while the ends are pulled apart, from right to left",
        plots(runs),
    )
}

/// F̄ and H̄ over l̄_k, with one curve for each run.
pub(super) fn plots(runs: &[&[Row]]) -> Figure {
    let over_tightness = |label: &str, value: fn(&Row) -> Option<f64>| {
        let curve = |rows: &&[Row]| {
            let falling = rows.iter().rev();
            curve(&rows[0].case, falling, |row| {
                (row.length_normalized, value(row))
            })
        };
        plot(label, runs.iter().map(curve))
    };
    let plots = [
        over_tightness("F̄ = F h²/EI", |row| Some(row.force_normalized)),
        over_tightness("H̄ = H/W", |row| row.height_normalized),
    ];
    line_plots(plots, TIGHTNESS)
}

/// The table of inversion points; `head` is the heading of the first column, which contains the
/// names of the runs.
pub(super) fn table(
    page: &mut Page,
    head: &str,
    cases: &[Case<Inversion>],
    name: impl Fn(usize, &Inversion) -> String,
) {
    page.table(columns! { (index, case) in cases.iter().enumerate();
        head => name(index, &case.run),
        "l̄_k by force" => number(Inversion::outcome(case).inversion_by_force, 2),
        "l̄_k by height" => number(Inversion::outcome(case).inversion_by_height, 2),
        "difference, %" => number(Inversion::outcome(case).inversion_difference.map(|part| 100.0 * part), 2),
        "kinetic over elastic energy before, at most" => match Inversion::outcome(case).kinetic_over_elastic {
            Some(ratio) => format!("{ratio:.1e}"),
            None => "–".to_owned(),
        },
        "end" => match Inversion::outcome(case).knot_ending {
            Some(ending) => ending.in_words(),
            None => case.status(),
        },
        "wall time, s" => number(case.record.wall_time, 0),
    });
}
