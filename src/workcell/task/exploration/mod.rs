//! The stability of helical rods, explored by an arm and a chuck (thesis 6.2 and 6.3).
//!
//! For each direction of (κ, τ, ω) the clamps of a rod are led outwards along its ray, on which the rod is a helix that turns ever
//! farther; the camera takes a picture at each step. Where the markers deviate from those of the helix, the rod has lost its
//! stability. The arm goes back along the ray until it is a helix again, finds the place by finer steps, and returns to the straight
//! rod.

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
