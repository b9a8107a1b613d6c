//! Folding of a sheet by its edge, without sliding (thesis sec. 4).
//!
//! The sheet lies flat on a table. A gripper holds its edge without a moment, at (x, z) relative
//! to the initial position of the edge, and lifts a part of length l_s. With lengths in L_gb = (E
//! h²/(24 ρ g))^(1/3) and forces in EI/L_gb², so that the weight per length is 1/2, the suspended
//! part is a planar heavy elastica:
//!
//! > θ'' = H sin θ − (V + s/2) cos θ,  θ(0) = θ'(0) = 0,  θ'(l̄_s) = 0
//! >
//! > x̄ = l̄_s − ∫ cos θ ds,  z̄ = ∫ sin θ ds,  α = θ(l̄_s),  λ = |H|/|V|
//!
//! (H, V) is the force of the suspended part on the lying part: it presses on the table with |V|,
//! and pulls (H > 0) or pushes the lying part. Some gripper positions have several solutions; the
//! gentle one belongs to the family that begins with the flat sheet.
//!
//! | file | what |
//! |---|---|
//! | `equilibrium` | one fold, and Newton's method for it |
//! | `atlas` | gentle folds all over the workspace |
//! | `search_all` | all folds at a gripper |
//! | `stability` | the second variation |
//! | `discrete` | the same with a discrete elastic rod |
//! | `workspace` | gripper positions |
//! | `manifold` | folds on a grid |
//! | `neural` | folds by a network |
//! | `graph_search` | paths over that grid |
//! | `held` | folds and paths with a moment at the gripper, for low friction |
//! | `path` | the path of the gripper from the flat sheet to the crease |
//! | `baseline` | baseline methods of the thesis |
//! | `pose` | a pose of the gripper |
//! | `planner` | a plan by any of these, and replanning of its rest |
//! | `sliding` | sliding of the sheet during the fold |
//! | `sheet` | the same in metres |

mod atlas;
mod baseline;
mod discrete;
mod equilibrium;
mod graph_search;
mod held;
mod manifold;
mod neural;
mod path;
mod planner;
mod pose;
mod search_all;
mod sheet;
mod sliding;
mod stability;
mod workspace;

pub use atlas::{FoldAtlas, solve_from};
pub use equilibrium::Fold;
pub use graph_search::{Cell, Objective, uniform_cost_search};
pub use held::held_path;
pub use manifold::{ForceManifold, ManifoldPoint};
pub use neural::{LearnedFold, NetworkCheck, NeuralFoldError, NeuralFolds};
pub use path::{FoldPath, Sheet, fold_path};
pub use planner::{Algorithm, FoldPlanner, PART_OF_FRICTION};
pub use pose::FoldPose;
pub use rodlab_engine::mechanics::kirchhoff::elastica::Forces;
pub use sheet::FoldedSheet;
pub use sliding::sliding;
pub use workspace::Workspace;

use thiserror::Error;

/// Why a fold was not found.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum FoldError {
    /// The gripper is outside the workspace.
    #[error(
        "no sheet can be held without a moment at x̄ = {}, z̄ = {} with a suspended length up to {} L_gb; the nearest feasible place found is \
         ({:.4}, {:.4})",
        gripper[0], gripper[1], Fold::LONGEST, nearest[0], nearest[1]
    )]
    Unreachable {
        /// (x̄, z̄).
        gripper: [f64; 2],
        /// A reachable position.
        nearest: [f64; 2],
    },
    /// The discrete rod has no such equilibrium.
    #[error("no equilibrium of {edges} edges was found at x̄ = {}, z̄ = {}", gripper[0], gripper[1])]
    NoConvergence {
        /// (x̄, z̄).
        gripper: [f64; 2],
        /// Edges.
        edges: usize,
    },
    /// The target cannot be reached.
    #[error(
        "the edge cannot be brought to x̄ = {target}: it would lie {reason}; targets from \
         {least:.4} to {largest:.4} L_gb can be reached"
    )]
    Target {
        /// C̄.
        target: f64,
        /// Least and largest target, L_gb.
        least: f64,
        /// Largest.
        largest: f64,
        /// The error.
        reason: &'static str,
    },
    /// No path leads there.
    #[error("no path over the manifold reaches x̄ = {0} within the allowed suspended lengths")]
    NoPath(f64),
    /// No moment at the gripper is sufficient for a given friction.
    #[error(
        "no moment at the gripper brings the edge to x̄ = {target:.4} with a friction demand of at \
         most {friction:.4}: a fold this tight needs more friction"
    )]
    NotHeld {
        /// C̄.
        target: f64,
        /// φ.
        friction: f64,
    },
    /// Nothing holds a sliding sheet.
    #[error("with the gripper at x̄ = {:.4}, z̄ = {:.4} nothing holds the sheet and it slides away", .0[0], .0[1])]
    NoHold([f64; 2]),
}
