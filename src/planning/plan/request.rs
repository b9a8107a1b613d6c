//! Request and plan of a deployment: from the source of its pattern to the path of the gripper and
//! the demands.

use super::deployment::{
    DeployedRod, DeploymentError, Feasibility, LaidPath, MOST_POSES, OptimalGrasps, Scheme, Spare,
    can_be_held, checked_points, friction_demands, lead_length, long_enough, times,
    with_spare_laid,
};
use super::pattern::{Crossing, Pattern, PatternError, PatternSource, crossings};
use super::tying::{Pass, Passage, TiedRod, TyingError, laid_length, passages};
use thiserror::Error;

/// Length of a lead-in or a lead-out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum LeadLength {
    /// Automatic.
    #[default]
    Auto,
    /// A length, m.
    Given(f64),
}

/// Options for laying a rod along a pattern.
#[derive(Clone, Debug)]
pub struct DeploymentRequest<'a> {
    /// The lead-in before the pattern.
    pub lead_in: LeadLength,
    /// The lead-out after the pattern. By default it takes as much of the surplus of the rod as
    /// there is space for.
    pub lead_out: LeadLength,
    /// Largest distance of adjacent poses along the pattern, m.
    pub step: f64,
    /// Speed of laying, m/s.
    pub speed: f64,
    /// Scheme of the gripper.
    pub scheme: Scheme,
    /// Solver for the optimal grasps.
    pub grasps: OptimalGrasps<'a>,
    /// Friction of the table, if known.
    pub friction: Option<f64>,
    /// Passes of the rod at its crossings for a knot; empty otherwise.
    pub knot: Vec<Pass>,
}

impl Default for DeploymentRequest<'_> {
    fn default() -> Self {
        Self {
            lead_in: LeadLength::Auto,
            lead_out: LeadLength::Auto,
            step: 3e-3,
            speed: 0.02,
            scheme: Scheme::Optimal,
            grasps: OptimalGrasps::Exact,
            friction: None,
            knot: Vec::new(),
        }
    }
}

/// Why planning failed.
#[derive(Debug, Error)]
pub enum RequestError {
    /// The pattern is invalid.
    #[error(transparent)]
    Pattern(#[from] PatternError),
    /// The rod cannot be laid along the pattern.
    #[error(transparent)]
    Deployment(#[from] DeploymentError),
    /// No knot can be tied along the pattern.
    #[error(transparent)]
    Tying(#[from] TyingError),
    /// The path needs too many poses.
    #[error("a distance of {step} m cuts {length:.4} m into more than {MOST_POSES} poses")]
    TooManyPoses {
        /// Distance of poses, m.
        step: f64,
        /// Length of the path, m.
        length: f64,
    },
}

/// A planned deployment.
pub struct PlannedDeployment {
    /// The path of the gripper.
    pub path: LaidPath,
    /// The pattern along which the rod is laid, with lead-in and lead-out.
    pub pattern: Pattern,
    /// Length of the lead-in over which the curvature grows, m.
    pub bent: f64,
    /// Times of the poses of the gripper, s.
    pub times: Vec<f64>,
    /// The largest demands of the pattern.
    pub feasibility: Feasibility,
    /// Friction demand of the pattern at each point.
    pub demands: Vec<f64>,
    /// Self-crossings of the pattern.
    pub crossings: Vec<Crossing>,
    /// For a knot, the whole pattern, including the path of the end of the rod, and its crossings.
    pub knot: Option<(Pattern, Vec<Passage>)>,
}

impl DeploymentRequest<'_> {
    /// Plans the deployment; `spare` is the treatment of a rod that is longer than its pattern.
    ///
    /// # Errors
    /// The pattern is invalid, or the rod cannot be laid or tied along it.
    pub fn plan(
        &self,
        source: &PatternSource,
        rod: &DeployedRod,
        spare: &Spare<'_>,
    ) -> Result<PlannedDeployment, RequestError> {
        self.refuse_rod(rod)?;
        let pattern = self.pattern(source, rod)?;
        let (bent, length) = (pattern.lead_in(), pattern.length());
        let knot = match self.knot[..] {
            [] => None,
            _ => Some((
                self.pattern(source, rod)?,
                self.passages(&[(rod, &pattern)])?,
            )),
        };
        let pattern = match (&knot, self.lead_out) {
            (Some(_), _) => pattern.shortened(laid_length(rod)),
            (None, LeadLength::Auto) => with_spare_laid(pattern, rod, spare),
            (None, LeadLength::Given(lead_out)) => {
                let last = pattern.at(length);
                pattern.with_lead_out(lead_length(rod, &last.turned_round()), lead_out)
            }
        };
        self.refuse_long(&pattern, rod)?;
        let checked = checked_points(&pattern, self.step, rod)?;
        let path = LaidPath::along(&pattern, length, rod, self.step, (self.scheme, self.grasps))?;
        Ok(PlannedDeployment {
            bent,
            times: times(&path.poses, self.speed),
            feasibility: Feasibility::of(&checked, rod, self.friction, &path.poses),
            demands: friction_demands(rod, &path.points, &path.poses),
            crossings: crossings(&path.points),
            pattern,
            path,
            knot,
        })
    }

    /// The pattern with its lead-in.
    ///
    /// # Errors
    /// The pattern is invalid.
    pub fn pattern(
        &self,
        source: &PatternSource,
        rod: &DeployedRod,
    ) -> Result<Pattern, PatternError> {
        let pattern = source.pattern()?;
        let length = match self.lead_in {
            LeadLength::Given(length) => length,
            LeadLength::Auto => lead_length(rod, &pattern.at(0.0)),
        };
        Ok(pattern.with_lead_in(length))
    }

    /// One rod of a knot of several rods: its whole pattern, and the path along which it is laid
    /// before its end is moved.
    ///
    /// # Errors
    /// The pattern is invalid, or the rod cannot be laid along it.
    pub fn tied(
        &self,
        source: &PatternSource,
        rod: &DeployedRod,
    ) -> Result<(Pattern, LaidPath), RequestError> {
        self.refuse_rod(rod)?;
        let laid = self.pattern(source, rod)?.shortened(laid_length(rod));
        self.refuse_long(&laid, rod)?;
        let way = (self.scheme, OptimalGrasps::Exact);
        let path = LaidPath::along(&laid, laid.length(), rod, self.step, way)?;
        Ok((self.pattern(source, rod)?, path))
    }

    /// The crossings of a knot of rods that are laid along whole patterns.
    ///
    /// # Errors
    /// The knot cannot be tied.
    pub fn passages(&self, rods: &[(&DeployedRod, &Pattern)]) -> Result<Vec<Passage>, TyingError> {
        let tied = rods.iter().map(|(rod, curve)| TiedRod { rod, curve });
        passages(&tied.collect::<Vec<_>>(), &self.knot)
    }

    /// Only the optimal scheme needs grasps.
    fn refuse_rod(&self, rod: &DeployedRod) -> Result<(), DeploymentError> {
        match self.scheme {
            Scheme::Optimal => can_be_held(rod),
            Scheme::Intuitive => Ok(()),
        }
    }

    /// Checked before sampling, since the pattern may be very long.
    fn refuse_long(&self, pattern: &Pattern, rod: &DeployedRod) -> Result<(), RequestError> {
        long_enough(rod, pattern)?;
        let (step, length) = (self.step, pattern.length());
        match length / step > MOST_POSES {
            true => Err(RequestError::TooManyPoses { step, length }),
            false => Ok(()),
        }
    }
}
