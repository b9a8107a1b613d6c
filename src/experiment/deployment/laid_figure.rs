//! The laid rod from above, beside its pattern and the pegs.

use super::pegs;
use super::tables::DeploymentTables;
use crate::experiment::kind::FigureError;
use crate::experiment::load;
use crate::figure::{Curve, Figure, LinePlot, Look, plot_to_scale};
use crate::mechanics::Vector3;
use crate::results::{NODES, SCENARIO, read_nodes};
use std::path::Path;

/// Points of the pattern.
const POINTS: usize = 400;
/// Half the gap of a strand below another, in radii of the rod.
const BREAK: f64 = 3.0;

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
    let Ok(curve) = deployment.laid_pattern() else {
        return Ok(None);
    };
    let nodes = deployment.rod.edges + 1;
    let others: usize = scenario.rods.iter().map(nodes_of).sum();
    let others = others + pegs::NODES * deployment.pegs.len();
    let outputs = read_nodes(directory, nodes + others)?;
    let Some(last) = outputs.last() else {
        return Ok(None);
    };
    let rod = pegs::first_part(
        &last.positions[..nodes],
        curve.length() / deployment.rod.length,
    );
    let Ok(whole) = deployment.whole_pattern() else {
        return Ok(None);
    };
    let length = whole.length();
    let drawn = (0..=POINTS).map(|index| whole.at(length * index as f64 / POINTS as f64));
    Ok(Some(LaidOutlines {
        rod: broken_below(&rod, BREAK * deployment.rod.radius),
        pattern: drawn
            .map(|point| (point.position.x, Some(point.position.y)))
            .collect(),
        pegs: pegs::outlines(&deployment.pegs),
    }))
}

/// A rod from above, with a gap where it passes below itself, nearer than `gap` (m) to the crossing.
fn broken_below(rod: &[Vector3], gap: f64) -> Outline {
    let mut below = vec![false; rod.len()];
    for (index, one) in rod.windows(2).enumerate() {
        for (other_index, other) in rod.windows(2).enumerate().skip(index + 2) {
            let (along, across) = ((one[1] - one[0]).xy(), (other[1] - other[0]).xy());
            let between = (other[0] - one[0]).xy();
            let turn = along.perp(&across);
            let parts = [between.perp(&across) / turn, between.perp(&along) / turn];
            if !parts.iter().all(|part| (0.0..1.0).contains(part)) {
                continue;
            }
            let places = [
                one[0].lerp(&one[1], parts[0]),
                other[0].lerp(&other[1], parts[1]),
            ];
            let lower = if places[0].z < places[1].z {
                index
            } else {
                other_index
            };
            let is_near = |node: &usize| (rod[*node] - places[0]).xy().norm() < gap;
            let before = (0..=lower).rev().take_while(is_near);
            let after = (lower + 1..rod.len()).take_while(is_near);
            for node in before.chain(after) {
                below[node] = true;
            }
        }
    }
    let points = rod.iter().zip(below);
    points
        .map(|(node, is_below)| (node.x, (!is_below).then_some(node.y)))
        .collect()
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
    Ok(Some(plot_to_scale(plot, "x in m")))
}

fn nodes_of(rod: &crate::scenario::Rod) -> usize {
    rod.edges + usize::from(!rod.closed)
}
