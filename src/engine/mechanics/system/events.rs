//! Times at which the rates of prescribed values change: corners of schedules, motions and poses.

use super::System;

/// A corner of a schedule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Event {
    /// Time, s.
    pub time: f64,
    /// Jump of the velocity of the moving clamp or obstacle, m/s. Infinite for a load and for a
    /// natural strain, whose effect depends on the scene.
    pub velocity_jump: f64,
}

impl Event {
    /// A corner at a time, s, of a load or of a natural strain.
    pub(crate) fn of_load(time: f64) -> Self {
        Self {
            time,
            velocity_jump: f64::INFINITY,
        }
    }
}

impl System {
    /// Lists the events of all terms and clamps in order of time; call this whenever one of them
    /// changes.
    pub(crate) fn list_events(&mut self) {
        let mut events = Vec::new();
        for term in self.terms.all() {
            term.list_events(&mut events);
        }
        let drives = self.assembly.drives.iter();
        for drive in drives.filter(|drive| !drive.released) {
            let (rod, _) = self.assembly.locate(drive.node);
            drive.list_events(self.assembly.radii[rod], &mut events);
        }
        events.sort_by(|a, b| a.time.total_cmp(&b.time));
        self.events = events;
    }

    /// The first event later than `time`, s; infinite after the last.
    pub(crate) fn next_event(&self, time: f64) -> f64 {
        let next = self.events.partition_point(|event| event.time <= time);
        self.events
            .get(next)
            .map_or(f64::INFINITY, |event| event.time)
    }

    /// Largest jump of a velocity among the events after `after` and up to `until`, m/s; `None` if
    /// there are none.
    pub(crate) fn largest_jump(&self, after: f64, until: f64) -> Option<f64> {
        let first = self.events.partition_point(|event| event.time <= after);
        let events = self.events[first..].iter();
        events
            .take_while(|event| event.time <= until)
            .map(|event| event.velocity_jump)
            .max_by(f64::total_cmp)
    }
}
