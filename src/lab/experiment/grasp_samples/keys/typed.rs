//! Typed samples of optimal grasps.

use crate::scenario::keys::{Dimensionless, Quantity};
use schemars::JsonSchema;
use serde::Deserialize;

/// Optimal grasps at many points of (l̄_s, κ̄, 1/k̄_s): suspended length in L_gb, curvature times L_gb, stretching compliance.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "grasp_samples")]
pub struct GraspSamples {
    /// Points at which grasps are computed.
    pub points: Option<Points>,
    /// Suspended lengths l̄_s, in L_gb. Default: 0.5 to 50. Short lengths are sampled more
    /// densely: uniform in √l̄_s.
    pub suspended_length: Option<Span>,
    /// Curvatures κ̄ of the pattern, times L_gb; mirror images have the opposite sign. Default: 0
    /// to 2.
    pub curvature: Option<Span>,
    /// Compliances 1/k̄_s = EI/(k_s L_gb²), 0 for a rod that does not stretch. Default: 0 to 0.003.
    pub stretch_compliance: Option<Span>,
}

/// Range of a number.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "span")]
pub struct Span {
    /// Smallest value of the range.
    pub from: Option<Quantity<Dimensionless>>,
    /// Largest value of the range.
    pub to: Option<Quantity<Dimensionless>>,
}

/// Points at which grasps are computed.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(tag = "kind", rename = "points")]
pub enum Points {
    /// Points of Sobol's sequence, evenly spread for any number of points.
    Sobol(Sobol),
    /// A grid that includes the borders.
    Grid(Grid),
}

/// Points of Sobol's sequence.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "sobol")]
pub struct Sobol {
    /// Number of points.
    pub count: Option<i64>,
    /// Number of the first point. Default: 0. Other parts of the sequence are other samples: for
    /// tests, or for the shares of a sweep.
    pub first: Option<i64>,
}

/// A grid of points.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "grid")]
pub struct Grid {
    /// Number of suspended lengths.
    pub suspended_lengths: Option<i64>,
    /// Number of curvatures.
    pub curvatures: Option<i64>,
    /// Number of compliances.
    pub stretch_compliances: Option<i64>,
}
