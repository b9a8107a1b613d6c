//! Cubics between the points of a motion, as trajectory controllers interpolate them: each passes
//! through two points with the velocities there (cubic Hermite interpolation).

/// The motion between points with velocities.
#[derive(Clone, Debug)]
pub struct Interpolant {
    times: Vec<f64>,
    points: Vec<Vec<f64>>,
    velocities: Vec<Vec<f64>>,
}

/// The cubic of one joint between two points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cubic {
    /// Duration, s.
    duration: f64,
    /// Positions at both ends, rad or m.
    ends: [f64; 2],
    /// Velocities at both ends.
    slopes: [f64; 2],
}

impl Interpolant {
    /// The spline through points at increasing times, at rest at both ends.
    pub fn new(times: &[f64], points: &[Vec<f64>]) -> Self {
        Self {
            times: times.to_vec(),
            points: points.to_vec(),
            velocities: clamped_velocities(times, points),
        }
    }

    /// The motion through points with velocities at increasing times: a row of joints per time.
    pub fn with_velocities(
        times: Vec<f64>,
        points: Vec<Vec<f64>>,
        velocities: Vec<Vec<f64>>,
    ) -> Self {
        Self {
            times,
            points,
            velocities,
        }
    }

    /// Times of the points, s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The points, rad or m: a row of joints per time.
    pub fn points(&self) -> &[Vec<f64>] {
        &self.points
    }

    /// Velocities at the points, rad/s or m/s: a row of joints per time.
    pub fn velocities(&self) -> &[Vec<f64>] {
        &self.velocities
    }

    /// Time, point and velocities at each point.
    pub(super) fn rows(&self) -> impl Iterator<Item = (f64, &Vec<f64>, &Vec<f64>)> {
        let rows = self.times.iter().zip(&self.points).zip(&self.velocities);
        rows.map(|((time, point), velocity)| (*time, point, velocity))
    }

    /// The last time, s.
    pub fn duration(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// The first point, rad or m.
    pub fn first(&self) -> &[f64] {
        &self.points[0]
    }

    /// The last point, rad or m.
    pub fn last(&self) -> &[f64] {
        &self.points[self.points.len() - 1]
    }

    /// The cubic of a joint from point `from` to point `to`.
    pub(crate) fn cubic(&self, joint: usize, from: usize, to: usize) -> Cubic {
        Cubic {
            duration: self.times[to] - self.times[from],
            ends: [self.points[from][joint], self.points[to][joint]],
            slopes: [self.velocities[from][joint], self.velocities[to][joint]],
        }
    }

    /// Positions at a time: the first point before the motion, the last point after it.
    pub fn at(&self, time: f64) -> Vec<f64> {
        match self.cubics_at(time) {
            Some((since, cubics)) => cubics.map(|cubic| cubic.at(since)).collect(),
            None if time >= self.times[0] => self.last().to_vec(),
            None => self.first().to_vec(),
        }
    }

    /// Velocities at a time, rad/s or m/s; zero before and after the motion.
    pub fn velocity_at(&self, time: f64) -> Vec<f64> {
        match self.cubics_at(time) {
            Some((since, cubics)) => cubics.map(|cubic| cubic.velocity_at(since)).collect(),
            None => vec![0.0; self.points[0].len()],
        }
    }

    /// The cubics of all joints at a time, and the time since their start, s; `None` before and
    /// after the motion.
    fn cubics_at(&self, time: f64) -> Option<(f64, impl Iterator<Item = Cubic>)> {
        let after = self.times.partition_point(|known| *known <= time);
        if after == 0 || after == self.times.len() {
            return None;
        }
        let joints = 0..self.points[0].len();
        let cubics = joints.map(move |joint| self.cubic(joint, after - 1, after));
        Some((time - self.times[after - 1], cubics))
    }

    /// The motion shifted to earlier times by `time`, s.
    #[must_use]
    pub fn earlier_by(mut self, time: f64) -> Self {
        self.times.iter_mut().for_each(|known| *known -= time);
        self
    }

    /// Adds a point.
    pub fn push(&mut self, time: f64, point: Vec<f64>, velocity: Vec<f64>) {
        self.times.push(time);
        self.points.push(point);
        self.velocities.push(velocity);
    }

    /// The motion of a controller that accepts this goal while it moves: from its present joint
    /// positions and velocities to the first point.
    #[cfg(test)]
    pub fn taken_at(&self, point: Vec<f64>, velocity: Vec<f64>) -> Self {
        let mut taken = self.clone();
        if taken.times[0] > 0.0 {
            taken.times.insert(0, 0.0);
            taken.points.insert(0, point);
            taken.velocities.insert(0, velocity);
        }
        taken
    }

    /// Indices of points to keep, including the first and the last. A single cubic between two
    /// neighbours passes all points in between within `tolerance`, rad or m.
    pub(super) fn knots_within(&self, tolerance: f64) -> Vec<usize> {
        let last = self.times.len() - 1;
        let fits = |from: usize, to: usize| {
            (0..self.points[0].len()).all(|joint| {
                let cubic = self.cubic(joint, from, to);
                (from + 1..to).all(|k| {
                    let there = cubic.at(self.times[k] - self.times[from]);
                    (there - self.points[k][joint]).abs() <= tolerance
                })
            })
        };
        let mut kept = vec![0];
        let mut from = 0;
        while from < last {
            // The longest stride is about as long as the previous one.
            let mut stride = 1;
            while from + 2 * stride <= last && fits(from, from + 2 * stride) {
                stride *= 2;
            }
            let mut step = stride;
            while step > 0 {
                if from + stride + step <= last && fits(from, from + stride + step) {
                    stride += step;
                }
                step /= 2;
            }
            from += stride;
            kept.push(from);
        }
        kept
    }
}

impl Cubic {
    /// Position at a time after its start, s.
    pub fn at(&self, since: f64) -> f64 {
        let ([p, q], [v, w], h) = (self.ends, self.slopes, self.duration);
        let u = since / h;
        let (squared, cubed) = (u * u, u * u * u);
        (2.0 * cubed - 3.0 * squared + 1.0) * p
            + (cubed - 2.0 * squared + u) * h * v
            + (3.0 * squared - 2.0 * cubed) * q
            + (cubed - squared) * h * w
    }

    /// Velocity at a time after its start, s.
    pub fn velocity_at(&self, since: f64) -> f64 {
        let [a, b] = self.accelerations();
        self.slopes[0] + since * (a + 0.5 * (b - a) * since / self.duration)
    }

    /// Accelerations at both ends; linear in between.
    pub fn accelerations(&self) -> [f64; 2] {
        let ([p, q], [v, w], h) = (self.ends, self.slopes, self.duration);
        let rise = (q - p) / h;
        [
            (6.0 * rise - 4.0 * v - 2.0 * w) / h,
            (2.0 * v + 4.0 * w - 6.0 * rise) / h,
        ]
    }

    /// The velocity of greatest magnitude.
    pub fn fastest(&self) -> f64 {
        let [a, b] = self.accelerations();
        let mut speeds = vec![self.slopes[0], self.slopes[1]];
        // Time at which the acceleration crosses zero.
        if a * b < 0.0 {
            let part = a / (a - b);
            speeds.push(self.slopes[0] + 0.5 * a * part * self.duration);
        }
        let larger = |x: f64, y: f64| if y.abs() > x.abs() { y } else { x };
        speeds.into_iter().fold(0.0, larger)
    }

    /// Least and greatest position.
    pub fn range(&self) -> [f64; 2] {
        let [a, b] = self.accelerations();
        let h = self.duration;
        // Zeros of the velocity v + a t + (b − a)/(2h) t².
        let (square, linear, constant) = (0.5 * (b - a) / h, a, self.slopes[0]);
        let root = (linear * linear - 4.0 * square * constant).sqrt();
        let half = -0.5 * (linear + root.copysign(linear));
        let turns = [half / square, constant / half];
        let turns = turns.into_iter().filter(|t| *t > 0.0 && *t < h);
        range_of(turns.map(|t| self.at(t)).chain(self.ends))
    }
}

/// Least and greatest of some numbers.
pub(crate) fn range_of(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], number| {
        [low.min(number), high.max(number)]
    })
}

/// Velocities at the points of the cubic spline that begins and ends at rest. The second derivative
/// of the spline is continuous: `v₋/h₋ + 2 (1/h₋ + 1/h₊) v + v₊/h₊ = 3 (Δ₋/h₋² + Δ₊/h₊²)` (de Boor
/// 1978, chapter IV). Thomas' algorithm solves these equations.
pub(super) fn clamped_velocities(times: &[f64], points: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let (count, joints) = (times.len(), points[0].len());
    let mut velocities = vec![vec![0.0; joints]; count];
    let mut factors = vec![0.0; count];
    for k in 1..count - 1 {
        let (before, after) = (times[k] - times[k - 1], times[k + 1] - times[k]);
        let pivot = 2.0 / before + 2.0 / after - factors[k - 1] / before;
        factors[k] = 1.0 / (after * pivot);
        for joint in 0..joints {
            let [p, q, r] = [k - 1, k, k + 1].map(|k| points[k][joint]);
            let right = 3.0 * ((q - p) / (before * before) + (r - q) / (after * after));
            velocities[k][joint] = (right - velocities[k - 1][joint] / before) / pivot;
        }
    }
    for k in (1..count - 1).rev() {
        for joint in 0..joints {
            velocities[k][joint] -= factors[k] * velocities[k + 1][joint];
        }
    }
    velocities
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 u² − 2 u³ is at rest at both ends.
    #[test]
    fn a_cubic_at_rest_at_both_ends_is_reproduced() {
        let rise = |u: f64| u * u * (3.0 - 2.0 * u);
        let times = [0.0, 0.1, 0.4, 0.5, 0.9, 1.0];
        let points: Vec<Vec<f64>> = times.iter().map(|u| vec![rise(*u)]).collect();
        let spline = Interpolant::new(&times, &points);
        for k in 0..=100 {
            let u = 0.01 * f64::from(k);
            assert!((spline.at(u)[0] - rise(u)).abs() < 1e-12);
        }
        let [a, _] = spline.cubic(0, 2, 3).accelerations();
        assert!((a - (6.0 - 12.0 * 0.4)).abs() < 1e-10);
        assert!((spline.cubic(0, 2, 4).fastest() - 1.5).abs() < 1e-12);
        assert!((spline.velocity_at(0.25)[0] - 6.0 * 0.25 * 0.75).abs() < 1e-12);
    }

    #[test]
    fn the_range_of_a_cubic_is_that_of_its_samples() {
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as f64 / (1_u64 << 31) as f64 - 0.5
        };
        for case in 0..200 {
            let still = if case % 4 == 0 { 0.0 } else { 1.0 };
            let cubic = Cubic {
                duration: 0.7 + random(),
                ends: [random(), random()],
                slopes: [still * 5.0 * random(), 5.0 * random()],
            };
            let samples = (0..=2000).map(|k| cubic.at(cubic.duration * f64::from(k) / 2000.0));
            let (range, sampled) = (cubic.range(), range_of(samples));
            for end in 0..2 {
                assert!(
                    (range[end] - sampled[end]).abs() < 1e-5,
                    "{cubic:?} {range:?} {sampled:?}"
                );
            }
        }
    }
}
