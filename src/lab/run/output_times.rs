//! Output times of a run.

/// Output times 0, Δ, 2Δ, ..., end. They are products, not sums, so that rounding errors do not
/// accumulate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputTimes {
    /// Numerator and denominator of the interval. For a short decimal the denominator is a power
    /// of ten: k · 3 / 100 is the number nearest to 0.03 k; k · 0.03 need not be.
    interval: [f64; 2],
    end: f64,
    last: usize,
}

/// Fraction of an interval by which the end may deviate from a multiple of the interval and still
/// count as a multiple.
const ROUND_OFF: f64 = 1e-9;

impl OutputTimes {
    /// Output times of a run; both arguments in s, both positive.
    pub fn new(interval: f64, end: f64) -> Self {
        let intervals = end / interval;
        let nearest = intervals.round();
        let whole = (intervals - nearest).abs() <= ROUND_OFF * nearest;
        let last = if whole { nearest } else { intervals.ceil() };
        Self {
            interval: as_fraction(interval),
            end,
            last: last as usize,
        }
    }

    /// A single output at time zero.
    pub fn only_start() -> Self {
        Self {
            interval: [0.0, 1.0],
            end: 0.0,
            last: 0,
        }
    }

    /// Number of the last output; the first is number 0 at time zero.
    pub fn last(&self) -> usize {
        self.last
    }

    /// Time of an output, s.
    pub fn time(&self, index: usize) -> f64 {
        if index >= self.last {
            return self.end;
        }
        let [numerator, denominator] = self.interval;
        index as f64 * numerator / denominator
    }
}

/// A number as a fraction: a whole number over a power of ten if nine decimals suffice, else the
/// number over one.
fn as_fraction(number: f64) -> [f64; 2] {
    (0..=9)
        .map(|decimals| 10f64.powi(decimals))
        .map(|denominator| [(number * denominator).round(), denominator])
        .find(|[numerator, denominator]| numerator / denominator == number)
        .unwrap_or([number, 1.0])
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
    fn every_time_is_the_nearest_number_to_its_decimal() {
        let times = OutputTimes::new(0.03, 300.0);
        for index in 0..=times.last() {
            let decimal = format!("{}.{:02}", 3 * index / 100, 3 * index % 100);
            assert_eq!(times.time(index), decimal.parse::<f64>().unwrap());
        }
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
        // Quotients such as 250 / 0.02 are whole numbers up to round-off.
        for (interval, end, last) in [(0.02, 250.0, 12_500), (0.1, 0.3, 3), (1.0 / 3.0, 7.0, 21)] {
            let times = OutputTimes::new(interval, end);
            assert_eq!(times.last(), last);
            assert_eq!(times.time(last), end);
            assert!((1..=last).all(|k| times.time(k) - times.time(k - 1) > 0.9 * interval));
        }
    }
}
