//! What the live page shows, shared with the thread of its server.

use crate::cell::{Cell, Line};
use crate::task::{LaidLength, SpeedOverride, described};
use nalgebra::Point3;
use rodlab_robot::StreamState;
use serde::Serialize;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Time after a request for which a page counts as open.
const OPEN: Duration = Duration::from_secs(2);

/// Least distance between two points of the path of a hand, m.
const STEP: f64 = 2e-3;

/// What stays the same during a task.
pub(super) struct Scene {
    pub cell: Cell,
    /// Planned paths of the hands, m.
    pub plans: Vec<Vec<[f64; 3]>>,
    /// The reason why the speed cannot change.
    pub fixed: Option<String>,
}

/// The [`Scene`] as the page reads it.
#[derive(Serialize)]
struct SceneText<'a> {
    title: &'a str,
    version: &'static str,
    boxes: Vec<Stroke>,
    plans: &'a [Vec<[f64; 3]>],
    trails: &'a [Vec<[f64; 3]>],
    fixed: Option<&'a str>,
}

/// What changes during a task.
#[derive(Default, Serialize)]
pub(super) struct State {
    pub step: Option<StepState>,
    pub motion: Option<MotionState>,
    /// Positions of the joints of each arm, rad or m.
    #[serde(skip)]
    pub joints: Vec<Vec<f64>>,
    /// Paths of the hands so far, m.
    #[serde(skip)]
    pub trails: Vec<Vec<[f64; 3]>>,
    pub picture: Option<Picture>,
    /// The end of the task in words.
    pub ended: Option<String>,
}

/// A step of the task.
#[derive(Clone, Serialize)]
pub(super) struct StepState {
    pub number: usize,
    pub of: usize,
    pub words: String,
}

/// A motion in progress.
#[derive(Clone, Serialize)]
pub(super) struct MotionState {
    time_s: f64,
    duration_s: f64,
    /// The state as text.
    words: String,
    /// Present speed relative to the planned one.
    speed: Option<f64>,
}

impl MotionState {
    pub(super) fn of(state: &StreamState, laid: Option<LaidLength>) -> Self {
        Self {
            time_s: state.time,
            duration_s: state.duration,
            words: described(state, laid),
            speed: state.pace,
        }
    }
}

/// The last picture: a file of the results, with a number that grows.
#[derive(Clone, Serialize)]
pub(super) struct Picture {
    pub name: String,
    pub number: usize,
    #[serde(skip)]
    pub file: PathBuf,
}

impl State {
    /// The state of the arms of a cell at home.
    pub(super) fn at_home(cell: &Cell) -> Self {
        Self {
            joints: cell.arms.iter().map(|arm| arm.home.clone()).collect(),
            trails: vec![Vec::new(); cell.arms.len()],
            ..Self::default()
        }
    }

    /// Moves an arm of a cell to joint positions, rad or m.
    pub(super) fn move_arm(&mut self, cell: &Cell, arm: usize, joints: &[f64]) {
        // The same report may come again.
        if self.joints[arm] == joints {
            return;
        }
        self.joints[arm] = joints.to_vec();
        let hand = hand(cell, arm, joints);
        let trail = &mut self.trails[arm];
        let is_far = |last: &[f64; 3]| (Point3::from(*last) - Point3::from(hand)).norm() > STEP;
        if trail.last().is_none_or(is_far) {
            trail.push(hand);
        }
    }
}

/// Position of the hand of an arm, m.
fn hand(cell: &Cell, arm: usize, joints: &[f64]) -> [f64; 3] {
    cell.arms[arm].hand(joints).translation.vector.into()
}

fn strokes(lines: Vec<Line>) -> Vec<Stroke> {
    lines.into_iter().map(Stroke::from).collect()
}

/// The state as the page reads it.
#[derive(Serialize)]
struct StateText<'a> {
    #[serde(flatten)]
    state: &'a State,
    /// Links of each arm.
    arms: Vec<Vec<Stroke>>,
    /// Positions of the hands, m.
    hands: Vec<[f64; 3]>,
    /// The wanted speed relative to the planned one.
    wanted: f64,
    is_stopped: bool,
}

/// Everything that the threads share.
pub(super) struct Shared {
    scene: Scene,
    state: Mutex<State>,
    /// Time of the last request, and whether it has read the end of the task.
    read: Mutex<(Option<Instant>, bool)>,
    end_was_read: Condvar,
    pub speed: SpeedOverride,
    pub is_stopped: AtomicBool,
    pub token: String,
}

impl Shared {
    pub(super) fn new(scene: Scene, speed: SpeedOverride, token: String) -> Self {
        Self {
            state: Mutex::new(State::at_home(&scene.cell)),
            scene,
            read: Mutex::default(),
            end_was_read: Condvar::new(),
            speed,
            is_stopped: AtomicBool::new(false),
            token,
        }
    }

    pub(super) fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The cell.
    pub(super) fn cell(&self) -> &Cell {
        &self.scene.cell
    }

    /// Whether the speed can change.
    pub(super) fn is_adjustable(&self) -> bool {
        self.scene.fixed.is_none()
    }

    /// The scene and the paths of the hands so far as JSON.
    pub(super) fn scene_text(&self) -> String {
        let state = self.state();
        let scene = SceneText {
            title: &self.scene.cell.title,
            version: rodlab_files::origin::VERSION,
            boxes: strokes(self.scene.cell.box_lines()),
            plans: &self.scene.plans,
            trails: &state.trails,
            fixed: self.scene.fixed.as_deref(),
        };
        serde_json::to_string(&scene).unwrap_or_default()
    }

    /// The state as JSON.
    pub(super) fn state_text(&self) -> String {
        let state = self.state();
        let cell = &self.scene.cell;
        let postures = || state.joints.iter().enumerate();
        let text = serde_json::to_string(&StateText {
            state: &state,
            arms: postures()
                .map(|(arm, joints)| strokes(cell.arm_lines(arm, joints)))
                .collect(),
            hands: postures()
                .map(|(arm, joints)| hand(cell, arm, joints))
                .collect(),
            wanted: self.speed.get(),
            is_stopped: self.is_stopped.load(Ordering::Relaxed),
        });
        let has_ended = state.ended.is_some();
        drop(state);
        *self.read() = (Some(Instant::now()), has_ended);
        if has_ended {
            self.end_was_read.notify_all();
        }
        text.unwrap_or_default()
    }

    fn read(&self) -> MutexGuard<'_, (Option<Instant>, bool)> {
        self.read.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether a browser shows the page.
    pub(super) fn is_read(&self) -> bool {
        let (last, _) = *self.read();
        last.is_some_and(|last| last.elapsed() < OPEN)
    }

    /// Waits until a browser that shows the page has read the end of the task.
    pub(super) fn wait_for_reader(&self, most: Duration) {
        if self.is_read() {
            let read = self.read();
            let waits = |read: &mut (Option<Instant>, bool)| !read.1;
            let waited = self.end_was_read.wait_timeout_while(read, most, waits);
            drop(waited);
        }
    }
}

/// A line of the page: its radius, m, and its points, m.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Stroke {
    radius: f64,
    points: Vec<[f64; 3]>,
}

impl From<Line> for Stroke {
    fn from(line: Line) -> Self {
        Self {
            radius: line.radius,
            points: line.points.into_iter().map(Into::into).collect(),
        }
    }
}
