//! A row of `samples.csv`.

use serde::{Deserialize, Serialize};

/// Whether a grasp was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// It was.
    Found,
    /// Newton's method did not converge.
    NoConvergence,
}

/// A row of `samples.csv`: lengths in L_gb, forces in EI/L_gb².
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Sample {
    /// l̄_s.
    pub suspended_length: f64,
    /// κ̄.
    pub curvature: f64,
    /// 1/k̄_s.
    pub stretch_compliance: f64,
    /// ln(1 + l̄_s).
    pub log_length: f64,
    /// Whether there is a grasp.
    pub outcome: Outcome,
    /// Position of the gripper.
    pub x: Option<f64>,
    /// Position of the gripper.
    pub y: Option<f64>,
    /// Position of the gripper.
    pub z: Option<f64>,
    /// Length l̄_s including its stretch by the weight, minus the height of the gripper.
    pub drop: Option<f64>,
    /// y over κ̄.
    pub y_per_curvature: Option<f64>,
    /// Rotation vector of the gripper (axis times angle), rad.
    pub rotation_x: Option<f64>,
    /// Component of the rotation vector, rad.
    pub rotation_y: Option<f64>,
    /// Component of the rotation vector, rad.
    pub rotation_z: Option<f64>,
    /// First component of the rotation vector over κ̄, rad.
    pub rotation_x_per_curvature: Option<f64>,
    /// Last component of the rotation vector over κ̄, rad.
    pub rotation_z_per_curvature: Option<f64>,
    /// Force at the contact node.
    pub force_y: Option<f64>,
    /// Force at the contact node.
    pub force_z: Option<f64>,
    /// Whether the hanging rod is stable.
    pub stable: Option<bool>,
    /// Residual of the equations.
    pub residual: Option<f64>,
}
