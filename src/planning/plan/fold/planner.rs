//! Plans a fold by any of the methods, and replans the rest of a path.

use super::FoldError;
use super::atlas::FoldAtlas;
use super::baseline::{circle, step_by_step};
use super::equilibrium::Fold;
use super::graph_search::{Objective, uniform_cost_search};
use super::held::{held_cost, held_path};
use super::manifold::ForceManifold;
use super::neural::{NetworkCheck, NeuralFoldError, NeuralFolds};
use super::path::{FoldPath, Sheet, fold_path, path_cost};
use super::pose::FoldPose;
use serde::{Deserialize, Serialize};
use std::sync::{Arc, Mutex, PoisonError};

/// Largest friction demand of a plan with moments, as a fraction of the friction of the table.
pub const PART_OF_FRICTION: f64 = 0.85;
/// Smallest allowed suspended length of a slid sheet during recovery, relative to its current
/// length.
const SHORTER: f64 = 0.95;
/// Number of cached planners.
const KEPT: usize = 8;

/// Largest considered suspended length of a sheet, L_gb.
fn longest(sheet: &Sheet) -> f64 {
    sheet.length.min(ForceManifold::LONGEST)
}

/// A method of folding.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Algorithm {
    /// Without a moment at the gripper: with least Σλ, as in the thesis, or least friction demand.
    Optimal(Objective),
    /// The smallest moment for a table with friction μ.
    Held {
        /// μ.
        friction: f64,
    },
    /// The edge on a semicircle.
    Circle,
    /// Step by step.
    StepByStep,
}

/// Plans folds of a sheet.
#[derive(Clone, Debug)]
pub struct FoldPlanner {
    sheet: Sheet,
    algorithm: Algorithm,
    atlas: FoldAtlas,
    manifold: ForceManifold,
}

impl FoldPlanner {
    /// Creates a planner, and computes the force manifold of the method.
    pub fn new(sheet: Sheet, algorithm: Algorithm) -> Self {
        let atlas = FoldAtlas::new();
        let spacing = ForceManifold::SPACING;
        let manifold = match algorithm {
            Algorithm::Held { friction } => {
                ForceManifold::held(spacing, &sheet, PART_OF_FRICTION * friction)
            }
            _ => ForceManifold::new(&atlas, spacing, longest(&sheet)),
        };
        Self {
            sheet,
            algorithm,
            atlas,
            manifold,
        }
    }

    /// Creates a planner that uses the folds of a network, for [`Objective::Sum`]. If too many of
    /// them differ from exact ones, it uses exact folds.
    ///
    /// # Errors
    /// As [`NeuralFolds::manifold`].
    pub fn by_network(
        sheet: Sheet,
        network: &NeuralFolds,
    ) -> Result<(Self, NetworkCheck), NeuralFoldError> {
        let atlas = FoldAtlas::new();
        let lengths = [sheet.least_suspended, longest(&sheet)];
        let manifold = network.manifold(&atlas, ForceManifold::SPACING, lengths)?;
        let check = NeuralFolds::check(&atlas, &manifold);
        let algorithm = Algorithm::Optimal(Objective::Sum);
        let planner = match check.is_passed() {
            false => Self::new(sheet, algorithm),
            true => Self {
                sheet,
                algorithm,
                atlas,
                manifold,
            },
        };
        Ok((planner, check))
    }

    /// The folds over which paths are searched.
    pub fn manifold(&self) -> &ForceManifold {
        &self.manifold
    }

    /// Creates a planner or returns a cached one: trials of one fold plan the same sheet
    /// repeatedly.
    pub fn shared(sheet: Sheet, algorithm: Algorithm) -> Arc<Self> {
        static MADE: Mutex<Vec<Arc<FoldPlanner>>> = Mutex::new(Vec::new());
        let made = || MADE.lock().unwrap_or_else(PoisonError::into_inner);
        let is_it = |planner: &&Arc<Self>| planner.sheet == sheet && planner.algorithm == algorithm;
        if let Some(planner) = made().iter().find(is_it) {
            return Arc::clone(planner);
        }
        let planner = Arc::new(Self::new(sheet, algorithm));
        let mut made = made();
        if made.len() >= KEPT {
            made.remove(0);
        }
        made.push(Arc::clone(&planner));
        planner
    }

    /// Poses from the flat sheet to the edge at (C̄, 0).
    ///
    /// # Errors
    /// The target cannot be reached.
    pub fn poses(&self, target: f64) -> Result<Vec<FoldPose>, FoldError> {
        match self.algorithm {
            Algorithm::Circle => Ok(circle(target)),
            Algorithm::StepByStep => step_by_step(&self.manifold, &self.sheet, target),
            _ => Ok(self.path(target)?.folds.iter().map(FoldPose::of).collect()),
        }
    }

    /// The path to the edge at (C̄, 0) with its folds.
    ///
    /// # Errors
    /// The target cannot be reached, or this method gives only poses.
    pub fn path(&self, target: f64) -> Result<FoldPath, FoldError> {
        match self.algorithm {
            Algorithm::Circle | Algorithm::StepByStep => Err(FoldError::NoPath(target)),
            Algorithm::Optimal(objective) => {
                fold_path(&self.atlas, &self.manifold, &self.sheet, target, objective)
            }
            Algorithm::Held { friction } => {
                let part = PART_OF_FRICTION * friction;
                held_path(&self.manifold, &self.sheet, target, part)
            }
        }
    }

    /// Replans the next part of a path for a sheet that has slid by `farther`, L_gb, since
    /// planning (thesis Algorithm 5). The gripper is at a planned pose, which is now behind its
    /// place on the sheet, and continues to its planned goal. Poses are relative to the sheet.
    ///
    /// # Errors
    /// No path leads there, or the gripper is beyond the end of the sheet.
    pub fn next_part(
        &self,
        at: FoldPose,
        farther: f64,
        to: FoldPose,
    ) -> Result<Vec<FoldPose>, FoldError> {
        let held = FoldPose {
            gripper: [at.gripper[0] - farther, at.gripper[1]],
            ..at
        };
        if held.gripper[0] > self.sheet.length {
            return Err(FoldError::NoPath(to.gripper[0]));
        }
        self.onwards(held, to)
    }

    /// Poses from a held pose to another, as a part of a replanned path (thesis Eq. 4.15). The
    /// path is the best one over the manifold. The initial difference of its angle from the
    /// manifold decreases along the path:
    ///
    /// > α_k + Δα (1 − k/L),  Δα = α − α(x̄, z̄)
    ///
    /// # Errors
    /// No path leads there.
    pub fn onwards(&self, held: FoldPose, to: FoldPose) -> Result<Vec<FoldPose>, FoldError> {
        let lost = FoldError::NoPath(to.gripper[0]);
        let [start, goal] = [held, to].map(|pose| self.manifold.cell(pose.gripper));
        // At the borders of the grid the nearest cell is used.
        let known = self.manifold.at(held.gripper);
        let known = known.map(|point| (point.angle, point.suspended_length));
        let of_cell = || {
            let fold = self.manifold.fold(start)?;
            Some((fold.angle, fold.suspended_length))
        };
        let (free, suspended) = known.or_else(of_cell).ok_or(lost)?;
        // A slid sheet may be bent too sharply; it must first be relaxed.
        let least = self.sheet.least_suspended.min(SHORTER * suspended);
        let sheet = Sheet {
            least_suspended: least,
            ..self.sheet
        };
        let cost = |fold: &Fold| match self.algorithm {
            Algorithm::Held { .. } => held_cost(fold, &sheet),
            Algorithm::Optimal(objective) => path_cost(fold, &sheet, objective),
            Algorithm::Circle | Algorithm::StepByStep => Some(fold.force_ratio()),
        };
        let found = uniform_cost_search(&self.manifold, &[start], goal, Objective::Sum, cost)
            .ok_or(lost)?;
        let inner = &found.0[1..found.0.len().max(2) - 1];
        let turned = held.angle - free;
        let parts = (inner.len() + 1) as f64;
        let mut poses = vec![held];
        for (index, cell) in inner.iter().enumerate() {
            let fold = self.manifold.fold(*cell).ok_or(lost)?;
            let left = 1.0 - (index + 1) as f64 / parts;
            poses.push(FoldPose {
                gripper: fold.gripper,
                angle: fold.angle + left * turned,
            });
        }
        poses.push(to);
        Ok(poses)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_replanned_rest_begins_at_the_held_edge() {
        let sheet = Sheet::A4;
        let planner = FoldPlanner::new(sheet, Algorithm::Optimal(Objective::Sum));
        let poses = planner.poses(sheet.length).unwrap();
        let [from, to] = [poses[poses.len() / 2], poses[3 * poses.len() / 4]];
        let slid = 0.1;
        let held = FoldPose {
            gripper: [from.gripper[0] - slid, from.gripper[1]],
            ..from
        };
        let rest = planner.onwards(held, to).unwrap();
        assert_eq!((rest[0], rest[rest.len() - 1]), (held, to));
        for pair in rest.windows(2) {
            let [dx, dz] = [0, 1].map(|k| pair[1].gripper[k] - pair[0].gripper[k]);
            assert!(dx.hypot(dz) < 3.0 * ForceManifold::SPACING, "{pair:?}");
            assert!((pair[1].angle - pair[0].angle).abs() < 0.3, "{pair:?}");
        }
        // A sheet that is bent too sharply is relaxed.
        let bent = FoldPose {
            gripper: [0.75, 0.55],
            angle: 2.4,
        };
        let fold = planner.manifold.at(bent.gripper).unwrap();
        assert!(fold.suspended_length < sheet.least_suspended, "{fold:?}");
        assert!(planner.onwards(bent, from).is_ok());
        // Also next to the table.
        let low = FoldPose {
            gripper: [to.gripper[0], 0.01],
            angle: to.angle,
        };
        let end = poses[poses.len() - 1];
        assert!(planner.onwards(low, end).is_ok());
        let out = FoldPose {
            gripper: [from.gripper[0] - 3.0, from.gripper[1]],
            ..from
        };
        assert!(planner.onwards(out, to).is_err());
    }
}
