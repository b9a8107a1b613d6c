//! Request and plan of a fold: the path of the gripper and its friction demand.

use super::deployment::{GripperPose, TimedPose, timed};
use super::files::trajectory_csv;
use super::fold::{
    Algorithm, FoldError, FoldPath, FoldPlanner, FoldedSheet, NetworkCheck, NeuralFoldError,
    NeuralFolds, Objective, sliding,
};
use super::fold_figures::{fold_figure, friction_figure};
use rodlab_files::figure::{Figure, Paper};
use rodlab_files::finite::NotFinite;
use serde::Serialize;
use std::fmt::Write;

/// Largest angular speed of the gripper, rad/s.
const FASTEST_TURN: f64 = 1.0;

/// Options of a fold.
#[derive(Clone, Copy, Debug)]
pub struct FoldPlanRequest<'a> {
    /// Planning method of the path of the gripper.
    pub algorithm: Algorithm,
    /// A network whose folds are used in the search for the least Σλ.
    pub network: Option<&'a NeuralFolds>,
    /// Friction of the table, if known.
    pub friction: Option<f64>,
    /// Speed of the gripper, m/s; it is lower where the gripper would turn faster than 1 rad/s.
    pub speed: f64,
}

impl Default for FoldPlanRequest<'_> {
    fn default() -> Self {
        Self {
            algorithm: Algorithm::Optimal(Objective::Sum),
            network: None,
            friction: None,
            speed: 0.05,
        }
    }
}

/// Sheets and edge displacements, m, of successive folds in half. Each folds the result of the
/// previous fold, whose gravito-bending length is larger by a factor.
pub fn halvings(
    sheet: FoldedSheet,
    target: f64,
    larger: f64,
) -> impl Iterator<Item = (FoldedSheet, f64)> {
    std::iter::successors(Some((sheet, target)), move |(sheet, target)| {
        let left = FoldedSheet {
            length: 0.5 * sheet.length,
            gravito_bending_length: sheet.gravito_bending_length * larger,
            ..*sheet
        };
        Some((left, 0.5 * target))
    })
}

impl FoldPlanRequest<'_> {
    /// The planner for the fold of a sheet, and the comparison of the network's folds with exact
    /// ones.
    ///
    /// # Errors
    /// The network cannot be used.
    pub fn planner(
        &self,
        sheet: &FoldedSheet,
    ) -> Result<(FoldPlanner, Option<NetworkCheck>), NeuralFoldError> {
        let sheet = sheet.dimensionless();
        match self.network {
            None => Ok((FoldPlanner::new(sheet, self.algorithm), None)),
            Some(network) => {
                let (planner, check) = FoldPlanner::by_network(sheet, network)?;
                Ok((planner, Some(check)))
            }
        }
    }

    /// Plans the fold of a sheet for an edge displacement, m.
    ///
    /// # Errors
    /// The target cannot be reached.
    pub fn plan(
        &self,
        planner: &FoldPlanner,
        sheet: FoldedSheet,
        target: f64,
    ) -> Result<PlannedFold, FoldError> {
        let path = planner.path(target / sheet.gravito_bending_length)?;
        let poses = sheet.poses(&path.folds);
        let length = sheet.dimensionless().length;
        let slid = self
            .friction
            .map(|friction| sliding(&path.folds, length, friction));
        let friction_demand = path.friction_demand(length);
        let times = self.times_of(&poses);
        let (slid, slides_away) = match slid.transpose() {
            Ok(slid) => (slid, None),
            Err(error) => (None, Some(error.to_string())),
        };
        let farthest = slid
            .iter()
            .flatten()
            .map(|slid| slid.abs())
            .reduce(f64::max);
        Ok(PlannedFold {
            numbers: FoldNumbers {
                poses: poses.len(),
                lifted_without_push: path.lift,
                grid_cost: path.grid_cost,
                grid_integral: path.grid_integral,
                integral: path.integral,
                largest_force_ratio: path.largest_force_ratio(),
                friction_demand,
                largest_moment: path.largest_moment(),
                friction: self.friction,
                holds: self.friction.map(|friction| friction_demand <= friction),
                slides_m: farthest.map(|farthest| farthest * sheet.gravito_bending_length),
                slides_away,
                duration_s: times.last().copied().unwrap_or(0.0),
            },
            trajectory: timed(&poses, &times),
            sheet,
            path,
            slid,
        })
    }

    /// Times of the poses of the gripper, s, from 0.
    fn times_of(&self, poses: &[GripperPose]) -> Vec<f64> {
        let mut time = 0.0;
        let steps = poses.windows(2).map(|pair| {
            let turn = pair[0].rotation.angle_to(&pair[1].rotation);
            time += ((pair[1].s - pair[0].s) / self.speed).max(turn / FASTEST_TURN);
            time
        });
        [0.0].into_iter().chain(steps).collect()
    }
}

/// A planned fold.
#[derive(Debug)]
pub struct PlannedFold {
    /// The sheet.
    pub sheet: FoldedSheet,
    /// The path of the gripper, in L_gb.
    pub path: FoldPath,
    /// The path of the gripper in metres, with times.
    pub trajectory: Vec<TimedPose>,
    /// Sliding of the sheet during the fold, in L_gb, if the friction is known and the sheet does
    /// not slide away.
    pub slid: Option<Vec<f64>>,
    /// Summary for programs.
    pub numbers: FoldNumbers,
}

/// Numbers of a planned fold.
#[derive(Clone, Debug, Default, Serialize)]
pub struct FoldNumbers {
    poses: usize,
    lifted_without_push: usize,
    grid_cost: f64,
    grid_integral: f64,
    integral: f64,
    largest_force_ratio: f64,
    friction_demand: f64,
    /// In EI/L_gb.
    largest_moment: f64,
    friction: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    holds: Option<bool>,
    /// Largest during the fold.
    #[serde(skip_serializing_if = "Option::is_none")]
    slides_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    slides_away: Option<String>,
    duration_s: f64,
}

impl PlannedFold {
    /// The files of a plan: the trajectory, its folds, and figures of both.
    ///
    /// # Errors
    /// A pose is not finite.
    pub fn files(&self, planner: &FoldPlanner) -> Result<Vec<(&'static str, Vec<u8>)>, NotFinite> {
        let length = self.sheet.dimensionless().length;
        let svg = |figure: Figure| figure.svg(&Paper::default()).into_bytes();
        let fold = fold_figure(&self.path, planner.manifold(), length);
        let friction = self.numbers.friction;
        let friction = friction_figure(&self.path, length, friction, self.slid.as_deref());
        Ok(vec![
            (
                "trajectory.csv",
                trajectory_csv(&self.trajectory)?.into_bytes(),
            ),
            ("folds.csv", self.folds_csv().into_bytes()),
            ("fold.svg", svg(fold)),
            ("friction.svg", svg(friction)),
        ])
    }

    /// Columns x, z, suspended length (m), alpha_rad, lambda, friction_demand, the forces in
    /// EI/L_gb² as in `rodlab solve fold`, and the moment at the gripper in EI/L_gb.
    fn folds_csv(&self) -> String {
        let mut text = String::from(
            "x_m,z_m,suspended_length_m,alpha_rad,lambda,friction_demand,\
             horizontal_force_ei_per_lgb2,vertical_force_ei_per_lgb2,moment_ei_per_lgb\n",
        );
        let length = self.sheet.dimensionless().length;
        for fold in &self.path.folds {
            let [x, z, suspended] = [fold.gripper[0], fold.gripper[1], fold.suspended_length]
                .map(|value| value * self.sheet.gravito_bending_length);
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "{x:.9},{z:.9},{suspended:.9},{:.9},{:.9},{:.9},{:.9},{:.9},{:.9}",
                fold.angle,
                fold.force_ratio(),
                fold.friction_demand(length),
                // Adding zero removes the sign of negative zero.
                fold.forces.horizontal + 0.0,
                fold.forces.vertical + 0.0,
                (1e9 * fold.moment).round() / 1e9 + 0.0
            );
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::fold::FoldAtlas;

    #[test]
    fn forces_of_a_plan_are_in_the_unit_of_a_single_fold() {
        let fold = FoldAtlas::new().solve([3.4, 1.7]).unwrap();
        let plan = PlannedFold {
            sheet: FoldedSheet {
                gravito_bending_length: 0.05,
                length: 0.3,
                least_suspended: 0.958,
            },
            path: FoldPath {
                folds: vec![fold],
                lift: 0,
                grid_cost: 0.0,
                grid_integral: 0.0,
                integral: 0.0,
            },
            trajectory: vec![],
            slid: None,
            numbers: FoldNumbers::default(),
        };
        let text = plan.folds_csv();
        let (header, row) = text.trim_end().split_once('\n').unwrap();
        let cell = |name: &str| -> f64 {
            let place = header.split(',').position(|column| column == name).unwrap();
            row.split(',').nth(place).unwrap().parse().unwrap()
        };
        let forces = fold.forces;
        assert!((cell("horizontal_force_ei_per_lgb2") - forces.horizontal).abs() < 1e-9);
        assert!((cell("vertical_force_ei_per_lgb2") - forces.vertical).abs() < 1e-9);
    }
}
