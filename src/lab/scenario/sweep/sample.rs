//! Samples of the ranges of a sweep.

use super::axis::{Axis, SampledRange};
use crate::scenario::document::Node;
use crate::scenario::typed::{Sample, SampleMethod};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};
use rodlab_engine::random::{MOST_DIMENSIONS, sobol_coordinate};

/// Most samples.
const MOST_SAMPLES: i64 = 1_000_000;

/// An axis whose points are samples of the ranges.
///
/// # Errors
/// The faulty key of `[sweep.sample]`, and a message.
pub fn sample(ranges: &[SampledRange], sample: &Sample) -> Result<Axis, (&'static str, String)> {
    if !(1..=MOST_SAMPLES).contains(&sample.count) {
        let count = sample.count;
        return Err((
            "count",
            format!("{count} is out of range; allowed: 1 to {MOST_SAMPLES}"),
        ));
    }
    let seed = u64::try_from(sample.seed).map_err(|_| {
        let seed = sample.seed;
        (
            "seed",
            format!("{seed} is out of range; allowed: at least 0"),
        )
    })?;
    if sample.method == SampleMethod::Sobol && ranges.len() > MOST_DIMENSIONS {
        let message = format!(
            "\"sobol\" takes at most {MOST_DIMENSIONS} ranges, found {}",
            ranges.len()
        );
        return Err(("method", message));
    }
    let mut random = Pcg64::seed_from_u64(seed);
    let mut draw = || random.next_u64() as u32;
    // A random shift, the same for all points, preserves the even spread. Without a seed there is
    // no shift.
    let shifts: Vec<u32> = ranges
        .iter()
        .map(|_| if seed == 0 { 0 } else { draw() })
        .collect();
    let points = (0..sample.count as u32).map(|index| {
        let value = |(dimension, range): (usize, &SampledRange)| {
            let bits = match sample.method {
                SampleMethod::Sobol => sobol_coordinate(index, dimension) ^ shifts[dimension],
                SampleMethod::Random => draw(),
            };
            Node {
                value: range.interval.at(f64::from(bits) / 2f64.powi(32)),
                span: range.key.span.clone(),
            }
        };
        ranges.iter().enumerate().map(value).collect()
    });
    Ok(Axis {
        points: points.collect(),
        keys: ranges.iter().map(|range| range.key.clone()).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::super::axis::SweptKey;
    use super::super::range::{Interval, Number, Scale};
    use super::*;
    use crate::scenario::document::Value;
    use crate::scenario::source::Span;

    fn ranges(count: usize) -> Vec<SampledRange> {
        let number = |value| Number {
            value,
            unit: String::new(),
            whole: false,
        };
        let range = |_| SampledRange {
            key: SweptKey {
                key: "contact.friction".into(),
                span: Span {
                    source: 0,
                    bytes: 0..0,
                },
            },
            interval: Interval::new(&number(1.0), &number(3.0), Scale::Linear).unwrap(),
        };
        (0..count).map(range).collect()
    }

    fn numbers(method: SampleMethod, count: i64, seed: i64, dimensions: usize) -> Vec<Vec<f64>> {
        let request = Sample {
            method,
            count,
            seed,
        };
        let axis = sample(&ranges(dimensions), &request).unwrap();
        let number = |node: &Node| match node.value {
            Value::Float(number) => number,
            _ => panic!("a range of numbers"),
        };
        axis.points
            .iter()
            .map(|point| point.iter().map(number).collect())
            .collect()
    }

    #[test]
    fn samples_lie_in_their_ranges_and_follow_the_seed() {
        for method in [SampleMethod::Sobol, SampleMethod::Random] {
            let first = numbers(method, 64, 7, 3);
            assert!(first.iter().flatten().all(|x| (1.0..3.0).contains(x)));
            assert_eq!(numbers(method, 64, 7, 3), first);
            assert_ne!(numbers(method, 64, 8, 3), first);
        }
        assert_eq!(numbers(SampleMethod::Sobol, 3, 0, 1), [[1.0], [2.0], [2.5]]);
    }

    #[test]
    fn shifted_sobol_points_are_still_evenly_spread() {
        let mut cells: Vec<usize> = numbers(SampleMethod::Sobol, 64, 5, 4)
            .iter()
            .map(|point| ((point[3] - 1.0) * 32.0) as usize)
            .collect();
        cells.sort_unstable();
        assert!(cells.into_iter().eq(0..64));
    }

    #[test]
    fn impossible_samples_are_refused() {
        let request = |method, count, seed| Sample {
            method,
            count,
            seed,
        };
        let key = |request, dimensions| sample(&ranges(dimensions), &request).err().unwrap().0;
        assert_eq!(key(request(SampleMethod::Sobol, 0, 0), 1), "count");
        assert_eq!(key(request(SampleMethod::Random, 5, -1), 1), "seed");
        assert_eq!(key(request(SampleMethod::Sobol, 5, 0), 11), "method");
    }
}
