//! Folds as typed.

use super::LEAST_SUSPENDED;
use super::resolved::AlgorithmName;
use crate::experiment::on_table::JITTER_PERIOD;
use crate::scenario::keys::{
    Angle, Density, Dimensionless, Length, NON_NEGATIVE, POSITIVE, Pressure, Quantity, Time, keys,
};

keys! {
    /// A sheet that a gripper folds on a table.
    table Folding "folding" {
        /// The sheet. `scenarios/papers` has those of the thesis; use them by `extends`.
        paper: raw(Paper) raw,
        /// Target of the edge: "half" (the default), the opposite edge; "diagonal-strip", the
        /// opposite corner of a square sheet, with a strip of uniform width in place of the
        /// triangle; or a distance (the thesis' C). The crease is pressed at half of the distance.
        crease: raw(Quantity<Length>) raw,
        /// Planner of the gripper's path: "optimal" (the default, the least sum of λ of thesis Eq.
        /// 4.11), "least-friction" (the smallest friction demand), "held" (the least moment at the
        /// gripper that the friction of the table allows), or the paths with which the thesis
        /// compares, "circle" (Eq. 4.17) and "step-by-step".
        algorithm: word(AlgorithmName) default(AlgorithmName::Optimal),
        /// Observes the sheet while it is folded, and replans the rest of the path if the sheet
        /// has slid. Without this table the gripper follows the path planned before the run.
        feedback: raw(Feedback) raw,
        /// Relative error of the gravito-bending length in the plan of the path. Default: 0.
        length_error: raw(Quantity<Dimensionless>) raw,
        /// Root mean square, in each direction, of a smooth random displacement of the gripper from its path. Default: none.
        jitter: number(Length, NON_NEGATIVE) default(0.0),
        /// Root mean square of a smooth random rotation of the gripper. Default: none.
        jitter_angle: number(Angle, NON_NEGATIVE) default(0.0),
        /// Period of the fastest jitter; the slowest jitter has five times this period.
        jitter_period: number(Time, POSITIVE) default(JITTER_PERIOD),
        /// Seed of the jitter, and of the noise of observations. Default: 0.
        seed: raw(i64) raw,
    }
}

keys! {
    /// Replanning of the path while the sheet is folded (thesis sec. 4.5.1, Algorithm 5).
    table Feedback "feedback" {
        /// Number of parts of the path; the camera measures after each part except the last.
        /// Default: 5, as in the thesis.
        parts: raw(i64) raw,
        /// Root mean square error of the slide measured by the camera. Default: none.
        noise: number(Length, NON_NEGATIVE) default(0.0),
    }
}

keys! {
    /// A sheet. The simulation computes a strip in the direction of the fold.
    table Paper "paper" {
        /// Length in the direction of the fold.
        length: number(Length, POSITIVE) required,
        /// Length of the side across the direction of the fold.
        width: number(Length, POSITIVE) required,
        /// Gravito-bending length L_gb = (E h²/(24 ρ g))^(1/3), which determines Young's modulus; or `youngs_modulus` with `thickness` and
        /// `density`.
        gravito_bending_length: number(Length, POSITIVE) required,
        /// Young's modulus E, if L_gb is not given.
        youngs_modulus: number(Pressure, POSITIVE) required,
        /// Thickness h. Default with a given L_gb: 0.1 mm; it affects only the thickness of the
        /// fold, and forces.
        thickness: number(Length, POSITIVE) optional,
        /// Mass per volume ρ. Default with a given L_gb: 800 kg/m³; forces are proportional to it.
        density: number(Density, POSITIVE) optional,
        /// Least suspended length of the bent sheet, in L_gb: shorter lengths crease it. Thesis
        /// sec. 4.6.5.
        least_suspended_length: number(Dimensionless, POSITIVE) default(LEAST_SUSPENDED),
        /// Static friction on a table, for `rodlab plan fold` and `rodlab fold`. A scenario uses
        /// `contact.friction` instead.
        friction: number(Dimensionless, NON_NEGATIVE) optional,
        /// Number of edges of the simulated strip. Default: twenty per gravito-bending length, at
        /// least 80 and at most 400.
        edges: raw(i64) raw,
    }
}
