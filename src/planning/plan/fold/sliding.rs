//! Sliding of a sheet during a fold.

use super::FoldError;
use super::equilibrium::{Fold, between};

/// Step of sliding, L_gb, largest sliding, L_gb, and number of bisections for its end.
const STEP: f64 = 0.004;
const FARTHEST: f64 = 4.0;
const BISECTIONS: usize = 30;
/// Number of steps from one planned fold to the next.
const PARTS: usize = 4;

/// Sliding of the sheet along x at each fold of a path, in L_gb, on a table with friction μ,
/// without inertia. The gripper holds its planned angles.
///
/// A fold at x̄ of a sheet that has slid by Δ is a fold at x̄ − Δ, but with a moment at the
/// gripper. If its friction demand exceeds μ, the sheet slides until its demand is μ: away if it
/// is pushed, and back if it is pulled.
///
/// # Errors
/// No friction can hold the sheet.
pub fn sliding(folds: &[Fold], length: f64, friction: f64) -> Result<Vec<f64>, FoldError> {
    let mut slid = 0.0;
    let mut last: Option<(&Fold, Fold)> = None;
    let mut all = Vec::with_capacity(folds.len());
    for fold in folds {
        let lost = || FoldError::NoHold(fold.gripper);
        let here = match &last {
            None => Some(*fold),
            Some((planned, state)) => carried(planned, fold, slid, state),
        };
        let here = here.ok_or_else(lost)?;
        let held = |slid: f64, near: &Fold| {
            let held = held(fold.gripper, fold.angle, slid, near);
            held.filter(|held| held.suspended_length <= length)
        };
        let mut state = here;
        if here.friction_demand(length) > friction {
            let step = -STEP * here.forces.horizontal.signum();
            let mut held_at = None;
            for part in 1..=(FARTHEST / STEP) as usize {
                let next = slid + step * part as f64;
                let Some(moved) = held(next, &state) else {
                    break;
                };
                // Beyond the fold without a push, the sheet is held in between, by less than μ.
                let turned = moved.forces.horizontal * here.forces.horizontal <= 0.0;
                if turned || moved.friction_demand(length) <= friction {
                    held_at = Some(next);
                    break;
                }
                state = moved;
            }
            let end = held_at.ok_or_else(lost)?;
            let (mut slips, mut holds) = (end - step, end);
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (slips + holds);
                let found = held(middle, &state).ok_or_else(lost)?;
                let turned = found.forces.horizontal * here.forces.horizontal <= 0.0;
                if turned || found.friction_demand(length) <= friction {
                    (holds, state) = (middle, found);
                } else {
                    slips = middle;
                }
            }
            slid = holds;
        }
        last = Some((fold, state));
        all.push(slid);
    }
    Ok(all)
}

/// The fold at the next planned gripper pose, if the sheet keeps its position.
fn carried(from: &Fold, to: &Fold, slid: f64, state: &Fold) -> Option<Fold> {
    (1..=PARTS).try_fold(*state, |state, part| {
        let part = part as f64 / PARTS as f64;
        let gripper = between(from.gripper, to.gripper, part);
        let angle = from.angle + part * (to.angle - from.angle);
        held(gripper, angle, slid, &state)
    })
}

/// The fold of a sheet that has slid, with the gripper at a position and an angle.
fn held([x, z]: [f64; 2], angle: f64, slid: f64, near: &Fold) -> Option<Fold> {
    let held = Fold::clamped_at([x - slid, z], angle, near)?;
    let ratio = held.suspended_length / near.suspended_length;
    (held.forces.vertical < 0.0 && (0.7..1.4).contains(&ratio)).then_some(held)
}

#[cfg(test)]
mod tests {
    use super::super::{FoldAtlas, ForceManifold, Objective, Sheet, fold_path};
    use super::*;

    #[test]
    fn a_sheet_slides_only_where_the_demand_is_above_the_friction() {
        let atlas = FoldAtlas::new();
        let manifold = ForceManifold::new(&atlas, 0.11, 6.84);
        let sheet = Sheet::A4;
        for objective in [Objective::Sum, Objective::Largest] {
            let path = fold_path(&atlas, &manifold, &sheet, 6.1875, objective).unwrap();
            let demand = path.friction_demand(sheet.length);
            let enough = sliding(&path.folds, sheet.length, 1.01 * demand).unwrap();
            assert!(enough.iter().all(|slid| *slid == 0.0));
            let less = sliding(&path.folds, sheet.length, 0.9 * demand).unwrap();
            let largest = less.iter().copied().fold(0.0, f64::max);
            assert!(largest > 0.01 && largest < 0.3, "{largest}");
            // The sheet is pushed away.
            assert!(less.iter().all(|slid| *slid >= 0.0));
            // With less friction it slides farther.
            let least = sliding(&path.folds, sheet.length, 0.7 * demand).unwrap();
            assert!(least.iter().copied().fold(0.0, f64::max) > largest);
        }
    }

    #[test]
    fn a_sheet_slides_until_its_demand_is_the_friction() {
        let length = Sheet::A4.length;
        let mut folds = vec![Fold::just_lifted(2.5).unwrap()];
        for _ in 0..12 {
            let last = folds[folds.len() - 1];
            let [x, z] = last.gripper;
            folds.push(Fold::at([x + 0.02, z], &last).unwrap());
        }
        let friction = 0.5 * folds[12].friction_demand(length);
        let slid = sliding(&folds, length, friction).unwrap();
        assert_eq!(slid[0], 0.0);
        assert!(slid[12] > 0.02, "{slid:?}");
        for (fold, slid) in folds.iter().zip(slid) {
            let [x, z] = fold.gripper;
            let held = Fold::clamped_at([x - slid, z], fold.angle, fold).unwrap();
            let excess = held.friction_demand(length) - friction;
            assert!(excess < 1e-8 && (slid == 0.0 || excess > -1e-6), "{excess}");
        }
    }
}
