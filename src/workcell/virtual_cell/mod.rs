//! A virtual robot cell: a simulation of a cell file behind the rosbridge protocol of real cells.
//!
//! Clients use it like a real cell. Arms follow `control_msgs/FollowJointTrajectory` with latency
//! and lag; grippers follow `control_msgs/GripperCommand`. A rod is handed to a gripper and hangs
//! from it. The rod can be laid on a table with friction, gripped by other grippers, and released.
//! A camera takes pictures. Instead of a rod, the table may carry a sheet, which a gripper takes by
//! its edge and folds. The clock of the cell, `/clock`, runs in real time or faster, and waits if
//! the simulation or a client cannot keep up.
//!
//! | file | what |
//! |---|---|
//! | `arm` | joints that follow trajectories with latency and lag, within their limits |
//! | `hanging` | rods of which a part hangs in the air |
//! | `rod` | rods for grippers, handed over so that they hang on the table |
//! | `simulated_rod` | a rod in simulation, or two: led by hands, released |
//! | `grip` | a gripper's hold on that rod, of which there may be several |
//! | `axis` | external axes, which move as arms do |
//! | `chuck` | a rod clamped between a chuck and a hand, led and twisted |
//! | `sheet`, `sheet_picture` | a sheet on the table in simulation: taken by its edge, folded, released; its image in a camera |
//! | `camera` | pictures of all that |
//! | `simulated_cell` | all of them on one clock, with faults |
//! | `fault` | faults to inject into a cell |
//! | `topics` | names of actions and topics |
//! | `message` | the rosbridge protocol |
//! | `goal_status` | goals as the status topics list them |
//! | `subscription` | how often a client receives a topic |
//! | `pace` | how much of the cell's time a client has seen |
//! | `connection` | a client, with bounds on all that comes and goes |
//! | `settings` | its contents, and the settings of the server |
//! | `beside` | a cell served in the process of the task in it |
//! | `server` | clients, goals, reports |

mod arm;
#[cfg(test)]
mod attack_tests;
mod axis;
mod beside;
mod camera;
mod chuck;
mod connection;
mod fault;
mod goal_status;
mod grip;
mod hanging;
mod message;
mod pace;
mod rod;
#[cfg(test)]
mod rod_tests;
mod server;
mod settings;
mod sheet;
mod sheet_picture;
mod simulated_cell;
mod simulated_rod;
mod subscription;
mod topics;

pub use arm::Response;
pub use beside::with_cell;
#[cfg(test)]
pub(crate) use camera::{Scenery, picture};
pub use chuck::ChuckedSupply;
pub use fault::{Fault, FaultKind};
pub use rod::{RodError, RodSupply};
pub use server::{ServeError, VirtualCell};
pub use settings::Settings;
pub use sheet::{HeldSheet, SheetPlace, SimulatedSheet};
