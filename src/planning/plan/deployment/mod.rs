//! Deployment of a rod along a pattern: the trajectory of the gripper (thesis Algorithm 9), and its
//! demands on the table.
//!
//! | file | what |
//! |---|---|
//! | `rod` | the rod by its gravito-bending length and radius |
//! | `trajectory` | poses of the gripper |
//! | `laid_path` | the whole path along which a rod is laid |
//! | `timing` | timing of the gripper |
//! | `feasibility` | friction, bending and length that the pattern needs |
//! | `lying` | the least friction that can hold the lying rod |
//! | `spare` | the surplus of a rod that is longer than its pattern |
//! | `landing` | the hanging rod at the start |
//! | `corrected_path` | the path of the gripper, replanned during laying |
//! | `correction` | the rest of the path from the observed position of the rod |
//! | `figure` | pattern, path of the gripper and friction demand |

mod corrected_path;
mod correction;
#[cfg(test)]
mod demand_tests;
mod feasibility;
mod figure;
mod laid_path;
mod landing;
mod lying;
mod rod;
mod spare;
mod timing;
mod trajectory;

pub use corrected_path::CorrectedPath;
pub use correction::{ObservedContact, corrected_length, return_curve};
pub use feasibility::{
    Feasibility, can_be_held, checked_points, friction_demands, lead_length, long_enough,
};
pub use figure::deployment_figure;
pub use laid_path::LaidPath;
pub use landing::hanging_rod;
pub use rod::DeployedRod;
pub use spare::{SUSPENDED, Spare, falls_straight, with_spare_laid};
pub use timing::{TimedPose, laid_after, timed, times, when_laid};
pub use trajectory::{
    GripperPose, OptimalGrasps, Scheme, Trajectory, checked_trajectory, network_trajectory,
    trajectory,
};

use crate::plan::grasp::{GraspError, GraspProblem};
use std::fmt;
use thiserror::Error;

/// Maximum number of poses of a trajectory.
pub const MOST_POSES: f64 = 100_000.0;

/// The curve laid before or after a pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lead {
    /// In front.
    In,
    /// Behind.
    Out,
}

impl Lead {
    /// How to omit it, as text.
    fn without(self) -> &'static str {
        match self {
            Self::In => "--lead-in none, or `lead_in = 0` in a scenario",
            Self::Out => "--lead-out none",
        }
    }
}

impl fmt::Display for Lead {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::In => "lead-in",
            Self::Out => "lead-out",
        })
    }
}

/// Reason why a rod cannot be laid along a pattern.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DeploymentError {
    /// The rod is too short.
    #[error(
        "the pattern is {pattern_m:.4} m long{lead_in}, and the rod {rod_m} m: the rod must be at least {least_m:.4} m long, so that \
         the gripper can still hold it at the end"
    )]
    TooLong {
        /// Length of the pattern, m.
        pattern_m: f64,
        /// Note on the lead-in, as text.
        lead_in: String,
        /// Length of the rod, m.
        rod_m: f64,
        /// Least length of the rod, m.
        least_m: f64,
    },
    /// There is no grasp of the whole rod.
    #[error(
        "the rod is {rod_m} m long; allowed: {least_m:.4} m to {most_m:.4} m, that is {least} to {most} \
         gravito-bending lengths of {unit_m} m",
        least = GraspProblem::LENGTHS[0],
        most = GraspProblem::LENGTHS[1]
    )]
    RodLength {
        /// Length of the rod, m.
        rod_m: f64,
        /// Its gravito-bending length, m.
        unit_m: f64,
        /// Least length, m.
        least_m: f64,
        /// Largest length, m.
        most_m: f64,
    },
    /// The radius of curvature of the pattern is smaller than the radius of the rod.
    #[error(
        "the pattern has a radius of {radius_m:.2e} m at {s_m:.4} m, less than the rod's, {rod_m} m: draw its corners \
         round, or allow a larger `deviation`"
    )]
    TooSharp {
        /// Least radius of curvature, m.
        radius_m: f64,
        /// Position of the least radius, m from the start.
        s_m: f64,
        /// Radius of the rod, m.
        rod_m: f64,
    },
    /// A lead is bent more sharply than allowed.
    #[error(
        "the {lead} bends to a radius of {radius_m:.2e} m at {s_m:.4} m; allowed: at least three \
         radii of the rod, {least_m:.4} m. The {lead} is too tight, not the drawing: shorten it, or leave it out ({})",
        lead.without()
    )]
    SharpLead {
        /// Which.
        lead: Lead,
        /// Least radius of curvature of the lead, m.
        radius_m: f64,
        /// Position of the least radius, m from the start.
        s_m: f64,
        /// The smallest allowed radius, m.
        least_m: f64,
    },
    /// There is no grasp at some point.
    #[error("at {s_m:.4} m from the start of the pattern: {error}")]
    Grasp {
        /// Arc length, m.
        s_m: f64,
        /// The error.
        error: GraspError,
    },
    /// A network failed.
    #[error("{0}")]
    Network(String),
    /// A pose has numbers that are not finite.
    #[error(
        "at {s_m:.4} m from the start of the pattern the pose of the gripper has numbers that are not finite"
    )]
    NotFinite {
        /// Arc length, m.
        s_m: f64,
    },
}
