//! The live page of a task: a small server on this computer shows the cell in motion, its plan and
//! pictures in a browser, and takes the speed and the request to stop from there.
//!
//! The address contains a random token, and requests with another host name are rejected, so that
//! no other page of the browser can move or stop anything.

mod server;
mod state;

use crate::cell::Cell;
use crate::task::{Display, LaidLength, SpeedOverride, Stage};
use rodlab_robot::{JointTrajectory, StreamState};
use server::Server;
use state::{MotionState, Picture, Scene, Shared, State, StepState};
use std::collections::hash_map::RandomState;
use std::hash::BuildHasher;
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Longest wait for a browser that shows the end of the task.
const LAST_LOOK: Duration = Duration::from_secs(2);
/// Largest number of points of a planned path.
const MOST_POINTS: usize = 500;

/// The live page of a task, served until this value is dropped.
pub struct LivePage {
    shared: Arc<Shared>,
    server: Server,
}

impl LivePage {
    /// Serves the page of a task in a cell on a port of this computer; zero selects a free one.
    /// `plan` has the planned motions. The page changes `speed` unless `fixed`, the reason why it
    /// cannot, is given.
    ///
    /// # Errors
    /// The port is in use.
    pub fn serve(
        cell: &Cell,
        plan: &[JointTrajectory],
        port: u16,
        speed: &SpeedOverride,
        fixed: Option<&str>,
    ) -> io::Result<Self> {
        let scene = Scene {
            cell: cell.clone(),
            plans: plan
                .iter()
                .flat_map(|motion| cell.hand_paths(motion, MOST_POINTS))
                .collect(),
            fixed: fixed.map(str::to_owned),
        };
        let token = format!("{:016x}", RandomState::new().hash_one(std::process::id()));
        let shared = Arc::new(Shared::new(scene, speed.clone(), token));
        let server = Server::start(port, Arc::clone(&shared))?;
        Ok(Self { shared, server })
    }

    /// The address of the page.
    pub fn address(&self) -> String {
        let token = &self.shared.token;
        format!("http://127.0.0.1:{}/{token}/", self.server.port())
    }

    /// Whether the user has pressed the button that ends the task.
    pub fn is_stopped(&self) -> bool {
        self.shared.is_stopped.load(Ordering::Relaxed)
    }

    /// Shows the end of the task, and waits until a browser that shows the page has read it, for
    /// two seconds at most.
    pub fn end(&self, words: &str) {
        self.change(|state| state.ended = Some(words.to_owned()));
        self.shared.wait_for_reader(LAST_LOOK);
    }

    fn change(&self, change: impl FnOnce(&mut State)) {
        change(&mut self.shared.state());
    }
}

impl Display for LivePage {
    fn step(&self, number: usize, of: usize, stage: &Stage) {
        let words = stage.words.clone().into_owned();
        self.change(|state| {
            state.step = Some(StepState { number, of, words });
            state.motion = None;
        });
    }

    fn motion(&self, state: &StreamState, laid: Option<LaidLength>) {
        let motion = MotionState::of(state, laid);
        self.change(|state| state.motion = Some(motion));
    }

    fn joints(&self, arm: &str, joints: &[f64]) {
        let cell = self.shared.cell();
        if let Some(arm) = cell.arms.iter().position(|known| known.name == arm) {
            self.change(|state| state.move_arm(cell, arm, joints));
        }
    }

    fn wrote(&self, file: &Path) {
        if file.extension().is_some_and(|kind| kind == "png") {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            self.change(|state| {
                let number = state.picture.as_ref().map_or(1, |last| last.number + 1);
                state.picture = Some(Picture {
                    name: name.into_owned(),
                    number,
                    file: file.to_owned(),
                });
            });
        }
    }
}
