//! Folds as resolved.

use rodlab_planning::plan::fold::{Algorithm, FoldedSheet, Objective};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};

/// A sheet that a gripper folds on a table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Folding {
    /// Planner of the gripper's path.
    pub algorithm: AlgorithmName,
    /// Target of the edge.
    pub crease: Crease,
    /// Relative error of the gravito-bending length assumed by the planner.
    pub length_error: f64,
    /// Root mean square of the gripper's displacement in each direction, m.
    pub jitter: f64,
    /// Root mean square of its rotation, rad.
    pub jitter_angle: f64,
    /// Period of the fastest jitter, s.
    pub jitter_period: f64,
    /// Seed of the jitter, and of the noise of observations.
    pub seed: u64,
    /// Replanning of the rest of the path, if enabled.
    pub feedback: Option<Feedback>,
    /// The sheet.
    pub paper: Paper,
}

/// Settings for replanning a path while the sheet is folded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Feedback {
    /// Parts of the path.
    pub parts: usize,
    /// Root mean square error of the observed slide, m.
    pub noise: f64,
}

/// Target of the edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Crease {
    /// Onto the opposite edge.
    Half,
    /// A corner onto the opposite one; a strip of uniform width replaces the triangle.
    Diagonal,
    /// So far, m.
    At(f64),
}

impl Crease {
    /// The key word for a fold along the diagonal.
    pub const DIAGONAL_STRIP: &str = "diagonal-strip";
    /// Reason why `diagonal` alone is rejected.
    pub const NO_DIAGONAL: &str = "a sheet that is folded along its diagonal is a triangle, whose stiffness and weight grow from the corner, \
        and folds are computed only for sheets of uniform width; \"diagonal-strip\" uses a strip of uniform width instead, as the thesis does";
}

impl Serialize for Crease {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Half => serializer.serialize_str("half"),
            Self::Diagonal => serializer.serialize_str(Self::DIAGONAL_STRIP),
            Self::At(target) => serializer.serialize_f64(*target),
        }
    }
}

/// Planners of a fold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum AlgorithmName {
    /// The path with the least sum of λ (thesis Eq. 4.11).
    Optimal,
    /// The path with the smallest friction demand.
    LeastFriction,
    /// The path with the least moment at the gripper that the friction of the table allows.
    Held,
    /// The edge on a semicircle (thesis Eq. 4.17).
    Circle,
    /// Each step by itself.
    StepByStep,
}

impl AlgorithmName {
    /// Whether the rest of such a path can be replanned.
    pub fn can_replan(self) -> bool {
        !matches!(self, Self::Circle | Self::StepByStep)
    }

    /// The planner's algorithm, on a table with friction μ.
    pub fn on(self, friction: f64) -> Algorithm {
        match self {
            Self::Optimal => Algorithm::Optimal(Objective::Sum),
            Self::LeastFriction => Algorithm::Optimal(Objective::Largest),
            Self::Held => Algorithm::Held { friction },
            Self::Circle => Algorithm::Circle,
            Self::StepByStep => Algorithm::StepByStep,
        }
    }
}

/// A sheet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Paper {
    /// Length of the sheet, m.
    pub length: f64,
    /// Length of the side across the direction of the fold, m.
    pub width: f64,
    /// L_gb, m.
    pub gravito_bending_length: f64,
    /// Thickness, m.
    pub thickness: f64,
    /// Mass per volume, kg/m³.
    pub density: f64,
    /// Least suspended length of the bent sheet, in L_gb.
    pub least_suspended_length: f64,
    /// Static friction on a table, if given.
    pub friction: Option<f64>,
    /// Number of edges of the simulated strip.
    pub edges: usize,
}

impl Paper {
    /// The sheet, folded in the direction of its length, or along its diagonal.
    pub fn sheet(&self, crease: Crease) -> FoldedSheet {
        FoldedSheet {
            gravito_bending_length: self.gravito_bending_length,
            length: if crease == Crease::Diagonal {
                libm::hypot(self.length, self.width)
            } else {
                self.length
            },
            least_suspended: self.least_suspended_length,
        }
    }

    /// Distance that the edge moves, m.
    ///
    /// The sheet is folded along its diagonal and is not square, or the target is beyond the
    /// opposite edge.
    pub fn target(&self, crease: Crease) -> Result<f64, String> {
        let length = self.sheet(crease).length;
        match crease {
            Crease::Diagonal if (self.length - self.width).abs() > 1e-6 * self.length => {
                Err(format!(
                    "the sheet is {} m by {} m; only a square sheet is folded along its diagonal",
                    self.length, self.width
                ))
            }
            Crease::At(target) if target > length => Err(format!(
                "{target} m: the sheet is {length} m long, and its edge cannot go beyond the opposite one"
            )),
            Crease::At(target) => Ok(target),
            Crease::Half | Crease::Diagonal => Ok(length),
        }
    }
}

impl Folding {
    /// The sheet in the direction of the fold.
    pub fn sheet(&self) -> FoldedSheet {
        self.paper.sheet(self.crease)
    }

    /// The sheet as the planner assumes it.
    pub fn believed(&self) -> FoldedSheet {
        let sheet = self.sheet();
        FoldedSheet {
            gravito_bending_length: sheet.gravito_bending_length * (1.0 + self.length_error),
            ..sheet
        }
    }

    /// Distance that the edge moves, m.
    pub fn target(&self) -> f64 {
        match self.crease {
            Crease::At(target) => target,
            Crease::Half | Crease::Diagonal => self.sheet().length,
        }
    }
}
