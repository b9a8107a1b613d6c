//! `rodlab explore`.

use super::prelude::*;
use super::preset_file::preset_file;
use rodlab_lab::experiment::ClampedRod;
use rodlab_vision::ColourRule;
use rodlab_workcell::cell::Cell;
use rodlab_workcell::task::{
    Exploration, ExplorationTask, ExploreError, Planning, SearchSteps, TaskCommand, Way,
    quarter_sphere, read_directions, section,
};
use rodlab_workcell::virtual_cell::ChuckedSupply;

/// The preset rod that is explored if none is given.
const PRESET: &str = "nitinol_wire";
/// Allowed distances ‖(κ, τ, ω)‖, as text.
const DISTANCE: &str = "a distance from 0.01 to 100 is needed";

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab explore --rod nitinol_wire --section 3                 in a virtual cell
  rodlab explore --rod nitinol_wire --section 8 --dry-run
  rodlab explore --rod nitinol_wire --spread 328 --cell cell.toml --out results/explored
  rodlab explore --rod nitinol_wire --directions mine.csv --step 0.25 --precision 0.02",
    "\
A rod is clamped between a chuck that a stepper turns and the hand of an arm. Along each direction
of (κ, τ, ω) both clamps move so that the rod is a helix, starting from the straight rod; the
camera takes a picture at each step. Where the markers deviate from those of the helix, the rod has
lost its stability: the arm returns until the rod is a helix again, locates the instability by finer
steps, and returns to the straight rod. With --dry-run nothing moves; it prints how far each
direction can be followed. The same command with the same --out resumes at the direction at which an
earlier one ended.

All results are in one directory: manifest.json, exploration.csv (a row for each direction, written
when it is done), report.md and report.html with figures, plan.csv, joints.csv, cell.html,
directions/ (looks.csv and a picture each), motion/ (the last motion). Exit code 1: a step failed;
the message and report.md give the reason; arm and chuck hold. A cell for trying --cell:
  rodlab cell serve --cell helix_gantry --rod nitinol_wire"
);

/// Arguments of `rodlab explore`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct ExploreArguments {
    /// Rod file: TOML with [material] and [rod] [default: the rod of the cell, or the preset nitinol_wire]
    ///
    /// [material] has youngs_modulus, poissons_ratio and density, [rod] radius, length and markers.
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Rod), add = presets(PresetKind::Rod))]
    rod: Option<PathBuf>,
    #[command(flatten)]
    directions: DirectionArguments,
    /// Name of the arm; optional if the cell has only one
    #[arg(long, value_name = "NAME")]
    arm: Option<String>,
    /// Distance ‖(κ, τ, ω)‖ between pictures in the first approach
    #[arg(long, value_name = "DISTANCE", default_value_t = 0.5, value_parser = number(is_distance, DISTANCE))]
    step: f64,
    /// Distance between pictures in the second approach to an instability
    #[arg(long, hide_short_help = true, value_name = "DISTANCE", default_value_t = 0.05, value_parser = number(is_distance, DISTANCE))]
    precision: f64,
    /// Distance at which a search ends
    #[arg(long, value_name = "DISTANCE", default_value_t = 14.0, value_parser = number(is_distance, DISTANCE))]
    farthest: f64,
    /// Distance of the markers from the helix, over the rod length, above which the rod is unstable
    #[arg(long, value_name = "PART", default_value_t = 0.015, value_parser = positive)]
    deviation: f64,
    /// Largest speed of the hand while it deforms the rod, m/s
    #[arg(long, value_name = "SPEED", default_value_t = 0.05, value_parser = positive)]
    hand_speed: f64,
    /// Largest speed of the hand while it returns, m/s
    #[arg(long, hide_short_help = true, value_name = "SPEED", default_value_t = 0.1, value_parser = positive)]
    return_speed: f64,
    /// Largest speed of the hand as it approaches the straight rod, m/s
    #[arg(long, hide_short_help = true, value_name = "SPEED", default_value_t = 0.1, value_parser = positive)]
    approach_speed: f64,
    /// Least distance of arm and rod to anything else, m
    #[arg(long, hide_short_help = true, value_name = "DISTANCE", default_value_t = 0.015, value_parser = positive)]
    margin: f64,
    /// Colour of the markers, as in `rodlab measure markers`
    #[arg(long, value_name = "RULE", default_value = "blue")]
    colour: String,
    /// Keep no pictures
    #[arg(long)]
    no_pictures: bool,
    /// Plan everything and write the pages, but move nothing
    #[arg(long)]
    dry_run: bool,
    /// Directory for the results [default: results/explore-ROD, without --rod results/explore]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct DirectionArguments {
    /// Table of directions: vectors with columns kappa, tau and omega
    #[arg(long, value_name = "FILE")]
    directions: Option<PathBuf>,
    /// Number of directions, evenly spread over κ > 0 and τ > 0
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    spread: Option<u32>,
    /// Number of directions with ω = 0, κ > 0 and τ > 0
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

impl ExploreArguments {
    /// The given rod file, otherwise that of the cell, or of the preset.
    fn rod_file(&self, cell: &Cell) -> Result<PathBuf, Failure> {
        if let Some(given) = &self.rod {
            return Ok(given.clone());
        }
        if let Some(file) = &cell.rod {
            tracing::warn!("no --rod: using {} of the cell", file.display());
            return Ok(file.clone());
        }
        tracing::warn!("no --rod: using the preset `{PRESET}`");
        preset_file(PresetKind::Rod, PRESET)
    }
}

fn is_distance(distance: f64) -> bool {
    (0.01..=100.0).contains(&distance)
}

impl TaskCommand for ExploreArguments {
    const NAME: &'static str = "explore";
    const CELL: &'static str = "helix_gantry";
    type Task = ExplorationTask;
    type Error = Failure;

    fn way(&self) -> Way<'_> {
        Way {
            arm: self.arm.as_deref(),
            dry_run: self.dry_run,
            checked: None,
            out: self.out.as_deref(),
        }
    }

    fn check(&self) -> Result<(), Failure> {
        if self.precision > self.step {
            return Err(Failure::Input(format!(
                "--precision is {}; allowed: at most --step, {}",
                self.precision, self.step
            )));
        }
        self.directions.list().map(drop)
    }

    fn resumed_in(&self) -> Option<String> {
        let stem = self.rod.as_ref().and_then(|rod| rod.file_stem());
        Some(match stem {
            Some(stem) => format!("explore-{}", stem.to_string_lossy()),
            None => "explore".to_owned(),
        })
    }

    fn plan(&self, planning: &Planning<'_>, arms: &[usize]) -> Result<ExplorationTask, Failure> {
        let rod = self.rod_file(planning.cell)?;
        let exploration = Exploration {
            arm: arms[0],
            rod: ClampedRod::read(&rod)?,
            directions: self.directions.list()?,
            farthest: self.farthest,
            margin: self.margin,
            search: SearchSteps {
                step: self.step,
                precision: self.precision,
                deviation: self.deviation,
                speed: self.hand_speed,
                return_speed: self.return_speed,
            },
            approach_speed: self.approach_speed,
            colour: ColourRule::parse(&self.colour)?,
            keeps_pictures: !self.no_pictures,
        };
        let Planning {
            cell, is_virtual, ..
        } = planning;
        // A simulated cell starts from its initial state in each task, with its rod in the chuck.
        let task = ExplorationTask::new(exploration, cell, planning.results(), *is_virtual);
        let task = task.map_err(|error| match error {
            ExploreError::Input(words) => Failure::Input(words),
            ExploreError::Results(error) => error.into(),
        })?;
        planning.furnish(|settings| -> Result<(), Failure> {
            settings.chucked = ChuckedSupply::new(&rod, cell)?;
            Ok(())
        })?;
        Ok(task)
    }
}
