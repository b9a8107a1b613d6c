//! Smoothing splines along a sequence of points.

use super::Point;

/// Points x that minimise Σ wᵢ |xᵢ − cᵢ|² + λ Σ |xᵢ₊₁ − 2 xᵢ + xᵢ₋₁|² for points c with weights w (Whittaker 1923).
///
/// Where weights are zero, the curve has the least bending between the neighbouring points. For λ
/// = (ℓ/h)⁴ and a sampling step h, waves shorter than about 2π ℓ are smoothed away. A closed curve
/// continues from its last point to its first. O(n) time: the matrix has five diagonals.
pub(super) fn smooth(points: &[Point], weights: &[f64], lambda: f64, closed: bool) -> Vec<Point> {
    let count = points.len();
    if count < 4 {
        return points.to_vec();
    }
    if closed {
        // Points beyond this overlap have no influence.
        let overlap = ((20.0 * libm::pow(lambda, 0.25)).ceil() as usize + 8).min(4 * count);
        let wrapped = |index: usize| (index + 4 * count - overlap) % count;
        let total = count + 2 * overlap;
        let long: Vec<Point> = (0..total).map(|index| points[wrapped(index)]).collect();
        let weights: Vec<f64> = (0..total).map(|index| weights[wrapped(index)]).collect();
        return smooth(&long, &weights, lambda, false)[overlap..overlap + count].to_vec();
    }
    // Keeps the matrix regular if nearly all weights are zero.
    const LEAST_WEIGHT: f64 = 1e-9;
    let weight = |index: usize| weights[index].max(LEAST_WEIGHT);
    let mut diagonals = vec![[0.0; 3]; count];
    for (index, row) in diagonals.iter_mut().enumerate() {
        row[0] = weight(index);
    }
    for middle in 1..count - 1 {
        let row = [1.0, -2.0, 1.0];
        for i in 0..3 {
            for j in i..3 {
                diagonals[middle - 1 + i][j - i] += lambda * row[i] * row[j];
            }
        }
    }
    let mut solution: Vec<Point> = points
        .iter()
        .enumerate()
        .map(|(index, point)| point * weight(index))
        .collect();
    // LDLᵀ factorisation in place: entry [k] of a row is in the column k to the right of the
    // diagonal.
    for pivot in 0..count {
        let [diagonal, first, second] = diagonals[pivot];
        for (offset, entry) in [(1, first), (2, second)] {
            if pivot + offset >= count {
                continue;
            }
            let factor = entry / diagonal;
            if offset == 1 {
                diagonals[pivot + 1][0] -= factor * first;
                diagonals[pivot + 1][1] -= factor * second;
            } else {
                diagonals[pivot + 2][0] -= factor * second;
            }
            diagonals[pivot][offset] = factor;
            let eliminated = solution[pivot] * factor;
            solution[pivot + offset] -= eliminated;
        }
    }
    for pivot in (0..count).rev() {
        let [diagonal, first, second] = diagonals[pivot];
        let mut value = solution[pivot] / diagonal;
        if pivot + 1 < count {
            value -= solution[pivot + 1] * first;
        }
        if pivot + 2 < count {
            value -= solution[pivot + 2] * second;
        }
        solution[pivot] = value;
    }
    solution
}

/// Points at equal distances of at most `step` along a polyline, including both ends; also returns
/// the length.
///
/// A closed polyline continues from its last point to its first, which is not repeated.
pub(super) fn resample(points: &[Point], step: f64, closed: bool) -> (Vec<Point>, f64) {
    let mut line = points.to_vec();
    if closed && let Some(first) = points.first() {
        line.push(*first);
    }
    let mut along = vec![0.0];
    for pair in line.windows(2) {
        along.push(along[along.len() - 1] + (pair[1] - pair[0]).norm());
    }
    let length = along[along.len() - 1];
    if line.len() < 2 || !(length > 0.0) {
        return (points.to_vec(), 0.0);
    }
    let intervals = (length / step).ceil().max(1.0) as usize;
    let samples = if closed { intervals } else { intervals + 1 };
    let mut segment = 0;
    let resampled = (0..samples).map(|index| {
        let s = length * index as f64 / intervals as f64;
        while segment + 2 < line.len() && along[segment + 1] < s {
            segment += 1;
        }
        let size = along[segment + 1] - along[segment];
        let t = if size > 0.0 {
            ((s - along[segment]) / size).min(1.0)
        } else {
            0.0
        };
        line[segment] + (line[segment + 1] - line[segment]) * t
    });
    (resampled.collect(), length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_stays_and_gaps_are_bridged() {
        let mut points: Vec<Point> = (0..50)
            .map(|i| Point::new(f64::from(i), 2.0 * f64::from(i)))
            .collect();
        let mut weights = vec![1.0; 50];
        for index in 20..30 {
            points[index] = Point::new(1000.0, -3.0);
            weights[index] = 0.0;
        }
        let smoothed = smooth(&points, &weights, 10.0, false);
        for (index, point) in smoothed.iter().enumerate() {
            let expected = Point::new(index as f64, 2.0 * index as f64);
            assert!((point - expected).norm() < 1e-4, "{index}: {point}");
        }
    }

    #[test]
    fn the_solution_has_no_gradient() {
        let points: Vec<Point> = (0..40)
            .map(|i| Point::new(f64::from(i * i % 17), f64::from(i * 7 % 13)))
            .collect();
        let weights: Vec<f64> = (0..40).map(|i| f64::from(i % 4)).collect();
        let lambda = 5.0;
        let x = smooth(&points, &weights, lambda, false);
        let bend = |i: usize| x[i + 1] - x[i] * 2.0 + x[i - 1];
        for i in 2..38 {
            let gradient = (x[i] - points[i]) * weights[i]
                + (bend(i - 1) - bend(i) * 2.0 + bend(i + 1)) * lambda;
            assert!(gradient.norm() < 1e-5, "{i}: {gradient}");
        }
    }

    #[test]
    fn a_closed_curve_has_no_seam() {
        let circle = |turn: f64| {
            (0..60)
                .map(|i| {
                    let angle = (f64::from(i) + turn) * std::f64::consts::TAU / 60.0;
                    Point::new(30.0 * angle.cos(), 30.0 * angle.sin())
                })
                .collect::<Vec<Point>>()
        };
        let smoothed = smooth(&circle(0.0), &[1.0; 60], 20.0, true);
        let radii: Vec<f64> = smoothed.iter().map(|point| point.norm()).collect();
        let spread = radii
            .iter()
            .fold(0.0f64, |most, r| most.max((r - radii[0]).abs()));
        assert!(spread < 1e-6, "{spread}");
        assert!((radii[0] - 30.0).abs() < 0.1);
    }

    #[test]
    fn resampling_keeps_the_ends_and_the_length() {
        let corner = [
            Point::new(0.0, 0.0),
            Point::new(3.0, 0.0),
            Point::new(3.0, 4.0),
        ];
        let (points, length) = resample(&corner, 0.5, false);
        assert_eq!(length, 7.0);
        assert_eq!(points.len(), 15);
        assert_eq!(points[14], corner[2]);
        assert!((points[7] - Point::new(3.0, 0.5)).norm() < 1e-12);
        let (closed, length) = resample(&corner, 1.0, true);
        assert_eq!((closed.len(), length), (12, 12.0));
    }
}
