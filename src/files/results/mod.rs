//! Results directories: manifests, series, node files, checkpoints, VTK.
//!
//! A run opens a [`ResultsDirectory`], writes its [`Manifest`], uses a [`Recorder`] for each output
//! time and [`CheckpointFiles`], and ends with [`write_summary`] and [`write_timings`]. This module
//! is independent of mechanics: rods are names, node counts and arrays.
//!
//! The directory of a sweep ([`SweepDirectory`]) has such a directory for each case; [`Leases`]
//! distribute the cases among processes. Short cases are synced together ([`LaterSync`]).
//!
//! Files that are written once appear atomically ([`write_whole`]). Files that grow are flushed at
//! each output time; when a run is continued, they are truncated to the length in the checkpoint.
//! Checkpoint and manifest hold their lengths and hashes ([`FileMark`]), which detect removed or
//! changed files.

mod atomic;
mod branch;
mod case_record;
mod checkpoint;
mod columns;
mod contacts;
mod difference;
mod directory;
mod end_state;
mod error;
mod files;
mod forces;
mod frame;
mod later_sync;
mod lease;
mod manifest;
mod mark;
mod nodes;
mod obstacle_frames;
mod outcome;
mod recorder;
mod series;
mod stream;
mod summary;
mod sweep_directory;
mod table;
mod usage;
mod value;
mod vtk;

pub use atomic::sync;
pub use atomic::{check_own, is_unfinished, replace_own, write_files, write_whole};
pub use branch::{BranchKind, BranchRow, read_branches};
pub use case_record::{CaseRecord, CaseStatus};
pub use checkpoint::CheckpointFiles;
pub use columns::{Column, ColumnGroup, FILES, FileDescription, always, file, table};
pub use contacts::{PressedNode, read_pressed_nodes};
pub use directory::{Opened, ResultsDirectory};
pub use end_state::{EndRow, read_end_state, write_end_state};
pub use error::ResultsError;
pub use files::{
    BRANCH, BRANCH_FIGURE, CONTACTS, CONTACTS_FIGURE, END_STATE, MANIFEST, NODE_FORCES, NODES,
    PAGE, RODS_FIGURE, SCENARIO, SERIES, SERIES_FIGURE, START, SUMMARY, SWEEP_FIGURE, TIMINGS,
    VTK_COLLECTION, VTK_FOLDER,
};
pub use forces::{NodeForces, read_node_forces};
pub use frame::{ContactRecord, Frame};
pub use later_sync::{LaterSync, sync_file_system};
pub use lease::{HEARTBEAT, Lease, LeaseAttempt, Leases, Owner, host_name};
pub use manifest::{MAIN_CASE, Manifest, RodRecord, scenario_hash, scenario_hash_with_inputs};
pub use mark::{FileMark, FileMarks, check_files, check_lengths, check_quickly};
pub use nodes::{NodePositions, read_nodes};
pub use obstacle_frames::ObstacleSurfaces;
pub use outcome::{CaseOutcome, Ending};
pub use recorder::{Recorder, RecorderPlan};
pub use series::{SeriesRow, read_series, read_series_as, series_columns};
pub use stream::{CsvStream, WholeRows, read_whole_rows};
pub use summary::{SummaryRow, write_summary, write_sweep_summary, write_timings};
pub use sweep_directory::{CASES, SweepDirectory};
pub use table::Table;
pub use usage::{Usage, UsageMeter, thread_cpu_time};
pub use value::{NamedValues, Value};
pub use vtk::{Surface, write_surface};
