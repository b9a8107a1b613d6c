//! The figure: target curve, equilibrium, and the rod without loads or before the design.

use super::outcome::Design;
use rodlab_engine::mechanics::Vector3;
use rodlab_files::figure::{Curve, Figure, LinePlot, Look, plot_to_scale};

const AXES: [&str; 3] = ["x", "y", "z"];

/// The three curves in the plane of the two axes along which they extend most. If one of these is
/// z, it is vertical.
pub fn design_figure(designed: &Design) -> Figure {
    let extent = |axis: usize| {
        let values = designed.nodes().iter().flatten().map(|node| node[axis]);
        let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), one| {
            (low.min(one), high.max(one))
        });
        most - least
    };
    let mut axes = [0, 1, 2];
    axes.sort_by(|one, other| extent(*other).total_cmp(&extent(*one)));
    let [across, up] = [axes[0].min(axes[1]), axes[0].max(axes[1])];
    let curve = |name: &str, nodes: &[Vector3], look: Look| {
        let points = nodes.iter().map(|node| (node[across], Some(node[up])));
        Curve::new(name, points.collect()).looking(look)
    };
    let [wanted, equilibrium, other] = designed.nodes();
    let name = match designed {
        Design::Shape(_) => "Without loads",
        Design::Numbers(_) => "Before",
    };
    let curves = [
        curve("Target", wanted, Look::Ground),
        curve("Equilibrium", equilibrium, Look::Bare),
        curve(name, other, Look::Dashed),
    ];
    plot_to_scale(
        LinePlot::new(format!("{} in m", AXES[up]), curves),
        &format!("{} in m", AXES[across]),
    )
}
