//! `rodlab stream`.

use super::interruption::{Interruption, watch_for_interruption};
use super::live_page::LiveArguments;
use super::log_directory::log_directory;
use super::prelude::*;
use super::safety_signals::{open_diagnostics, open_signals, write_signals};
use rodlab_files::results::write_whole;
use rodlab_robot::{
    Ending, JointState, JointTrajectory, StreamLog, StreamState, Supervisor, stream as run,
};
use rodlab_workcell::cell::{ArmGuard, Cell, Driver, Signals, StreamReport};
use rodlab_workcell::live::LivePage;
use rodlab_workcell::task::{Display, Displays, FirstRun, SpeedOverride, write_manifest};

const HELP: [&str; 2] = help!(
    "\
Examples:
  rodlab stream joints.csv --cell cell.toml --dry-run
  rodlab stream joints.csv --cell cell.toml --speed 0.2
  rodlab stream right.csv left.csv twist.csv --cell scenarios/cells/two_sawyers.toml",
    "\
The motion is checked against limits and collisions before the first point is sent, also between the
points. The motion starts only if every joint is at its first point. The motion is finished when the
joints are reported at the last point, at rest. If reports cease or a joint leaves its path, the
motion ends: every arm is commanded to hold, and monitored until it is at rest. Ctrl-C and Ctrl-Z,
SIGTERM, SIGHUP, SIGQUIT, SIGUSR1 and SIGUSR2 have the same effect.

The log is a directory with manifest.json, trajectory.csv (for several, trajectory-1.csv and so on),
commanded.csv, state.csv, events.csv and, if the cell has safety signals, signals.csv. Exit code 1: a driver failed; the message gives the reason."
);

/// Arguments of `rodlab stream`.
#[derive(Debug, Args)]
#[command(after_help = HELP[0], after_long_help = HELP[1])]
pub struct StreamArguments {
    /// Joint trajectory; several, one for each arm or axis, start together on one clock
    ///
    /// A table with time_s and a column arm.joint_rad, arm.joint_m or axis_rad per joint.
    #[arg(required = true, value_name = "TRAJECTORY")]
    trajectories: Vec<PathBuf>,
    /// The cell file
    #[arg(long, value_name = "FILE", value_parser = file_or_preset(PresetKind::Cell), add = presets(PresetKind::Cell))]
    cell: PathBuf,
    /// Speed relative to that of the trajectory
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = within(0.01, 10.0))]
    speed: f64,
    #[command(flatten)]
    live: LiveArguments,
    /// Check everything and print the plan, but move nothing
    #[arg(long)]
    dry_run: bool,
    /// Directory for the log [default: results/stream-TIME]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Manifest of a stream.
#[derive(Serialize)]
struct Manifest<'a> {
    version: &'static str,
    command_line: Vec<String>,
    cell: &'a Path,
    cell_file: Option<PathBuf>,
    trajectories: &'a [PathBuf],
    trajectory_hashes: Vec<String>,
    speed: f64,
    start: jiff::Timestamp,
    end: Option<jiff::Timestamp>,
    status: &'static str,
    error: Option<String>,
    /// The signal that ended the motion.
    interrupted_by: Option<&'static str>,
    #[serde(flatten)]
    report: StreamReport,
}

/// A motion that ends when the user interrupts it, a signal forbids it, or an arm exceeds its
/// limits.
struct Guarded<'a> {
    guard: ArmGuard<'a>,
    signals: &'a Signals,
    interrupted: &'a Interruption,
    speed: &'a SpeedOverride,
    page: Option<&'a LivePage>,
    display: Displays<'a>,
}

impl Supervisor for Guarded<'_> {
    fn is_interrupted(&self) -> bool {
        self.interrupted.is_raised() || self.page.is_some_and(LivePage::is_stopped)
    }

    fn forbids(&self) -> Option<String> {
        self.signals.fault()
    }

    fn pace(&self) -> f64 {
        self.speed.get().min(self.signals.speed())
    }

    fn show(&self, state: &StreamState) {
        self.display.motion(state, None);
    }

    fn refuses(&self, part: &str, time: f64, state: &JointState) -> Option<String> {
        self.display.joints(part, &state.positions);
        self.guard.fault(part, time, state)
    }
}

/// Streams trajectories.
pub fn stream(arguments: &StreamArguments) -> Result<(), Failure> {
    let cell = Cell::read(&arguments.cell)?;
    let files = &arguments.trajectories;
    let planned = files
        .iter()
        .map(|path| JointTrajectory::read(path))
        .collect::<Result<Vec<_>, _>>();
    let planned = planned.or_input()?;
    let first_run = FirstRun::of(&cell, "stream", &planned);
    let speed = first_run.speed(arguments.speed);
    let trajectories: Vec<_> = planned.iter().map(|motion| motion.scaled(speed)).collect();
    let names: Vec<_> = files
        .iter()
        .map(|file| file.display().to_string())
        .collect();
    let (mut parts, report) = cell.prepare_stream(&trajectories).at(names.join(", "))?;
    if arguments.dry_run {
        return print_json(&report);
    }
    let speed_override = arguments.live.speed(&cell)?;
    let signals = open_signals(&cell)?;
    let diagnostics = open_diagnostics(&cell)?;
    let directory = log_directory("stream", arguments.out.as_deref())?;
    let mut hashes = Vec::new();
    for (k, trajectory) in trajectories.iter().enumerate() {
        let name = match trajectories.len() {
            1 => "trajectory.csv".to_owned(),
            _ => format!("trajectory-{}.csv", k + 1),
        };
        let text = trajectory.to_csv()?;
        write_whole(&directory.join(name), text.as_bytes())?;
        hashes.push(blake3::hash(text.as_bytes()).to_hex().to_string());
    }
    let mut manifest = Manifest {
        version: env!("CARGO_PKG_VERSION"),
        command_line: std::env::args().collect(),
        cell: &arguments.cell,
        cell_file: std::path::absolute(&arguments.cell).ok(),
        trajectories: files,
        trajectory_hashes: hashes,
        speed,
        start: jiff::Timestamp::now(),
        end: None,
        status: "running",
        error: None,
        interrupted_by: None,
        report,
    };
    write_manifest(&manifest, &directory)?;
    let unwritable = |error: std::io::Error| {
        Failure::System(format!(
            "{} cannot be written: {error}",
            directory.display()
        ))
    };
    let mut log = StreamLog::open(&directory).map_err(unwritable)?;
    let page = arguments.live.page(&cell, &trajectories, &speed_override)?;
    let interrupted = watch_for_interruption()?;
    let pages = page.iter().map(|page| page as &dyn Display);
    let topics = diagnostics.iter().map(|topic| topic as &dyn Display);
    let guarded = Guarded {
        guard: ArmGuard::new(&cell),
        signals: &signals,
        interrupted: &interrupted,
        speed: &speed_override,
        page: page.as_ref(),
        display: Displays(pages.chain(topics).collect()),
    };
    let ending = run(&mut parts, &cell.streaming, &guarded, &mut log);
    let logged = log.finish().map_err(unwritable);
    let listed = write_signals(&signals, &directory);
    manifest.end = Some(jiff::Timestamp::now());
    manifest.interrupted_by = interrupted.signal();
    (manifest.status, manifest.error) = match &ending {
        Ending::Finished => ("finished", None),
        Ending::Interrupted => ("interrupted", None),
        Ending::Failed(reason) => ("failed", Some(reason.clone())),
    };
    write_manifest(&manifest, &directory)?;
    let words = manifest.error.as_deref().unwrap_or(manifest.status);
    if let Some(diagnostics) = diagnostics {
        diagnostics.end(match ending {
            Ending::Finished => Ok(words),
            Ending::Interrupted | Ending::Failed(_) => Err(words),
        });
    }
    if let Some(page) = page {
        page.end(words);
    }
    match ending {
        Ending::Failed(reason) => Err(Failure::System(format!(
            "{reason}\nthe log is in {}",
            directory.display()
        ))),
        Ending::Interrupted => Err(Failure::interrupted(format!(
            "interrupted by {}; everything holds; the log is in {}",
            interrupted.signal().unwrap_or("the live page"),
            directory.display()
        ))),
        Ending::Finished => {
            logged?;
            listed?;
            first_run.finished().map_err(Failure::system)?;
            // A driver that writes to standard output uses it exclusively.
            if drives_standard_output(&cell) {
                Ok(())
            } else {
                print_json(&manifest)
            }
        }
    }
}

fn drives_standard_output(cell: &Cell) -> bool {
    let arms = cell.arms.iter().map(|arm| &arm.driver);
    let axes = cell.axes.iter().map(|axis| &axis.driver);
    arms.chain(axes)
        .any(|driver| matches!(driver, Some(Driver::File { path: None, .. })))
}
