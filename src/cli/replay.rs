//! `rodlab replay`.

use super::picture_source::has_ending;
use super::prelude::*;
use super::view::show;
use nalgebra::{Point3, Vector3};
use rodlab_files::results::MANIFEST;
use rodlab_vision::{ColourRule, Point, read_picture};
use rodlab_workcell::cell::{Cell, Line};
use rodlab_workcell::recording::{Replay, ReplayedMotion, replay as read_log, unpack};
use rodlab_workcell::task::{DeployScore, LaidRod};
use std::fmt::Write;
use tempfile::TempDir;

/// Largest number of points of a path on the page.
const PATH_POINTS: usize = 150;
/// Radius of the lines of paths, m.
const LINE: f64 = 1.5e-3;

const EXAMPLES: &str = "\
Examples:
  rodlab replay results/deploy-2026-11-28T12-00-00 --open
  rodlab replay letter.mcap --cell cell.toml --json
  rodlab replay results/letter --colour red      score the picture by another colour

The page shows the arms as their joints reported them, the planned and the measured path of each
hand, and the rod in the picture. The table has the largest distances from the plan: of joints from
their commanded positions at the same time, which contains the delay of the controller, and of the
hand from its path.";

/// Arguments of `rodlab replay`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ReplayArguments {
    /// The results of a task in a cell, the log of `rodlab stream`, or their recording (.mcap)
    #[arg(value_name = "LOG")]
    pub source: PathBuf,
    /// Cell file [default: the one in manifest.json]
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Cell), add = presets(PresetKind::Cell))]
    pub cell: Option<PathBuf>,
    /// Colour of the rod, as in `rodlab trace`
    #[arg(long, value_name = "RULE", default_value = "auto")]
    pub colour: String,
    /// Output file [default: replay.html in the directory; beside a recording its name with .html]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Show at most this many postures, evenly spread
    #[arg(long, value_name = "N", default_value = "1000", value_parser = clap::value_parser!(u32).range(1..))]
    pub outputs: u32,
    /// Open the page in the browser
    #[arg(long)]
    pub open: bool,
    /// Print the numbers as JSON
    #[arg(long)]
    pub json: bool,
}

/// The answer of the command.
#[derive(Serialize)]
struct Answer<'a> {
    page: &'a Path,
    motions: &'a [ReplayedMotion],
    rods: Vec<ScoredRod>,
}

/// A laid rod.
#[derive(Serialize)]
struct ScoredRod {
    /// Folder of its stroke; empty if it is the only one.
    stroke: String,
    /// Score of the picture with this version and these options.
    score: Option<DeployScore>,
    /// Score in the results.
    recorded_score: Option<DeployScore>,
}

/// Shows the measured motion of a log, and scores its picture again.
pub fn replay(arguments: &ReplayArguments) -> Result<(), Failure> {
    let is_recording = has_ending(&arguments.source, &["mcap"]);
    let unpacked = is_recording
        .then(|| unpacked(&arguments.source))
        .transpose()?;
    let directory = unpacked.as_ref().map_or(&*arguments.source, TempDir::path);
    let colour = ColourRule::parse(&arguments.colour)?;
    let file = arguments.cell.clone();
    let file = file.map_or_else(|| cell_of(directory), Ok)?;
    let cell = Cell::read(&file)?;
    let log = read_log(directory, &cell).or_input()?;
    let mut lines = paths(&log, &cell);
    let picture = directory.join("picture.png");
    let mut rods = Vec::new();
    if picture.is_file() {
        let seen = read_picture(&picture)?;
        for laid in LaidRod::read(directory).or_input()? {
            let again = laid.score(&seen, &cell, &colour);
            let again = again.inspect_err(|error| {
                tracing::warn!("{} {}: {error}", picture.display(), laid.name);
            });
            let again = again.ok();
            lines.extend(again.iter().map(|again| rod_line(&laid, &again.rod)));
            rods.push(ScoredRod {
                stroke: laid.name,
                score: again.map(|again| again.score),
                recorded_score: laid.recorded,
            });
        }
    }
    let page = cell.page(Some(&log.measured), arguments.outputs as usize, &lines);
    let to = arguments.out.clone();
    let to = to.unwrap_or_else(|| match is_recording {
        true => arguments.source.with_extension("html"),
        false => directory.join("replay.html"),
    });
    write_file(&to, page.as_bytes())?;
    let answer = Answer {
        page: &to,
        motions: &log.motions,
        rods,
    };
    match arguments.json {
        true => print_json(&answer)?,
        false => print(&answer.table())?,
    }
    if arguments.open { show(&to) } else { Ok(()) }
}

/// The log inside a recording, in a temporary directory.
fn unpacked(recording: &Path) -> Result<TempDir, Failure> {
    let directory = tempfile::tempdir().at("no temporary directory can be made")?;
    unpack(recording, directory.path()).or_input()?;
    Ok(directory)
}

/// The cell file that a manifest names.
fn cell_of(directory: &Path) -> Result<PathBuf, Failure> {
    let path = directory.join(MANIFEST);
    let unknown = |reason: &dyn Display| {
        Failure::Input(format!(
            "{}: {reason}; --cell names the cell file",
            path.display()
        ))
    };
    let text = std::fs::read_to_string(&path).map_err(|error| unknown(&error))?;
    let manifest: serde_json::Value =
        serde_json::from_str(&text).map_err(|error| unknown(&error))?;
    let file = manifest["cell_file"].as_str().map(PathBuf::from);
    let file = file.ok_or_else(|| unknown(&"it names no `cell_file`"))?;
    match file.is_file() {
        true => Ok(file),
        false => Err(unknown(&format_args!(
            "its cell file {} is not there",
            file.display()
        ))),
    }
}

/// Planned and measured paths of the hands.
fn paths(log: &Replay, cell: &Cell) -> Vec<Line> {
    let line = |name: &str, path: &[[f64; 3]]| {
        let stride = path.len().div_ceil(PATH_POINTS).max(1);
        let points = path.iter().step_by(stride).chain(path.last());
        Line {
            name: name.to_owned(),
            radius: LINE,
            points: points.map(|point| Vector3::from(*point)).collect(),
        }
    };
    let planned = log.planned.iter().map(|(motion, path)| {
        let name = format!("planned path {motion}");
        line(name.trim_end(), path)
    });
    let measured = cell.hand_paths(&log.measured, 10 * PATH_POINTS);
    let measured = measured.iter().map(|path| line("measured path", path));
    planned.chain(measured).collect()
}

/// The rod of a picture, on the table.
fn rod_line(laid: &LaidRod, rod: &[Point]) -> Line {
    let stride = rod.len().div_ceil(PATH_POINTS).max(1);
    let place = |point: &Point| (laid.frame * Point3::new(point.x, point.y, laid.radius)).coords;
    Line {
        name: format!("rod in the picture {}", laid.name)
            .trim_end()
            .into(),
        radius: laid.radius,
        points: rod.iter().step_by(stride).map(place).collect(),
    }
}

impl Answer<'_> {
    fn table(&self) -> String {
        let mut text = format!("{}\n", self.page.display());
        let names = self.motions.iter().map(|motion| motion.name.len());
        let width = names.max().unwrap_or(0).max("motion".len());
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{:<width$}  begin    duration  joints off        hand off  end",
            "motion"
        );
        for motion in self.motions {
            let [joints, slides] = [
                motion.joints_off_rad.to_degrees(),
                1e3 * motion.slides_off_m,
            ];
            let _ = writeln!(
                text,
                "{:<width$}  {:>5.1} s  {:>6.1} s  {joints:>5.2}°, {slides:>5.2} mm  {:>5.2} mm  {}",
                motion.name,
                motion.begin_s,
                motion.duration_s,
                1e3 * motion.hand_off_m,
                motion.ending
            );
        }
        let scores = self.rods.iter().flat_map(|rod| {
            let named = |words: &str| match rod.stroke.as_str() {
                "" => String::from(words),
                stroke => format!("{stroke}, {words}"),
            };
            [
                (named("picture scored again"), &rod.score),
                (named("score in the results"), &rod.recorded_score),
            ]
        });
        for (name, score) in scores {
            if let Some(score) = score {
                let errors = [&score.by_arc_length, &score.by_nearest_point];
                let [along, near] = errors
                    .map(|error| [error.mean_m, error.deviation_m].map(|metres| 1e3 * metres));
                let _ = writeln!(
                    text,
                    "{name}: {:.2} ± {:.2} mm by arc length, {:.2} ± {:.2} mm by nearest point",
                    along[0], along[1], near[0], near[1]
                );
            }
        }
        text
    }
}
