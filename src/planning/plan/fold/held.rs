//! Folds whose edge is held by a moment that keeps the friction demand within the friction of the
//! table.

use super::FoldError;
use super::atlas::in_parts;
use super::equilibrium::Fold;
use super::graph_search::{Objective, Waiting, uniform_cost_search};
use super::manifold::ForceManifold;
use super::path::{FoldPath, Sheet, after_lift, lift_of, starts, way_over};
use std::collections::BinaryHeap;

/// Maximum number of steps to a neighbour if a single step fails.
const MOST_PARTS: usize = 4;
/// Largest differences of a fold from its neighbour: ln l̄_s and α.
const FARTHEST: [f64; 2] = [0.3, 0.5];
/// Cost of a step without a moment, which selects the shortest path among those without moments.
const STEP_COST: f64 = 0.02;
/// Number of smoothing sweeps of a path, and allowed growth of a moment in each.
const SWEEPS: usize = 16;
const LARGER: f64 = 1e-3;
/// Number of points of a sheet checked against the table, and tolerance.
const POINTS: usize = 24;
const BELOW: f64 = 1e-6;

/// The fold at another gripper position, found from a nearby fold, with the smallest moment that
/// the friction φ of the table allows:
///
/// > |H| ≤ φ ((L̄ − l̄_s)/2 − V)
///
/// There is no moment if the demand is not larger; otherwise the sheet is pushed or pulled with
/// exactly this force.
pub fn held_from(start: &Fold, gripper: [f64; 2], length: f64, friction: f64) -> Option<Fold> {
    in_parts(start, gripper, MOST_PARTS, |fold, place| {
        held_next_to(fold, place, length, friction)
    })
}

fn held_next_to(near: &Fold, gripper: [f64; 2], length: f64, friction: f64) -> Option<Fold> {
    let is_like = |fold: &Fold| is_like(fold, near, length);
    let free = Fold::at(gripper, near).filter(is_like);
    if let Some(free) = free.filter(|free| free.friction_demand(length) <= friction) {
        return Some(free);
    }
    let pushed = free.unwrap_or(*near).forces.horizontal;
    let ratio = friction * pushed.signum();
    Fold::pushing_at(gripper, ratio, length, near).filter(is_like)
}

/// Whether a fold is similar to its neighbour, and possible.
fn is_like(fold: &Fold, near: &Fold, length: f64) -> bool {
    let stretched = libm::log(fold.suspended_length / near.suspended_length);
    let turned = fold.angle - near.angle;
    fold.suspended_length > 0.0
        && fold.suspended_length <= length
        && fold.forces.vertical < 0.0
        && stretched.abs() < FARTHEST[0]
        && turned.abs() < FARTHEST[1]
}

impl ForceManifold {
    /// Folds of a sheet on a table with friction φ at every cell that `held_from` reaches,
    /// starting at the folds of the lift. The search continues from the cells with the smallest
    /// moments first.
    pub fn held(spacing: f64, sheet: &Sheet, friction: f64) -> Self {
        let cells = |reach: f64| (reach / spacing).ceil() as usize + 1;
        let longest = sheet.length.min(Fold::LONGEST);
        // x̄ is the suspended length plus the extent of the sheet beyond the touchdown point.
        let (columns, rows) = (cells(sheet.length.min(2.0 * longest)), cells(longest));
        let mut manifold = Self::without_folds(spacing, [columns, rows]);
        let mut waiting = BinaryHeap::new();
        for fold in &lift_of(sheet) {
            waiting.push(Waiting {
                cost: 0.0,
                cell: manifold.cell(fold.gripper),
                from: *fold,
            });
        }
        while let Some(Waiting { cell, from, .. }) = waiting.pop() {
            if !manifold.has(cell) || manifold.fold(cell).is_some() {
                continue;
            }
            let found = held_from(&from, manifold.place(cell), sheet.length, friction);
            let Some(fold) = found.filter(is_above_the_table) else {
                continue;
            };
            manifold.set(cell, fold);
            let [column, row] = cell;
            let beside = [
                [column.wrapping_sub(1), row],
                [column + 1, row],
                [column, row.wrapping_sub(1)],
                [column, row + 1],
            ];
            for cell in beside {
                waiting.push(Waiting {
                    cost: fold.moment.abs(),
                    cell,
                    from: fold,
                });
            }
        }
        manifold
    }
}

/// Plans a fold whose edge reaches (C̄, 0). Moments at the gripper keep the friction demand within
/// φ; their sum over the cells of [`ForceManifold::held`] is minimal.
///
/// # Errors
/// The target cannot be reached.
pub fn held_path(
    manifold: &ForceManifold,
    sheet: &Sheet,
    target: f64,
    friction: f64,
) -> Result<FoldPath, FoldError> {
    let refused = FoldError::NotHeld { target, friction };
    let lift = lift_of(sheet);
    let goal_cell = manifold.cell([target, 0.0]);
    let starts = starts(&lift, manifold, sheet);
    let starts: Vec<_> = starts
        .into_iter()
        .filter(|cell| manifold.fold(*cell).is_some())
        .collect();
    let cost = |fold: &Fold| held_cost(fold, sheet);
    let found = uniform_cost_search(manifold, &starts, goal_cell, Objective::Sum, cost);
    let (cells, grid_cost) = found.ok_or(refused)?;
    let near = manifold.fold(goal_cell).ok_or(refused)?;
    let goal = held_from(near, [target, 0.0], sheet.length, friction).ok_or(refused)?;
    let (leave, mut way) = way_over(&cells, &lift, manifold, sheet, goal)?;
    smooth(&mut way, sheet, friction);
    let integral = way.windows(2).map(|pair| {
        let [one, other] = [pair[0], pair[1]].map(|fold| (fold.gripper, fold.force_ratio()));
        let step = libm::hypot(other.0[0] - one.0[0], other.0[1] - one.0[1]);
        0.5 * step * (one.1 + other.1)
    });
    let integral = integral.sum();
    let (lifted, folds) = after_lift(&lift[..leave], &way, manifold.spacing());
    Ok(FoldPath {
        folds,
        lift: lifted,
        grid_cost,
        grid_integral: integral,
        integral,
    })
}

/// Smooths the path over the grid. Each gripper position except the first and the last moves to
/// the midpoint of its neighbours, if that needs no larger moment.
fn smooth(way: &mut [Fold], sheet: &Sheet, friction: f64) {
    for _ in 0..SWEEPS {
        for index in 1..way.len() - 1 {
            let middle =
                [0, 1].map(|k| 0.5 * (way[index - 1].gripper[k] + way[index + 1].gripper[k]));
            let here = way[index];
            let moved = held_from(&here, middle, sheet.length, friction);
            let is_better = |fold: &Fold| {
                let is_no_harder = fold.moment.abs() <= here.moment.abs() + LARGER;
                is_no_harder && sheet.allows(fold) && is_above_the_table(fold)
            };
            if let Some(moved) = moved.filter(is_better) {
                way[index] = moved;
            }
        }
    }
}

/// Cost of a fold on such a path; `None` if it is not allowed.
pub fn held_cost(fold: &Fold, sheet: &Sheet) -> Option<f64> {
    let cost = fold.moment.abs() + STEP_COST;
    sheet.allows(fold).then_some(cost)
}

fn is_above_the_table(fold: &Fold) -> bool {
    fold.shape(POINTS).iter().all(|[_, z]| *z > -BELOW)
}

#[cfg(test)]
mod tests {
    use super::*;

    const A4: Sheet = Sheet::A4;

    #[test]
    fn a_small_moment_brings_a_sheet_over_the_ridge_without_asking_for_friction() {
        let friction = 0.1;
        let plan = |friction: f64| {
            let manifold = ForceManifold::held(0.11, &A4, friction);
            held_path(&manifold, &A4, A4.length, friction).unwrap()
        };
        let path = plan(friction);
        let demand = path.friction_demand(A4.length);
        assert!(demand <= friction * (1.0 + 1e-9), "{demand}");
        let last = path.folds.last().unwrap();
        assert!((last.gripper[0] - A4.length).abs() < 1e-9 && last.gripper[1].abs() < 1e-9);
        // ∫ λ over the way of the gripper lies between the sums with the smaller and the larger λ of each step.
        let sums = path.folds[path.lift..].windows(2).map(|pair| {
            let [from, to] = [pair[0].gripper, pair[1].gripper];
            let step = libm::hypot(to[0] - from[0], to[1] - from[1]);
            let [one, other] = [pair[0], pair[1]].map(|fold| step * fold.force_ratio());
            [one.min(other), one.max(other)]
        });
        let [least, most] = sums.fold([0.0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]]);
        assert!((least..=most).contains(&path.integral), "{least} {most}");
        assert!(most < 1.5 * least, "{least} {most}");
        let moment = |fold: &Fold| fold.moment.abs();
        let most = path.folds.iter().map(moment).fold(0.0, f64::max);
        // Without push and weight θ'² = 2 |V| sin θ. At the tightest loop the curvature at the end
        // is √6.
        assert!((0.3..1.1).contains(&most), "{most}");
        assert!(
            path.folds
                .iter()
                .all(|fold| fold.unstable_modes_held() == 0)
        );
        // With sufficient friction no moment is needed.
        let free = plan(0.7);
        assert!(free.folds.iter().map(moment).fold(0.0, f64::max) < 1e-9);
    }

    #[test]
    fn the_equations_hold_with_a_moment_at_the_gripper() {
        let manifold = ForceManifold::held(0.11, &A4, 0.1);
        let path = held_path(&manifold, &A4, 5.2, 0.1).unwrap();
        for fold in path.folds.iter().filter(|fold| fold.moment.abs() > 0.1) {
            let again = Fold::clamped_at(fold.gripper, fold.angle, fold).unwrap();
            assert!((again.forces.horizontal - fold.forces.horizontal).abs() < 1e-8);
            assert!((again.moment - fold.moment).abs() < 1e-8);
        }
    }

    /// Without weight, a sheet that leaves the table under a force at the angle atan φ oscillates
    /// about its direction like a pendulum, so its edge never reaches the table.
    #[test]
    fn a_tight_fold_is_held_by_no_moment() {
        let cardboard = Sheet {
            length: 0.2794 / 0.132,
            least_suspended: 0.958,
        };
        let manifold = ForceManifold::held(0.11, &cardboard, 0.1);
        let refused = held_path(&manifold, &cardboard, cardboard.length, 0.1);
        assert!(matches!(refused, Err(FoldError::NotHeld { .. })));
    }
}
