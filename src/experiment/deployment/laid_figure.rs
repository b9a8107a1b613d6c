//! The laid rod from above, beside its pattern.

use super::laid_rod::rod_at;
use super::tables::DeploymentTables;
use crate::experiment::kind::FigureError;
use crate::experiment::load;
use crate::figure::{Curve, Figure, LinePlot, Look, PlotStyle, styled_line_plots};
use crate::results::{NODES, SCENARIO, read_nodes};
use std::path::Path;

/// Points of the pattern and of the rod.
const POINTS: usize = 400;

/// Rod and pattern from above at the last output; `None` where the run wrote no nodes.
///
/// # Errors
/// Where files of the run cannot be read.
pub fn laid_figure(directory: &Path) -> Result<Option<Figure>, FigureError> {
    if !directory.join(NODES).exists() {
        return Ok(None);
    }
    let scenario = load(&directory.join(SCENARIO), &[])?.scenario;
    let Some(DeploymentTables { deployment, .. }) = scenario.experiment.tables() else {
        return Ok(None);
    };
    let Ok(curve) = deployment.pattern.source().pattern() else {
        return Ok(None);
    };
    let curve = curve.with_lead_in(deployment.lead_in);
    let nodes = deployment.rod.edges + 1;
    let others: usize = scenario.rods.iter().map(nodes_of).sum();
    let outputs = read_nodes(directory, nodes + others)?;
    let Some(last) = outputs.last() else {
        return Ok(None);
    };
    let rod = &last.positions[..nodes];
    let length = curve.length();
    let arc_lengths = || (0..=POINTS).map(move |index| length * index as f64 / POINTS as f64);
    let pattern = arc_lengths().map(|s| curve.at(s).position);
    let laid = arc_lengths().map(|s| rod_at(rod, deployment.rod.length, s));
    let line = |name: &str, points: &mut dyn Iterator<Item = nalgebra::Vector2<f64>>| {
        Curve::new(name, points.map(|point| (point.x, Some(point.y))).collect())
    };
    let plot = LinePlot {
        label: "y in m".into(),
        curves: vec![
            line("rod", &mut { laid }),
            line("pattern", &mut { pattern }).looking(Look::Dashed),
        ],
    };
    let style = PlotStyle {
        is_to_scale: true,
        ..PlotStyle::default()
    };
    Ok(Some(styled_line_plots([plot], "x in m", style)))
}

fn nodes_of(rod: &crate::scenario::Rod) -> usize {
    rod.edges + usize::from(!rod.closed)
}
