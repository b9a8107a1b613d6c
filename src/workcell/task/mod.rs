//! Tasks of the robot cell: what joins plan, cell, camera and results.
//!
//! | file | what |
//! |---|---|
//! | `deploy` | a rod laid along a pattern by an arm: approach, take, lay, let go, look, score |
//! | `tie` | a knot tied by two arms |
//! | `fold` | a sheet folded by an arm, with the camera |
//! | `exploration` | the stability of helical rods, explored along a list of directions |
//! | `motion` | the motions of a deployment, planned and checked before anything moves |
//! | `room` | where a rod may lie |
//! | `correction` | its path, planned anew from what the camera sees while it is laid |
//! | `look` | the camera's picture as a curve in the frame of the pattern |
//! | `working_arm` | motions and grips of an arm, with the log of each |
//! | `stage_clock` | its stages, with the time that each took |
//! | `error` | why a task ends early |
//! | `stopped` | how it leaves the cell then |
//! | `unfinished` | whether the last task came to its end |
//! | `record` | what any task leaves in a results directory |
//! | `deploy_record` | what a deployment does |

mod correction;
mod deploy;
mod deploy_record;
mod error;
mod exploration;
mod fold;
mod look;
mod motion;
mod record;
mod room;
mod stage_clock;
mod stopped;
mod tie;
mod unfinished;
mod working_arm;

pub use correction::Correction;
pub use deploy::{DeployEnd, DeployError, DeployTask, Laid, LayingMethod, Stage};
pub use deploy_record::DeployRecord;
pub use error::{TaskError, TaskStage};
pub use exploration::{
    Exploration, ExplorationPlan, ExplorationRecord, ExplorationRow, ExplorationSummary,
    ExploreError, SearchSteps, found_and_theory, quarter_sphere, read_directions,
    read_rows as read_exploration, section, section_figure, write_page as write_exploration,
};
pub use fold::{
    FoldEnd, FoldMotion, FoldMotionRequest, FoldRecord, FoldRequest, FoldScore, FoldStage,
    FoldTask, FoldTaskError, FoldWay, Look, heading,
};
pub use motion::{DeployMotion, MotionRequest, middle_of_table};
pub use record::{Report, Status, TaskHead, TaskRecord, write_manifest};
pub use stopped::{HandPlace, LaidLength, Stopped};
pub use tie::{
    KnotPlan, PlannedRod, TieEnd, TieError, TieMotion, TieMotionRequest, TieRecord, TieScore,
    TieStage, TieTask,
};
pub use unfinished::Unfinished;
