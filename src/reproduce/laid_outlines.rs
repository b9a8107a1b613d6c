//! Laid rods from above, compared with their patterns.

use super::laying::{FRICTIONS, Laying, PATTERNS, RODS};
use super::prelude::*;
use rodlab_files::figure::{Figure, Panel, panels};
use rodlab_files::results::{SCENARIO, read_nodes};
use rodlab_lab::experiment::{DeploymentTables, from_text};
use std::path::Path;

/// Number of panels in a row.
const COLUMNS: usize = 4;
/// Number of points of a drawn pattern.
const POINTS: usize = 300;

/// A figure of a rod from above with its patterns, for both schemes and one friction (an index
/// into [`FRICTIONS`]). The name of the file begins with that of the page.
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
    let Some(figure) = in_panels(&["optimal", "intuitive", "pattern"], &patterns) else {
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

/// Panels of the patterns, in which the last curve is the pattern itself. `None` if there are no
/// outlines.
pub(super) fn in_panels(names: &[&str], patterns: &[NumberedOutlines]) -> Option<Figure> {
    let shown = patterns.iter().zip(&PATTERNS);
    let shown = shown.filter(|(outlines, _)| !outlines.is_empty());
    let shown = shown.map(|(outlines, pattern)| {
        let curves = names.iter().enumerate().map(|(index, name)| {
            let of = outlines.iter().filter(|(curve, _)| *curve == index);
            let points = of.flat_map(|(_, points)| points);
            let look = if index + 1 == names.len() {
                Look::Ground
            } else {
                Look::Bare
            };
            curve(*name, points, |&[x, y]| (x, y)).looking(look)
        });
        Panel {
            title: pattern.name.into(),
            curves: curves.collect(),
        }
    });
    let shown: Vec<Panel> = shown.collect();
    (!shown.is_empty()).then(|| panels(shown, COLUMNS))
}

/// A laid rod and its pattern from above, m.
type Outlines = (Vec<[f64; 2]>, Vec<[f64; 2]>);

/// The laid part of a rod from above and its pattern; `None` if the run has no nodes.
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
