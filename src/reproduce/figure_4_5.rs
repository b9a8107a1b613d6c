//! Figure 4.5: the force manifold, and the paths of the gripper over it.

use super::folds::{Folded, SCENARIOS};
use super::prelude::*;
use rodlab_files::figure::{ColourField, Figure, LinePlot};
use rodlab_lab::experiment::planned_fold;
use rodlab_planning::plan::fold::{
    Algorithm, Fold, FoldAtlas, FoldPlanner, ForceManifold, Objective, Workspace,
};

pub(super) const ARTIFACT: Artifact = Artifact {
    name: "fig4.5",
    title: "Figure 4.5: the force manifold of folding",
    recipe: &Free::new(Folded::of_figure_4_5, write),
};

/// λ above which folds have the last colour.
const LARGEST_RATIO: f64 = 1.0;
/// Step, in cells of the grid, between drawn cells.
const DRAWN: usize = 4;
/// Step, in cells of the grid, between cells in the table.
const LISTED: usize = 8;
/// Shortest suspended length of the workspace, L_gb.
const SHORTEST: f64 = 0.5;

/// A row of the CSV file: a cell of the manifold.
#[derive(Serialize)]
struct Row {
    x: f64,
    z: f64,
    lambda: f64,
    alpha_rad: f64,
    suspended_length: f64,
}

/// Writes table and figures.
fn write(page: &mut Page, cases: &[Case<Folded>]) -> Result<()> {
    page.text(
        "λ and α over the positions of the gripper, for suspended lengths up to 6.84 L_gb: the exact folds of the \
         thesis' grid of 0.0548 L_gb, of which every fourth in each direction is drawn. λ vanishes along two canyons, \
         the lift of the flat sheet on the left and a second one that leads from z̄ = 0.9 down to the table; between \
         them lies a ridge. The paths of least Σλ (without jitter, any table) leave the lift, cross the ridge low, \
         where it is narrow, and continue along the second canyon to their crease targets; the penalty region (l̄_s \
         below 0.958) is left of them. The thesis draws the output of its network; here no network is used. `rodlab \
         evaluate` compares a network with these folds (guide, page `folding`).",
    );
    let atlas = FoldAtlas::new();
    let manifold = ForceManifold::new(&atlas, spacing(), ForceManifold::LONGEST);
    let folds = |every: usize| {
        let [columns, rows] = manifold.size();
        let manifold = &manifold;
        (0..rows).step_by(every).flat_map(move |row| {
            let cells = (0..columns).step_by(every);
            cells.filter_map(move |column| manifold.fold([column, row]))
        })
    };
    let mut lines = vec![];
    let mut ways = vec![];
    for case in cases {
        let Some((sheet, target)) = planned_fold(&case.directory) else {
            continue;
        };
        let planner = FoldPlanner::shared(sheet, Algorithm::Optimal(Objective::Sum));
        let Ok(poses) = planner.poses(target) else {
            continue;
        };
        let name = SCENARIOS[case.run.scenario].name;
        let highest = largest(poses.iter().map(|pose| pose.gripper[1]));
        lines.push(vec![
            name.to_owned(),
            number(target, 3),
            poses.len().to_string(),
            number(highest, 2),
        ]);
        let way = curve(name, &poses, |pose| (pose.gripper[0], pose.gripper[1]));
        ways.push(way.looking(Look::Line));
    }
    let header = ["scenario", "crease target, L_gb", "poses", "highest, L_gb"];
    page.lines(&header, &lines);
    let rows: Vec<Row> = folds(LISTED)
        .map(|fold| Row {
            x: fold.gripper[0],
            z: fold.gripper[1],
            lambda: fold.force_ratio(),
            alpha_rad: fold.angle,
            suspended_length: fold.suspended_length,
        })
        .collect();
    page.csv(&rows)?;
    let drawn: Vec<&Fold> = folds(DRAWN).collect();
    page.figure(&PageFigure::new(
        "fig4.5_lambda",
        "λ over the positions of the gripper, and paths of least Σλ",
        coloured(
            &drawn,
            ("λ", Some(LARGEST_RATIO)),
            &|fold| fold.force_ratio(),
            &ways,
        ),
    ))?;
    page.figure(&PageFigure::new(
        "fig4.5_alpha",
        "α over the positions of the gripper, and paths of least Σλ",
        coloured(
            &drawn,
            ("α in degrees", None),
            &|fold| fold.angle.to_degrees(),
            &ways,
        ),
    ))?;
    Ok(())
}

/// Grid spacing of the gripper positions, L_gb: that of the thesis; in short tests it is four
/// times as large.
fn spacing() -> f64 {
    #[cfg(test)]
    if !super::tests_are_full() {
        return 4.0 * ForceManifold::SPACING;
    }
    ForceManifold::SPACING
}

/// A quantity of folds over the gripper positions, with the outline of the workspace and paths.
fn coloured(
    folds: &[&Fold],
    (label, most): (&str, Option<f64>),
    value: &dyn Fn(&Fold) -> f64,
    ways: &[Curve],
) -> Figure {
    let cell = DRAWN as f64 * spacing();
    let values = folds.iter().map(|fold| {
        let [x, z] = fold.gripper;
        [x, z, value(fold)]
    });
    let field = ColourField {
        label: label.into(),
        values: values.collect(),
        cell: Some([cell; 2]),
        most,
        ..ColourField::default()
    };
    let outline = Workspace::new([SHORTEST, ForceManifold::LONGEST]).map(|workspace| {
        curve("workspace", workspace.outline(), |[x, z]| (*x, *z)).looking(Look::Dashed)
    });
    let plot = LinePlot {
        field: Some(field),
        ..plot("z/L_{gb}", ways.iter().cloned().chain(outline))
    };
    plot_to_scale(plot, "x/L_{gb}")
}
