//! Laid rods from above, beside their patterns.

use super::laying::{FRICTIONS, Laying, PATTERNS, RODS};
use super::prelude::*;
use rodlab_files::figure::Figure;
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
) -> Result<Option<PageFigure>> {
    let mut patterns = Vec::new();
    for pattern in 0..PATTERNS.len() {
        let chosen = cases.iter().filter(|case| {
            let run = &case.run;
            (run.rod, run.friction, run.pattern) == (rod, friction, pattern)
        });
        let mut outlines = Vec::new();
        for case in chosen {
            let Some((laid, drawn)) = outlines_of(case)? else {
                continue;
            };
            outlines.push((usize::from(!case.run.is_optimal), laid));
            if outlines.len() == 1 {
                outlines.push((2, drawn));
            }
        }
        patterns.push(outlines);
    }
    let Some(figure) = side_by_side(&["optimal", "intuitive", "pattern"], &patterns) else {
        return Ok(None);
    };
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

/// Outlines from above, m, each with the index of its curve.
pub(super) type NumberedOutlines = Vec<(usize, Vec<[f64; 2]>)>;

/// Patterns side by side; the last of the curves is that of the patterns themselves. `None` where there is nothing.
pub(super) fn side_by_side(names: &[&str], patterns: &[NumberedOutlines]) -> Option<Figure> {
    let mut curves: Vec<Curve> = names.iter().map(|name| Curve::new(*name, vec![])).collect();
    let of_patterns = names.len() - 1;
    let mut left = 0.0;
    for outlines in patterns {
        let all = || outlines.iter().flat_map(|(_, points)| points);
        let least = all().map(|[x, _]| *x).fold(f64::INFINITY, f64::min);
        let most = all().map(|[x, _]| *x).fold(f64::NEG_INFINITY, f64::max);
        let pattern = outlines.iter().find(|(curve, _)| *curve == of_patterns);
        let heights = pattern.map(|(_, points)| points.iter().map(|[_, y]| *y));
        let middle = heights.and_then(mean).unwrap_or(0.0);
        for (curve, points) in outlines {
            let list = &mut curves[*curve].points;
            let placed = points.iter();
            list.extend(placed.map(|[x, y]| (left + x - least, Some(y - middle))));
            // A gap before the next pattern.
            list.push((left, None));
        }
        if most > least {
            left += most - least + GAP;
        }
    }
    curves[of_patterns].look = Look::Dashed;
    let is_empty = curves.iter().all(|curve| curve.points.is_empty());
    let plot = plot("y in m", curves);
    (!is_empty).then(|| plot_to_scale(plot, "x in m, patterns side by side"))
}

/// A rod as it lies along its pattern, and the pattern, from above, m.
type Outlines = (Vec<[f64; 2]>, Vec<[f64; 2]>);

/// The laid part of a rod from above and its pattern; `None` where the run left no nodes.
fn outlines_of(case: &Case<Laying>) -> Result<Option<Outlines>> {
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
