//! `rodlab solve fold`.

use super::answers::Answers;
use super::prelude::*;
use rodlab_planning::plan::fold::{Fold, FoldAtlas, FoldError};
use std::ops::RangeInclusive;

/// Smallest and largest number of edges of a discrete rod. Beyond it, round-off exceeds the error
/// of the mesh.
const EDGES: RangeInclusive<usize> = 10..=5000;

/// Arguments of `rodlab solve fold`.
#[derive(Debug, Args)]
pub struct FoldArguments {
    /// x̄: distance by which the edge has moved towards the sheet, over the gravito-bending length
    #[arg(long, value_name = "X", allow_hyphen_values = true)]
    x: f64,
    /// z̄: height of the edge above the table, over the gravito-bending length
    #[arg(long, value_name = "Z", allow_hyphen_values = true)]
    z: f64,
    /// Method of solution
    #[arg(long, default_value = "theory")]
    method: Method,
    /// Edges of the discrete rod
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = edges(EDGES))]
    edges: usize,
    /// Return all solutions found, starting with the one returned without --all
    #[arg(long)]
    all: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Method {
    /// Initial values of the continuous sheet.
    Theory,
    /// The planar discrete elastic rod.
    Der,
}

/// A fold, dimensionless.
#[derive(Serialize)]
pub struct Answer {
    x: f64,
    z: f64,
    method: Method,
    lambda: f64,
    alpha: f64,
    suspended_length: f64,
    horizontal_force: f64,
    vertical_force: f64,
    stable: bool,
    unstable_modes: usize,
}

impl FoldArguments {
    /// Finds the fold, or all folds.
    pub fn solve(&self) -> Result<Answers<Answer>, Failure> {
        for (flag, value) in [("--x", self.x), ("--z", self.z)] {
            if !value.is_finite() {
                return Err(Failure::Input(format!(
                    "{flag} {value}: expected a finite number"
                )));
            }
        }
        let atlas = FoldAtlas::new();
        let gripper = [self.x, self.z];
        let folds = match (self.method, self.all) {
            (Method::Theory, true) => atlas.solve_all(gripper)?,
            (Method::Theory, false) => vec![atlas.solve(gripper)?],
            (Method::Der, true) => {
                let folds = atlas.solve_all(gripper)?;
                let discrete = folds.iter().map(|fold| fold.discrete(self.edges));
                discrete.collect::<Result<_, _>>()?
            }
            (Method::Der, false) => vec![atlas.solve(gripper)?.discrete(self.edges)?],
        };
        let mut answers: Vec<Answer> = folds.iter().map(|fold| self.answer(fold)).collect();
        Ok(match (self.all, answers.pop()) {
            (false, Some(answer)) => Answers::One(answer),
            (_, last) => Answers::All {
                solutions: answers.into_iter().chain(last).collect(),
            },
        })
    }

    fn answer(&self, fold: &Fold) -> Answer {
        let unstable_modes = fold.unstable_modes();
        Answer {
            x: fold.gripper[0],
            z: fold.gripper[1],
            method: self.method,
            lambda: fold.force_ratio(),
            alpha: fold.angle,
            suspended_length: fold.suspended_length,
            horizontal_force: fold.forces.horizontal,
            vertical_force: fold.forces.vertical,
            stable: unstable_modes == 0,
            unstable_modes,
        }
    }
}

impl From<FoldError> for Failure {
    fn from(error: FoldError) -> Self {
        Self::input(error)
    }
}
