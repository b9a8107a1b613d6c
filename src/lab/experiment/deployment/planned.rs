//! The model on which the plan of a gripper's path is based, and the reasons why planning may
//! fail.

use super::keys::Deployment;
use nalgebra::{Matrix2, Vector2};
use rodlab_planning::plan::deployment::{DeployedRod, DeploymentError, MOST_POSES};
use rodlab_planning::plan::pattern::{PatternError, PatternPoint, Point};
use rodlab_planning::plan::tying::TyingError;
use serde::{Deserialize, Serialize};

/// Why there is no path.
#[derive(Debug, thiserror::Error)]
pub enum PathError {
    /// The pattern is invalid.
    #[error(transparent)]
    Pattern(#[from] PatternError),
    /// The rod cannot be laid along the pattern.
    #[error(transparent)]
    Deployment(#[from] DeploymentError),
    /// No knot can be tied along the pattern.
    #[error(transparent)]
    Tying(#[from] TyingError),
    /// There is no time left.
    #[error("tying alone takes {tying_s:.1} s, but `time.end` is {end_s:?} s: increase `time.end`")]
    NoTime {
        /// Time of tying, s.
        tying_s: f64,
        /// Duration of the run, s.
        end_s: f64,
    },
    /// There is no time to bring the second rod.
    #[error(
        "bringing the second rod alone takes {brought_s} s, but only {end_s:.1} s are left for laying both rods: \
         increase `time.end`"
    )]
    NoTimeForSecond {
        /// Time of bringing, s.
        brought_s: f64,
        /// Time until both are laid, s.
        end_s: f64,
    },
    /// The path needs too many poses.
    #[error("its gripper would need {0:.1e} poses; allowed: {MOST_POSES:.0e}")]
    TooManyPoses(f64),
}

/// Model assumed by the planner: the rod, and the place of the pattern.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Planned {
    /// The rod.
    pub rod: DeployedRod,
    pivot: Vector2<f64>,
    shift: Vector2<f64>,
    turn: f64,
}

impl Planned {
    /// Model of rod and frame in the plan of a deployment of one rod. `pivot` is the first point
    /// of the first pattern, m.
    pub fn new(deployment: &Deployment, pivot: Point) -> Self {
        let rod = deployment.rod.deployed();
        Self {
            rod: DeployedRod {
                gravito_bending_length: rod.gravito_bending_length
                    * (1.0 + deployment.length_error),
                ..rod
            },
            pivot,
            shift: deployment.frame_shift.into(),
            turn: deployment.frame_turn,
        }
    }

    /// A place in the planner's model, m.
    pub fn place(&self, place: Point) -> Point {
        let (sine, cosine) = libm::sincos(self.turn);
        let turned = Matrix2::new(cosine, -sine, sine, cosine);
        self.pivot + turned * (place - self.pivot) + self.shift
    }

    /// Points of the pattern in the planner's model.
    pub fn seen(&self, mut points: Vec<PatternPoint>) -> Vec<PatternPoint> {
        for point in &mut points {
            point.position = self.place(point.position);
            point.angle += self.turn;
        }
        points
    }
}
