//! Two arms tie a knot (thesis 5.5.6). One arm lays a rod and leads its end; the other one lifts
//! the strands under which the end passes. With two rods, each arm lays one and leads its end,
//! while the other arm lifts strands.

mod choreography;
mod motion;
mod plan;
mod record;
mod request;
mod score;
mod sight;
mod task;
mod two_arms;

pub use motion::TieMotion;
pub use plan::{KnotPlan, PlannedRod};
pub use record::TieRecord;
pub use request::TieMotionRequest;
pub use score::TieScore;
pub use task::{TiePlan, TieTask};
