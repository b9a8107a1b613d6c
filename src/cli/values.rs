//! Parsers of argument values that several subcommands use, or that are more than a number.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
pub use rodlab_files::input::{is_positive, number, numbers, positive};
use rodlab_lab::scenario::{metres, seconds};
use rodlab_lab::sweep::Shard;
use std::ops::RangeInclusive;
use std::time::Duration;

/// A name, its value, and its help text.
pub type Named<T> = (&'static str, T, &'static str);

/// A parser of names.
pub fn named<T: Copy + Send + Sync + 'static>(
    names: &'static [Named<T>],
) -> impl TypedValueParser<Value = T> {
    let values = names.iter();
    let values = values.map(|(name, _, help)| PossibleValue::new(*name).help(*help));
    PossibleValuesParser::new(values).map(|given| {
        let found = names.iter().find(|(name, ..)| *name == given);
        found.expect("a possible value").1
    })
}

/// A parser of numbers in a range.
pub fn within(least: f64, most: f64) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| match text.trim().parse() {
        Ok(number) if (least..=most).contains(&number) => Ok(number),
        _ => Err(format!("a number from {least} to {most} is needed")),
    }
}

/// A parser of numbers of edges.
pub fn edges(range: RangeInclusive<usize>) -> impl Fn(&str) -> Result<usize, String> + Clone {
    move |text| match text.parse() {
        Ok(edges) if range.contains(&edges) => Ok(edges),
        _ => Err(format!(
            "a number of edges from {} to {} is needed",
            range.start(),
            range.end()
        )),
    }
}

/// Parses a speed above zero, m/s.
pub fn speed(text: &str) -> Result<f64, String> {
    number(is_positive, "a speed above 0 is needed, m/s")(text)
}

/// Parses a coefficient of friction.
pub fn friction(text: &str) -> Result<f64, String> {
    let is_friction = |number: f64| number >= 0.0 && number.is_finite();
    number(is_friction, "a number from 0 up is needed")(text)
}

/// Parses a length above zero, in metres.
pub fn positive_length(text: &str) -> Result<f64, String> {
    let length = metres(text)?;
    if is_positive(length) {
        Ok(length)
    } else {
        Err("must be a length above 0".into())
    }
}

/// Parses a length of at least zero, in metres.
pub fn length_from_zero(text: &str) -> Result<f64, String> {
    let length = metres(text)?;
    if length >= 0.0 && length.is_finite() {
        Ok(length)
    } else {
        Err("must be a length of 0 or more".into())
    }
}

/// A wall time.
pub fn duration(text: &str) -> Result<Duration, String> {
    let seconds = seconds(text)?;
    Duration::try_from_secs_f64(seconds).map_err(|_| format!("{seconds} s is not a wall time"))
}

/// Parses a share of the cases of a sweep, `K/N`.
pub fn shard(text: &str) -> Result<Shard, String> {
    let (number, of) = text.split_once('/').ok_or("expected K/N, such as 1/4")?;
    let whole = |text: &str| text.trim().parse::<usize>();
    match (whole(number), whole(of)) {
        (Ok(number), Ok(of)) if (1..=of).contains(&number) => Ok(Shard { number, of }),
        _ => Err("expected K/N with 1 ≤ K ≤ N, such as 1/4".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_out_of_range_are_refused() {
        let tilt = within(30.0, 90.0);
        assert_eq!(tilt("60"), Ok(60.0));
        for bad in ["29", "91", "NaN", "sixty"] {
            assert!(tilt(bad).unwrap_err().contains("30 to 90"), "{bad}");
        }
    }

    #[test]
    fn shares_are_counted_from_one() {
        assert_eq!(shard("2/3"), Ok(Shard { number: 2, of: 3 }));
        for text in ["0/3", "4/3", "2", "a/b", "-1/2", "1/0"] {
            assert!(shard(text).is_err(), "{text}");
        }
    }

    #[test]
    fn time_limits_take_units() {
        assert_eq!(duration("90"), Ok(Duration::from_secs(90)));
        assert_eq!(duration("10 min"), Ok(Duration::from_secs(600)));
        assert_eq!(duration("8h"), Ok(Duration::from_secs(8 * 3600)));
        assert!(duration("-1").is_err());
        assert!(duration("nan").is_err());
        assert!(duration("3 m").is_err());
    }
}
