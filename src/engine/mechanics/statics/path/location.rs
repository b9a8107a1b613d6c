//! Points of a path, and the directions in which it continues from there.

use crate::mechanics::rod::ReferenceFrames;
use crate::mechanics::statics::neutral::NeutralModes;
use crate::mechanics::statics::small_motions::{SmallMotions, Unstable};
use serde::{Deserialize, Serialize};

/// An equilibrium and the frames it was computed with.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Location {
    pub parameter: f64,
    pub unknowns: Vec<f64>,
    pub reference: ReferenceFrames,
    /// Small motions that grow.
    pub unstable: Unstable,
    /// Its null vectors.
    pub neutral: NeutralModes,
}

/// Direction of the path, of length 1 in the norm of [`Tracer::inner`](super::tracer::Tracer::inner).
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Tangent {
    pub unknowns: Vec<f64>,
    pub parameter: f64,
}

/// Start of another branch.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Origin {
    pub location: Location,
    /// Direction of the branch: plus or minus the null vector.
    pub direction: Tangent,
}

/// Event at a point of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PointKind {
    /// No event.
    Regular,
    /// Stability changes, and the parameter turns back.
    Fold,
    /// Stability changes, and another branch crosses.
    Bifurcation,
    /// Two small motions coincide, and oscillations begin or cease to grow.
    Flutter,
}

/// A point of the path.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PathPoint {
    /// Number of the branch; 0 is the one that starts at the start of the plan.
    pub branch: usize,
    /// The path parameter λ.
    pub parameter: f64,
    /// Bound on the difference of λ to that of the critical point; 0 if the point is not critical.
    pub parameter_error: f64,
    /// Unknowns, 4 per node.
    pub unknowns: Vec<f64>,
    /// Frames of the edges.
    pub reference: ReferenceFrames,
    /// Number of directions in which the energy decreases, or of growing small motions if forces
    /// have no energy; at a critical point, those just beyond it.
    pub negative: usize,
    /// Lowest eigenvalue of the Hessian, except those of motions without stiffness, N/m; NaN if
    /// forces have no energy. Motions are those of the nodes in m and of the edges in rad times
    /// the shortest edge.
    pub lowest_eigenvalue: f64,
    /// Small motions, if forces have no energy.
    pub motions: Option<SmallMotions>,
    /// Event at the point.
    pub kind: PointKind,
    /// Newton iterations for this point and the steps towards it.
    pub iterations: usize,
}
