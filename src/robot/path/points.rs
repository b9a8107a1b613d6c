//! Points along a path of poses.

use crate::pose::{Pose, distance_and_angle};
use nalgebra::{Translation3, UnitQuaternion, Vector3, Vector6};

/// Length equivalent to a rotation by one radian, m.
const LENGTH_PER_RADIAN: f64 = 0.1;

/// A pose is a corner if the path turns by more than this there, rad.
const CORNER: f64 = 0.5;

/// A point of a path.
#[derive(Clone, Copy, Debug)]
pub struct PathPoint {
    /// Pose of the hand.
    pub pose: Pose,
    /// Arc length from the start, m: the sum of √(dx² + (0.1 m dφ)²).
    pub way: f64,
    /// Index of the last given pose up to this point.
    pub given: usize,
}

/// Divides a path into points whose neighbours are at most `step` apart (m, with a rotation of 1
/// rad counted as 0.1 m). All given poses are points; equal neighbours are merged.
///
/// Between two poses the path is a cubic. The slope of the spline at a pose is that of the parabola
/// through the pose and its neighbours. A pose at which the path turns by more than 0.5 rad remains
/// a corner.
pub fn subdivide(poses: &[Pose], step: f64) -> Vec<PathPoint> {
    let Some(first) = poses.first() else {
        return Vec::new();
    };
    // Index, pose and the distance from the previous pose, without repeated poses.
    let mut given: Vec<(usize, Pose, f64)> = vec![(0, *first, 0.0)];
    for (index, pose) in poses.iter().enumerate().skip(1) {
        let length = length(&given[given.len() - 1].1, pose);
        if length >= 1e-9 {
            given.push((index, *pose, length));
        }
    }
    let slopes: Vec<[Vector6<f64>; 2]> = (0..given.len()).map(|k| slopes(&given, k)).collect();
    let mut points = vec![PathPoint {
        pose: *first,
        way: 0.0,
        given: 0,
    }];
    for k in 1..given.len() {
        let (from, to, length) = (given[k - 1].1, given[k].1, given[k].2);
        let cubic = Cubic {
            from,
            change: local_change(&from, &to),
            slopes: [slopes[k - 1][1] * length, slopes[k][0] * length],
        };
        // A cubic is longer than its chord; this and round-off must not add a point between poses
        // that are one step apart.
        let pieces = (cubic.length() / step - 1e-6).ceil().max(1.0) as usize;
        for piece in 1..=pieces {
            let pose = if piece == pieces {
                to
            } else {
                cubic.at(piece as f64 / pieces as f64)
            };
            let before = points[points.len() - 1];
            points.push(PathPoint {
                pose,
                way: before.way + self::length(&before.pose, &pose),
                given: if piece == pieces {
                    given[k].0
                } else {
                    given[k - 1].0
                },
            });
        }
    }
    points
}

/// Distance between two poses, m.
fn length(from: &Pose, to: &Pose) -> f64 {
    let (distance, angle) = distance_and_angle(from, to);
    libm::hypot(distance, LENGTH_PER_RADIAN * angle)
}

/// Displacement, m, and rotation vector, rad, from one pose to another. The displacement is in the
/// common frame of the poses, the rotation vector in the frame of the first pose.
fn local_change(from: &Pose, to: &Pose) -> Vector6<f64> {
    let shift = to.translation.vector - from.translation.vector;
    let turn = (from.rotation.inverse() * to.rotation).scaled_axis();
    Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
}

/// Change of the pose per arc length before and after a pose; equal except at a corner.
fn slopes(given: &[(usize, Pose, f64)], k: usize) -> [Vector6<f64>; 2] {
    let pose = &given[k].1;
    let before = (k > 0).then(|| -local_change(pose, &given[k - 1].1) / given[k].2);
    let after = given
        .get(k + 1)
        .map(|next| local_change(pose, &next.1) / next.2);
    match (before, after) {
        (Some(before), Some(after)) => {
            let scaled = |slope: &Vector6<f64>| {
                let mut scaled = *slope;
                scaled.fixed_rows_mut::<3>(3).scale_mut(LENGTH_PER_RADIAN);
                scaled
            };
            if scaled(&before).angle(&scaled(&after)) > CORNER {
                return [before, after];
            }
            let (length_before, length_after) = (given[k].2, given[k + 1].2);
            let slope =
                (before * length_after + after * length_before) / (length_before + length_after);
            [slope; 2]
        }
        (Some(only), None) | (None, Some(only)) => [only; 2],
        (None, None) => [Vector6::zeros(); 2],
    }
}

/// A cubic change of a pose with given slopes at its ends; its parameter runs from 0 to 1.
struct Cubic {
    from: Pose,
    change: Vector6<f64>,
    slopes: [Vector6<f64>; 2],
}

impl Cubic {
    fn at(&self, t: f64) -> Pose {
        let (t2, t3) = (t * t, t * t * t);
        let change = self.change * (3.0 * t2 - 2.0 * t3)
            + self.slopes[0] * (t3 - 2.0 * t2 + t)
            + self.slopes[1] * (t3 - t2);
        let shift: Vector3<f64> = change.fixed_rows::<3>(0).into_owned();
        let turn: Vector3<f64> = change.fixed_rows::<3>(3).into_owned();
        Pose::from_parts(
            Translation3::from(self.from.translation.vector + shift),
            self.from.rotation * UnitQuaternion::from_scaled_axis(turn),
        )
    }

    /// An upper bound of the length: eight times the longest chord over eight equal intervals of
    /// the parameter.
    fn length(&self) -> f64 {
        let fastest = (0..8).map(|k| {
            length(
                &self.at(f64::from(k) / 8.0),
                &self.at(f64::from(k + 1) / 8.0),
            )
        });
        8.0 * fastest.fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose_of_angles;

    #[test]
    fn points_are_at_most_a_step_apart_and_hit_every_given_pose() {
        let poses = [
            pose_of_angles([0.0; 3], [0.0; 3]),
            pose_of_angles([0.0105, 0.0, 0.0], [0.0; 3]),
            pose_of_angles([0.0105, 0.0, 0.0], [0.0; 3]),
            pose_of_angles([0.0105, 0.0, 0.0], [0.0, 0.0, 0.055]),
        ];
        let points = subdivide(&poses, 1e-3);
        assert_eq!(points.len(), 1 + 11 + 6);
        for pair in points.windows(2) {
            let (distance, angle) = distance_and_angle(&pair[0].pose, &pair[1].pose);
            assert!(distance <= 1e-3 && angle <= 1e-2);
        }
        assert_eq!(points[11].given, 2 - 1);
        assert_eq!(points[17].given, 3);
        assert!(subdivide(&[], 1e-3).is_empty());
    }

    /// Poses along a circle of radius 1, whose orientation follows the circle.
    fn circle(count: usize) -> Vec<Pose> {
        let poses = (0..=count).map(|k| {
            let angle = std::f64::consts::TAU * k as f64 / count as f64;
            pose_of_angles([angle.cos(), angle.sin(), 0.0], [0.0, 0.0, angle])
        });
        poses.collect()
    }

    #[test]
    fn smooth_poses_give_a_smooth_path_of_third_order() {
        let error = |count: usize| {
            let points = subdivide(&circle(count), 0.01);
            // The slopes at the ends are of first order only.
            let inner = points
                .iter()
                .filter(|point| (2..count - 2).contains(&point.given));
            let off = inner.map(|point| {
                let [x, y, _]: [f64; 3] = point.pose.translation.vector.into();
                let turned = point.pose.rotation.euler_angles().2;
                let deviation = (turned - y.atan2(x)).rem_euclid(std::f64::consts::TAU);
                (x.hypot(y) - 1.0).abs() + deviation.min(std::f64::consts::TAU - deviation)
            });
            off.fold(0.0, f64::max)
        };
        let (coarse, fine) = (error(30), error(60));
        assert!(
            coarse < 1e-3 && (coarse / fine).log2() > 2.9,
            "{coarse:e} {fine:e}"
        );
    }

    #[test]
    fn a_corner_stays_one() {
        let at = |x: f64, y: f64| pose_of_angles([x, y, 0.0], [0.0; 3]);
        let points = subdivide(&[at(0.0, 0.0), at(0.1, 0.0), at(0.1, 0.1)], 1e-3);
        assert_eq!(points.len(), 201);
        let deviation = |point: &PathPoint| {
            let [x, y, _]: [f64; 3] = point.pose.translation.vector.into();
            (x - 0.1).abs().min(y.abs())
        };
        assert!(points.iter().all(|point| deviation(point) < 1e-15));
    }
    /// The slope at a pose is that of the parabola through it and its neighbours, however far away each of them is: a flat
    /// parabola is followed to the third power of its slope.
    #[test]
    fn a_parabola_through_uneven_poses_is_followed() {
        let bent = |x: f64| 0.02 * x * x;
        let poses: Vec<Pose> = [0.0, 0.1, 0.4, 0.5, 0.9, 1.0, 1.3]
            .iter()
            .map(|x| pose_of_angles([*x, bent(*x), 0.0], [0.0; 3]))
            .collect();
        let inner = subdivide(&poses, 0.01);
        let inner = inner.iter().filter(|point| (1..5).contains(&point.given));
        let off = inner.map(|point| {
            let place = point.pose.translation.vector;
            (place.y - bent(place.x)).abs()
        });
        let farthest = off.fold(0.0, f64::max);
        assert!(farthest < 2e-6, "{farthest:e}");
    }
}
