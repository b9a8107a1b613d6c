//! `rodlab explore`.

use super::chosen_cell::{CellChoice, FULL_SPEED, TaskCell};
use super::interruption::watch_for_interruption;
use super::log_directory::{no_directory, results_directory};
use super::prelude::*;
use super::solve_arm::arm_named;
use rodlab_files::results::{MANIFEST, write_whole};
use rodlab_lab::experiment::ClampedRod;
use rodlab_vision::ColourRule;
use rodlab_workcell::task::{
    Exploration, ExplorationPlan, ExplorationRecord, ExplorationSummary, ExploreError, HandPlace,
    SearchSteps, Status, Stopped, quarter_sphere, read_directions, section, write_exploration,
};
use rodlab_workcell::virtual_cell::{ChuckedSupply, Settings};

/// Distances ‖(κ, τ, ω)‖ that are allowed, in words.
const DISTANCE: &str = "a distance from 0.01 to 100 is needed";
/// Frames of the page of the arm in motion.
const FRAMES: usize = 400;
/// The preset cell with a chuck.
const HELIX_GANTRY: &str = "helix_gantry";

/// Arguments of `rodlab explore`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rodlab explore --rod nitinol_wire --section 3                 in a virtual cell
  rodlab explore --rod nitinol_wire --section 8 --dry-run
  rodlab explore --rod nitinol_wire --spread 328 --cell cell.toml --out results/explored
  rodlab explore --rod nitinol_wire --directions mine.csv --step 0.25 --precision 0.02

A rod is clamped between a chuck that a stepper turns and the hand of an arm. Along each direction of (κ, τ, ω) both clamps are led
such that the rod is a helix, from the straight rod outwards; the camera looks at each step. Where the markers are not where those of
the helix would be, it has lost its stability: the arm goes back until it is a helix again, finds the place by finer steps, and
returns to the straight rod. Nothing moves with --dry-run, which tells how far each direction can be led. The same command with the same
--out goes on after any end, at the direction in which it was.
Everything is in one directory: manifest.json, exploration.csv (a row for each direction, written when it is done), report.md and
report.html with figures, plan.csv, cell.html, directions/ (looks.csv and a picture each), motion/ (the last motion). Exit code 1: something failed on
the way; the message and report.md say what; arm and chuck hold. `rodlab cell serve --cell helix_gantry --rod nitinol_wire` is a cell to try --cell
with.")]
pub struct ExploreArguments {
    /// The rod: TOML with youngs_modulus, poissons_ratio and density in [material], and radius, length and markers in [rod]
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Rod), add = presets(PresetKind::Rod))]
    rod: PathBuf,
    #[command(flatten)]
    directions: DirectionArguments,
    #[command(flatten)]
    choice: CellChoice,
    /// Name of the arm; not needed where the cell has only one
    #[arg(long, value_name = "NAME")]
    arm: Option<String>,
    /// Distance ‖(κ, τ, ω)‖ from look to look on the way out
    #[arg(long, value_name = "DISTANCE", default_value_t = 0.5, value_parser = number(is_distance, DISTANCE))]
    step: f64,
    /// The same for the second approach to an instability
    #[arg(long, value_name = "DISTANCE", default_value_t = 0.05, value_parser = number(is_distance, DISTANCE))]
    precision: f64,
    /// Distance at which a search ends
    #[arg(long, value_name = "DISTANCE", default_value_t = 14.0, value_parser = number(is_distance, DISTANCE))]
    farthest: f64,
    /// Mean distance of the markers from those of the helix, over the length of the rod, above which it is no helix
    #[arg(long, value_name = "PART", default_value_t = 0.015, value_parser = positive)]
    deviation: f64,
    /// Greatest speed of the hand on the way out, m/s
    #[arg(long, value_name = "SPEED", default_value_t = 0.05, value_parser = positive)]
    hand_speed: f64,
    /// Greatest speed of the hand on the way back, m/s
    #[arg(long, value_name = "SPEED", default_value_t = 0.1, value_parser = positive)]
    return_speed: f64,
    /// Greatest speed of the hand on the way to the straight rod, m/s
    #[arg(long, value_name = "SPEED", default_value_t = 0.1, value_parser = positive)]
    approach_speed: f64,
    /// Least distance of arm and rod to anything else, m
    #[arg(long, value_name = "DISTANCE", default_value_t = 0.015, value_parser = positive)]
    margin: f64,
    /// Which colours are markers, as of `rodlab measure markers`
    #[arg(long, value_name = "RULE", default_value = "blue")]
    colour: String,
    /// Keep no pictures
    #[arg(long)]
    no_pictures: bool,
    /// Plan everything, write the pages, and move nothing
    #[arg(long)]
    dry_run: bool,
    /// Where everything goes [default: results/explore-ROD]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct DirectionArguments {
    /// A table with the columns kappa, tau and omega, of any length
    #[arg(long, value_name = "FILE")]
    directions: Option<PathBuf>,
    /// So many directions, evenly spread over κ > 0 and τ > 0
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    spread: Option<u32>,
    /// So many directions with ω = 0, κ > 0 and τ > 0
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    section: Option<u32>,
}

impl DirectionArguments {
    fn list(&self) -> Result<Vec<[f64; 3]>, Failure> {
        if let Some(file) = &self.directions {
            return read_directions(file).or_input();
        }
        let spread = self.spread.map(|count| quarter_sphere(count as usize));
        let flat = self.section.map(|count| section(count as usize));
        Ok(spread.or(flat).unwrap_or_default())
    }
}

fn is_distance(distance: f64) -> bool {
    (0.01..=100.0).contains(&distance)
}

/// Explores the stability of helical rods.
pub fn explore(arguments: &ExploreArguments) -> Result<(), Failure> {
    if arguments.precision > arguments.step {
        return Err(Failure::Input(format!(
            "--precision is {}; allowed: at most --step, {}",
            arguments.precision, arguments.step
        )));
    }
    let directions = arguments.directions.list()?;
    let colour = ColourRule::parse(&arguments.colour)?;
    let rod = ClampedRod::read(&arguments.rod)?;
    let chosen = arguments.choice.read(HELIX_GANTRY, arguments.dry_run)?;
    let arm = arguments.arm.as_deref();
    let arm = arm_named(&chosen.cell, "--arm", arm, &chosen.file)?;
    let stem = arguments.rod.file_stem().unwrap_or_default();
    let stem = stem.to_string_lossy();
    let directory = results_directory(arguments.out.as_deref(), &format!("explore-{stem}"));
    let settings = || {
        Ok(Settings {
            chucked: ChuckedSupply::new(&arguments.rod, &chosen.cell)?,
            ..Settings::empty(FULL_SPEED)
        })
    };
    chosen.work(settings, |cell| {
        let exploration = Exploration {
            cell,
            arm,
            rod: &rod,
            directions: &directions,
            farthest: arguments.farthest,
            margin: arguments.margin,
            search: SearchSteps {
                step: arguments.step,
                precision: arguments.precision,
                deviation: arguments.deviation,
                speed: arguments.hand_speed,
                return_speed: arguments.return_speed,
            },
            approach_speed: arguments.approach_speed,
            colour: &colour,
            keeps_pictures: !arguments.no_pictures,
            directory: &directory,
        };
        arguments.carry_out(&exploration, &chosen)
    })
}

impl ExploreArguments {
    /// Shows an exploration, and carries it out, unless it is a dry run.
    fn carry_out(&self, exploration: &Exploration<'_>, chosen: &TaskCell) -> Result<(), Failure> {
        let directory = exploration.directory;
        let failed = |error| failed(error, directory);
        let start = exploration.start().map_err(failed)?;
        // A simulated cell is new each time, with its rod in the chuck.
        let is_clamped = is_clamped(directory, &exploration.plan())? && !chosen.is_virtual;
        std::fs::create_dir_all(directory).map_err(|error| no_directory(directory, &error))?;
        let mut record = exploration.record(std::env::args().collect());
        record.is_clamped = is_clamped;
        let first = exploration.ray(&start, 0);
        let page = exploration.page(&first, FRAMES).map_err(failed)?;
        write_whole(&directory.join("cell.html"), page.as_bytes())?;
        if self.dry_run {
            exploration.write_plan(&start).map_err(failed)?;
            record.summary = ExplorationSummary::of(&exploration.rows()?);
            return finish(&mut record, exploration, None, &self.choice);
        }
        chosen.confirm(&[exploration.arm], directory, &self.choice)?;
        let interrupted = watch_for_interruption()?;
        record.head.status = Status::Running;
        record.write(directory)?;
        let ended = exploration.run(&mut record, &|| interrupted.is_raised());
        record.head.end = Some(jiff::Timestamp::now());
        finish(&mut record, exploration, ended.err(), &self.choice)
    }
}

/// Writes manifest and page, and prints the record or says why it ended early.
fn finish(
    record: &mut ExplorationRecord,
    exploration: &Exploration<'_>,
    error: Option<ExploreError>,
    choice: &CellChoice,
) -> Result<(), Failure> {
    if record.head.status == Status::Running {
        record.head.status = match &error {
            None => Status::Finished,
            Some(ExploreError::Interrupted) => Status::Interrupted,
            Some(_) => Status::Failed,
        };
    }
    record.head.error = error.as_ref().map(ToString::to_string);
    let left_by = |error| left_by(error, record, exploration);
    record.head.stopped = error.as_ref().and_then(left_by);
    record.write(exploration.directory)?;
    let report = write_exploration(record, &exploration.rows()?, exploration.directory)?;
    match error {
        Some(error) => Err(failed(error, exploration.directory)),
        None => choice.print(&report, &record.summary, exploration.directory),
    }
}

/// How an error left the cell.
fn left_by(
    error: &ExploreError,
    record: &ExplorationRecord,
    exploration: &Exploration<'_>,
) -> Option<Stopped> {
    let during = match error {
        ExploreError::Failed { doing, .. } => doing.clone(),
        ExploreError::Interrupted => {
            let done = exploration.rows().map_or(0, |rows| rows.len());
            format!(
                "exploring direction {} of {}",
                done + 1,
                record.plan.directions.len()
            )
        }
        ExploreError::Input(_) | ExploreError::Results(_) => return None,
    };
    let rod = match record.is_clamped {
        true => "the rod is clamped between chuck and hand",
        false => "no rod is clamped",
    };
    Some(Stopped {
        during,
        laid: Vec::new(),
        hands: vec![HandPlace::of(exploration.cell, exploration.arm)],
        next: format!(
            "{rod}: look at arm, chuck and rod, then run the same command again; directions that are done are kept"
        ),
    })
}

fn failed(error: ExploreError, directory: &Path) -> Failure {
    let message = format!("{error}; the log is in {}", directory.display());
    match error {
        ExploreError::Input(words) => Failure::Input(words),
        ExploreError::Interrupted => Failure::interrupted(message),
        ExploreError::Results(error) => error.into(),
        ExploreError::Failed { .. } => Failure::System(message),
    }
}

/// Whether a rod is clamped already, as an earlier call with the same plan says in its manifest.
fn is_clamped(directory: &Path, plan: &ExplorationPlan) -> Result<bool, Failure> {
    let refused = |what: &str| {
        Err(Failure::Input(format!(
            "--out: {} {what}; choose another directory",
            directory.display()
        )))
    };
    let Ok(mut entries) = std::fs::read_dir(directory) else {
        return Ok(false);
    };
    if entries.next().is_none() {
        return Ok(false);
    }
    let text = std::fs::read(directory.join(MANIFEST)).unwrap_or_default();
    let Ok(manifest) = serde_json::from_slice::<serde_json::Value>(&text) else {
        return refused("holds something else");
    };
    // Numbers as they are read back.
    let plan = serde_json::to_string(plan).expect("names and numbers are JSON values");
    let plan: serde_json::Value = serde_json::from_str(&plan).expect("as it was written");
    if manifest["plan"] != plan {
        return refused("holds another exploration");
    }
    Ok(manifest["is_clamped"] == true)
}
