//! The motion of one arm or axis, and the cubics by which controllers move between its points.

use super::interpolant::Interpolant;

/// The motion of one arm or axis.
#[derive(Clone, Debug, PartialEq)]
pub struct PartTrajectory {
    /// Names of the joints.
    pub joints: Vec<String>,
    /// Increasing times from zero, s.
    pub times: Vec<f64>,
    /// Positions, rad or m: a row per time.
    pub points: Vec<Vec<f64>>,
}

impl PartTrajectory {
    /// Positions at a time, linearly interpolated: the first point before the motion, the last
    /// point after it.
    pub fn at(&self, time: f64) -> Vec<f64> {
        let after = self.times.partition_point(|known| *known <= time);
        if after == 0 || after == self.times.len() {
            return self.points[after.saturating_sub(1)].clone();
        }
        let (from, to) = (self.times[after - 1], self.times[after]);
        let part = (time - from) / (to - from);
        let pairs = self.points[after - 1].iter().zip(&self.points[after]);
        pairs.map(|(a, b)| a + part * (b - a)).collect()
    }

    /// A motion from rest to rest over a time, s, in a number of steps: each joint follows a
    /// polynomial of fifth degree to its final value.
    #[cfg(test)]
    pub fn smooth(joints: &[(&str, f64)], duration: f64, steps: usize) -> Self {
        let part = |k: usize| k as f64 / steps as f64;
        let rise = |s: f64| s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
        let point = |k| joints.iter().map(move |(_, height)| height * rise(part(k)));
        Self {
            joints: joints.iter().map(|(name, _)| (*name).to_owned()).collect(),
            times: (0..=steps).map(|k| duration * part(k)).collect(),
            points: (0..=steps).map(|k| point(k).collect()).collect(),
        }
    }

    /// The cubic spline through the points that begins and ends at rest. A controller that interpolates between points with
    /// positions and velocities follows it.
    pub fn interpolant(&self) -> Interpolant {
        Interpolant::new(&self.times, &self.points)
    }

    /// The last time, s.
    pub fn duration(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// The motion with fewer points. The removed points are within `tolerance`, rad or m, of the
    /// interpolant of the remaining ones.
    #[must_use]
    pub fn thinned(&self, tolerance: f64) -> Self {
        let whole = self.interpolant();
        let mut allowed = tolerance;
        loop {
            let kept = whole.knots_within(allowed);
            let thin = Self {
                joints: self.joints.clone(),
                times: kept.iter().map(|k| self.times[*k]).collect(),
                points: kept.iter().map(|k| self.points[*k].clone()).collect(),
            };
            // The spline through the remaining points is smooth at its knots; the fitted pieces
            // need not be.
            if kept.len() == self.times.len() || self.distance_from(&thin) <= tolerance {
                return thin;
            }
            allowed *= 0.5;
        }
    }

    /// Largest distance of a point from the interpolant of another motion at its time, rad or m.
    fn distance_from(&self, other: &Self) -> f64 {
        let other = other.interpolant();
        let distances = self.times.iter().zip(&self.points).map(|(time, point)| {
            let there = other.at(*time);
            let pairs = point.iter().zip(&there);
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        });
        distances.fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thinned_motion_stays_within_its_tolerance() {
        let time = |k: i32| 1e-3 * f64::from(k);
        let trajectory = PartTrajectory {
            joints: vec!["a".into(), "b".into()],
            times: (0..=4000).map(time).collect(),
            points: (0..=4000)
                .map(|k| {
                    let turn = std::f64::consts::TAU * time(k) / 4.0;
                    vec![1.0 - turn.cos(), 0.3 * (1.0 - (2.0 * turn).cos())]
                })
                .collect(),
        };
        let thin = trajectory.thinned(1e-5);
        assert!(thin.times.len() < 400, "{}", thin.times.len());
        assert!(trajectory.distance_from(&thin) <= 1e-5);
        assert_eq!(thin.points.first(), trajectory.points.first());
        assert_eq!(thin.points.last(), trajectory.points.last());
    }
}
