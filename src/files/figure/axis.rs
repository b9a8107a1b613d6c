//! Linear and logarithmic axes, and their ticks.

use std::ops::Range;

/// Scale of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AxisScale {
    /// A linear scale: equal steps are differences.
    #[default]
    Linear,
    /// A logarithmic scale: equal steps are ratios. Only positive numbers have a position.
    Logarithmic,
}

impl AxisScale {
    /// The logarithmic scale if all numbers are positive and range over more than a decade,
    /// otherwise the linear one.
    pub fn fitting(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = extremes(values);
        if low > 0.0 && high > 10.0 * low {
            Self::Logarithmic
        } else {
            Self::Linear
        }
    }

    /// Whether a number has a position on the axis.
    pub fn holds(self, value: f64) -> bool {
        value.is_finite() && (self == Self::Linear || value > 0.0)
    }
}

/// An axis of a plot: a range of numbers and its scale.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    pub scale: AxisScale,
    pub range: Range<f64>,
    /// Whether all its values are integers.
    is_whole: bool,
}

/// Ticks of an axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Ticks {
    /// Values and their labels.
    pub labelled: Vec<(f64, String)>,
    /// Values between them.
    pub small: Vec<f64>,
    /// Factor of the labels, a power of ten, as shown at the end of the axis.
    pub factor: Option<String>,
}

/// Size below which numbers count as zero: sums of steps have rounding errors.
const ZERO: f64 = 1e-290;
/// Share of their numbers below which a range is round-off: the axis then shows a constant.
const ROUND_OFF: f64 = 1e-12;

impl Axis {
    /// An axis with a small margin around the values that have a position on it; never empty.
    pub fn around(scale: AxisScale, values: impl Iterator<Item = f64> + Clone) -> Self {
        let values = values.filter(|value| scale.holds(*value));
        let (low, high) = extremes(values.clone());
        let is_whole = scale == AxisScale::Linear
            && values.clone().any(|value| low < value && value < high)
            && values.into_iter().all(|value| value.fract() == 0.0);
        let size = low.abs().max(high.abs());
        let range = match scale {
            _ if low > high && scale == AxisScale::Logarithmic => 1.0..10.0,
            _ if low > high => 0.0..1.0,
            AxisScale::Linear if size < ZERO => -1.0..1.0,
            AxisScale::Linear if high - low <= ROUND_OFF * size => {
                low - 0.05 * size..high + 0.05 * size
            }
            AxisScale::Linear => {
                let room = 0.03 * (high - low);
                low - room..high + room
            }
            AxisScale::Logarithmic => {
                let room = libm::pow(high / low, 0.03).max(1.05);
                low / room..high * room
            }
        };
        Self {
            scale,
            range,
            is_whole,
        }
    }

    /// A linear axis over a range.
    pub fn over(range: Range<f64>) -> Self {
        Self {
            scale: AxisScale::Linear,
            range,
            is_whole: false,
        }
    }

    /// Position of a value along the axis, 0 to 1.
    pub fn part(&self, value: f64) -> f64 {
        let Range { start, end } = self.range;
        match self.scale {
            AxisScale::Linear => (value - start) / (end - start),
            AxisScale::Logarithmic => libm::log(value / start) / libm::log(end / start),
        }
    }

    /// Ticks, at most `most` of them with labels (`most` is at least 2).
    pub fn ticks(&self, most: usize) -> Ticks {
        match self.scale {
            AxisScale::Linear => self.linear_ticks(most.max(2)),
            AxisScale::Logarithmic => self.logarithmic_ticks(most.max(2)),
        }
    }

    /// The smallest round step that results in at most `most` ticks.
    fn linear_ticks(&self, most: usize) -> Ticks {
        let Range { start, end } = self.range;
        let count = |step: f64| (end / step).floor() - (start / step).ceil() + 1.0;
        let mut power = libm::log10((end - start) / most as f64).floor() as i32;
        let step = loop {
            let steps = [1.0, 2.0, 5.0].map(|factor| factor * 10f64.powi(power));
            let fits = |step: &f64| count(*step) <= most as f64 && (*step >= 1.0 || !self.is_whole);
            if let Some(step) = steps.into_iter().find(fits) {
                break step;
            }
            power += 1;
        };
        let first = (start / step).ceil();
        let values: Vec<f64> = (0..count(step) as usize)
            .map(|k| step * (first + k as f64))
            .collect();
        let largest = values.iter().map(|value| value.abs()).fold(0.0, f64::max);
        let exponent = match largest {
            0.0 => 0,
            largest if (1e-2..1e5).contains(&largest) => 0,
            largest => power_of(largest),
        };
        let unit = 10f64.powi(exponent);
        let decimals = (exponent - power_of(step)).clamp(0, 12) as usize;
        let label = |value: f64| number_label(value / unit, decimals);
        Ticks {
            labelled: values.iter().map(|value| (*value, label(*value))).collect(),
            small: Vec::new(),
            factor: (exponent != 0).then(|| format!("×10^{{{exponent}}}")),
        }
    }

    /// Powers of ten; also 2 and 5 times those if the axis has few of them, and every other one or
    /// fewer if it has too many.
    fn logarithmic_ticks(&self, most: usize) -> Ticks {
        let Range { start, end } = self.range;
        let holds = |value: &f64| (start..=end).contains(value);
        let (first, last) = (power_of(start), power_of(end) + 1);
        let decades = libm::log10(end / start);
        if decades < 0.5 {
            // The range is too short for ratios: round numbers are more useful.
            return Self {
                scale: AxisScale::Linear,
                ..self.clone()
            }
            .linear_ticks(most.min(5));
        }
        let factors: &[f64] = if decades < 1.7 {
            &[1.0, 2.0, 5.0]
        } else {
            &[1.0]
        };
        let stride = ((last - first) as usize).div_ceil(most).max(1);
        let times = |power: i32, factor: f64| factor * 10f64.powi(power);
        let values: Vec<(f64, i32, f64)> = (first..=last)
            .filter(|power| power.rem_euclid(stride as i32) == 0)
            .flat_map(|power| {
                let value = move |factor: &f64| (times(power, *factor), power, *factor);
                factors.iter().map(value)
            })
            .filter(|(value, ..)| holds(value))
            .collect();
        let is_plain =
            factors.len() > 1 && values.iter().all(|(value, ..)| (1e-3..1e5).contains(value));
        let label = |&(value, power, factor): &(f64, i32, f64)| {
            let label = if is_plain {
                number_label(value, (-power).max(0) as usize)
            } else if factor == 1.0 {
                format!("10^{{{power}}}")
            } else {
                format!("{factor}·10^{{{power}}}")
            };
            (value, label)
        };
        let between =
            (first..=last).flat_map(|power| (2..10).map(move |k| times(power, f64::from(k))));
        Ticks {
            labelled: values.iter().map(label).collect(),
            small: if stride == 1 {
                between.filter(holds).collect()
            } else {
                (first..=last)
                    .map(|power| times(power, 1.0))
                    .filter(holds)
                    .collect()
            },
            factor: None,
        }
    }
}

/// The largest power of ten that is not above a size.
fn power_of(size: f64) -> i32 {
    // Guard against rounding, which could give a smaller power.
    (libm::log10(size) + 1e-12).floor() as i32
}

/// Least and greatest of the finite values; reversed if there are none.
fn extremes(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let finite = values.filter(|value| value.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    })
}

/// A number with at most the given number of decimals, without trailing zeros.
fn number_label(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = match text.split_once('.') {
        Some(_) => text.trim_end_matches('0').trim_end_matches('.'),
        None => &text,
    };
    match text.strip_prefix('-') {
        Some("0") => "0".into(),
        Some(size) => format!("−{size}"),
        None => text.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(scale: AxisScale, values: &[f64]) -> Axis {
        Axis::around(scale, values.iter().copied())
    }

    fn labels(scale: AxisScale, values: &[f64], most: usize) -> (Vec<String>, Option<String>) {
        let ticks = axis(scale, values).ticks(most);
        let labels = ticks.labelled.into_iter().map(|(_, label)| label);
        (labels.collect(), ticks.factor)
    }

    #[test]
    fn equal_ratios_are_equal_steps_of_a_logarithmic_axis() {
        let axis = axis(AxisScale::Logarithmic, &[1e-3, 1.0, 1e3, -4.0, f64::NAN]);
        let places = [1e-3, 1.0, 1e3].map(|value| axis.part(value));
        assert!((places[1] - 0.5).abs() < 1e-12);
        assert!((places[0] + places[2] - 1.0).abs() < 1e-12 && places[0] > 0.0);
    }

    #[test]
    fn scales_fit_their_numbers() {
        let fitting = |values: &[f64]| AxisScale::fitting(values.iter().copied());
        assert_eq!(fitting(&[0.1, 0.5, 1.0]), AxisScale::Linear);
        assert_eq!(fitting(&[0.1, 2.0]), AxisScale::Logarithmic);
        assert_eq!(fitting(&[-1.0, 200.0]), AxisScale::Linear);
        assert_eq!(fitting(&[]), AxisScale::Linear);
    }

    #[test]
    fn linear_ticks_are_round_and_share_a_power_of_ten() {
        let linear = |values: &[f64]| labels(AxisScale::Linear, values, 6);
        assert_eq!(
            linear(&[0.0, 1.0]).0,
            ["0", "0.2", "0.4", "0.6", "0.8", "1"]
        );
        assert_eq!(linear(&[-1.0, 1.0]).0, ["−1", "−0.5", "0", "0.5", "1"]);
        let (small, factor) = linear(&[0.0, 3e-7]);
        assert_eq!(small, ["0", "1", "2", "3"]);
        assert_eq!(factor.as_deref(), Some("×10^{-7}"));
        let (large, factor) = linear(&[1.0e6, 1.2e6]);
        assert_eq!(large, ["1", "1.05", "1.1", "1.15", "1.2"]);
        assert_eq!(factor.as_deref(), Some("×10^{6}"));
    }

    #[test]
    fn whole_numbers_have_no_ticks_between() {
        assert_eq!(
            labels(AxisScale::Linear, &[1.0, 2.0, 3.0], 9).0,
            ["1", "2", "3"]
        );
        assert_eq!(
            labels(AxisScale::Linear, &[1.0, 2.5, 3.0], 5).0,
            ["1", "1.5", "2", "2.5", "3"]
        );
    }

    #[test]
    fn logarithmic_ticks_are_powers_of_ten_or_few_steps_between() {
        let logarithmic = |values: &[f64], most| labels(AxisScale::Logarithmic, values, most).0;
        let powers = ["10^{0}", "10^{1}", "10^{2}", "10^{3}", "10^{4}"];
        assert_eq!(logarithmic(&[1.0, 1e4], 6), powers);
        assert_eq!(logarithmic(&[1.0, 20.0], 6), ["1", "2", "5", "10", "20"]);
        let tiny = ["10^{-6}", "2·10^{-6}", "5·10^{-6}", "10^{-5}"];
        assert_eq!(logarithmic(&[1e-6, 1e-5], 6), tiny);
        assert!(logarithmic(&[1e-12, 1e12], 6).len() <= 7);
        assert_eq!(logarithmic(&[2.0, 3.0], 3), ["2", "2.5", "3"]);
    }

    #[test]
    fn any_constant_has_a_few_finite_ticks() {
        for value in [0.0, 3.0, -2e-9, 1e-308, 5e-324, 1e12, 1e300, -1e300] {
            for other in [value, value * (1.0 + 2e-16)] {
                let ticks = axis(AxisScale::Linear, &[value, other]).ticks(5);
                assert!(
                    (1..=5).contains(&ticks.labelled.len()),
                    "{value}: {ticks:?}"
                );
                for (at, label) in &ticks.labelled {
                    assert!(at.is_finite() && !label.contains("inf"), "{value}: {label}");
                    assert!(label.len() < 8, "{value}: {label}");
                }
            }
        }
    }
}
