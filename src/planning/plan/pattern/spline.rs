//! A smooth curve along drawn points: a penalised spline (Eilers & Marx, Statistical Science 11, 1996).
//!
//! The curve consists of uniform B-splines of degree five over the arc length of the drawing, so
//! that κ'' is continuous. The spline minimises Σ|x(u) − q|² + λ Σ|Δ³c|² with the largest λ for
//! which it stays within the allowed deviation. Of the allowed curves its curvature changes least.

use super::{PatternError, PlaneCurve, Point};

/// Degree of the spline.
const DEGREE: usize = 5;
/// Initial and maximum number of pieces.
const PIECES: [usize; 2] = [128, 4096];
/// Number of resampled points of the drawing per piece.
const POINTS_PER_PIECE: usize = 6;
/// Range of trial weights λ of the penalty, as powers of ten.
const WEIGHTS: [f64; 2] = [-8.0, 10.0];
/// Halvings of their range.
const HALVINGS: usize = 14;

/// A spline over the arc length of the drawing, m.
#[derive(Clone, Debug)]
pub struct SmoothCurve {
    control: Vec<Point>,
    /// Length of a piece, m.
    step: f64,
}

impl SmoothCurve {
    /// The smoothest curve within `allowed` (m) of the points, and its deviation.
    ///
    /// # Errors
    /// The points have no length or are not finite, or corners are too sharp.
    pub fn along(points: &[Point], allowed: f64) -> Result<(Self, f64), PatternError> {
        if !points
            .iter()
            .all(|point| point.iter().all(|x| x.is_finite()))
        {
            return Err(PatternError::Degenerate(
                "a coordinate is not a finite number",
            ));
        }
        let mut sums = vec![0.0];
        let mut kept: Vec<Point> = points.first().copied().into_iter().collect();
        for point in points.iter().skip(1) {
            let length = (point - kept[kept.len() - 1]).norm();
            if length > 0.0 {
                sums.push(sums[sums.len() - 1] + length);
                kept.push(*point);
            }
        }
        let length = sums[sums.len() - 1];
        if !(length > 0.0 && length.is_finite()) {
            return Err(PatternError::Degenerate("it has no length"));
        }
        let mut pieces = PIECES[0];
        let mut least = f64::INFINITY;
        while pieces <= PIECES[1] {
            let fit = Fit::new(&kept, &sums, pieces);
            let (curve, deviation) = fit.solve(libm::pow(10f64, WEIGHTS[0]));
            least = least.min(deviation);
            if deviation <= allowed {
                return Ok(fit.smoothest(curve, deviation, allowed));
            }
            pieces *= 2;
        }
        Err(PatternError::Deviation {
            allowed_m: allowed,
            least_m: least,
        })
    }
}

impl PlaneCurve for SmoothCurve {
    fn end(&self) -> f64 {
        self.step * self.pieces() as f64
    }

    fn pieces(&self) -> usize {
        self.control.len() - DEGREE
    }

    fn at(&self, u: f64) -> [Point; 3] {
        let place = (u / self.step).clamp(0.0, self.pieces() as f64);
        let piece = (place as usize).min(self.pieces() - 1);
        let t = place - piece as f64;
        let mut control: [Point; DEGREE + 1] =
            std::array::from_fn(|index| self.control[piece + index]);
        let mut scale = 1.0;
        let weights = bases(t);
        std::array::from_fn(|order| {
            let mut value = Point::zeros();
            for index in 0..=DEGREE - order {
                value += scale * weights[DEGREE - order][index] * control[index];
            }
            for index in 0..DEGREE - order {
                control[index] = control[index + 1] - control[index];
            }
            scale /= self.step;
            value
        })
    }
}

/// Values of the non-zero uniform B-splines at t in a piece [0, 1], for each degree up to
/// [`DEGREE`] (de Boor's recursion).
fn bases(t: f64) -> [[f64; DEGREE + 1]; DEGREE + 1] {
    let mut values = [[0.0; DEGREE + 1]; DEGREE + 1];
    values[0][0] = 1.0;
    for d in 1..=DEGREE {
        let lower = values[d - 1];
        for j in 0..=d {
            let before = if j > 0 { lower[j - 1] } else { 0.0 };
            let rising = (t + (d - j) as f64) * before;
            let falling = ((j + 1) as f64 - t) * lower[j];
            values[d][j] = (rising + falling) / d as f64;
        }
    }
    values
}

/// The piece of a sample, and the number of the sample in it.
fn place_of(sample: usize, pieces: usize) -> (usize, usize) {
    let piece = (sample / POINTS_PER_PIECE).min(pieces - 1);
    (piece, sample - piece * POINTS_PER_PIECE)
}

/// The resampled points, and the matrices of least squares and of the penalty.
struct Fit {
    samples: Vec<Point>,
    step: f64,
    controls: usize,
    /// Rows of the normal matrix, each from the diagonal to the right.
    normal: Vec<[f64; DEGREE + 1]>,
    penalty: Vec<[f64; DEGREE + 1]>,
    right: Vec<Point>,
    /// Splines at the samples of a piece, and at its end.
    weights: [[f64; DEGREE + 1]; POINTS_PER_PIECE + 1],
}

impl Fit {
    fn new(points: &[Point], sums: &[f64], pieces: usize) -> Self {
        let length = sums[sums.len() - 1];
        let count = pieces * POINTS_PER_PIECE;
        let mut segment = 0;
        let samples: Vec<Point> = (0..=count)
            .map(|index| {
                let s = length * index as f64 / count as f64;
                while segment + 2 < sums.len() && sums[segment + 1] < s {
                    segment += 1;
                }
                let part = (s - sums[segment]) / (sums[segment + 1] - sums[segment]);
                points[segment] + part.min(1.0) * (points[segment + 1] - points[segment])
            })
            .collect();
        let controls = pieces + DEGREE;
        let weights =
            std::array::from_fn(|sample| bases(sample as f64 / POINTS_PER_PIECE as f64)[DEGREE]);
        let mut normal = vec![[0.0; DEGREE + 1]; controls];
        let mut right = vec![Point::zeros(); controls];
        for (index, sample) in samples.iter().enumerate() {
            let (piece, sample_in_piece) = place_of(index, pieces);
            let weights: &[f64; DEGREE + 1] = &weights[sample_in_piece];
            for row in 0..=DEGREE {
                right[piece + row] += weights[row] * sample;
                for column in row..=DEGREE {
                    normal[piece + row][column - row] += weights[row] * weights[column];
                }
            }
        }
        let mut penalty = vec![[0.0; DEGREE + 1]; controls];
        let third = [-1.0, 3.0, -3.0, 1.0];
        for first in 0..controls - 3 {
            for row in 0..4 {
                for column in row..4 {
                    penalty[first + row][column - row] += third[row] * third[column];
                }
            }
        }
        Self {
            samples,
            step: length / pieces as f64,
            controls,
            normal,
            penalty,
            right,
            weights,
        }
    }

    /// Solves penalised least squares by LDLᵀ of a band matrix. Returns the curve and its largest
    /// deviation.
    fn solve(&self, weight: f64) -> (SmoothCurve, f64) {
        let mut rows: Vec<[f64; DEGREE + 1]> = self.normal.clone();
        for (row, penalty) in rows.iter_mut().zip(&self.penalty) {
            for (entry, penalty) in row.iter_mut().zip(penalty) {
                *entry += weight * penalty;
            }
        }
        let mut control = self.right.clone();
        for pivot in 0..self.controls {
            let row = rows[pivot];
            for below in 1..=DEGREE.min(self.controls - 1 - pivot) {
                let factor = row[below] / row[0];
                for column in below..=DEGREE {
                    rows[pivot + below][column - below] -= factor * row[column];
                }
                let part = factor * control[pivot];
                control[pivot + below] -= part;
            }
        }
        for pivot in (0..self.controls).rev() {
            let mut sum = control[pivot];
            for right in 1..=DEGREE.min(self.controls - 1 - pivot) {
                sum -= rows[pivot][right] * control[pivot + right];
            }
            control[pivot] = sum / rows[pivot][0];
        }
        let pieces = self.controls - DEGREE;
        let deviations = self.samples.iter().enumerate().map(|(index, sample)| {
            let (piece, sample_in_piece) = place_of(index, pieces);
            let weights = &self.weights[sample_in_piece];
            let mut place = -sample;
            for row in 0..=DEGREE {
                place += weights[row] * control[piece + row];
            }
            place.norm()
        });
        let deviation = deviations.fold(0.0, f64::max);
        let step = self.step;
        (SmoothCurve { control, step }, deviation)
    }

    /// The largest weight whose curve stays within the allowed deviation.
    fn smoothest(&self, curve: SmoothCurve, deviation: f64, allowed: f64) -> (SmoothCurve, f64) {
        let mut best = (curve, deviation);
        let [mut low, mut high] = WEIGHTS;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let found = self.solve(libm::pow(10f64, middle));
            if found.1 <= allowed {
                (best, low) = (found, middle);
            } else {
                high = middle;
            }
        }
        best
    }
}
