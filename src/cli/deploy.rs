//! `rodlab deploy`.

use super::cell::FRICTION;
use super::identify_held::HeldArguments;
use super::in_cell::InCell;
use super::laying::{Laying, LayingArguments};
use super::log_directory::log_directory;
use super::plan_deployment::DeploymentPlan;
use super::prelude::*;
use super::run::simulate;
use rodlab_lab::experiment::case_set;
use rodlab_lab::identify::ROD;
use rodlab_lab::run::RunOptions;
use rodlab_planning::plan::deployment::Spare;
use rodlab_workcell::task::{DrawingTask, Planning, TaskCommand, Way, stroke_folder};
use rodlab_workcell::virtual_cell::RodSupply;

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab deploy --pattern A.svg                  a drawing or a preset; in a virtual cell
  rodlab deploy --pattern U --rod green_vps --cell gantry --dry-run
  rodlab deploy --pattern letter.csv --rod pink_vps --cell cell.toml --colour red
  rodlab deploy --pattern S --rod green_vps --identify --simulated-rod mine.toml
  rodlab deploy --pattern circle:0.08 --rod green_vps --simulate",
    "\
The path of the gripper is planned as by `rodlab plan deployment`, that of the joints as by
`rodlab plan joints`. The arm moves straight to the first point; its gripper takes the rod, lays it
and releases it; the camera of the cell file takes a picture, and the rod is scored by it. With
--dry-run nothing moves: look at its page first. `rodlab cell serve` starts a cell for trying
--cell.

With --identify the arm first holds the rod in three poses before the camera. --rod is then the
expected rod, and identify/ has the record and the identified rod, rod.toml.

All results are in one directory: manifest.json, report.md, report.html, plan/, joints.csv,
cell.html, approach/ and laying/ (commanded.csv, state.csv, events.csv), picture.png, overlay.png,
rod.csv (the rod as seen, in the frame of the pattern), score.svg. Exit code 1: a step failed; the
message and report.md give the reason."
);

/// Arguments of `rodlab deploy`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct DeployArguments {
    #[command(flatten)]
    plan: DeploymentPlan,
    #[command(flatten)]
    laying: LayingArguments,
    /// Replan the rest of the path from a picture every 0.8 gravito-bending lengths
    #[arg(long, conflicts_with_all = ["simulate", "dry_run"])]
    correct: bool,
    /// Identify the rod first, as `rodlab identify --rod` does, and plan with the result
    #[arg(long, conflicts_with_all = ["simulate", "dry_run"])]
    identify: bool,
    /// Rod of the simulated cell [default: --rod, for which the path is planned]
    #[arg(long, hide_short_help = true, value_name = "FILE", conflicts_with_all = ["simulate", "cell"], value_parser = file_or_preset(PresetKind::Rod), add = presets(PresetKind::Rod))]
    simulated_rod: Option<PathBuf>,
    /// Lay the rod in plain simulation, without a cell
    #[arg(long, conflicts_with = "dry_run")]
    simulate: bool,
}

/// Lays a rod along a pattern.
pub fn deploy(command: &InCell<DeployArguments>, common: &Common) -> Result<(), Failure> {
    let DeployArguments {
        plan,
        laying,
        simulate: is_simulated,
        ..
    } = &command.what;
    if plan.ties_knot() {
        return Err(Failure::Input(
            "--knot: a knot needs two grippers, and this command has one; use `rodlab tie`".into(),
        ));
    }
    if command.what.identify {
        let directory = log_directory(DeployArguments::NAME, laying.task.out.as_deref())?;
        let identified = directory.join(HeldArguments::NAME);
        command
            .identification()?
            .run_in(identified.clone(), false, common)?;
        plan.use_identified(identified.join(ROD));
        return command.run_in(directory, true, common);
    }
    if !is_simulated {
        return command.run(common);
    }
    let directory = log_directory(DeployArguments::NAME, laying.task.out.as_deref())?;
    plan.write(&directory.join("plan"), &Spare::HANGS)?;
    let scenario = directory.join("plan").join("landing.toml");
    let options = RunOptions::new(directory.join("landing"));
    simulate(&case_set(&scenario, &[], &[])?, options, common)?;
    Ok(())
}

impl InCell<DeployArguments> {
    /// The identification of the rod before it is laid.
    fn identification(&self) -> Result<InCell<HeldArguments>, Failure> {
        let (plan, laying) = (&self.what.plan, &self.what.laying);
        // A cell may define its own rod.
        let rod = match (plan.given_rod(), &self.choice.cell) {
            (None, Some(_)) => None,
            _ => Some(plan.expected_rod()?.to_owned()),
        };
        let task = &laying.task;
        Ok(InCell {
            what: HeldArguments {
                rod,
                free: None,
                simulated_rod: self.what.simulated_rod.clone(),
                arm: laying.arm.clone(),
                hand_speed: task.hand_speed,
                approach_speed: task.approach_speed,
                margin: task.margin,
                colour: task.colour.clone(),
                dry_run: false,
                checked: task.checked,
                out: None,
            },
            choice: self.choice.clone(),
        })
    }
}

impl TaskCommand for DeployArguments {
    const NAME: &'static str = "deploy";
    type Task = DrawingTask;
    type Error = Failure;

    fn way(&self) -> Way<'_> {
        self.laying.way()
    }

    fn plan(&self, planning: &Planning<'_>, arms: &[usize]) -> Result<DrawingTask, Failure> {
        self.plan.use_rod_of(planning.cell);
        let plans = self.plan.strokes()?;
        let outlines = plans.iter().map(DeploymentPlan::outline);
        let outlines = outlines.collect::<Result<Vec<_>, _>>()?;
        // All strokes of a drawing have one frame.
        let place = self.laying.task.place(planning.cell, &outlines.concat())?;
        let is_alone = plans.len() == 1;
        if !is_alone && place.pose().is_none() {
            return Err(Failure::Input(
                "--place auto is for a single stroke: several strokes keep their places to each other".into(),
            ));
        }
        let mut strokes = Vec::new();
        for (index, (plan, outline)) in plans.iter().zip(outlines).enumerate() {
            let folder = stroke_folder(index);
            let laying = Laying {
                name: plan.pattern_name(),
                outline,
                place: Some(place),
                folder: if is_alone { "" } else { &folder },
                fixtures: None,
                is_corrected: self.correct,
                supply: &|_| self.supply(plan),
            };
            let plan = |spare: &Spare<'_>, directory: &Path| {
                let written = plan.write(directory, spare)?;
                Ok((written.rod, written.path))
            };
            strokes.push(self.laying.plan(planning, arms[0], laying, plan)?);
        }
        Ok(DrawingTask::new(self.plan.pattern_name(), strokes))
    }
}

impl DeployArguments {
    /// Rods of a simulated cell for a plan.
    fn supply(&self, plan: &DeploymentPlan) -> Result<RodSupply, Failure> {
        let simulated = self.simulated_rod.as_deref();
        let rod = simulated.map_or_else(|| plan.expected_rod(), Ok)?;
        Ok(match plan.cut_length()? {
            Some(length) => RodSupply::cut(rod, FRICTION, length)?,
            None => RodSupply::new(rod, FRICTION)?,
        })
    }
}
