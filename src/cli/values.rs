//! Values of arguments that several subcommands read, or that take more than a number.

use rodlab_lab::scenario::{metres, seconds};
use rodlab_lab::sweep::Shard;
use std::time::Duration;

/// A length above zero, in metres.
pub fn positive_length(text: &str) -> Result<f64, String> {
    let length = metres(text)?;
    if length > 0.0 && length.is_finite() {
        Ok(length)
    } else {
        Err("must be a length above 0".into())
    }
}

/// A length from zero up, in metres.
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
    Duration::try_from_secs_f64(seconds).map_err(|_| format!("{seconds} s is no wall time"))
}

/// A share of a sweep's cases, `K/N`.
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
