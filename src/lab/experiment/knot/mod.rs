//! Knots that are pulled tight (thesis 2.5) or until they invert (thesis 3).

//!
//! | file | what |
//! |---|---|
//! | `kind` | the two experiments |
//! | `keys` | their table `[knot]` |
//! | `tied_knot`, `tightening` | the rods, and how their ends are held and moved |
//! | `observer`, `monitor` | the measurements, and the end of a run |
//! | `files`, `traction_figure` | their files in a results directory |

mod files;
mod keys;
mod kind;
pub mod monitor;
pub mod observer;
mod outcome;
mod row;
pub mod tied_knot;
pub mod tightening;
mod traction_figure;

pub use keys::{Knot, KnotEnds, KnotKind, KnotStart, KnotTables};
pub use kind::{INVERSION, TIGHTENING};
pub use monitor::KnotMonitor;
pub use observer::{KnotObserver, KnotSample};
pub use outcome::{KnotEnding, KnotOutcome};
pub use row::{KnotRow, read_knot_series};
