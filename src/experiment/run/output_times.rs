//! When a run writes its output.

/// Output times 0, Δ, 2Δ, ..., end: products, not sums, so that they do not drift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OutputTimes {
    interval: f64,
    end: f64,
    /// Outputs per second where that is a whole number: k / 10 is the number nearest to 0.1 k; k · 0.1 need not be.
    per_second: Option<f64>,
    last: usize,
}

/// Part of an interval by which the end may miss a multiple of it and still count as one.
const ROUND_OFF: f64 = 1e-9;

impl OutputTimes {
    /// Output times of a run; both arguments in s, both positive.
    pub fn new(interval: f64, end: f64) -> Self {
        let intervals = end / interval;
        let nearest = intervals.round();
        let whole = (intervals - nearest).abs() <= ROUND_OFF * nearest;
        let last = if whole { nearest } else { intervals.ceil() };
        let frequency = 1.0 / interval;
        let per_second = (frequency.fract() == 0.0 && frequency >= 1.0).then_some(frequency);
        Self {
            interval,
            end,
            per_second,
            last: last as usize,
        }
    }

    /// A single output at time zero.
    pub fn only_start() -> Self {
        Self {
            interval: 0.0,
            end: 0.0,
            per_second: None,
            last: 0,
        }
    }

    /// Number of the last output; the first is number 0 at time zero.
    pub fn last(&self) -> usize {
        self.last
    }

    /// Time of an output, s.
    pub fn time(&self, index: usize) -> f64 {
        match self.per_second {
            _ if index >= self.last => self.end,
            Some(frequency) => index as f64 / frequency,
            None => index as f64 * self.interval,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_those_a_person_would_write() {
        let times = OutputTimes::new(0.1, 0.7);
        let all: Vec<f64> = (0..=times.last()).map(|k| times.time(k)).collect();
        assert_eq!(all, [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]);
    }

    #[test]
    fn the_end_is_an_output_even_off_the_grid() {
        let times = OutputTimes::new(0.3, 1.0);
        assert_eq!(times.last(), 4);
        assert_eq!(times.time(4), 1.0);
        assert_eq!(OutputTimes::new(5.0, 2.0).last(), 1);
        assert_eq!(OutputTimes::new(5.0, 2.0).time(1), 2.0);
    }

    #[test]
    fn round_off_adds_no_tiny_last_interval() {
        // 250 / 0.02 and the like are whole numbers up to round-off.
        for (interval, end, last) in [(0.02, 250.0, 12_500), (0.1, 0.3, 3), (1.0 / 3.0, 7.0, 21)] {
            let times = OutputTimes::new(interval, end);
            assert_eq!(times.last(), last);
            assert_eq!(times.time(last), end);
            assert!((1..=last).all(|k| times.time(k) - times.time(k - 1) > 0.9 * interval));
        }
    }
}
