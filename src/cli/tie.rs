//! `rodlab tie`.

use super::cell::FRICTION;
use super::cell_task::CellTask;
use super::chosen_cell::{CellChoice, FULL_SPEED, TaskCell};
use super::plan_deployment::DeploymentPlan;
use super::prelude::*;
use super::solve_arm::arm_named;
use super::task_arguments::TaskArguments;
use rodlab_planning::plan::deployment::Spare;
use rodlab_planning::plan::pattern::StrokeChoice;
use rodlab_vision::ColourRule;
use rodlab_workcell::task::{KnotPlan, TaskHead, TieMotion, TieMotionRequest, TieRecord, TieTask};
use rodlab_workcell::virtual_cell::{RodSupply, Settings};

/// Frames of the page of the arms in motion.
const FRAMES: usize = 600;
/// The preset cell with two arms.
const TWO_GANTRIES: &str = "two_gantries";

/// Arguments of `rodlab tie`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab tie --pattern trefoil --knot over,under,over                   in a virtual cell
  rodlab tie --pattern trefoil --rod thick_pink_vps --knot over,under,over --dry-run
  rodlab tie --pattern knot.svg --size \"30 cm\" --rod rod.toml --knot over,under,over --cell cell.toml --arm right --second-arm left
  rodlab tie --pattern reef --stroke 1 --rod thick_pink_vps --second-stroke 2 --second-rod green_vps \
    --knot over,over,under,over,over,under

Two arms tie a knot in one rod, or in two. The pattern crosses itself and is longer than the rod: one arm lays the rod along it, and leads its
end along the rest, under the strands that the other arm lifts meanwhile, and over others. --knot says how it passes each crossing
when it comes there again; the first ones, which are laid, go over. Of two rods each arm lays one, the second over the first, and
leads its end, that of the second first; --knot counts the second rod as it is laid, then its end, then that of the first. Then both let go, the camera of the cell file looks, and the
knot of the rod that it sees, by its determinant and signature, is compared with that of the pattern: `score.tied` is true or
false, or null where the picture does not decide, and `score.undecided` says why. Nothing moves with --dry-run: look at its page
first. Everything is in one directory: manifest.json, report.md, report.html, plan/, joints.csv, cell.html, approach/, laying/ and tying/
(commanded.csv, state.csv, events.csv), picture.png, overlay.png, rod.csv. Exit code 1: something failed on the way; the message and
report.md say what. A cell to try --cell with:
  rodlab cell serve --cell two_gantries --rod thick_pink_vps")]
pub struct TieArguments {
    #[command(flatten)]
    plan: DeploymentPlan,
    #[command(flatten)]
    choice: CellChoice,
    /// Name of the arm that lays the rod and leads its end [default: the first]
    #[arg(long, value_name = "NAME")]
    arm: Option<String>,
    /// Name of the arm that lifts strands, and lays a second rod [default: the first of the others]
    #[arg(long, value_name = "NAME")]
    second_arm: Option<String>,
    /// The second rod of a knot of two, as --rod: it is laid over the first, and its end is led before that of the first
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Rod), add = presets(PresetKind::Rod))]
    second_rod: Option<PathBuf>,
    /// Its pattern, an SVG or CSV file in the same frame [default: --pattern]
    #[arg(long, value_name = "FILE", requires = "second_rod", value_parser = file_or_preset(PresetKind::Pattern), add = presets(PresetKind::Pattern))]
    second_pattern: Option<PathBuf>,
    /// Which stroke of an SVG: its number from 1, its id, or `longest`; or which strand of a CSV file, from 1 [default: the only one]
    #[arg(long, value_name = "N|ID|longest", requires = "second_rod")]
    second_stroke: Option<StrokeChoice>,
    #[command(flatten)]
    task: TaskArguments,
}

/// Ties a knot.
pub fn tie(arguments: &TieArguments) -> Result<(), Failure> {
    let colour = ColourRule::parse(&arguments.task.colour)?;
    if !arguments.plan.ties_knot() {
        return Err(Failure::Input(
            "--knot is needed: over or under for each crossing, in the order in which the pattern comes there again, as in \
             --knot over,under,over"
                .into(),
        ));
    }
    let dry_run = arguments.task.dry_run;
    let chosen = arguments.choice.read(TWO_GANTRIES, dry_run)?;
    let arms = arguments.arms(&chosen)?;
    let cell = &chosen.cell;
    arguments.plan.use_rod_of(cell);
    if !dry_run {
        let camera = "its picture shows whether the knot is tied";
        chosen.refuse_unready(&arms, arguments.task.checked, camera)?;
    }
    let second = arguments.second()?;
    let mut outline = arguments.plan.outline()?;
    let second_points = second.iter().flat_map(|knot| knot.rods[1].points());
    outline.extend(second_points);
    let place = arguments.task.place(cell, &outline)?;
    // Before a directory is made.
    if second.is_none() {
        arguments.plan.check_knot()?;
    }
    let task = CellTask::new(
        "tie",
        arguments.task.out.as_deref(),
        &chosen,
        &arms,
        &arguments.choice,
    )?;
    let knot = match second {
        Some(knot) => knot,
        None => {
            let plan = task.directory.join("plan");
            let written = arguments.plan.write(&plan, &Spare::HANGS)?;
            written.knot.expect("a plan with --knot")
        }
    };
    let request = TieMotionRequest {
        cell,
        arms,
        place,
        speed: arguments.task.hand_speed,
        free_speed: arguments.task.approach_speed,
        margin: arguments.task.margin,
    };
    let motion = TieMotion::plan(&request, &knot)?;
    let whole = &motion.whole;
    task.write_motion(whole, FRAMES)?;
    let record = TieRecord {
        head: TaskHead::planned(std::env::args().collect()),
        cell: cell.title.clone(),
        arms: arms.map(|arm| cell.arms[arm].name.clone()),
        patterns: arguments.pattern_names(),
        passes: knot.passages.iter().map(|passage| passage.pass).collect(),
        drawn: knot.drawn,
        lifts: knot.lifts(),
        motion: motion.report.clone(),
        duration_s: whole.duration(),
        least_clearance_m: motion.least_clearance,
        times_s: Vec::new(),
        score: None,
    };
    let settings = || {
        // A person lays the free ends where the patterns begin.
        let supply = |number: usize, file: &Path| -> Result<RodSupply, Failure> {
            let start = knot.rods[number].pattern.at(0.0).position;
            let start = motion.frame * nalgebra::Point3::new(start.x, start.y, 0.0);
            Ok(RodSupply::new(file, FRICTION)?.with_free_end([start.x, start.y]))
        };
        let second = arguments.second_rod.as_deref();
        Ok(Settings {
            supply: Some(supply(0, arguments.plan.rod_file()?)?),
            second_supply: second.map(|file| supply(1, file)).transpose()?,
            ..Settings::empty(FULL_SPEED)
        })
    };
    chosen.work(settings, |cell| {
        let tying = TieTask {
            cell,
            arms,
            motion: &motion,
            knot: &knot,
            free_speed: arguments.task.approach_speed,
            colour: &colour,
            unfinished: match task.unfinished.as_slice() {
                [one, other] => Some([one, other]),
                _ => None,
            },
            directory: &task.directory,
        };
        task.carry_out(record, dry_run, |record, is_interrupted| {
            let end = tying.run(is_interrupted);
            record.times_s = end.times;
            record.head.stopped = end.stopped;
            record.score = Some(end.score?);
            Ok(())
        })
    })
}

impl TieArguments {
    /// The plan of a knot of two rods, where there is a second one.
    fn second(&self) -> Result<Option<KnotPlan>, Failure> {
        let Some(rod) = &self.second_rod else {
            return Ok(None);
        };
        let file = self.second_pattern.as_deref();
        let source = self.plan.second_source(file, self.second_stroke.as_ref())?;
        self.plan.knot_with(rod, &source).map(Some)
    }

    /// The patterns as they were given.
    fn pattern_names(&self) -> Vec<String> {
        let first = self.plan.pattern_name().to_owned();
        let second = self.second_rod.as_ref().map(|_| {
            let file = self.second_pattern.as_ref();
            let file = file.map_or_else(|| first.clone(), |file| file.display().to_string());
            match &self.second_stroke {
                Some(stroke) => format!("stroke {stroke} of {file}"),
                None => file,
            }
        });
        std::iter::once(first.clone()).chain(second).collect()
    }

    /// Indices of the arm that lays and of the one that lifts.
    fn arms(&self, chosen: &TaskCell) -> Result<[usize; 2], Failure> {
        let TaskCell { cell, file, .. } = chosen;
        let names: Vec<&str> = cell.arms.iter().map(|arm| arm.name.as_str()).collect();
        if names.len() < 2 {
            let found = names
                .first()
                .map_or("none".into(), |name| format!("one: {name}"));
            return Err(Failure::Input(format!(
                "{}: a knot takes two arms, one that leads the end and one that lifts strands; it has {found}",
                file.display()
            )));
        }
        let named = |flag: &str, name: &Option<String>| {
            let arm = name
                .as_deref()
                .map(|name| arm_named(cell, flag, Some(name), file));
            arm.transpose()
        };
        let layer = named("--arm", &self.arm)?;
        let lifter = named("--second-arm", &self.second_arm)?;
        let other = |known: Option<usize>| usize::from(known == Some(0));
        let layer = layer.unwrap_or_else(|| other(lifter));
        let lifter = lifter.unwrap_or_else(|| other(Some(layer)));
        if layer == lifter {
            return Err(Failure::Input(format!(
                "--second-arm: {} lays the rod and leads its end; another arm must lift strands",
                names[layer]
            )));
        }
        Ok([layer, lifter])
    }
}
