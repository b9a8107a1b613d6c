//! When the end of a rod is led where, and when strands are lifted and put down.

use super::{Pass, Passage, TiedRod};
use crate::plan::deployment::DeployedRod;

/// Time in which a strand is lifted, and in which it is put down, s.
const LIFTING: f64 = 2.0;
/// Where the end waits before a strand that is lifted, in gravito-bending lengths.
const WAITING: f64 = 1.0;

/// How a rod is handled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handling {
    /// Height to which strands are lifted, m.
    pub lift: f64,
    /// Speed at which the end is led, m/s.
    pub speed: f64,
}

/// Height to which strands are lifted where nothing is said, in radii of the thickest rod, and speed at which the end is led, m/s.
const USUAL_LIFT: f64 = 8.0;
const USUAL_SPEED: f64 = 0.04;

impl Handling {
    /// How rods are handled where nothing is said.
    pub fn usual<'a>(rods: impl IntoIterator<Item = &'a DeployedRod>) -> Self {
        let thickest = rods.into_iter().map(|rod| rod.radius).fold(0.0, f64::max);
        Self {
            lift: USUAL_LIFT * thickest,
            speed: USUAL_SPEED,
        }
    }
}

/// When the end of a rod is led. Times are counted from when it begins, s.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// Number of the rod, from 0.
    pub rod: usize,
    /// Times and the arc length of the pattern at which the end is then, m; linear between them.
    pub end: Vec<(f64, f64)>,
    /// Strands that are lifted: number of the passage, when the gripper takes hold, when it has lifted, when it begins to put
    /// down, and when it lets go.
    pub lifts: Vec<(usize, [f64; 4])>,
}

impl Schedule {
    /// The schedule of the rod of a number, whose end is led along the rest of its pattern: it waits before each crossing under
    /// which it must go until the strand there is lifted; a strand is put down before the next one is lifted, or when the end has
    /// arrived.
    pub fn new(
        number: usize,
        tied: &TiedRod<'_>,
        passages: &[Passage],
        handling: &Handling,
    ) -> Self {
        let rod = tied.rod;
        let mut schedule = Self {
            rod: number,
            end: vec![(0.0, rod.length)],
            lifts: Vec::new(),
        };
        for (index, passage) in passages.iter().enumerate() {
            let is_led = passage.second.rod == number && passage.second.s > rod.length;
            if !is_led || passage.pass == Pass::Over {
                continue;
            }
            schedule.lead(
                passage.second.s - WAITING * rod.gravito_bending_length,
                handling,
            );
            schedule.put_down();
            let begin = schedule.duration();
            schedule.wait();
            let lifted = schedule.duration();
            schedule
                .lifts
                .push((index, [begin, lifted, f64::INFINITY, f64::INFINITY]));
        }
        schedule.lead(tied.curve.length(), handling);
        schedule.put_down();
        schedule
    }

    /// How long it takes, s.
    pub fn duration(&self) -> f64 {
        self.end.last().map_or(0.0, |(time, _)| *time)
    }

    fn lead(&mut self, to: f64, handling: &Handling) {
        if let Some(&(time, from)) = self.end.last()
            && to > from
        {
            self.end.push((time + (to - from) / handling.speed, to));
        }
    }

    fn wait(&mut self) {
        if let Some(&(time, at)) = self.end.last() {
            self.end.push((time + LIFTING, at));
        }
    }

    /// Puts the last strand down that was lifted, if there is one.
    fn put_down(&mut self) {
        if self.lifts.is_empty() {
            return;
        }
        let begin = self.duration();
        self.wait();
        let end = self.duration();
        if let Some((_, times)) = self.lifts.last_mut() {
            [times[2], times[3]] = [begin, end];
        }
    }
}
