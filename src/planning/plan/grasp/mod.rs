//! Optimal grasps: position and orientation of a gripper that holds a rod hanging onto a table,
//! for which the lying part has no axial force (thesis secs. 5.2 and 5.3).
//!
//! A suspended part of length l_s rises from the contact node, where it continues the lying part: same tangent t and
//! same curvature κ. With lengths in L_gb and forces in EI/L_gb², so that EI = 1 and the weight per length is 1/2,
//!
//! > r' = (1 + n·t/k̄_s) t,  t' = M × t,  M' = −r' × n,  n' = ẑ/2
//! >
//! > r(0) = 0,  t(0) = x̂,  M(0) = κ̄ ẑ,  n(0)·x̂ = 0,  M(l̄_s) = 0
//!
//! n(s) and M(s) are the force and the moment of the material beyond s. Without a moment at the
//! gripper the force at the contact node cannot vanish, as required by thesis Eq. 5.8: the moments
//! of the suspended part about z give x_M n_y(0) = κ̄. Only its component along the lying part
//! vanishes.
//!
//! | file | what |
//! |---|---|
//! | `gauss`, `interval` | Gauss collocation, and the linearised equations on an interval |
//! | `shape` | Newton's method for the suspended rod |
//! | `mesh` | distribution of the intervals |
//! | `continuation` | from the planar rod to the requested length and curvature |
//! | `branches` | all solutions found |
//! | `stability` | the second variation |
//! | `sideways` | a push out of the plane, by linear theory |
//! | `region` | allowed positions of the gripper above a straight line |
//! | `solution` | position and rotation of the gripper |
//! | `discrete` | the same with the discrete elastic rod |
//! | `solver` | sequences of grasps |
//! | `neural` | the same by a network |

mod branches;
mod continuation;
mod discrete;
mod gauss;
mod interval;
mod mesh;
mod neural;
mod region;
mod shape;
mod sideways;
mod solution;
mod solver;
mod stability;

pub use neural::{LearnedGrasp, NeuralGrasps, hanging_height, log_length};
pub use region::{
    FreeGrasp, GraspBound, GraspStretch, PlanarGrasp, SidewaysAnswer, free_grasps, grasp_region,
    rod_along_ray,
};
pub use solution::{Grasp, contact_demand, force_of_pose};
pub use solver::{GraspMethod, GraspSolver};
pub use stability::TWIST_STIFFNESS;

use rodlab_engine::mechanics::Vector3;
use std::fmt;
use thiserror::Error;

/// Weight per length where EI = L_gb = 1: EI/w = 2 L_gb³.
const WEIGHT: f64 = 0.5;

/// Problem of a grasp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GraspProblem {
    /// l̄_s, the suspended length over L_gb.
    suspended_length: f64,
    /// κ̄, the curvature of the pattern at the contact node times L_gb; positive to the left.
    curvature: f64,
    /// 1/k̄_s.
    stretch_compliance: f64,
}

/// Why no grasp was found.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum GraspError {
    /// The suspended length is out of range.
    #[error(
        "the suspended length is {0} gravito-bending lengths: it must be between {least} and {largest}",
        least = GraspProblem::LENGTHS[0],
        largest = GraspProblem::LENGTHS[1]
    )]
    Length(f64),
    /// The curvature is out of range.
    #[error(
        "the curvature times the gravito-bending length is {0}: it must be between −{limit} and {limit}",
        limit = GraspProblem::LARGEST_CURVATURE
    )]
    Curvature(f64),
    /// The rod stretches too easily.
    #[error(
        "the stretching stiffness k_s L_gb²/EI is {0}: it must be {least} or more",
        least = GraspProblem::LEAST_STIFFNESS
    )]
    Stiffness(f64),
    /// No solution was found.
    #[error("no grasp was found for {problem}")]
    NoConvergence {
        /// The requested value.
        problem: GraspProblem,
    },
}

impl GraspProblem {
    /// Allowed suspended lengths, in L_gb.
    pub const LENGTHS: [f64; 2] = [0.1, 100.0];
    /// Largest |κ̄|.
    pub const LARGEST_CURVATURE: f64 = 12.0;
    /// Smallest k̄_s: softer rods would stretch by a large fraction of their length.
    pub const LEAST_STIFFNESS: f64 = 100.0;

    /// A rod with the suspended length l̄_s on a pattern with the curvature κ̄. The stretching
    /// stiffness k̄_s may be infinite, for a rod that does not stretch.
    ///
    /// # Errors
    /// A value is out of range.
    pub fn new(
        suspended_length: f64,
        curvature: f64,
        stretch_stiffness: f64,
    ) -> Result<Self, GraspError> {
        let [least, largest] = Self::LENGTHS;
        if !(least..=largest).contains(&suspended_length) {
            return Err(GraspError::Length(suspended_length));
        }
        if !(curvature.abs() <= Self::LARGEST_CURVATURE) {
            return Err(GraspError::Curvature(curvature));
        }
        if !(stretch_stiffness >= Self::LEAST_STIFFNESS) {
            return Err(GraspError::Stiffness(stretch_stiffness));
        }
        Ok(Self {
            suspended_length,
            curvature,
            stretch_compliance: 1.0 / stretch_stiffness,
        })
    }

    /// l̄_s.
    pub fn suspended_length(&self) -> f64 {
        self.suspended_length
    }

    /// κ̄.
    pub fn curvature(&self) -> f64 {
        self.curvature
    }

    /// k̄_s; infinite if the rod does not stretch.
    pub fn stretch_stiffness(&self) -> f64 {
        1.0 / self.stretch_compliance
    }

    /// Interpolation to another problem.
    fn towards(&self, other: &Self, part: f64) -> Self {
        let between = |from: f64, to: f64| from + part * (to - from);
        Self {
            suspended_length: between(self.suspended_length, other.suspended_length),
            curvature: between(self.curvature, other.curvature),
            stretch_compliance: between(self.stretch_compliance, other.stretch_compliance),
        }
    }
}

impl fmt::Display for GraspProblem {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(
            formatter,
            "suspended length {}, curvature {}",
            self.suspended_length, self.curvature
        )?;
        if self.stretch_compliance > 0.0 {
            write!(
                formatter,
                ", stretching stiffness {}",
                self.stretch_stiffness()
            )?;
        }
        Ok(())
    }
}
