//! `rodlab deploy`.

use super::cell_task::{ended_early, note_end, refuse_unfinished, status_of};
use super::common::Common;
use super::failure::Failure;
use super::interruption::watch_for_interruption;
use super::log_directory::log_directory;
use super::output::{print, print_json};
use super::plan::{parse_place, positive};
use super::plan_deployment::DeploymentPlan;
use super::run::{prepare, summary};
use super::solve_arm::arm_named;
use crate::cell::{Cell, Place};
use crate::experiment::case_set;
use crate::plan::deployment::Spare;
use crate::report::write_page;
use crate::results::{PAGE, write_whole};
use crate::run::RunOptions;
use crate::task::{
    Correction, DeployRecord, DeployTask, LayingMethod, MotionRequest, SETTLING, Status,
    Unfinished, middle_of_table, write_manifest, write_report,
};
use crate::vision::ColourRule;
use clap::Args;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

/// Frames of the page of the arm in motion.
const FRAMES: usize = 400;
/// Outputs that the page of a simulation shows at most.
const OUTPUTS: usize = 2500;

/// Arguments of `rodlab deploy`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab deploy --pattern scenarios/patterns/U.svg --rod scenarios/rods/green_vps.toml --dry-run
  rodlab deploy --pattern scenarios/patterns/U.svg --rod scenarios/rods/green_vps.toml
  rodlab deploy --pattern letter.csv --rod scenarios/rods/pink_vps.toml --cell cell.toml --colour red --hand-speed 0.02
  rodlab deploy --pattern circle:0.08 --rod scenarios/rods/green_vps.toml --simulate

The gripper's path is planned as by `rodlab plan deployment`, that of the joints as by `rodlab plan joints`. The arm goes
straight to the first point, its gripper takes the rod, lays it and lets it go; the camera of the cell file looks, and what it
saw is scored. Nothing moves with --dry-run: look at its page first. Everything is in one directory: manifest.json, report.md,
plan/, joints.csv, cell.html, approach/ and laying/ (commanded.csv, state.csv, events.csv), picture.png, overlay.png, rod.csv
(what was seen, in the frame of the pattern), score.svg. Exit code 1: something failed on the way; the message and report.md say
what. `rodlab cell serve` is a cell to try it with.")]
pub struct DeployArguments {
    #[command(flatten)]
    plan: DeploymentPlan,
    /// The cell file
    #[arg(
        long,
        value_name = "FILE",
        default_value = "scenarios/cells/gantry.toml"
    )]
    cell: PathBuf,
    /// Name of the arm; not needed where the cell has only one
    #[arg(long, value_name = "NAME")]
    arm: Option<String>,
    /// Where the pattern lies in the cell: x,y,z in metres and a turn about z in degrees, or `auto`: the best place on the
    /// table [default: its middle in that of the table]
    #[arg(long, value_name = "X,Y,Z[,TURN]|auto", value_parser = parse_place, allow_hyphen_values = true)]
    place: Option<Place>,
    /// Greatest speed of the hand while it lays, m/s
    #[arg(long, value_name = "SPEED", default_value_t = 0.03, value_parser = positive)]
    hand_speed: f64,
    /// Greatest speed of the hand on the way to the first point, m/s
    #[arg(long, value_name = "SPEED", default_value_t = 0.1, value_parser = positive)]
    approach_speed: f64,
    /// Least distance to anything else, m
    #[arg(long, value_name = "DISTANCE", default_value_t = 0.01, value_parser = positive)]
    margin: f64,
    /// Which colours are rod, as of `rodlab trace`
    #[arg(long, value_name = "RULE", default_value = "auto")]
    colour: String,
    /// Look at the rod each 0.8 gravito-bending lengths while it is laid, and plan the rest of its path anew from where it lies
    #[arg(long, conflicts_with_all = ["simulate", "dry_run"])]
    correct: bool,
    /// Plan everything, write the pages, and move nothing
    #[arg(long, conflicts_with = "simulate")]
    dry_run: bool,
    /// Lay the rod in plain simulation, without a cell
    #[arg(long)]
    simulate: bool,
    /// The arm, and what it holds, were looked at after a task that did not come to its end
    #[arg(long)]
    checked: bool,
    /// Where everything goes [default: results/deploy-TIME]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Lays a rod along a pattern.
pub fn deploy(arguments: &DeployArguments, common: &Common) -> Result<(), Failure> {
    if arguments.plan.ties_knot() {
        return Err(Failure::Input(
            "--knot: a knot takes two grippers, and this lays with one; leave it out".into(),
        ));
    }
    let colour = ColourRule::parse(&arguments.colour)?;
    let cell = Cell::read(&arguments.cell)?;
    let arm = arm_named(&cell, arguments.arm.as_deref(), &arguments.cell)?;
    if !(arguments.dry_run || arguments.simulate || arguments.checked) {
        refuse_unfinished(&cell, arm)?;
    }
    let directory = log_directory("deploy", arguments.out.as_deref())?;
    let unfinished = Unfinished::of(&cell, arm, &directory);
    if arguments.simulate {
        arguments
            .plan
            .write(&directory.join("plan"), &Spare::HANGS)?;
        return simulate(&directory, common);
    }
    let pattern = arguments.plan.outline()?;
    let place = arguments.place.or_else(|| middle_of_table(&cell, &pattern));
    let place =
        place.ok_or_else(|| Failure::Input("--place is needed: the cell has no [table]".into()))?;
    let motion = MotionRequest {
        cell: &cell,
        arm,
        place,
        speed: arguments.hand_speed,
        margin: arguments.margin,
    };
    let (rod, path, motion) = motion.plan(|spare| {
        let plan = arguments.plan.write(&directory.join("plan"), spare)?;
        Ok::<_, Failure>((plan.rod, plan.path))
    })?;
    write_whole(
        &directory.join("joints.csv"),
        motion.laying.to_csv().as_bytes(),
    )?;
    let page = cell.page(Some(&motion.laying), FRAMES);
    write_whole(&directory.join("cell.html"), page.as_bytes())?;
    let mut record = DeployRecord {
        version: env!("CARGO_PKG_VERSION"),
        command_line: std::env::args().collect(),
        start: jiff::Timestamp::now(),
        end: None,
        status: Status::Planned,
        error: None,
        cell: cell.title.clone(),
        arm: cell.arms[arm].name.clone(),
        pattern: arguments.plan.pattern_name().to_owned(),
        motion: motion.report.clone(),
        times_s: Vec::new(),
        score: None,
    };
    if arguments.dry_run {
        write_manifest(&record, &directory)?;
        write_report(&record, &directory)?;
        return print_json(&record);
    }
    record.status = Status::Running;
    write_manifest(&record, &directory)?;
    let interrupted = watch_for_interruption()?;
    let correction = arguments
        .correct
        .then(|| Correction::usual(rod.gravito_bending_length, arguments.hand_speed));
    let task = DeployTask {
        cell: &cell,
        arm,
        motion: &motion,
        approach_speed: arguments.approach_speed,
        pattern: &pattern,
        path: &path,
        rod: &rod,
        colour: &colour,
        laying: correction.as_ref().map(|way| way as &dyn LayingMethod),
        unfinished: Some(&unfinished),
        settling: SETTLING,
        directory: &directory,
    };
    let end = task.run(&|| interrupted.load(Ordering::Relaxed));
    record.end = Some(jiff::Timestamp::now());
    record.times_s = end.times;
    let failure = match end.score {
        Ok(score) => {
            record.score(&score);
            record.status = Status::Finished;
            note_end(&unfinished).err()
        }
        Err(error) => {
            record.status = status_of(&error);
            record.error = Some(error.to_string());
            Some(ended_early(&error, &directory))
        }
    };
    write_manifest(&record, &directory)?;
    write_report(&record, &directory)?;
    match failure {
        Some(failure) => Err(failure),
        None => print_json(&record),
    }
}

/// Lays it in plain simulation, and writes the page.
fn simulate(directory: &Path, common: &Common) -> Result<(), Failure> {
    let scenario = directory.join("plan").join("landing.toml");
    let prepared = prepare(&case_set(&scenario, &[], &[])?)?;
    let options = RunOptions {
        progress: !common.quiet,
        ..RunOptions::new(directory.join("landing"))
    };
    let outcome = crate::run::run(&prepared, &options)?;
    let page = outcome.directory.join(PAGE);
    write_page(&outcome.directory, &page, OUTPUTS, &|_, _| {})?;
    print(&summary(&outcome))?;
    print(&format!("{:<24}{}\n", "page", page.display()))
}
