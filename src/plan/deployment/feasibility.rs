//! What a pattern asks of rod and table.

use super::{DeployedRod, DeploymentError};
use crate::plan::grasp::GraspProblem;
use crate::plan::pattern::{Pattern, PatternPoint};

/// Friction that a lead-in may ask for.
const LEAD_IN_DEMAND: f64 = 0.1;
/// Largest |d²κ/dx²| of the lead-in's curvature over x = s/ℓ, of a pattern that goes on with constant curvature 1.
const LEAD_IN_BEND: f64 = 5.7735;
/// Curvature times L_gb below which a pattern starts straight.
const STRAIGHT: f64 = 0.02;

/// The coefficient of friction that holds a lying rod in its curve: k_b|κ''|/(ρ A g) = 2 L_gb³|κ''| (thesis Eq. 5.2).
pub fn friction_demand(rod: &DeployedRod, point: &PatternPoint) -> f64 {
    2.0 * rod.gravito_bending_length.powi(3) * point.curvature_bend.abs()
}

/// Length of the lead-in that a pattern needs which starts with this curvature, m: zero where that is nearly none.
pub fn lead_in_length(rod: &DeployedRod, curvature: f64) -> f64 {
    let unit = rod.gravito_bending_length;
    let bent = curvature.abs() * unit;
    if bent < STRAIGHT {
        0.0
    } else {
        unit * (2.0 * LEAD_IN_BEND * bent / LEAD_IN_DEMAND).sqrt()
    }
}

/// Whether the gripper still has something to hold when the pattern ends.
///
/// # Errors
/// [`DeploymentError::TooLong`].
pub fn long_enough(rod: &DeployedRod, pattern: &Pattern) -> Result<(), DeploymentError> {
    let (length, lead_in) = (pattern.length(), pattern.lead_in());
    let least = length + GraspProblem::LENGTHS[0] * rod.gravito_bending_length;
    if rod.length >= least {
        return Ok(());
    }
    Err(DeploymentError::TooLong {
        pattern_m: length,
        lead_in: if lead_in > 0.0 {
            format!(" with a lead-in of {lead_in:.4} m (`lead_in`)")
        } else {
            String::new()
        },
        rod_m: rod.length,
        least_m: least,
    })
}

/// What a pattern asks for, at worst.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feasibility {
    /// Least radius of curvature, m; infinite for a straight line.
    pub least_radius_m: f64,
    /// Where, m from the start.
    pub least_radius_at_m: f64,
    /// Largest friction demand.
    pub largest_demand: f64,
    /// Where, m from the start.
    pub largest_demand_at_m: f64,
    /// Part of the length whose demand is above a coefficient of friction, if there was one.
    pub share_above_friction: Option<f64>,
}

/// Least number of points at which a pattern is checked, and most.
const CHECKED_POINTS: [f64; 2] = [8000.0, 400_000.0];

impl Feasibility {
    /// Checks a pattern whose poses lie `spacing` (m) apart at closer points, for corners may lie between poses; `friction`
    /// is that of the table.
    ///
    /// # Errors
    /// The pattern is too sharp for the rod. That it slides is no error: it is said.
    pub fn of(
        pattern: &Pattern,
        spacing: f64,
        rod: &DeployedRod,
        friction: Option<f64>,
    ) -> Result<Self, DeploymentError> {
        let [least, most] = CHECKED_POINTS.map(|count| pattern.length() / count);
        let close = spacing.min(0.25 * rod.radius).min(least).max(most);
        Self::at(&pattern.sampled(close), rod, friction)
    }

    fn at(
        points: &[PatternPoint],
        rod: &DeployedRod,
        friction: Option<f64>,
    ) -> Result<Self, DeploymentError> {
        let demand = |point: &PatternPoint| friction_demand(rod, point);
        let worst = |value: &dyn Fn(&PatternPoint) -> f64| {
            let values = points.iter().map(|point| (value(point), point.s));
            values.fold(
                (0.0, 0.0),
                |most, here| if here.0 > most.0 { here } else { most },
            )
        };
        let (sharpest, sharpest_at) = worst(&|point| point.curvature.abs());
        let (largest_demand, largest_demand_at_m) = worst(&demand);
        let found = Self {
            least_radius_m: 1.0 / sharpest,
            least_radius_at_m: sharpest_at,
            largest_demand,
            largest_demand_at_m,
            share_above_friction: friction.map(|friction| {
                let above = points.iter().filter(|point| demand(point) > friction);
                above.count() as f64 / points.len().max(1) as f64
            }),
        };
        if found.least_radius_m < rod.radius {
            return Err(DeploymentError::TooSharp {
                radius_m: found.least_radius_m,
                s_m: sharpest_at,
                rod_m: rod.radius,
            });
        }
        Ok(found)
    }
}
