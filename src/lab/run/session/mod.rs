//! One call of `run` on a results directory: it starts or resumes, runs and concludes.
//!
//! `integrate` proceeds in time, `follow` along a path of equilibria.

mod follow;
mod integrate;

use super::advance::Advance;
use super::counters::Counters;
use super::end_state::rows_of;
use super::observer::Sample;
use super::output_times::OutputTimes;
use super::participants::{self, Participants, SavedStates};
use super::path::{PathAtWork, PathCheckpoint};
use super::progress::Progress;
use super::records::{manifest_of_call, place_start, recorder_plan, rod_records};
use super::stop::{Stop, StopRequests};
use super::{Mode, PreparedRun, Reached, RunError, RunOptions, RunOutcome, RunStatus};
use nalgebra::Isometry3;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{Obstacle, Start};
use rodlab_engine::mechanics::system::obstacle_poses;
use rodlab_files::results::{
    BRANCH, CaseRecord, CaseStatus, CheckpointFiles, FileMarks, Frame, MANIFEST, Manifest,
    Recorder, ResultsDirectory, ResultsError, Usage, UsageMeter, Value, check_lengths,
    scenario_hash, sync, write_end_state,
};
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};
use tracing::{info, warn};

/// Wall time between two log lines on the progress of a run.
const BETWEEN_WORDS: Duration = Duration::from_secs(10);

/// Wall time of a step above which the program may be killed during the next step; little work
/// must be lost then.
const LONG_STEP: Duration = Duration::from_millis(500);
/// Time between two checkpoints during such steps, as a multiple of the time to write one.
const BETWEEN_CHECKPOINTS: u32 = 20;

/// A run in progress.
pub struct Session {
    directory: ResultsDirectory,
    manifest: Manifest,
    recorder: Recorder,
    checkpoints: CheckpointFiles,
    checkpoint_every: Duration,
    last_checkpoint: Instant,
    /// Duration of the last checkpoint write.
    writing_time: Duration,
    times: OutputTimes,
    /// The path of equilibria that is followed.
    path: Option<PathAtWork>,
    /// Positions at the start, m.
    placed: Vec<Vector3>,
    /// Contents of the frames in addition to the rods.
    obstacles: Vec<Obstacle>,
    run_state: RunState,
    meter: UsageMeter,
    /// Time of the last log line on outputs.
    last_told: Instant,
    /// Wall time of the last step; infinite before the first.
    last_step: Duration,
    resumed_from: Option<Reached>,
    progress: Progress,
    /// Further remarks at the end, a line each.
    remarks: Vec<String>,
    /// Observers and controllers.
    participants: Participants,
}

/// Progress of a run.
#[derive(Clone, Default, Serialize, Deserialize)]
struct RunState {
    /// Outputs written so far.
    outputs: usize,
    counters: Counters,
    /// Cost of the previous calls.
    earlier_usage: Usage,
    /// States of observers and controllers at a checkpoint.
    participants: SavedStates,
}

/// Contents of a checkpoint.
#[derive(Serialize, Deserialize)]
struct Checkpoint<S> {
    state: S,
    files: FileMarks,
    run_state: RunState,
    path: Option<PathCheckpoint>,
}

impl Session {
    /// Starts from scratch, or resumes from the newest usable checkpoint and restores its state in
    /// `simulation`.
    pub fn begin<S: Advance>(
        directory: ResultsDirectory,
        simulation: &mut S,
        prepared: &PreparedRun,
        options: &RunOptions,
    ) -> Result<Self, RunError> {
        let meter = UsageMeter::start();
        let hash = scenario_hash(&prepared.scenario_toml);
        let rods = rod_records(prepared);
        let plan = recorder_plan(prepared);
        let participants = Participants::of(prepared);
        let mut checkpoints = CheckpointFiles::new(directory.path(), &hash);
        let continued = checkpoints.read(|mut checkpoint: Checkpoint<S::State>| {
            let (rods, plan) = (rods.clone(), plan.clone());
            let recorder = Recorder::continue_at(directory.path(), rods, plan, &checkpoint.files)?;
            let mut restored = participants.clone();
            restored.restore(&checkpoint.run_state.participants, directory.path())?;
            let path = checkpoint.path.take();
            let path = path.map(|path| PathAtWork::resume(path, &directory));
            Ok((checkpoint, restored, recorder, path.transpose()?))
        })?;
        if continued.is_none() && checkpoints.exist() {
            tracing::warn!(
                "no usable checkpoint in `{}`: starting again",
                directory.path().display()
            );
        }

        let manifest = manifest_of_call(
            prepared,
            options,
            directory.unfinished(),
            continued.is_some(),
        );
        manifest.place(directory.path())?;
        place_start(prepared, directory.path())?;

        let placed = simulation.frame(false).positions;
        let is_continued = continued.is_some();
        let (run_state, participants, recorder, path) = match continued {
            Some((checkpoint, participants, recorder, path)) => {
                let restored = simulation.restore(checkpoint.state);
                restored.map_err(RunError::Scene)?;
                (checkpoint.run_state, participants, recorder, path)
            }
            None => {
                let recorder = Recorder::create(directory.path(), rods, plan)?;
                (RunState::default(), participants, recorder, None)
            }
        };
        let times = match prepared.mode {
            Mode::Dynamic { end, .. } => OutputTimes::new(prepared.output.interval, end),
            Mode::Static | Mode::Continuation(_) => OutputTimes::only_start(),
        };
        let visible = options.progress && !matches!(prepared.mode, Mode::Static);
        let bar = Progress::bar(visible, options.among.as_ref());
        let range = match prepared.mode {
            Mode::Continuation(plan) => [plan.from, plan.to],
            Mode::Static | Mode::Dynamic { .. } => [0.0, times.time(times.last())],
        };
        let mut session = Self {
            progress: Progress::new(bar, simulation.time(), range),
            directory,
            manifest,
            recorder,
            checkpoints,
            checkpoint_every: options.checkpoint_every,
            last_checkpoint: Instant::now(),
            writing_time: Duration::ZERO,
            times,
            path,
            placed,
            obstacles: prepared.scene.obstacles.clone(),
            run_state,
            meter,
            last_told: Instant::now(),
            last_step: Duration::MAX,
            resumed_from: None,
            remarks: prepared.warnings.clone(),
            participants,
        };
        session.resumed_from = is_continued.then(|| session.reached(simulation));
        session.tell_beginning(prepared);
        Ok(session)
    }

    fn tell_beginning(&self, prepared: &PreparedRun) {
        let rods = &prepared.scene.rods;
        let nodes: usize = rods.iter().map(|rod| rod.centreline.len()).sum();
        let results = self.directory.path().display();
        match self.resumed_from {
            Some(from) => info!(%results, %from, "run continues"),
            None => info!(%results, rods = rods.len(), nodes, "run begins"),
        }
        for warning in &prepared.warnings {
            warn!("{warning}");
        }
    }

    /// Logs the progress of the run from time to time.
    fn tell_progress(&mut self, simulation: &impl Advance) {
        if self.last_told.elapsed() >= BETWEEN_WORDS {
            self.last_told = Instant::now();
            let outputs = self.run_state.outputs;
            info!(reached = %self.reached(simulation), outputs, "output written");
        }
    }

    /// Progress of the run.
    fn reached(&self, simulation: &impl Advance) -> Reached {
        if self.path.is_some() {
            Reached::Parameter(simulation.time())
        } else if self.times.last() > 0 {
            Reached::Time(simulation.time())
        } else {
            Reached::Start
        }
    }

    /// Runs to the end, or until there is a reason to stop.
    pub fn proceed(
        &mut self,
        simulation: &mut impl Advance,
        mode: Mode,
        stop_requested: StopRequests<'_>,
    ) -> Result<(), Stop> {
        match mode {
            Mode::Static => {
                self.settle(simulation, stop_requested)?;
                self.record(simulation)
            }
            Mode::Continuation(plan) => self.follow(simulation, plan, stop_requested),
            Mode::Dynamic { settles, .. } => {
                if settles && self.run_state.outputs == 0 {
                    self.settle(simulation, stop_requested)?;
                }
                self.integrate(simulation, stop_requested)
            }
        }
    }

    /// Finds the equilibrium.
    fn settle(
        &mut self,
        simulation: &mut impl Advance,
        stop_requested: StopRequests<'_>,
    ) -> Result<(), Stop> {
        let goes_on = || self.ask_to_stop(stop_requested).is_ok();
        let found = simulation.find_equilibrium(&goes_on)?;
        let report = found.ok_or_else(|| self.reason_to_stop(stop_requested))?;
        self.run_state.counters.add_equilibrium(&report);
        Ok(())
    }

    /// Whether an observer has ended the run.
    fn has_ended(&self) -> bool {
        self.run_state.counters.outcome.ending.is_some()
    }

    /// Input of observers now.
    fn sample_of<'a>(&self, simulation: &'a impl Advance) -> Option<Sample<'a>> {
        let counters = &self.run_state.counters;
        Some(Sample {
            simulation: simulation.simulation()?,
            steps: counters.outcome.steps,
            exchange: counters.exchange,
        })
    }

    /// Stops if requested.
    fn ask_to_stop(&self, stop_requested: StopRequests<'_>) -> Result<(), Stop> {
        if let Some(request) = stop_requested() {
            return Err(request.into());
        }
        Ok(())
    }

    /// The stop request that a search has just received.
    fn reason_to_stop(&self, stop_requested: StopRequests<'_>) -> Stop {
        let asked = self.ask_to_stop(stop_requested);
        asked.err().unwrap_or(Stop::Interrupted)
    }

    /// Time of an output, s, or the parameter of a point on a path.
    fn output_time(&self, index: usize) -> f64 {
        let path = self.path.as_ref();
        let parameter = path.and_then(|path| path.parameters.get(index).copied());
        parameter.unwrap_or_else(|| self.times.time(index))
    }

    /// Writes the output that is due now.
    fn record(&mut self, simulation: &impl Advance) -> Result<(), Stop> {
        let nearest = simulation.nearest();
        self.run_state.counters.note_nearest(nearest);
        self.run_state.counters.note_gap(simulation.mean_gap());
        let time = self.output_time(self.run_state.outputs);
        let energies = simulation.energies();
        self.run_state.counters.note_energies(&energies);
        let row = self.run_state.counters.take_row(time, nearest, &energies);
        let frame = if self.recorder.needs_frames() {
            Frame {
                time,
                obstacle_poses: self.obstacle_poses(time),
                contacts: if self.recorder.needs_contacts() {
                    simulation.contacts()
                } else {
                    Vec::new()
                },
                ..simulation.frame(self.recorder.needs_forces())
            }
        } else {
            Frame::default()
        };
        let mut values: Vec<Value> = Vec::new();
        let mut findings = Vec::new();
        if let Some(sample) = self.sample_of(simulation) {
            for observer in &mut self.participants.observers {
                let (cells, finding) = observer.measure(&sample, &row);
                values.extend(cells);
                findings.push(finding);
            }
        }
        let output = self.run_state.outputs;
        self.recorder.record(output, &row, &values, &frame)?;
        self.run_state.outputs += 1;
        self.tell_progress(simulation);
        Ok(self.run_state.counters.conclude_from(findings)?)
    }

    /// Poses of the obstacles, if the frames need them.
    fn obstacle_poses(&self, time: f64) -> Vec<Isometry3<f64>> {
        if !self.recorder.needs_obstacle_poses() {
            return Vec::new();
        }
        let poses = obstacle_poses(&self.obstacles, time);
        let poses = poses.iter();
        poses
            .map(|pose| Isometry3::from_parts(pose.translation.into(), pose.rotation))
            .collect()
    }

    /// Writes a checkpoint if the last one is old, or if steps are so long that a kill during a
    /// step would lose much work.
    fn write_checkpoint_if_due(&mut self, simulation: &impl Advance) -> Result<(), ResultsError> {
        let is_long = (LONG_STEP..Duration::MAX).contains(&self.last_step);
        let age = self.last_checkpoint.elapsed();
        let is_due = is_long && age >= BETWEEN_CHECKPOINTS * self.writing_time;
        if is_due || age >= self.checkpoint_every {
            self.write_checkpoint(simulation)
        } else {
            Ok(())
        }
    }

    fn write_checkpoint(&mut self, simulation: &impl Advance) -> Result<(), ResultsError> {
        let start = Instant::now();
        let files = self.sync_outputs()?;
        // Without the manifest the checkpoint could not be identified.
        sync(&self.directory.file(MANIFEST))?;
        let run_state = RunState {
            earlier_usage: self.usage(),
            participants: self.participants.save(),
            ..self.run_state.clone()
        };
        self.checkpoints.write(&Checkpoint {
            state: simulation.state(),
            files,
            run_state,
            path: self.path.as_mut().map(PathAtWork::checkpoint).transpose()?,
        })?;
        self.last_checkpoint = Instant::now();
        self.writing_time = start.elapsed();
        info!(reached = %self.reached(simulation), "checkpoint written");
        Ok(())
    }

    fn sync_outputs(&mut self) -> Result<FileMarks, ResultsError> {
        let times: Vec<f64> = (0..self.run_state.outputs)
            .map(|index| self.output_time(index))
            .collect();
        self.recorder.sync(times.into_iter())
    }

    /// Syncs all files to disk, including the state at the `end`, and records their final hashes.
    fn leave_outputs(&mut self, end: Option<Start>) -> Result<FileMarks, ResultsError> {
        let mut files = self.sync_outputs()?;
        if let Some(path) = &mut self.path {
            files.insert(BRANCH.to_owned(), path.sync()?);
        }
        if let Some(start) = end {
            write_end_state(self.directory.path(), &rows_of(&start, &self.manifest.rods))?;
        }
        // Frames were written one by one; the user might have removed some since.
        check_lengths(self.directory.path(), &files)?;
        Ok(files)
    }

    fn usage(&self) -> Usage {
        self.run_state.earlier_usage + self.meter.usage()
    }

    /// Writes the final state of all files.
    pub fn conclude(
        mut self,
        simulation: &impl Advance,
        result: Result<(), Stop>,
    ) -> Result<RunOutcome, RunError> {
        let directory = self.directory.path().to_owned();
        let result = result
            .and_then(|()| Ok(self.leave_outputs(simulation.as_start())?))
            .or_else(|stop| {
                // A failure to write the checkpoint is the more serious error.
                if stop.leaves_sound_state() && self.reached(simulation) != Reached::Start {
                    self.write_checkpoint(simulation)?;
                }
                Err(stop)
            });
        let reached = self.reached(simulation);
        let status = result
            .as_ref()
            .map_or_else(Stop::status, |_| CaseStatus::Finished);
        let reason = result.as_ref().err().map(Stop::reason);
        self.remarks.extend(simulation.remarks());
        let observers = self.participants.observers.iter();
        self.remarks.extend(observers.flat_map(|one| one.remarks()));
        let files = result.as_ref().ok().cloned().unwrap_or_default();
        let wall_time = self.usage().wall_time.as_secs_f64();
        let how = status.in_words();
        info!(status = how, %reached, steps = self.run_state.counters.outcome.steps, wall_time, "run ends");
        let written = self.write_tables(status, reason, files);
        match result {
            Ok(_) => written?,
            // An error that prevents writing the tables most likely ended the run itself.
            Err(stop) => {
                return Err(stop.into_error(self.reached(simulation), directory));
            }
        }
        self.checkpoints.remove()?;
        let observers = &self.participants.observers;
        let case = self.run_state.counters.outcome.clone();
        Ok(RunOutcome {
            directory,
            status: self
                .resumed_from
                .map_or(RunStatus::Finished, |from| RunStatus::Resumed { from }),
            highlights: participants::highlights(observers, &case),
            wall_time: self.usage().wall_time,
            case,
        })
    }

    fn write_tables(
        &mut self,
        status: CaseStatus,
        error: Option<String>,
        files: FileMarks,
    ) -> Result<(), ResultsError> {
        let path = self.directory.path();
        let outcome = &mut self.run_state.counters.outcome;
        outcome.observed = participants::outcomes(&self.participants.observers);
        outcome.remarks.clone_from(&self.remarks);
        let outcome = outcome.clone();
        let record = CaseRecord::with_usage(status, outcome, self.usage(), error);
        self.manifest.conclude(path, record, files)
    }
}
