//! The robot cell from its file: arms, external axes, table, camera, drivers.
//!
//! A cell file is TOML with the units and the messages of scenario files. [`Cell::read`] gives the cell in SI units;
//! [`robot`](rodlab_robot) plans and streams with its parts.
//!
//! | file | what |
//! |---|---|
//! | `typed` | every key of a cell file, as typed |
//! | `resolve`, `resolve_chain`, `resolver` | units, ranges, names: from the file as typed to the [`Cell`] |
//! | `resolved` | the [`Cell`] |
//! | `surroundings`, `clearance`, `plan` | collision checks; the least distance along a motion; joint trajectories along a path of a hand |
//! | `streaming` | a joint trajectory with the drivers that it moves |
//! | `safety`, `arm_guard` | limits of hands and efforts, checked before and during every motion |
//! | `signal_rule`, `resolve_signals`, `signals` | topics that end motions |
//! | `approach` | motion of an arm from its current joints to the start of another motion |
//! | `hand_path` | joints along poses of a hand that begin where it is, and motions along a part of them, with an axis |
//! | `sums` | lengths from the start of a curve on |
//! | `fingers` | whether a gripper still holds its object |
//! | `continuation` | motion of an arm from its current joints along a path |
//! | `camera` | the camera as one that locates what it sees |
//! | `view` | the 3-D page of a cell |
//! | `report` | the report of `rodlab check` |

mod approach;
mod arm_guard;
mod camera;
mod clearance;
mod continuation;
mod fingers;
mod hand_path;
mod plan;
mod report;
mod resolve;
mod resolve_chain;
mod resolve_signals;
mod resolved;
mod resolver;
mod safety;
mod signal_rule;
mod signals;
mod streaming;
mod sums;
mod surroundings;
#[cfg(test)]
mod tests;
mod typed;
mod view;

pub(crate) use approach::straight;
pub use arm_guard::ArmGuard;
pub use fingers::Fingers;
pub use hand_path::{HandPath, HandPathRequest};
pub use plan::{Place, Plan, PlanError, PlanReport, PlanRequest, read_poses};
pub use report::CellReport;
pub(crate) use resolved::ros_version;
pub use resolved::{Arm, Axis, Camera, Cell, Chuck, Driver, Gripper, Obstacle, Table};
pub use safety::Safety;
pub use signal_rule::{Bounds, SignalRule};
pub use signals::Signals;
pub use streaming::StreamReport;
pub(crate) use sums::sums;
pub use view::Line;
