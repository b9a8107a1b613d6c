//! The pace of a motion: its speed relative to the plan, which can change while it runs.
//!
//! A pace `r` maps the time `t` since the start to the place `s` on the trajectory, the time of the
//! trajectory that is due: `ds/dt = r`. Each change is smooth. With `u` from 0 to 1 over its
//! duration `T`, the pace is `r₀ + (r₁ − r₀)(3 u² − 2 u³)`, and the place advances by
//! `T (r₀ u + (r₁ − r₀)(u³ − u⁴/2))`. Joint positions are those of the trajectory at the place, so
//! that the joints stay on their path at any pace.

/// The pace of a motion over time: constant before the first change and after each change.
#[derive(Clone, Debug)]
pub(super) struct Pace {
    changes: Vec<Change>,
}

/// A smooth change of pace, and the constant pace after it.
#[derive(Clone, Copy, Debug)]
struct Change {
    /// Begin, s after the start.
    begin: f64,
    /// Place at the begin, s.
    place: f64,
    from: f64,
    to: f64,
    /// Duration, s.
    duration: f64,
}

impl Change {
    fn end(&self) -> f64 {
        self.begin + self.duration
    }

    /// Fraction of the change that is over.
    fn part(&self, time: f64) -> f64 {
        match self.duration > 0.0 {
            true => ((time - self.begin) / self.duration).clamp(0.0, 1.0),
            false => 1.0,
        }
    }

    fn place(&self, time: f64) -> f64 {
        let u = self.part(time);
        let rise = self.to - self.from;
        let changing = self.duration * u * (self.from + rise * u * u * (1.0 - 0.5 * u));
        let after = time - self.end();
        // An infinite time is the end of any motion, also of one that is held.
        let constant = match after > 0.0 {
            true if after.is_infinite() => after,
            true => self.to * after,
            false => 0.0,
        };
        self.place + changing + constant
    }

    fn rate(&self, time: f64) -> f64 {
        let u = self.part(time);
        self.from + (self.to - self.from) * u * u * (3.0 - 2.0 * u)
    }
}

impl Pace {
    /// A constant pace.
    pub(super) fn constant(rate: f64) -> Self {
        let first = Change {
            begin: 0.0,
            place: 0.0,
            from: rate,
            to: rate,
            duration: 0.0,
        };
        Self {
            changes: vec![first],
        }
    }

    fn last(&self) -> &Change {
        &self.changes[self.changes.len() - 1]
    }

    /// The change that begins last before a time; the first one before the start.
    fn at(&self, time: f64) -> &Change {
        let after = self.changes.partition_point(|change| change.begin <= time);
        &self.changes[after.saturating_sub(1)]
    }

    /// Place at a time since the start, s.
    pub(super) fn place(&self, time: f64) -> f64 {
        let change = self.at(time);
        match time < change.begin {
            // Before the start, a place at the pace of the start.
            true => change.place + change.from * (time - change.begin),
            false => change.place(time),
        }
    }

    /// Pace at a time since the start.
    pub(super) fn rate(&self, time: f64) -> f64 {
        self.at(time).rate(time)
    }

    /// Pace after the last change.
    pub(super) fn target(&self) -> f64 {
        self.last().to
    }

    /// Time from which the pace is constant, s after the start.
    pub(super) fn settled(&self) -> f64 {
        self.last().end()
    }

    /// Time at which a place is reached, s after the start; infinite if the motion is held before
    /// it.
    pub(super) fn time_of(&self, place: f64) -> f64 {
        let after = self.changes.partition_point(|change| change.place < place);
        let change = &self.changes[after.saturating_sub(1)];
        let settled = change.place(change.end());
        if place >= settled {
            let beyond = place - settled;
            return match (beyond > 0.0, change.to > 0.0) {
                (false, _) => change.end(),
                (true, true) => change.end() + beyond / change.to,
                (true, false) => f64::INFINITY,
            };
        }
        // The place grows with time; bisect down to rounding.
        let [mut low, mut high] = [change.begin, change.end()];
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match change.place(middle) < place {
                true => low = middle,
                false => high = middle,
            }
        }
        high
    }

    /// The times at which changes begin and end, s after the start.
    pub(super) fn bends(&self) -> impl Iterator<Item = f64> {
        let changes = self.changes.iter().filter(|change| change.duration > 0.0);
        changes.flat_map(|change| [change.begin, change.end()])
    }

    /// Whether the pace changes at a time.
    pub(super) fn is_changing(&self, time: f64) -> bool {
        let change = self.at(time);
        time > change.begin && time < change.end()
    }

    /// This pace, and a change to another one, from a time after the last change.
    #[must_use]
    pub(super) fn changed(&self, begin: f64, to: f64, duration: f64) -> Self {
        debug_assert!(begin >= self.settled());
        let mut changed = self.clone();
        changed.changes.push(Change {
            begin,
            place: self.place(begin),
            from: self.target(),
            to,
            duration,
        });
        changed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slower, held, and at full pace again.
    fn varied() -> Pace {
        Pace::constant(1.0)
            .changed(1.0, 0.25, 0.8)
            .changed(2.0, 0.0, 1.0)
            .changed(4.0, 1.0, 0.5)
    }

    #[test]
    fn a_constant_pace_is_exact() {
        let pace = Pace::constant(1.0);
        for time in [0.0, 0.1, 1.0 / 3.0, 7.3, 1e4 / 7.0] {
            assert_eq!((pace.place(time), pace.time_of(time)), (time, time));
        }
        assert_eq!(pace.place(-0.3), -0.3);
    }

    #[test]
    fn the_place_is_the_integral_of_the_pace() {
        let pace = varied();
        let step = 1e-4;
        let mut place = 0.0;
        for k in 0..60_000 {
            let time = step * f64::from(k);
            place += step * pace.rate(time + 0.5 * step);
            assert!((pace.place(time + step) - place).abs() < 1e-8, "{time}");
        }
        assert_eq!((pace.rate(3.5), pace.rate(5.0)), (0.0, 1.0));
        assert_eq!(pace.place(3.5), pace.place(3.1));
    }

    #[test]
    fn times_of_places_are_found() {
        let pace = varied();
        for k in 0..600 {
            let time = 0.01 * f64::from(k);
            let found = pace.time_of(pace.place(time));
            let is_held = pace.rate(time) < 1e-3;
            assert!(is_held || (found - time).abs() < 1e-9, "{time} {found}");
        }
        let held = Pace::constant(1.0).changed(1.0, 0.0, 1.0);
        assert_eq!(held.time_of(1.5 + 1e-9), f64::INFINITY);
        assert!(held.time_of(1.5) <= 2.0);
    }
}
