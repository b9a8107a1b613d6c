//! Plan of an exploration, and detection of a rod that an earlier run of the same plan left
//! clamped.

use super::ray::{Ray, RayRequest};
use super::record::ExplorationPlan;
use super::row::{ExplorationRow, Found};
use super::walk::{SearchSteps, Searched};
use crate::cell::{Cell, HandPathRequest, PlanError};
use rodlab_engine::mechanics::kirchhoff::Helix;
use rodlab_files::results::{MANIFEST, ResultsError};
use rodlab_lab::experiment::ClampedRod;
use rodlab_robot::{JointTrajectory, Pose};
use rodlab_vision::ColourRule;
use std::path::Path;
use std::time::Instant;

/// Plan of an exploration.
pub struct Exploration {
    /// Index of the arm.
    pub arm: usize,
    /// The rod.
    pub rod: ClampedRod,
    /// Unit vectors (κ, τ, ω).
    pub directions: Vec<[f64; 3]>,
    /// Distance ‖(κ, τ, ω)‖ at which a search ends.
    pub farthest: f64,
    /// Least distance of arm and rod to anything else, m.
    pub margin: f64,
    /// Steps of the search.
    pub search: SearchSteps,
    /// Greatest speed of the hand on the way to the straight rod, m/s.
    pub approach_speed: f64,
    /// Colour of the markers.
    pub colour: ColourRule,
    /// Whether pictures of instabilities are saved.
    pub keeps_pictures: bool,
}

/// Reason why an exploration cannot start.
#[derive(Debug, thiserror::Error)]
pub enum ExploreError {
    /// The cell lacks something, the rod cannot be held straight, or the directory contains other
    /// results.
    #[error("{0}")]
    Input(String),
    /// The rows of an earlier exploration cannot be read.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

impl Exploration {
    /// The plan as it is written to the manifest.
    pub fn plan(&self, cell: &Cell) -> ExplorationPlan {
        let rod = &self.rod;
        ExplorationPlan {
            cell: cell.title.clone(),
            arm: cell.arms[self.arm].name.clone(),
            rod: (rod.title.clone(), rod.length, rod.radius),
            directions: self.directions.clone(),
            farthest: self.farthest,
            margin_m: self.margin,
            search: self.search,
        }
    }

    /// Joint positions in which the arm holds the straight rod.
    ///
    /// # Errors
    /// The cell has no chuck or no camera, or the arm does not reach the end of the straight rod.
    pub fn start(&self, cell: &Cell) -> Result<Vec<f64>, ExploreError> {
        let rod = &self.rod;
        let input = |words: &str| ExploreError::Input(words.into());
        let chuck = cell.chuck.ok_or_else(|| {
            input("the cell has no [chuck], which holds the fixed end of the rod")
        })?;
        if cell.camera.is_none() {
            return Err(input("the cell has no [camera] to see the rod"));
        }
        let arm = &cell.arms[self.arm];
        let end = chuck.pose * Pose::translation(rod.length, 0.0, 0.0);
        let joints = arm.chain.reach(&(arm.base.inverse() * end), &arm.home);
        let joints = joints.map_err(|nearest| {
            ExploreError::Input(format!(
                "arm {} does not reach the end of the straight rod; it comes within {:.3} m of it",
                arm.name, nearest.distance
            ))
        })?;
        let path = cell.follow_poses(&HandPathRequest {
            arm: self.arm,
            from: joints.clone(),
            poses: &[end],
            margin: self.margin,
        });
        match path.ends {
            None => Ok(joints),
            Some(words) => Err(ExploreError::Input(format!(
                "the straight rod cannot be held: {words}"
            ))),
        }
    }

    /// The ray of a direction; directions are counted from 0.
    pub fn ray(&self, cell: &Cell, start: &[f64], direction: usize) -> Ray {
        let request = RayRequest {
            cell,
            arm: self.arm,
            rod: &self.rod,
            start,
            farthest: self.farthest,
            margin: self.margin,
        };
        request.plan(Helix::from(self.directions[direction]))
    }

    /// A motion along joint positions of arm and chuck; `None` if there is only one point.
    pub fn motion(
        &self,
        cell: &Cell,
        points: &[Vec<f64>],
        speed: f64,
    ) -> Result<Option<JointTrajectory>, PlanError> {
        if points.len() < 2 {
            return Ok(None);
        }
        let chuck = cell.chuck.expect("the start was found");
        let motion = cell.motion_along(self.arm, chuck.axis, points, speed, 0.0);
        Ok(Some(motion?))
    }

    /// The row of a direction that was searched; directions are counted from 0.
    pub fn row(
        &self,
        index: usize,
        ray: &Ray,
        searched: &Searched,
        began: Instant,
    ) -> ExplorationRow {
        let [kappa, tau, omega] = self.directions[index];
        let theory = ray.theory();
        let found = searched.lost.map(|lost| 0.5 * (searched.stable + lost));
        ExplorationRow {
            direction: index + 1,
            kappa,
            tau,
            omega,
            outcome: found.map_or(Found::StaysHelix, |_| Found::Buckles),
            stable: searched.stable,
            lost: searched.lost,
            found,
            theory,
            relative_difference: found
                .zip(theory)
                .map(|(found, theory)| found / theory - 1.0),
            reach: ray.reach(),
            limit: ray.limit.clone().unwrap_or_default(),
            looks: searched.looks.len(),
            wall_time_s: began.elapsed().as_secs_f64(),
        }
    }
}

/// Whether a rod is already clamped, according to the manifest of an earlier task with the same
/// plan.
pub fn is_clamped(directory: &Path, plan: &ExplorationPlan) -> Result<bool, ExploreError> {
    let refused = |what: &str| {
        Err(ExploreError::Input(format!(
            "--out: {} {what}; choose another directory",
            directory.display()
        )))
    };
    let Ok(mut entries) = std::fs::read_dir(directory) else {
        return Ok(false);
    };
    if entries.next().is_none() {
        return Ok(false);
    }
    let text = std::fs::read(directory.join(MANIFEST)).unwrap_or_default();
    let Ok(manifest) = serde_json::from_slice::<serde_json::Value>(&text) else {
        return refused("holds something else");
    };
    // Compare the numbers as they are read back from JSON.
    let plan = serde_json::to_string(plan).expect("names and numbers are JSON values");
    let plan: serde_json::Value = serde_json::from_str(&plan).expect("as it was written");
    if manifest["plan"] != plan {
        return refused("holds another exploration");
    }
    Ok(manifest["is_clamped"] == true)
}
