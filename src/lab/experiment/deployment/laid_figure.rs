//! Laid rods seen from above, with their patterns and the pegs.

use super::pegs;
use super::tables::DeploymentTables;
use crate::experiment::kind::FigureError;
use crate::experiment::load;
use rodlab_engine::mechanics::Vector3;
use rodlab_files::figure::{Curve, Figure, LinePlot, Look, plot_to_scale};
use rodlab_files::results::{NODES, SCENARIO, read_nodes};
use std::path::Path;

/// Points of the pattern.
const POINTS: usize = 400;
/// Half the gap drawn in a strand below another, in radii of the rod.
const BREAK: f64 = 3.0;

/// Points of a curve seen from above, m; a point without a value is a gap.
pub type Outline = Vec<(f64, Option<f64>)>;

/// Final state of a deployment on the table, seen from above.
pub struct LaidOutlines {
    /// The parts of the rods that belong to their patterns; for tied rods the whole rods.
    pub rods: Vec<Outline>,
    /// The patterns with their lead-ins.
    pub pattern: Outline,
    /// Circles of pegs; empty without any.
    pub pegs: Outline,
}

/// Rods, patterns and pegs seen from above at the last output; `None` if the run wrote no nodes.
///
/// # Errors
/// Files of the run cannot be read.
pub fn laid_outlines(directory: &Path) -> Result<Option<LaidOutlines>, FigureError> {
    if !directory.join(NODES).exists() {
        return Ok(None);
    }
    let scenario = load(&directory.join(SCENARIO), &[])?.scenario;
    let Some(DeploymentTables { deployment, .. }) = scenario.experiment.tables() else {
        return Ok(None);
    };
    let layings = deployment.layings();
    let nodes: usize = layings.iter().map(|laying| laying.rod.edges + 1).sum();
    let others: usize = scenario.rods.iter().map(nodes_of).sum();
    let others = others + pegs::NODES * deployment.pegs.len();
    let outputs = read_nodes(directory, nodes + others)?;
    let Some(last) = outputs.last() else {
        return Ok(None);
    };
    let mut left = &last.positions[..nodes];
    let mut rods = Vec::new();
    let mut pattern = Outline::new();
    for laying in &layings {
        let (Ok(curve), Ok(whole)) = (laying.laid_pattern(), laying.whole_pattern()) else {
            return Ok(None);
        };
        let (rod, others) = left.split_at(laying.rod.edges + 1);
        left = others;
        // A tied rod extends beyond the laid part.
        let part = match laying.knot {
            Some(_) => 1.0,
            None => curve.length() / laying.rod.length,
        };
        rods.push(pegs::first_part(rod, part));
        let length = whole.length();
        let drawn = (0..=POINTS).map(|index| whole.at(length * index as f64 / POINTS as f64));
        pattern.extend(drawn.map(|point| (point.position.x, Some(point.position.y))));
        pattern.extend(pattern.last().map(|(x, _)| (*x, None)));
    }
    let thickest = deployment.rods().map(|rod| rod.radius).fold(0.0, f64::max);
    Ok(Some(LaidOutlines {
        rods: broken_below(&rods, BREAK * thickest),
        pattern,
        pegs: pegs::outlines(&deployment.pegs),
    }))
}

/// Rods seen from above. A strand below another has a gap of `gap` (m) on each side of the
/// crossing.
fn broken_below(rods: &[Vec<Vector3>], gap: f64) -> Vec<Outline> {
    let mut below: Vec<Vec<bool>> = rods.iter().map(|rod| vec![false; rod.len()]).collect();
    let edges = |number: usize| (0..rods[number].len() - 1).map(move |index| (number, index));
    let all: Vec<(usize, usize)> = (0..rods.len()).flat_map(edges).collect();
    let ends = |(rod, index): (usize, usize)| [rods[rod][index], rods[rod][index + 1]];
    for (rank, &place) in all.iter().enumerate() {
        for &other_place in &all[rank + 1..] {
            // Neighbours meet.
            if other_place == (place.0, place.1 + 1) {
                continue;
            }
            let (one, other) = (ends(place), ends(other_place));
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
            let (rod, lower) = if places[0].z < places[1].z {
                place
            } else {
                other_place
            };
            let nodes = &rods[rod];
            let is_near = |node: &usize| (nodes[*node] - places[0]).xy().norm() < gap;
            let before = (0..=lower).rev().take_while(is_near);
            let after = (lower + 1..nodes.len()).take_while(is_near);
            for node in before.chain(after) {
                below[rod][node] = true;
            }
        }
    }
    let outline = |(rod, below): (&Vec<Vector3>, Vec<bool>)| {
        let points = rod.iter().zip(below);
        let points = points.map(|(node, is_below)| (node.x, (!is_below).then_some(node.y)));
        points.collect()
    };
    rods.iter().zip(below).map(outline).collect()
}

/// The figure of these outlines; `None` if the run wrote no nodes.
///
/// # Errors
/// Files of the run cannot be read.
pub fn laid_figure(directory: &Path) -> Result<Option<Figure>, FigureError> {
    let Some(outlines) = laid_outlines(directory)? else {
        return Ok(None);
    };
    let names: &[&str] = match outlines.rods[..] {
        [_] => &["rod"],
        _ => &["first rod", "second rod"],
    };
    let rods = names.iter().zip(outlines.rods);
    let mut curves: Vec<Curve> = rods.map(|(name, rod)| Curve::new(*name, rod)).collect();
    let pattern = if curves.len() == 1 {
        "pattern"
    } else {
        "patterns"
    };
    curves.push(Curve::new(pattern, outlines.pattern).looking(Look::Dashed));
    if !outlines.pegs.is_empty() {
        curves.push(Curve::new("pegs", outlines.pegs).looking(Look::Bare));
    }
    let plot = LinePlot::new("y in m", curves);
    Ok(Some(plot_to_scale(plot, "x in m")))
}

fn nodes_of(rod: &crate::scenario::Rod) -> usize {
    rod.edges + usize::from(!rod.closed)
}
