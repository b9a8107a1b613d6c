//! Side view of the sheet while it is folded.

use super::tables::FoldingTables;
use crate::experiment::kind::FigureError;
use crate::experiment::load;
use rodlab_files::figure::{Curve, Figure, LinePlot, Look, plot_to_scale};
use rodlab_files::results::{NODES, SCENARIO, read_nodes};
use std::path::Path;

/// Sheets that are drawn.
const SHEETS: usize = 7;

/// A sheet from the side, m.
pub struct FoldedOutlines {
    /// The sheet at some times, with a gap after each.
    pub sheets: Vec<(f64, Option<f64>)>,
    /// The path of its edge.
    pub gripper: Vec<(f64, Option<f64>)>,
}

/// The sheet from the side at equal distances in time, and the path of its edge; `None` if the run
/// wrote no nodes.
///
/// # Errors
/// Files of the run cannot be read.
pub fn folded_outlines(directory: &Path) -> Result<Option<FoldedOutlines>, FigureError> {
    if !directory.join(NODES).exists() {
        return Ok(None);
    }
    let scenario = load(&directory.join(SCENARIO), &[])?.scenario;
    let Some(FoldingTables { folding, .. }) = scenario.experiment.tables() else {
        return Ok(None);
    };
    let others: usize = scenario
        .rods
        .iter()
        .map(|rod| rod.edges + usize::from(!rod.closed))
        .sum();
    let nodes = folding.paper.edges + 1;
    let outputs = read_nodes(directory, nodes + others)?;
    if outputs.is_empty() {
        return Ok(None);
    }
    let mut sheets = vec![];
    for sheet in 0..SHEETS {
        let output = &outputs[sheet * (outputs.len() - 1) / (SHEETS - 1)];
        let side = output.positions[..nodes].iter();
        sheets.extend(side.map(|node| (node.x, Some(node.z))));
        sheets.push((0.0, None));
    }
    let edges = outputs.iter().map(|output| &output.positions[nodes - 1]);
    Ok(Some(FoldedOutlines {
        sheets,
        gripper: edges.map(|edge| (edge.x, Some(edge.z))).collect(),
    }))
}

/// The figure of these curves; `None` if the run wrote no nodes.
///
/// # Errors
/// Files of the run cannot be read.
pub fn folded_figure(directory: &Path) -> Result<Option<Figure>, FigureError> {
    let Some(outlines) = folded_outlines(directory)? else {
        return Ok(None);
    };
    let plot = LinePlot::new(
        "z in m",
        [
            Curve::new("sheet", outlines.sheets),
            Curve::new("gripper", outlines.gripper).looking(Look::Dashed),
        ],
    );
    Ok(Some(plot_to_scale(plot, "x in m")))
}
