//! A knot tied by two arms (thesis 5.5.6): one lays a rod and leads its end, the other one lifts the strands under which it goes. Of
//! two rods each arm lays one and leads its end, while the other one lifts strands.
//!
//! | file | what |
//! |---|---|
//! | `task` | approach, take, lay, tie, let go, retreat, look, score |
//! | `stage` | names of these, and why a knot is not tied to its end |
//! | `plan` | what the grippers do with one rod, or with two |
//! | `request` | what is asked of the arms |
//! | `choreography` | their motions, put together one after the other |
//! | `motion` | the motions of both arms, planned and checked before anything moves |
//! | `two_arms` | motions of two arms on one clock |
//! | `sight` | rods as the camera sees them, with what lies over what |
//! | `score` | the knot of that, compared with the one that was drawn |
//! | `record` | what it leaves in a results directory |

mod choreography;
mod motion;
mod plan;
mod record;
mod request;
mod score;
mod sight;
mod stage;
mod task;
mod two_arms;

pub use motion::TieMotion;
pub use plan::{KnotPlan, PlannedRod};
pub use record::TieRecord;
pub use request::TieMotionRequest;
pub use score::TieScore;
pub use stage::{TieError, TieStage};
pub use task::{TieEnd, TieTask};
