//! Positions of the gripper for the samples.

use super::keys::{FoldSamples, Points};
use crate::experiment::data_set::Span;
use rodlab_engine::random::{MOST_POINTS, sobol};
use rodlab_planning::plan::fold::Workspace;

/// The positions of an experiment in its workspace; empty if there is no workspace.
pub fn places(plan: &FoldSamples) -> Option<Vec<[f64; 2]>> {
    let Span { from, to } = plan.suspended_length;
    let workspace = Workspace::new([from, to])?;
    let reach = workspace.reach();
    let places = match plan.points {
        Points::Sobol { count, first } => (0..MOST_POINTS)
            .map(|number| {
                let parts: [f64; 2] = sobol(number);
                [0, 1].map(|k| reach[k] * parts[k].powi(2))
            })
            .filter(|place| workspace.contains(*place))
            .skip(first)
            .take(count)
            .collect(),
        Points::Grid { spacing } => {
            let [columns, rows] = reach.map(|reach| (reach / spacing).ceil() as usize);
            let place = |index: usize| (index as f64 + 0.5) * spacing;
            (0..rows)
                .flat_map(|row| (0..columns).map(move |column| [place(column), place(row)]))
                .filter(|place| workspace.contains(*place))
                .collect()
        }
    };
    Some(places)
}
