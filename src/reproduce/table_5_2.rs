//! Table 5.2: how well rods are laid along patterns, simulated beside measured.

use super::ReproduceError;
use super::cases::Case;
use super::laying::{FRICTIONS, Laying, PATTERNS, RODS, Substrate};
use super::measured_deployments::measured;
use super::page::{Page, PageFigure, number};
use crate::experiment::{DeploymentOutcome, DeploymentTables, from_text};
use crate::figure::{Curve, LinePlot, Look, PlotStyle, styled_line_plots};
use crate::results::{SCENARIO, read_nodes};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A row of the CSV file; lengths in cm, as in the thesis.
#[derive(Serialize, Deserialize)]
struct Row {
    rod: usize,
    rod_name: String,
    substrate: String,
    friction: f64,
    scheme: String,
    pattern: String,
    status: String,
    mean_cm: Option<f64>,
    deviation_cm: Option<f64>,
    thesis_mean_cm: f64,
    thesis_deviation_cm: f64,
    largest_friction_demand: Option<f64>,
    share_above_friction: Option<f64>,
    largest_sliding_cm: Option<f64>,
    largest_gripper_force_n: Option<f64>,
    simulated_s: f64,
    wall_time_s: f64,
    cpu_time_s: Option<f64>,
}

impl Row {
    fn is_optimal(&self) -> bool {
        self.scheme == "optimal"
    }

    /// Whether the pattern asks for more friction than the table has.
    fn is_marked(&self) -> bool {
        self.share_above_friction.is_some_and(|share| share > 0.0)
    }

    fn is_worse(&self) -> bool {
        self.mean_cm.is_none_or(|mean| mean > self.thesis_mean_cm)
    }
}

/// Writes table and figures.
pub(super) fn write(page: &mut Page, cases: &[Case<Laying>]) -> Result<(), ReproduceError> {
    let rows: Vec<Row> = cases.iter().map(row).collect();
    page.text(
        "Mean distance and standard deviation in cm between the laid rod and its pattern at equal arc lengths, over 50 \
         points without the lead-in (thesis Eq. 5.11, the deviations squared). Below each value stands what the thesis \
         measured. The thesis calls friction low, medium and high: 0.2, 0.4 and 0.8 here. Line, circle and sine are as long \
         and as wide as those of the thesis, letters are drawn anew. A star marks patterns that ask for more friction somewhere \
         than the table has (thesis Eq. 5.2), so that the rod must slide there.",
    );
    let names = PATTERNS.iter().map(|pattern| pattern.name);
    let header: Vec<&str> = ["rod", "table", "scheme"]
        .into_iter()
        .chain(names)
        .collect();
    page.table(&header, &lines(&rows));
    page.text(&verdict(&rows));
    page.csv(&rows)?;
    for rod in 0..RODS.len() {
        if let Some(figure) = figure(rod, cases)? {
            page.figure(&figure)?;
        }
    }
    Ok(())
}

fn row(case: &Case<Laying>) -> Row {
    let run = &case.run;
    let rod = &RODS[run.rod];
    let substrate = rod.substrates[run.friction];
    let outcome = DeploymentOutcome::of(&case.record.outcome);
    let has_ended = case.record.outcome.simulated_time >= run.end * (1.0 - 1e-9);
    let ended = outcome.filter(|_| has_ended);
    let cm = |metres: f64| 1e2 * metres;
    let (thesis_mean_cm, thesis_deviation_cm) = measured(run, substrate);
    Row {
        rod: rod.number,
        rod_name: rod.name.into(),
        substrate: in_words(substrate).into(),
        friction: FRICTIONS[run.friction],
        scheme: if run.is_optimal {
            "optimal"
        } else {
            "intuitive"
        }
        .into(),
        pattern: PATTERNS[run.pattern].name.into(),
        status: case.status().into(),
        mean_cm: ended.and_then(|laid| laid.mean_error_m).map(cm),
        deviation_cm: ended.and_then(|laid| laid.error_deviation_m).map(cm),
        thesis_mean_cm,
        thesis_deviation_cm,
        largest_friction_demand: outcome.map(|laid| laid.largest_friction_demand),
        share_above_friction: outcome.map(|laid| laid.share_above_friction),
        largest_sliding_cm: outcome.map(|laid| cm(laid.largest_sliding_m)),
        largest_gripper_force_n: outcome.map(|laid| laid.largest_gripper_force_n),
        simulated_s: case.record.outcome.simulated_time,
        wall_time_s: case.record.wall_time,
        cpu_time_s: case.record.cpu_time,
    }
}

fn in_words(substrate: Substrate) -> &'static str {
    match substrate {
        Substrate::Fabric => "fabric",
        Substrate::Steel => "steel",
        Substrate::Foam => "foam",
    }
}

/// A line for each rod, table and scheme.
fn lines(rows: &[Row]) -> Vec<Vec<String>> {
    let heads_of = |row: &Row| (row.rod, row.friction, row.is_optimal());
    let mut lines: Vec<Vec<String>> = Vec::new();
    let mut last = None;
    for row in rows {
        if last != Some(heads_of(row)) {
            last = Some(heads_of(row));
            lines.push(vec![
                format!("#{} {}", row.rod, row.rod_name),
                format!("{}, {}", row.substrate, row.friction),
                row.scheme.clone(),
            ]);
        }
        let mark = if row.is_marked() && row.is_optimal() {
            "*"
        } else {
            ""
        };
        let cell = format!(
            "{} ± {}{mark}<br>{:.2} ± {:.2}",
            number(row.mean_cm, 2),
            number(row.deviation_cm, 2),
            row.thesis_mean_cm,
            row.thesis_deviation_cm
        );
        if let Some(line) = lines.last_mut() {
            line.push(cell);
        }
    }
    lines
}

/// What comes of it all, in words.
fn verdict(rows: &[Row]) -> String {
    let mean = |wanted: &dyn Fn(&Row) -> bool, value: &dyn Fn(&Row) -> Option<f64>| {
        let values: Vec<f64> = rows
            .iter()
            .filter(|row| wanted(row))
            .filter_map(value)
            .collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    };
    let simulated = |row: &Row| row.mean_cm;
    let measured = |row: &Row| Some(row.thesis_mean_cm);
    let optimal = mean(&|row| row.is_optimal(), &simulated);
    let intuitive = mean(&|row| !row.is_optimal(), &simulated);
    let held = mean(&|row| row.is_optimal() && !row.is_marked(), &simulated);
    let ratio = intuitive.zip(optimal).map(|(i, o)| i / o);
    let of_optimal = || rows.iter().filter(|row| row.is_optimal());
    let worse: Vec<&Row> = of_optimal().filter(|row| row.is_worse()).collect();
    let marked = worse.iter().filter(|row| row.is_marked()).count();
    let open = rows.iter().filter(|row| row.mean_cm.is_none()).count();
    let slowest = rows
        .iter()
        .filter_map(|row| Some(row.cpu_time_s? / row.simulated_s));
    let slowest = slowest.fold(0.0, f64::max);
    let total: f64 = rows.iter().map(|row| row.wall_time_s).sum();
    let mut text = format!(
        "On average the optimal scheme lies {} cm from the pattern ({} cm where there is friction enough), the intuitive one \
         {} cm: {} times as far; measured were {} and {} cm. Of {} entries of the optimal scheme {} lie farther from the \
         pattern than measured",
        number(optimal, 3),
        number(held, 3),
        number(intuitive, 2),
        number(ratio, 1),
        number(mean(&|row| row.is_optimal(), &measured), 2),
        number(mean(&|row| !row.is_optimal(), &measured), 2),
        of_optimal().count(),
        worse.len(),
    );
    if !worse.is_empty() {
        let names: Vec<String> = worse
            .iter()
            .map(|row| format!("{} of #{} at {}", row.pattern, row.rod, row.friction))
            .collect();
        text += &format!(
            ", {marked} of which ask for more friction than there is: {}",
            names.join(", ")
        );
    }
    text += ".";
    if open > 0 {
        text += &format!(" {open} runs did not come to their end.");
    }
    text += &format!(
        " All took {total:.0} s of wall time, a simulation at most {slowest:.2} s of processor time for each second of motion."
    );
    text
}

/// Distance between patterns in a figure, m.
const GAP: f64 = 0.05;
/// Points of a drawn pattern.
const POINTS: usize = 300;

/// Rods from above beside their patterns, at the medium friction.
fn figure(rod: usize, cases: &[Case<Laying>]) -> Result<Option<PageFigure>, ReproduceError> {
    let mut curves = ["optimal", "intuitive", "pattern"].map(|name| (name, Vec::new()));
    let mut left = 0.0;
    for pattern in 0..PATTERNS.len() {
        let chosen = cases.iter().filter(|case| {
            let run = &case.run;
            (run.rod, run.pattern) == (rod, pattern) && FRICTIONS[run.friction] == 0.4
        });
        let mut outlines: Vec<(usize, Vec<[f64; 2]>)> = Vec::new();
        for case in chosen {
            let Some((laid, drawn)) = outlines_of(case)? else {
                continue;
            };
            outlines.push((usize::from(!case.run.is_optimal), laid));
            if outlines.len() == 1 {
                outlines.push((2, drawn));
            }
        }
        let all = || outlines.iter().flat_map(|(_, points)| points);
        let least = all().map(|[x, _]| *x).fold(f64::INFINITY, f64::min);
        let most = all().map(|[x, _]| *x).fold(f64::NEG_INFINITY, f64::max);
        let middle = mean_height(&outlines);
        for (curve, points) in &outlines {
            let list: &mut Vec<(f64, Option<f64>)> = &mut curves[*curve].1;
            let placed = points
                .iter()
                .map(|[x, y]| (left + x - least, Some(y - middle)));
            list.extend(placed);
            // A gap before the next pattern.
            list.push((left, None));
        }
        if most > least {
            left += most - least + GAP;
        }
    }
    if curves.iter().all(|(_, points)| points.is_empty()) {
        return Ok(None);
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
    let style = PlotStyle {
        is_to_scale: true,
        ..PlotStyle::default()
    };
    let figure = styled_line_plots([plot], "x in m, patterns side by side", style);
    let name = format!("tab5.2_rod{}", RODS[rod].number);
    let caption = format!(
        "Rod #{}, {}, on a table of friction 0.4, from above",
        RODS[rod].number, RODS[rod].name
    );
    Ok(Some(PageFigure::new(&name, &caption, figure)))
}

/// Mean height of the pattern among outlines, m.
fn mean_height(outlines: &[(usize, Vec<[f64; 2]>)]) -> f64 {
    let pattern = outlines.iter().find(|(curve, _)| *curve == 2);
    pattern.map_or(0.0, |(_, points)| {
        points.iter().map(|[_, y]| y).sum::<f64>() / points.len().max(1) as f64
    })
}

/// A rod as it lies along its pattern, and the pattern, from above, m.
type Outlines = (Vec<[f64; 2]>, Vec<[f64; 2]>);

/// The laid part of a rod from above and its pattern; `None` where the run left no nodes.
fn outlines_of(case: &Case<Laying>) -> Result<Option<Outlines>, ReproduceError> {
    let scenario = std::fs::read_to_string(case.directory.join(SCENARIO)).unwrap_or_default();
    let Ok(loaded) = from_text("scenario", &scenario, Path::new(""), &[]) else {
        return Ok(None);
    };
    let Some(DeploymentTables { deployment, .. }) = loaded.scenario.experiment.tables() else {
        return Ok(None);
    };
    let Ok(curve) = deployment.pattern.source().pattern() else {
        return Ok(None);
    };
    let curve = curve.with_lead_in(deployment.lead_in);
    let nodes = deployment.rod.edges + 1;
    let outputs = read_nodes(&case.directory, nodes)?;
    let Some(last) = outputs.last() else {
        return Ok(None);
    };
    let laid = (curve.length() / deployment.rod.length * deployment.rod.edges as f64).ceil();
    let rod = last.positions.iter().take(laid as usize + 1);
    let rod = rod.map(|node| [node.x, node.y]).collect();
    let drawn = (0..=POINTS)
        .map(|index| {
            curve
                .at(curve.length() * index as f64 / POINTS as f64)
                .position
        })
        .map(|point| [point.x, point.y])
        .collect();
    Ok(Some((rod, drawn)))
}
