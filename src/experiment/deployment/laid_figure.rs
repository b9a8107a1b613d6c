//! The laid rod from above, beside its pattern and the pegs.

use super::laid_rod::rod_at;
use super::pegs;
use super::tables::DeploymentTables;
use crate::experiment::kind::FigureError;
use crate::experiment::load;
use crate::figure::{Curve, Figure, LinePlot, Look, PlotStyle, styled_line_plots};
use crate::results::{NODES, SCENARIO, read_nodes};
use std::path::Path;

/// Points of the pattern and of the rod.
const POINTS: usize = 400;

/// Points of a curve from above, m; a gap where there is no height.
pub type Outline = Vec<(f64, Option<f64>)>;

/// What a deployment left on the table, seen from above.
pub struct LaidOutlines {
    /// The rod, as far as it belongs to the pattern.
    pub rod: Outline,
    /// The pattern with its lead-in.
    pub pattern: Outline,
    /// Circles of pegs; empty without any.
    pub pegs: Outline,
}

/// Rod, pattern and pegs from above at the last output; `None` where the run wrote no nodes.
///
/// # Errors
/// Where files of the run cannot be read.
pub fn laid_outlines(directory: &Path) -> Result<Option<LaidOutlines>, FigureError> {
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
    let others = others + pegs::NODES * deployment.pegs.len();
    let outputs = read_nodes(directory, nodes + others)?;
    let Some(last) = outputs.last() else {
        return Ok(None);
    };
    let rod = &last.positions[..nodes];
    let length = curve.length();
    let arc_lengths = || (0..=POINTS).map(|index| length * index as f64 / POINTS as f64);
    let point = |point: nalgebra::Vector2<f64>| (point.x, Some(point.y));
    Ok(Some(LaidOutlines {
        rod: arc_lengths()
            .map(|s| point(rod_at(rod, deployment.rod.length, s)))
            .collect(),
        pattern: arc_lengths().map(|s| point(curve.at(s).position)).collect(),
        pegs: pegs::outlines(&deployment.pegs),
    }))
}

/// The figure of these; `None` where the run wrote no nodes.
///
/// # Errors
/// Where files of the run cannot be read.
pub fn laid_figure(directory: &Path) -> Result<Option<Figure>, FigureError> {
    let Some(outlines) = laid_outlines(directory)? else {
        return Ok(None);
    };
    let mut curves = vec![
        Curve::new("rod", outlines.rod),
        Curve::new("pattern", outlines.pattern).looking(Look::Dashed),
    ];
    if !outlines.pegs.is_empty() {
        curves.push(Curve::new("pegs", outlines.pegs));
    }
    let plot = LinePlot {
        label: "y in m".into(),
        curves,
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
