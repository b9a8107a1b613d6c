//! The stages of a task under way: how long each took, and whether an interruption was requested.

use super::error::{TaskError, TaskStage, WorkError};
use std::time::Instant;

/// A clock that runs from stage to stage.
pub struct StageClock<'a, S> {
    /// Stages that were done, with the time that each took, s.
    pub times: Vec<(S, f64)>,
    /// Whether an interruption was requested.
    pub is_interrupted: &'a dyn Fn() -> bool,
    begin: Instant,
}

impl<'a, S: TaskStage> StageClock<'a, S> {
    /// Of a task that begins now.
    pub fn new(is_interrupted: &'a dyn Fn() -> bool) -> Self {
        Self {
            times: Vec::new(),
            is_interrupted,
            begin: Instant::now(),
        }
    }

    /// Notes that a stage is done.
    pub fn note(&mut self, stage: S) {
        tracing::info!("done: {}", stage.in_words());
        let now = Instant::now();
        self.times.push((stage, (now - self.begin).as_secs_f64()));
        self.begin = now;
    }

    /// Whether the task continues in a stage, or after it.
    ///
    /// # Errors
    /// Somebody asks for the end.
    pub fn check(&self, stage: S) -> Result<(), TaskError<S>> {
        match (self.is_interrupted)() {
            true => Err(TaskError::Interrupted { stage }),
            false => Ok(()),
        }
    }

    /// Notes that the work of a stage is done.
    ///
    /// # Errors
    /// It was not.
    pub fn done(&mut self, stage: S, work: Result<(), WorkError>) -> Result<(), TaskError<S>> {
        work.map_err(TaskError::of_work(stage))?;
        self.note(stage);
        Ok(())
    }

    /// The same, and whether an interruption was requested by then.
    ///
    /// # Errors
    /// It was not done, or an interruption was requested.
    pub fn finish(&mut self, stage: S, work: Result<(), WorkError>) -> Result<(), TaskError<S>> {
        self.done(stage, work)?;
        self.check(stage)
    }
}
