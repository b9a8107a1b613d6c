//! Stability of helical rods, explored by an arm and a chuck (thesis 6.2 and 6.3).
//!
//! For each direction (κ, τ, ω), arm and chuck move the clamps of a rod outwards along the ray of
//! this direction. The rod is a helix with growing κ, τ and ω there. The camera takes a picture at
//! each step. If the markers deviate from those of the helix, the rod has lost its stability. The
//! arm then returns along the ray until the rod is a helix again, locates the instability in finer
//! steps, and returns to the straight rod.

mod directions;
mod explore;
mod figure;
mod ray;
mod record;
mod row;
mod task;
mod walk;

pub use directions::{quarter_sphere, read_directions, section};
pub use explore::{Exploration, ExploreError};
pub use figure::{found_and_theory, section_figure};
pub use record::{ExplorationPlan, ExplorationRecord};
pub use row::{ExplorationRow, ExplorationSummary, read_rows};
pub use task::ExplorationTask;
pub use walk::SearchSteps;
