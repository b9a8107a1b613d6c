//! Schedule of the end of a rod, and of the lifted strands.

use super::{Pass, Passage, TiedRod};
use crate::plan::deployment::DeployedRod;

/// Time to lift a strand, and to put it down, s.
const LIFTING: f64 = 2.0;
/// Distance before a lifted strand at which the end waits, in gravito-bending lengths.
const WAITING: f64 = 1.0;

/// Parameters of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handling {
    /// Height to which strands are lifted, m.
    pub lift: f64,
    /// Speed of the end, m/s.
    pub speed: f64,
}

/// Default height to which strands are lifted, in radii of the thickest rod, and default speed of
/// the end, m/s.
const USUAL_LIFT: f64 = 8.0;
const USUAL_SPEED: f64 = 0.04;

impl Handling {
    /// The default parameters of the motion.
    pub fn usual<'a>(rods: impl IntoIterator<Item = &'a DeployedRod>) -> Self {
        let thickest = rods.into_iter().map(|rod| rod.radius).fold(0.0, f64::max);
        Self {
            lift: USUAL_LIFT * thickest,
            speed: USUAL_SPEED,
        }
    }
}

/// Schedule of the end of a rod. Times count from its start, s.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// Number of the rod, from 0.
    pub rod: usize,
    /// Times, and arc lengths of the pattern of the end, m; linear in between.
    pub end: Vec<(f64, f64)>,
    /// Lifted strands: number of the passage, and times of the grasp, of the end of lifting, of
    /// the start of lowering, and of the release.
    pub lifts: Vec<(usize, [f64; 4])>,
}

impl Schedule {
    /// The schedule of a rod whose end moves along the rest of its pattern. The end waits before
    /// each crossing under which it must pass, until the strand there is lifted. A strand is put
    /// down before the next one is lifted, or when the end has arrived.
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

    /// Duration of the schedule, s.
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

    /// Puts down the lifted strand, if there is one.
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
