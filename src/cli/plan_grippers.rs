//! `rodlab plan grippers`.

use super::prelude::*;
use rodlab_lab::experiment::{DeploymentTables, GripperTask, GripperWork, load};
use rodlab_planning::plan::files::trajectory_csv;

/// Arguments of `rodlab plan grippers`.
#[derive(Debug, Args)]
pub struct GripperPlanArguments {
    /// A scenario of the experiment "deployment"
    #[arg(value_parser = file_or_preset(PresetKind::Scenario), add = presets(PresetKind::Scenario))]
    scenario: PathBuf,
    /// Set a key of the scenario, such as deployment.scheme=intuitive; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Directory for the trajectories
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

#[derive(Serialize)]
struct Report {
    scenario: PathBuf,
    tasks: Vec<TaskReport>,
}

/// Task of a gripper. Numbers are counted from 1.
#[derive(Serialize)]
struct TaskReport {
    gripper: usize,
    rod: usize,
    work: GripperWork,
    begin_s: f64,
    end_s: f64,
    file: PathBuf,
}

impl GripperPlanArguments {
    /// Plans, and writes a trajectory for each task.
    pub fn plan(&self) -> Result<(), Failure> {
        // A planned path has no jitter.
        let mut overrides = self.set.clone();
        overrides.extend(["deployment.jitter=0", "deployment.jitter_angle=0"].map(str::to_owned));
        let scenario = load(&self.scenario, &overrides)?.scenario;
        let file = self.scenario.display();
        let tables: Option<&DeploymentTables> = scenario.experiment.tables();
        let tables = tables.ok_or("`experiment`: grippers are planned for \"deployment\" only");
        let paths = tables.at(&file)?.paths(&scenario);
        let paths = paths.at(format_args!("{file}: `deployment.pattern`"))?;
        make_directory(&self.out)?;
        let mut tasks = Vec::new();
        for (index, task) in paths.tasks().iter().enumerate() {
            tasks.push(self.written(index + 1, task)?);
        }
        print_json(&Report {
            scenario: self.scenario.clone(),
            tasks,
        })
    }

    fn written(&self, number: usize, task: &GripperTask) -> Result<TaskReport, Failure> {
        let work = match task.work {
            GripperWork::Lay => "lays",
            GripperWork::Lift => "lifts",
            GripperWork::Lead => "leads",
        };
        let (gripper, rod) = (task.gripper, task.rod);
        let file = self
            .out
            .join(format!("{number}_gripper_{gripper}_{work}_rod_{rod}.csv"));
        write_file(&file, trajectory_csv(&task.poses)?.as_bytes())?;
        Ok(TaskReport {
            gripper,
            rod,
            work: task.work,
            begin_s: task.poses.first().map_or(0.0, |pose| pose.0),
            end_s: task.poses.last().map_or(0.0, |pose| pose.0),
            file,
        })
    }
}
