//! Linear and logarithmic axes.

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;
use std::ops::Range;

/// How numbers lie along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AxisScale {
    /// Equal steps are differences.
    #[default]
    Linear,
    /// Equal steps are ratios; only positive numbers have a place.
    Logarithmic,
}

impl AxisScale {
    /// Logarithmic where all numbers are positive and range over more than a decade.
    pub fn fitting(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = extremes(values);
        if low > 0.0 && high > 10.0 * low {
            Self::Logarithmic
        } else {
            Self::Linear
        }
    }

    /// Whether a number has a place on the axis.
    pub fn holds(self, value: f64) -> bool {
        value.is_finite() && (self == Self::Linear || value > 0.0)
    }
}

/// An axis of a plot: a range of numbers and how they lie along it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    scale: AxisScale,
    range: Range<f64>,
}

impl Axis {
    /// An axis with a little room around the values that have a place on it; never empty.
    pub fn around(scale: AxisScale, values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = extremes(values.filter(|value| scale.holds(*value)));
        let range = match scale {
            _ if low > high && scale == AxisScale::Logarithmic => 1.0..10.0,
            _ if low > high => 0.0..1.0,
            AxisScale::Linear => {
                let size = if high > low {
                    high - low
                } else {
                    low.abs().max(f64::MIN_POSITIVE)
                };
                low - 0.02 * size..high + 0.02 * size
            }
            AxisScale::Logarithmic => {
                let room = (high / low).powf(0.03).max(1.05);
                low / room..high * room
            }
        };
        Self { scale, range }
    }

    /// Place of a value along the axis, 0 to 1.
    fn part(&self, value: f64) -> f64 {
        let Range { start, end } = self.range;
        match self.scale {
            AxisScale::Linear => (value - start) / (end - start),
            AxisScale::Logarithmic => (value / start).ln() / (end / start).ln(),
        }
    }

    /// Powers of ten; between them 2 and 5 times those where the axis holds few of them, every other one or
    /// fewer where it holds too many.
    fn decades(&self, most: usize) -> Vec<f64> {
        let Range { start, end } = self.range;
        let (first, last) = (start.log10().floor() as i32, end.log10().ceil() as i32);
        let holds = |value: &f64| (start..=end).contains(value);
        let decades = (end / start).log10();
        let factors: &[f64] = if decades < 0.7 {
            &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]
        } else if decades < 2.2 {
            &[1.0, 2.0, 5.0]
        } else {
            &[1.0]
        };
        let stride = ((last - first) as usize).div_ceil(most.max(1)).max(1);
        (first..=last)
            .step_by(stride)
            .flat_map(|power| factors.iter().map(move |factor| factor * 10f64.powi(power)))
            .filter(holds)
            .collect()
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (low, high): (i32, i32)) -> i32 {
        low + (self.part(*value) * f64::from(high - low)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        match self.scale {
            AxisScale::Linear => RangedCoordf64::from(self.range.clone()).key_points(hint),
            AxisScale::Logarithmic => self.decades(hint.bold_points()),
        }
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        let step = match self.scale {
            AxisScale::Linear => (self.range.end - self.range.start) / 5.0,
            AxisScale::Logarithmic => *value,
        };
        number_label(*value, step)
    }
}

/// Least and greatest of the finite values; reversed where there are none.
fn extremes(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let finite = values.filter(|value| value.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    })
}

/// A number with as many digits as tell it from another `step` away, in scientific form where it is small or
/// large.
fn number_label(value: f64, step: f64) -> String {
    let power = |size: f64| size.log10().floor() as i32;
    let size = value.abs();
    // Ticks that are sums of steps miss zero by rounding.
    if size < 1e-9 * step {
        return "0".into();
    }
    let without_zeros = |text: String| match text.split_once('.') {
        Some(_) => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        None => text,
    };
    if (1e-3..1e5).contains(&size) {
        let decimals = (1 - power(step)).clamp(0, 12) as usize;
        return without_zeros(format!("{value:.decimals$}"));
    }
    let exponent = power(size);
    let decimals = (1 + exponent - power(step)).clamp(0, 12) as usize;
    let mantissa = value / 10f64.powi(exponent);
    format!(
        "{}e{exponent}",
        without_zeros(format!("{mantissa:.decimals$}"))
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(scale: AxisScale, values: &[f64]) -> Axis {
        Axis::around(scale, values.iter().copied())
    }

    #[test]
    fn equal_ratios_are_equal_steps_of_a_logarithmic_axis() {
        let axis = axis(AxisScale::Logarithmic, &[1e-3, 1.0, 1e3, -4.0, f64::NAN]);
        let places = [1e-3, 1.0, 1e3].map(|value| axis.map(&value, (0, 60_000)));
        assert_eq!(places[1], 30_000);
        assert!((places[0] + places[2] - 60_000).abs() <= 1 && places[0] > 0);
    }

    #[test]
    fn ticks_are_powers_of_ten_or_few_steps_between() {
        let ticks = |values: &[f64]| axis(AxisScale::Logarithmic, values).decades(6);
        assert_eq!(ticks(&[1.0, 10.0, 1e4]), [1.0, 10.0, 100.0, 1e3, 1e4]);
        assert_eq!(ticks(&[1.0, 20.0]), [1.0, 2.0, 5.0, 10.0, 20.0]);
        assert_eq!(ticks(&[2.0, 3.0]), [2.0, 3.0]);
        assert!(ticks(&[1e-12, 1e12]).len() <= 8);
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
    fn axes_are_never_empty() {
        for scale in [AxisScale::Linear, AxisScale::Logarithmic] {
            for values in [&[][..], &[0.0], &[3.0], &[-2.0, -2.0]] {
                let range = axis(scale, values).range();
                assert!(range.start < range.end, "{scale:?} {values:?} {range:?}");
            }
        }
    }

    #[test]
    fn labels_have_the_digits_that_tell_ticks_apart() {
        for (value, step, label) in [
            (0.0, 1.0, "0"),
            (1e-17, 0.1, "0"),
            (0.30000000000000004, 0.1, "0.3"),
            (-12.5, 0.5, "-12.5"),
            (500.0, 500.0, "500"),
            (0.0020027, 1e-7, "0.0020027"),
            (1.5e-7, 0.5e-7, "1.5e-7"),
            (1e-6, 1e-6, "1e-6"),
            (-2.5e8, 1e7, "-2.5e8"),
        ] {
            assert_eq!(number_label(value, step), label);
        }
    }
}
