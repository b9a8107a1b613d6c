//! The path of the gripper from the flat sheet to the crease target.

use super::FoldError;
use super::atlas::{FoldAtlas, solve_from};
use super::equilibrium::{Fold, between};
use super::graph_search::{Cell, Objective, uniform_cost_search};
use super::manifold::ForceManifold;
use serde::{Deserialize, Serialize};

/// Folds of the lift per L_gb of suspended length.
const LIFT_STEPS: usize = 100;
/// Intervals between two folds of a path in its integral.
const PARTS: usize = 3;
/// Number of sweeps of the refinement, smallest gain of a move, and initial and smallest move of a
/// point in grid spacings.
const SWEEPS: usize = 400;
const LEAST_GAIN: f64 = 1e-9;
const FIRST_MOVE: f64 = 0.5;
const LEAST_MOVE: f64 = 0.01;

/// Parameters of a sheet for folding, in L_gb.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sheet {
    /// L̄, its length in the direction of the fold.
    pub length: f64,
    /// Least suspended length of the bent sheet, L_gb: shorter lengths crease it (thesis sec.
    /// 4.6.5).
    pub least_suspended: f64,
}

/// A planned fold.
#[derive(Clone, Debug)]
pub struct FoldPath {
    /// Folds in order, from the nearly flat sheet to the crease target.
    pub folds: Vec<Fold>,
    /// Number of folds that only lift the edge, without a push along the table.
    pub lift: usize,
    /// The minimum of the search over the grid: Σλ or the largest friction demand.
    pub grid_cost: f64,
    /// ∫ λ over the path of the gripper, in L_gb, along the cells and along the folds.
    pub grid_integral: f64,
    /// Along the folds.
    pub integral: f64,
}

impl Sheet {
    /// Half an A4 sheet, thesis sec. 4.6.3.
    #[cfg(test)]
    pub(super) const A4: Self = Self {
        length: 0.297 / 0.048,
        least_suspended: 0.958,
    };

    /// Whether a fold is allowed: its suspended length is neither too small nor larger than the
    /// sheet.
    pub(super) fn allows(&self, fold: &Fold) -> bool {
        self.allows_place(fold.gripper, fold.suspended_length)
    }

    fn allows_place(&self, [_, z]: [f64; 2], suspended_length: f64) -> bool {
        z >= 0.0 && (self.least_suspended..=self.length).contains(&suspended_length)
    }
}

/// Plans a fold whose edge reaches (C̄, 0). First the edge is lifted without a push. A search
/// finds the point where the path leaves the lift and its continuation over the grid (thesis
/// Algorithm 4). For [`Objective::Sum`] the points are then moved until ∫ λ ds no longer
/// decreases. Finally the folds along the path are solved exactly.
///
/// # Errors
/// The target cannot be reached.
pub fn fold_path(
    atlas: &FoldAtlas,
    manifold: &ForceManifold,
    sheet: &Sheet,
    target: f64,
    objective: Objective,
) -> Result<FoldPath, FoldError> {
    let goal = goal_fold(atlas, sheet, target)?;
    let lift = lift_of(sheet);
    let cost = |fold: &Fold| path_cost(fold, sheet, objective);
    let starts = starts(&lift, manifold, sheet);
    let goal_cell = manifold.cell(goal.gripper);
    let found = uniform_cost_search(manifold, &starts, goal_cell, objective, cost);
    let (cells, grid_cost) = found.ok_or(FoldError::NoPath(target))?;
    let (leave, mut way) = way_over(&cells, &lift, manifold, sheet, goal)?;
    let grid_integral = integral(&way)?;
    if objective == Objective::Sum {
        let moved = refined(&way, manifold, sheet);
        let exact = exactly(&way, &moved)?;
        // The manifold is only as accurate as its grid.
        if integral(&exact)? < grid_integral {
            way = exact;
        }
    }
    let (lifted, folds) = after_lift(&lift[..leave], &way, manifold.spacing());
    Ok(FoldPath {
        folds,
        lift: lifted,
        grid_cost,
        grid_integral,
        integral: integral(&way)?,
    })
}

/// Cost of a fold on the path; `None` if it is not allowed.
pub fn path_cost(fold: &Fold, sheet: &Sheet, objective: Objective) -> Option<f64> {
    let cost = match objective {
        Objective::Sum => fold.force_ratio(),
        Objective::Largest => fold.friction_demand(sheet.length),
    };
    sheet.allows(fold).then_some(cost)
}

/// A sheet that is only lifted, as far as it can be.
pub fn lift_of(sheet: &Sheet) -> Vec<Fold> {
    let longest = sheet.length.min(Fold::LONGEST);
    FoldAtlas::lift(longest, (LIFT_STEPS as f64 * longest).ceil() as usize)
}

/// Cells on the lift from which a path over a manifold may begin.
pub fn starts(lift: &[Fold], manifold: &ForceManifold, sheet: &Sheet) -> Vec<Cell> {
    let allowed = lift.iter().filter(|fold| sheet.allows(fold));
    allowed.map(|fold| manifold.cell(fold.gripper)).collect()
}

/// The folds of a path over cells. The first element is the index of the fold of the lift at the
/// start of the path; the folds end at the goal.
pub fn way_over(
    cells: &[Cell],
    lift: &[Fold],
    manifold: &ForceManifold,
    sheet: &Sheet,
    goal: Fold,
) -> Result<(usize, Vec<Fold>), FoldError> {
    let leave = lift
        .iter()
        .position(|fold| sheet.allows(fold) && manifold.cell(fold.gripper) == cells[0]);
    let leave = leave.ok_or(FoldError::NoPath(goal.gripper[0]))?;
    let inner = &cells[1..cells.len().max(2) - 1];
    let inner = inner.iter().filter_map(|cell| manifold.fold(*cell));
    let begin = std::iter::once(&lift[leave]);
    let way = begin.chain(inner).chain([&goal]).copied();
    Ok((leave, way.collect()))
}

/// Thins a lift to a spacing and appends the path that follows. Returns the number of kept folds
/// of the lift, and all folds.
pub fn after_lift(lift: &[Fold], way: &[Fold], spacing: f64) -> (usize, Vec<Fold>) {
    let mut folds = lift.to_vec();
    thin(&mut folds, spacing);
    let lifted = folds.len();
    folds.extend(way);
    (lifted, folds)
}

impl FoldPath {
    /// Largest λ while more than the edge of the sheet presses on the table.
    pub fn largest_force_ratio(&self) -> f64 {
        self.folds[self.lift..]
            .iter()
            .fold(0.0, |largest, fold| fold.force_ratio().max(largest))
    }

    /// Largest moment at the gripper, in EI/L_gb.
    pub fn largest_moment(&self) -> f64 {
        let moments = self.folds.iter().map(|fold| fold.moment.abs());
        moments.fold(0.0, f64::max)
    }

    /// The coefficient of friction that holds a sheet of length L̄ during the whole fold.
    pub fn friction_demand(&self, length: f64) -> f64 {
        self.folds.iter().fold(0.0, |largest, fold| {
            fold.friction_demand(length).max(largest)
        })
    }
}

/// The fold with the edge on the table at the target.
fn goal_fold(atlas: &FoldAtlas, sheet: &Sheet, target: f64) -> Result<Fold, FoldError> {
    let down = atlas.folds().windows(2).filter_map(|pair| {
        let [above, below] = [pair[0], pair[1]];
        let is_last = below.gripper[1] <= 0.0 && above.gripper[1] > 0.0;
        (is_last && sheet.allows(&above)).then_some(below.gripper[0])
    });
    let down: Vec<f64> = down.collect();
    let least = down.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = down.iter().copied().fold(0.0, f64::max).min(sheet.length);
    let fault = |reason| FoldError::Target {
        target,
        least,
        largest,
        reason,
    };
    if target > sheet.length {
        return Err(fault("beyond the end of the sheet"));
    }
    let goal = atlas.solve([target, 0.0]);
    let goal = goal.map_err(|_| fault("where no sheet can be held without a moment"))?;
    if goal.suspended_length < sheet.least_suspended {
        return Err(fault("where the sheet would have to be bent too sharply"));
    }
    if goal.suspended_length > sheet.length {
        return Err(fault(
            "where more of the sheet would have to be suspended than there is",
        ));
    }
    Ok(goal)
}

/// ∫ λ |dr| by the trapezoidal rule, with additional folds between those of the path.
fn integral(way: &[Fold]) -> Result<f64, FoldError> {
    let mut sum = 0.0;
    for pair in way.windows(2) {
        let mut last = pair[0];
        for part in 1..=PARTS {
            let place = between(pair[0].gripper, pair[1].gripper, part as f64 / PARTS as f64);
            let next = solve_from(&last, place).ok_or(FoldError::NoPath(place[0]))?;
            let mean = 0.5 * (last.force_ratio() + next.force_ratio());
            sum += mean * distance(last.gripper, next.gripper);
            last = next;
        }
    }
    Ok(sum)
}

/// Refines the positions of a path. Each inner position moves across the path as long as this
/// decreases the adjacent parts of the integral, in ever smaller moves; λ is that of the manifold.
/// The end and the start on the lift are fixed.
fn refined(way: &[Fold], manifold: &ForceManifold, sheet: &Sheet) -> Vec<[f64; 2]> {
    let mut places: Vec<[f64; 2]> = way.iter().map(|fold| fold.gripper).collect();
    let mut ratios: Vec<f64> = way.iter().map(Fold::force_ratio).collect();
    let mut size = FIRST_MOVE * manifold.spacing();
    for _ in 0..SWEEPS {
        let mut moved = 0;
        for point in 1..places.len() - 1 {
            let [before, here, after] = [places[point - 1], places[point], places[point + 1]];
            let length = distance(before, after).max(f64::MIN_POSITIVE);
            let across = [
                size * (before[1] - after[1]) / length,
                size * (after[0] - before[0]) / length,
            ];
            let cost = |place: [f64; 2], ratio: f64| {
                (ratios[point - 1] + ratio) * distance(before, place)
                    + (ratio + ratios[point + 1]) * distance(place, after)
            };
            let candidates = [
                [here[0] + across[0], here[1] + across[1]],
                [here[0] - across[0], here[1] - across[1]],
                // Keeps the points apart.
                between(before, after, 0.5),
            ];
            let best = cost(here, ratios[point]) - LEAST_GAIN;
            let better = candidates.into_iter().find_map(|place| {
                let known = manifold.at(place)?;
                let allowed = sheet.allows_place(place, known.suspended_length);
                (allowed && cost(place, known.force_ratio) < best)
                    .then_some((place, known.force_ratio))
            });
            if let Some((place, ratio)) = better {
                (places[point], ratios[point]) = (place, ratio);
                moved += 1;
            }
        }
        if moved == 0 {
            size *= 0.5;
            if size < LEAST_MOVE * manifold.spacing() {
                break;
            }
        }
    }
    places
}

/// The folds at moved positions, each found from the previous one.
fn exactly(way: &[Fold], places: &[[f64; 2]]) -> Result<Vec<Fold>, FoldError> {
    let folds = way
        .iter()
        .zip(places)
        .map(|(fold, place)| solve_from(fold, *place).ok_or(FoldError::NoPath(place[0])));
    folds.collect()
}

fn distance(from: [f64; 2], to: [f64; 2]) -> f64 {
    libm::hypot(to[0] - from[0], to[1] - from[1])
}

/// Removes folds whose gripper is closer to the last kept one than a spacing.
pub fn thin(folds: &mut Vec<Fold>, spacing: f64) {
    let mut last = [0.0; 2];
    folds.retain(|fold| {
        let keeps = distance(last, fold.gripper) >= spacing;
        if keeps {
            last = fold.gripper;
        }
        keeps
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fold_begins_flat_and_ends_at_the_crease_target() {
        let atlas = FoldAtlas::new();
        let manifold = ForceManifold::new(&atlas, 0.11, 6.84);
        for (target, objective) in [(6.1875, Objective::Sum), (5.2083, Objective::Largest)] {
            let path = fold_path(&atlas, &manifold, &Sheet::A4, target, objective).unwrap();
            let last = path.folds.last().unwrap();
            assert!((last.gripper[0] - target).abs() < 1e-9 && last.gripper[1].abs() < 1e-9);
            assert!(
                path.folds[..path.lift]
                    .iter()
                    .all(|fold| fold.force_ratio() < 1e-9)
            );
            assert!(
                path.folds
                    .iter()
                    .all(|fold| fold.gripper[1] > -1e-9 && fold.unstable_modes() == 0)
            );
            assert!(path.folds[0].gripper[1] < 0.25);
            assert!(path.integral <= path.grid_integral);
            // By the trapezoidal rule with many more folds.
            let fine = path.folds[path.lift..].windows(2).flat_map(|pair| {
                let mut last = pair[0];
                (1..=12).map(move |part| {
                    let part = f64::from(part) / 12.0;
                    let place = between(pair[0].gripper, pair[1].gripper, part);
                    let next = solve_from(&last, place).unwrap();
                    let step = distance(last.gripper, next.gripper);
                    let sum = step * (last.force_ratio() + next.force_ratio());
                    last = next;
                    0.5 * sum
                })
            });
            let fine: f64 = fine.sum();
            assert!((path.integral / fine - 1.0).abs() < 0.04, "{fine}");
            // The lying rest of the sheet presses on the table as well.
            assert!(path.largest_force_ratio() >= path.friction_demand(Sheet::A4.length));
        }
    }

    /// The path of least friction has at most the friction of the path of least sum, and vice
    /// versa.
    #[test]
    fn each_plan_is_best_in_what_it_is_made_for() {
        let atlas = FoldAtlas::new();
        let manifold = ForceManifold::new(&atlas, 0.11, 6.84);
        let plan = |objective| fold_path(&atlas, &manifold, &Sheet::A4, 6.1875, objective).unwrap();
        let (sum, largest) = (plan(Objective::Sum), plan(Objective::Largest));
        assert!(sum.integral < largest.integral);
        let [by_sum, by_largest] =
            [&sum, &largest].map(|path| path.friction_demand(Sheet::A4.length));
        assert!(by_largest < 0.5 * by_sum, "{by_sum} {by_largest}");
        assert!(sum.integral < 0.99 * sum.grid_integral);
    }

    #[test]
    fn targets_out_of_reach_are_refused() {
        let atlas = FoldAtlas::new();
        let manifold = ForceManifold::new(&atlas, 0.2, 6.84);
        for target in [0.3, 6.3] {
            let refused = fold_path(&atlas, &manifold, &Sheet::A4, target, Objective::Sum);
            assert!(
                matches!(refused, Err(FoldError::Target { .. })),
                "{:?}",
                refused.err()
            );
        }
    }
}
