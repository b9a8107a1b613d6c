//! Deployment: a gripper lays a rod on a table along a pattern (thesis chapter 5).
//!
//! | file | what |
//! |---|---|
//! | `kind` | the experiment |
//! | `keys` | its table `[deployment]` |
//! | `gripper_path` | the path of the gripper with its errors, planned before the run |
//! | `tying` | what both grippers do when the rod is laid, where a knot is tied |
//! | `planned` | what the planner believes |
//! | `online` | the path planned anew from where the rod is seen to lie |
//! | `tables` | that table with what is planned of it |
//! | `laid_rod` | distances of the laid rod from its pattern |
//! | `pegs` | posts on the table, and whether the rod passes them as its pattern does |
//! | `strand_gripper`, `release` | a second gripper lifts strands; the first one lets go |
//! | `knot_proof` | which knot a rod on the table is tied into |
//! | `monitor`, `outcome` | what is measured, and what it came to |
//! | `files`, `laid_figure` | what it leaves in a results directory |

mod files;
mod gripper_path;
mod keys;
mod kind;
mod knot_proof;
mod laid_figure;
mod laid_rod;
mod monitor;
mod online;
mod outcome;
mod pegs;
mod planned;
mod release;
mod strand_gripper;
mod tables;
mod tying;

pub use keys::Deployment;
pub use kind::DeploymentKind;
pub use laid_figure::{LaidOutlines, Outline, laid_outlines};
pub use monitor::DeploymentMonitor;
pub use outcome::{DeploymentOutcome, PassedPegs, TiedKnot};
pub use tables::DeploymentTables;
