//! Deployment: grippers lay a rod, or two, on a table along patterns (thesis chapter 5).
//!
//! | file | what |
//! |---|---|
//! | `kind` | the experiment |
//! | `keys` | its table `[deployment]` |
//! | `scene` | rods, grippers and table of the scene |
//! | `gripper_path` | the path of a gripper that lays a rod, with its errors, planned before the run |
//! | `tying` | motion of both grippers after rods are laid, where a knot is tied |
//! | `paths` | the paths of all grippers, one after the other |
//! | `planned` | the model that the planner assumes |
//! | `online` | the path replanned from the observed place of the rod |
//! | `tables` | that table with the plan made from it |
//! | `laid_rod` | distances of the laid rod from its pattern |
//! | `pegs` | posts on the table, and whether the rod passes them as its pattern does |
//! | `fixtures` | the same on the table of a robot cell |
//! | `hand`, `release` | a gripper grasps strands and ends; one that laid a rod lets go |
//! | `placement` | a cable between pegs, with its plan, for a robot cell |
//! | `rod_file`, `landing_scenario` | files of rods, and of scenarios that lay them along a plan |
//! | `knot_proof` | type of the knot of rods on the table |
//! | `monitor`, `outcome` | the measurements, and the outcome |
//! | `files`, `laid_figure` | its files in a results directory |

mod files;
mod fixtures;
mod gripper_path;
mod hand;
mod keys;
mod kind;
mod knot_proof;
mod laid_figure;
mod laid_rod;
mod landing_scenario;
mod monitor;
mod online;
mod outcome;
mod paths;
mod pegs;
mod placement;
mod planned;
mod release;
mod rod_file;
mod scene;
mod tables;
mod tying;

pub use fixtures::Fixtures;
pub use keys::{Deployment, svg_drawing};
pub use kind::DeploymentKind;
pub use knot_proof::{knot_of_patterns, knot_on_table};
pub use laid_figure::{LaidOutlines, Outline, laid_outlines};
pub use landing_scenario::Landing;
pub use monitor::DeploymentMonitor;
pub use outcome::{DeploymentOutcome, PassedPegs, TiedKnot};
pub use paths::{GripperTask, GripperWork};
pub use placement::{Placement, PlacementError};
pub use rod_file::RodFile;
pub use tables::DeploymentTables;
