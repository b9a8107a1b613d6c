//! Folds as typed.

use super::resolved::AlgorithmName;
use crate::scenario::keys::{Angle, Density, Dimensionless, Length, Pressure, Quantity, Time};
use schemars::JsonSchema;
use serde::Deserialize;

/// A sheet that a gripper folds on a table.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "folding")]
pub struct Folding {
    /// The sheet. `scenarios/papers` has those of the thesis, to be taken over by `extends`.
    pub paper: Option<Paper>,
    /// Where the edge goes: "half" (the default), onto the opposite edge; "diagonal-strip", a corner of a square sheet onto the
    /// opposite one, of a strip of one width in place of the triangle; or how far (the thesis' C). The crease is pressed half way.
    pub crease: Option<Quantity<Length>>,
    /// How the way of the gripper is planned: "optimal" (the default, the least sum of λ of thesis Eq. 4.11), "least-friction" (the
    /// smallest friction demand), "held" (with as little moment at the gripper as the friction of the table needs), or the ways that the thesis
    /// compares with, "circle" (Eq. 4.17) and "step-by-step".
    pub algorithm: Option<AlgorithmName>,
    /// Looks at the sheet while it is folded, and plans the rest anew where it has slid. Without this table the path is that which was
    /// planned before.
    pub feedback: Option<Feedback>,
    /// Relative error of the gravito-bending length for which the path is planned. Default: 0.
    pub length_error: Option<Quantity<Dimensionless>>,
    /// Root mean square, in each direction, of a smooth random displacement of the gripper from its path. Default: none.
    pub jitter: Option<Quantity<Length>>,
    /// Root mean square of a smooth random turn of the gripper. Default: none.
    pub jitter_angle: Option<Quantity<Angle>>,
    /// Period of the fastest jitter; the slowest takes five times as long. Default: 1 s.
    pub jitter_period: Option<Quantity<Time>>,
    /// Seed of the jitter, and of the noise of observations. Default: 0.
    pub seed: Option<i64>,
}

/// A path that is planned anew while the sheet is folded (thesis sec. 4.5.1, Algorithm 5).
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "feedback")]
pub struct Feedback {
    /// Parts of the path; after each but the last the camera looks. Default: 5, as in the thesis.
    pub parts: Option<i64>,
    /// Root mean square by which the camera sees wrongly how far the sheet has slid. Default: none.
    pub noise: Option<Quantity<Length>>,
}

/// A sheet, of which a strip in the direction of the fold is simulated.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "paper")]
pub struct Paper {
    /// Length in the direction of the fold.
    pub length: Option<Quantity<Length>>,
    /// The side that stays as it is.
    pub width: Option<Quantity<Length>>,
    /// Gravito-bending length L_gb = (E h²/(24 ρ g))^(1/3), by which Young's modulus is known; or `youngs_modulus` with `thickness` and
    /// `density`.
    pub gravito_bending_length: Option<Quantity<Length>>,
    /// Young's modulus E, where L_gb is not given.
    pub youngs_modulus: Option<Quantity<Pressure>>,
    /// Thickness h. Default where L_gb is given: 0.1 mm; it matters only for how thick the fold is, and for forces.
    pub thickness: Option<Quantity<Length>>,
    /// Mass per volume ρ. Default where L_gb is given: 800 kg/m³; forces are in proportion to it.
    pub density: Option<Quantity<Density>>,
    /// Least suspended length while the sheet is bent, in L_gb: shorter ones crease it. Default: 0.958 (thesis sec. 4.6.5).
    pub least_suspended_length: Option<Quantity<Dimensionless>>,
    /// Static friction on a table, for `rodlab plan fold` and `rodlab fold`. The table of a scenario has that of `contact.friction`.
    pub friction: Option<Quantity<Dimensionless>>,
    /// Edges of the simulated strip. Default: twenty to a gravito-bending length, 80 at least and 400 at most.
    pub edges: Option<i64>,
}
