//! Folding: a gripper folds a sheet on a table (thesis chapter 4).
//!
//! | file | what |
//! |---|---|
//! | `kind` | the experiment |
//! | `keys` | its table `[folding]` |
//! | `paper_file` | files of sheets |
//! | `tables` | that table with the plan made from it |
//! | `gripper_path` | the path of the gripper with its errors, planned before the run |
//! | `feedback` | the rest of the path replanned from the observed slide of the sheet |
//! | `monitor`, `outcome` | the measurements, and the outcome |
//! | `files`, `folded_figure` | its files in a results directory |

mod feedback;
mod files;
mod folded_figure;
mod gripper_path;
mod keys;
mod kind;
mod monitor;
mod outcome;
mod paper_file;
mod tables;

pub use folded_figure::{FoldedOutlines, folded_outlines};
pub use keys::{AlgorithmName, Crease, Paper};
pub use kind::FoldingKind;
pub use outcome::FoldingOutcome;
pub use paper_file::PaperFile;
pub use tables::{FoldingTables, planned_fold};
