//! Laid rods from above, beside their patterns.

use super::ReproduceError;
use super::cases::Case;
use super::laying::{FRICTIONS, Laying, PATTERNS, RODS};
use super::page::PageFigure;
use rodlab_files::figure::{Curve, LinePlot, Look, plot_to_scale};
use rodlab_files::results::{SCENARIO, read_nodes};
use rodlab_lab::experiment::{DeploymentTables, from_text};
use std::path::Path;

/// Distance between patterns in a figure, m.
const GAP: f64 = 0.05;
/// Points of a drawn pattern.
const POINTS: usize = 300;

/// A rod from above beside its patterns, by both schemes, at a friction (an index into [`FRICTIONS`]); its name begins with that of
/// the page.
pub(super) fn outlines_figure(
    page: &str,
    rod: usize,
    friction: usize,
    cases: &[Case<Laying>],
) -> Result<Option<PageFigure>, ReproduceError> {
    let mut curves = ["optimal", "intuitive", "pattern"].map(|name| (name, Vec::new()));
    let mut left = 0.0;
    for pattern in 0..PATTERNS.len() {
        let chosen = cases.iter().filter(|case| {
            let run = &case.run;
            (run.rod, run.friction, run.pattern) == (rod, friction, pattern)
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
    let figure = plot_to_scale(plot, "x in m, patterns side by side");
    let number = RODS[rod].number;
    let friction = FRICTIONS[friction];
    let name = if page == "fig5.11" {
        format!("{page}_friction{friction}")
    } else {
        format!("{page}_rod{number}")
    };
    let caption = format!(
        "Rod #{number}, {}, on a table of friction {friction}, from above",
        RODS[rod].name
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
