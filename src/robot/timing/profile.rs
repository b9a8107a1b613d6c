//! The speed along a path, and the motion in time that results from it.

use super::SAMPLE;
use super::spline::Spline;
use crate::chain::Limits;

/// Smallest number of points of the profile.
const FEWEST: usize = 1000;
/// Longest distance between points, m.
const SPACING: f64 = 5e-4;
/// Fraction of the acceleration limit that is reserved for the curvature of the path; the rest is
/// for the change of speed.
const PART_FOR_CURVATURE: f64 = 0.5;

/// Bounds on speed and acceleration along a path, at evenly spaced points.
pub(super) struct SpeedProfile {
    start: f64,
    spacing: f64,
    speed: Vec<f64>,
    acceleration: Vec<f64>,
    /// Number of samples of each moving average.
    window: usize,
}

impl SpeedProfile {
    /// Computes the bounds of a path.
    pub fn new(spline: &Spline, limits: &[Limits], speed: f64) -> Self {
        let length = spline.end() - spline.start();
        let count = ((length / SPACING) as usize).max(FEWEST);
        let spacing = length / count as f64;
        let mut profile = Self {
            start: spline.start(),
            spacing,
            speed: Vec::with_capacity(count + 1),
            acceleration: Vec::with_capacity(count + 1),
            window: 1,
        };
        for k in 0..=count {
            let (mut fastest, mut strongest) = (speed, f64::INFINITY);
            let derivatives = spline.derivatives(profile.start + spacing * k as f64);
            for ([first, second, third], limits) in derivatives.iter().zip(limits) {
                let tiny = 1e-12;
                fastest = fastest
                    .min(limits.velocity / (first.abs() + tiny))
                    .min((PART_FOR_CURVATURE * limits.acceleration / (second.abs() + tiny)).sqrt())
                    .min(libm::cbrt(limits.jerk / (third.abs() + tiny)));
                let rest = (1.0 - PART_FOR_CURVATURE) * limits.acceleration;
                strongest = strongest.min(rest / (first.abs() + tiny));
            }
            profile.speed.push(fastest);
            profile.acceleration.push(strongest);
        }
        // Each average lasts a/j, so that both together limit the jerk when the acceleration
        // changes from a to −a.
        let seconds = limits
            .iter()
            .map(|limits| limits.acceleration / limits.jerk)
            .fold(0.0, f64::max);
        profile.window = ((seconds / SAMPLE).ceil() as usize).max(2);
        profile
    }

    /// Arc length at each sample, m.
    pub fn motion(&self) -> Vec<f64> {
        let speed = self.swept();
        let mut way = vec![0.0];
        let (mut elapsed, mut next) = (0.0, SAMPLE);
        for (k, pair) in speed.windows(2).enumerate() {
            let duration = 2.0 * self.spacing / (pair[0] + pair[1]);
            let acceleration = (pair[1] - pair[0]) / duration;
            while next <= elapsed + duration {
                let t = next - elapsed;
                way.push(k as f64 * self.spacing + pair[0] * t + 0.5 * acceleration * t * t);
                next += SAMPLE;
            }
            elapsed += duration;
        }
        let length = (speed.len() - 1) as f64 * self.spacing;
        way.push(length);
        let smooth = averaged(&averaged(&way, self.window), self.window);
        smooth
            .iter()
            .map(|way| self.start + way.clamp(0.0, length))
            .collect()
    }

    /// The speed at every point, from rest to rest, with bounded accelerations.
    fn swept(&self) -> Vec<f64> {
        let mut speed = self.speed.clone();
        let last = speed.len() - 1;
        speed[0] = 0.0;
        speed[last] = 0.0;
        let faster =
            |from: f64, acceleration: f64| (from * from + 2.0 * acceleration * self.spacing).sqrt();
        for k in 1..=last {
            let acceleration = self.acceleration[k - 1].min(self.acceleration[k]);
            speed[k] = speed[k].min(faster(speed[k - 1], acceleration));
        }
        for k in (0..last).rev() {
            let acceleration = self.acceleration[k + 1].min(self.acceleration[k]);
            speed[k] = speed[k].min(faster(speed[k + 1], acceleration));
        }
        speed
    }

    /// Lowers the bounds around samples that are too fast; `excess` is the factor for each sample.
    pub fn lower(&mut self, way: &[f64], excess: &[f64], allowed: f64) {
        let count = self.speed.len();
        let mut factor = vec![1.0_f64; count];
        // All samples in the windows of the averages contribute to an excess.
        let reach = self.window;
        for (k, excess) in excess
            .iter()
            .enumerate()
            .filter(|(_, excess)| **excess > allowed)
        {
            // Lower the speed in several rounds, since lowered neighbours help, too.
            let scale = libm::pow((allowed / excess).max(0.5), 0.7) * 0.995;
            let at = |k: usize| (((way[k] - self.start) / self.spacing) as usize).min(count - 1);
            let from = at(k.saturating_sub(reach));
            let to = at((k + reach).min(way.len() - 1));
            for factor in &mut factor[from..=to] {
                *factor = factor.min(scale);
            }
        }
        for (k, factor) in factor.into_iter().enumerate() {
            self.speed[k] *= factor;
            self.acceleration[k] *= factor * factor;
        }
    }
}

/// Moving average over `window` samples, with rest before the first and after the last. The result
/// is longer by the window.
fn averaged(values: &[f64], window: usize) -> Vec<f64> {
    let last = values.len() - 1;
    let at = |k: usize| values[k.saturating_sub(window).min(last)];
    // Summing differences keeps round-off from growing along the motion.
    let mut sum = values[0] * window as f64;
    let mut averages = Vec::with_capacity(values.len() + window + 1);
    averages.push(values[0]);
    for k in 1..=values.len() - 1 + window {
        sum += at(k + window) - at(k);
        averages.push(sum / window as f64);
    }
    averages
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// A joint that swings as q = sin(8 w)/2 along a path of π: its first derivative is bounded by the velocity, its second by
    /// half of the acceleration, of which the other half is left for changes of speed, and its third by the jerk.
    #[test]
    fn each_derivative_of_a_path_bounds_the_speed_by_a_limit_of_its_own() {
        const WAVE: f64 = 8.0;
        let way: Vec<f64> = (0..=4000).map(|k| PI * f64::from(k) / 4000.0).collect();
        let joints: Vec<Vec<f64>> = way.iter().map(|w| vec![0.5 * (WAVE * w).sin()]).collect();
        let spline = Spline::natural(&way, &joints);
        let limits = |velocity: f64, acceleration: f64, jerk: f64| Limits {
            lower: -1.0,
            upper: 1.0,
            velocity,
            acceleration,
            jerk,
        };
        for (order, limits) in [
            (1, limits(1.0, 1e9, 1e12)),
            (2, limits(1e6, 3.0, 1e12)),
            (3, limits(1e6, 1e9, 20.0)),
        ] {
            let profile = SpeedProfile::new(&spline, &[limits], 1e6);
            for (k, speed) in profile.speed.iter().enumerate() {
                let w = profile.spacing * k as f64;
                let (sine, cosine) = (WAVE * w).sin_cos();
                let size = 0.5 * WAVE.powi(order) * if order == 2 { sine } else { cosine };
                // Elsewhere, others bound it.
                if size.abs() < 0.2 * WAVE.powi(order) {
                    continue;
                }
                let expected = match order {
                    1 => 1.0 / size.abs(),
                    2 => (0.5 * 3.0 / size.abs()).sqrt(),
                    _ => (20.0 / size.abs()).cbrt(),
                };
                assert!(
                    (speed / expected - 1.0).abs() < 0.01,
                    "{order} at {w}: {speed} {expected}"
                );
                if order == 1 {
                    let left = 0.5 * limits.acceleration / size.abs();
                    assert!((profile.acceleration[k] / left - 1.0).abs() < 0.01);
                }
            }
        }
    }
}
