//! Tasks of the robot cell. They combine plan, cell, camera and results.
//!
//! | file | what |
//! |---|---|
//! | `deploy` | a rod laid along a pattern by an arm: approach, take, lay, release, see, score |
//! | `drawing` | rods laid along the strokes of a drawing |
//! | `tie` | a knot tied by two arms |
//! | `fold` | a sheet folded by an arm, with the camera |
//! | `exploration` | the stability of helical rods, explored along a list of directions |
//! | `identification` | the gravito-bending length of a rod, held in front of the camera in three poses |
//! | `motion` | the motions of a deployment, planned and checked before anything moves |
//! | `room` | the room for a rod on the table and in the picture |
//! | `correction` | its path, replanned from pictures of the camera while it is laid |
//! | `look` | the camera's picture as a curve in the frame of the pattern |
//! | `laid_rod` | a laid rod from its results, to score its picture again |
//! | `step` | a task as a list of steps, and its interface to the runner |
//! | `runner` | the runner of any task: step by step, with one record |
//! | `command` | a command that plans a task: properties of `rodlab NAME` beside its arguments |
//! | `arguments` | arguments that tasks with rods share |
//! | `workplace` | the cell, camera and directory of a step |
//! | `working_arm` | motions and grips of an arm, with the log of each |
//! | `display` | display of the progress |
//! | `diagnostics` | the progress for the monitors of ROS |
//! | `speed_override` | the speed that the user wants at the moment |
//! | `stage` | name and description of a step |
//! | `error` | reasons of an early end |
//! | `stopped` | state of the cell after an early end |
//! | `unfinished`, `first_run` | whether the last task finished; whether a motion was carried out |
//! | `record` | the record of any task in a results directory |
//! | `deploy_plan`, `deploy_record` | plan and record of a deployment |

mod arguments;
mod command;
mod correction;
mod deploy;
mod deploy_plan;
mod deploy_record;
mod diagnostics;
mod display;
mod drawing;
mod error;
mod exploration;
mod first_run;
mod fold;
mod identification;
mod laid_rod;
mod look;
mod motion;
mod record;
mod room;
mod runner;
mod speed_override;
mod stage;
mod state_folder;
mod step;
mod stopped;
mod tie;
mod unfinished;
mod working_arm;
mod workplace;

pub use arguments::TaskArguments;
pub use command::{Planning, TaskCommand, Way};
pub use correction::Correction;
pub use deploy::DeployTask;
pub use deploy_plan::DeployPlan;
pub use deploy_record::{DeployRecord, DeployScore, stroke_folder};
pub use diagnostics::Diagnostics;
pub use display::{Display, Displays, Hidden, described};
pub use drawing::{DrawingRecord, DrawingTask};
pub use error::{TaskError, WorkError};
pub use exploration::{
    Exploration, ExplorationPlan, ExplorationRecord, ExplorationRow, ExplorationSummary,
    ExplorationTask, ExploreError, SearchSteps, found_and_theory, quarter_sphere, read_directions,
    read_rows as read_exploration, section, section_figure,
};
pub use first_run::FirstRun;
pub use fold::{
    FoldMotion, FoldPlan, FoldRecord, FoldRequest, FoldScore, FoldTask, FoldWay, Look, heading,
};
pub use identification::{
    HeldPose, HoldRequest, IdentificationPlan, IdentificationRecord, IdentificationTask,
};
pub use laid_rod::{LaidRod, Rescored};
pub use motion::{DeployMotion, MotionRequest, middle_of_table};
pub use record::{Report, Status, TaskHead, TaskRecord, write_manifest};
pub use runner::TaskRun;
pub use speed_override::SpeedOverride;
pub use stage::Stage;
pub use step::{Step, Task};
pub use stopped::{HandPlace, LaidAlong, LaidLength, Stopped};
pub use tie::{
    KnotPlan, PlannedRod, TieMotion, TieMotionRequest, TiePlan, TieRecord, TieScore, TieTask,
};
pub use unfinished::Unfinished;
pub use working_arm::{Grip, WorkingArm};
pub use workplace::Workplace;
