//! `rodlab deploy`.

use super::cell::FRICTION;
use super::laying::{Laying, LayingArguments};
use super::plan_deployment::DeploymentPlan;
use super::prelude::*;
use super::run::simulate;
use rodlab_lab::experiment::case_set;
use rodlab_lab::run::RunOptions;
use rodlab_planning::plan::deployment::Spare;
use rodlab_workcell::virtual_cell::RodSupply;

/// Arguments of `rodlab deploy`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab deploy --pattern A.svg                                 a drawing, or a preset; in a virtual cell
  rodlab deploy --pattern U --rod green_vps --cell gantry --dry-run
  rodlab deploy --pattern letter.csv --rod pink_vps --cell cell.toml --colour red --hand-speed 0.02
  rodlab deploy --pattern circle:0.08 --rod green_vps --simulate

The gripper's path is planned as by `rodlab plan deployment`, that of the joints as by `rodlab plan joints`. The arm goes
straight to the first point, its gripper takes the rod, lays it and lets it go; the camera of the cell file looks, and what it
saw is scored. Nothing moves with --dry-run: look at its page first. Everything is in one directory: manifest.json, report.md,
report.html, plan/, joints.csv, cell.html, approach/ and laying/ (commanded.csv, state.csv, events.csv), picture.png, overlay.png, rod.csv
(what was seen, in the frame of the pattern), score.svg. Exit code 1: something failed on the way; the message and report.md say
what. `rodlab cell serve` is a cell to try --cell with.")]
pub struct DeployArguments {
    #[command(flatten)]
    plan: DeploymentPlan,
    #[command(flatten)]
    laying: LayingArguments,
    /// Look at the rod each 0.8 gravito-bending lengths while it is laid, and plan the rest of its path anew from where it lies
    #[arg(long, conflicts_with_all = ["simulate", "dry_run"])]
    correct: bool,
    /// Lay the rod in plain simulation, without a cell
    #[arg(long, conflicts_with = "dry_run")]
    simulate: bool,
}

/// Lays a rod along a pattern.
pub fn deploy(arguments: &DeployArguments, common: &Common) -> Result<(), Failure> {
    let DeployArguments { plan, laying, .. } = arguments;
    if plan.ties_knot() {
        return Err(Failure::Input(
            "--knot: a knot takes two grippers, and this lays with one; leave it out".into(),
        ));
    }
    if arguments.simulate {
        let directory = laying.directory("deploy")?;
        plan.write(&directory.join("plan"), &Spare::HANGS)?;
        let scenario = directory.join("plan").join("landing.toml");
        let options = RunOptions::new(directory.join("landing"));
        simulate(&case_set(&scenario, &[], &[])?, options, common)?;
        return Ok(());
    }
    let cell = laying.cell()?;
    plan.use_rod_of(&cell.cell);
    let what = Laying {
        task: "deploy",
        pattern: plan.pattern_name(),
        outline: &plan.outline()?,
        fixtures: None,
        is_corrected: arguments.correct,
        supply: &|_| Ok(RodSupply::new(plan.rod_file()?, FRICTION)?),
    };
    laying.lay(&cell, &what, |spare, directory| {
        let plan = plan.write(directory, spare)?;
        Ok((plan.rod, plan.path))
    })
}
