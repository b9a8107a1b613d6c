//! Figures of a planned fold.

use super::fold::{Cell, Fold, FoldPath, ForceManifold};
use rodlab_files::figure::{Curve, Figure, LinePlot, Look, line_plots, plot_to_scale};

/// Number of drawn poses of the sheet, and of points of each pose.
const POSES: usize = 7;
const POINTS: usize = 60;
/// Number of rows and columns of the manifold between two samples.
const EVERY: usize = 4;

/// The sheet along its path, to scale, in L_gb, with the positions without a force along the
/// table.
pub fn fold_figure(path: &FoldPath, manifold: &ForceManifold, length: f64) -> Figure {
    let mut poses = vec![];
    for pose in 0..POSES {
        let fold = &path.folds[pose * (path.folds.len() - 1) / (POSES - 1)];
        poses.extend(whole(fold, length));
        poses.push((0.0, None));
    }
    let mut curves = vec![Curve::new("sheet", poses).like(1)];
    let way = path.folds.iter().map(|fold| point(fold.gripper));
    curves.push(
        Curve::new(
            "gripper",
            [(0.0, Some(0.0))].into_iter().chain(way).collect(),
        )
        .like(0),
    );
    let free = Curve::new("no push: λ = 0", without_push(manifold));
    curves.push(free.looking(Look::OpenMarks).like(2));
    let plot = LinePlot::new("z/L_{gb}", curves);
    plot_to_scale(plot, "x/L_{gb}")
}

/// λ and the friction demand of a sheet of length L̄ along the path of the gripper, in L_gb, with
/// the friction of the table and the sliding of the sheet.
pub fn friction_figure(
    path: &FoldPath,
    length: f64,
    friction: Option<f64>,
    slid: Option<&[f64]>,
) -> Figure {
    let mut way = 0.0;
    let mut before = [0.0; 2];
    let mut curves = [vec![], vec![]];
    let mut ways = vec![];
    for fold in &path.folds {
        way += libm::hypot(fold.gripper[0] - before[0], fold.gripper[1] - before[1]);
        before = fold.gripper;
        ways.push(way);
        curves[0].push((way, Some(fold.force_ratio())));
        curves[1].push((way, Some(fold.friction_demand(length))));
    }
    let [ratios, demands] = curves;
    let mut curves = vec![
        Curve::new("λ, at the touchdown point alone", ratios),
        Curve::new("demand of the whole sheet", demands),
    ];
    if let Some(friction) = friction {
        let line = vec![(0.0, Some(friction)), (way, Some(friction))];
        curves.push(Curve::new("friction of the table", line).looking(Look::Dashed));
    }
    let plot = LinePlot::new("friction", curves);
    let slid = slid.map(|slid| {
        let points = ways.iter().copied().zip(slid.iter().copied().map(Some));
        LinePlot::new("slid over L_{gb}", [Curve::new("sheet", points.collect())])
    });
    let plots: Vec<LinePlot> = [plot].into_iter().chain(slid).collect();
    line_plots(plots, "way of the gripper over L_{gb}")
}

/// The suspended part and the lying rest.
fn whole(fold: &Fold, length: f64) -> Vec<(f64, Option<f64>)> {
    let lying = [[length.max(fold.suspended_length), 0.0]];
    let shape = fold.shape(POINTS);
    lying.into_iter().chain(shape).map(point).collect()
}

fn point([x, z]: [f64; 2]) -> (f64, Option<f64>) {
    (x, Some(z))
}

/// Positions on some rows and columns of the grid where H changes its sign.
fn without_push(manifold: &ForceManifold) -> Vec<(f64, Option<f64>)> {
    let [columns, rows] = manifold.size();
    let right = (0..rows)
        .step_by(EVERY)
        .flat_map(|row| (1..columns).map(move |column| [[column - 1, row], [column, row]]));
    let up = (0..columns)
        .step_by(EVERY)
        .flat_map(|column| (1..rows).map(move |row| [[column, row - 1], [column, row]]));
    let place = |pair: [Cell; 2]| {
        let [Some(one), Some(other)] = pair.map(|cell| manifold.fold(cell)) else {
            return None;
        };
        let [a, b] = [one, other].map(|fold| fold.forces.horizontal);
        let part = a / (a - b);
        let between = |k: usize| one.gripper[k] + part * (other.gripper[k] - one.gripper[k]);
        (a * b < 0.0).then(|| point([between(0), between(1)]))
    };
    right.chain(up).filter_map(place).collect()
}
