//! Points along a path of poses.

use crate::robot::pose::{Pose, between, distance_and_angle};

/// Length that counts as much as a turn by one radian, m.
const LENGTH_PER_RADIAN: f64 = 0.1;

/// A point of a path.
#[derive(Clone, Copy, Debug)]
pub struct PathPoint {
    /// Pose of the hand.
    pub pose: Pose,
    /// Way from the start, m: √(dx² + (0.1 m dφ)²) summed up.
    pub way: f64,
    /// Index of the given pose at or before it.
    pub given: usize,
}

/// Cuts a path into points whose neighbours are at most `step` apart (m, and 10 rad per m): straight between the
/// given poses, all of which are points. Equal neighbours become one point.
pub fn subdivide(poses: &[Pose], step: f64) -> Vec<PathPoint> {
    let Some(first) = poses.first() else {
        return Vec::new();
    };
    let mut points = vec![PathPoint {
        pose: *first,
        way: 0.0,
        given: 0,
    }];
    for (index, pair) in poses.windows(2).enumerate() {
        let (distance, angle) = distance_and_angle(&pair[0], &pair[1]);
        let length = distance.hypot(LENGTH_PER_RADIAN * angle);
        if length < 1e-9 {
            continue;
        }
        let start = points[points.len() - 1].way;
        // Round-off must not add a point where poses are a step apart.
        let pieces = (length / step - 1e-6).ceil().max(1.0) as usize;
        for piece in 1..=pieces {
            let part = piece as f64 / pieces as f64;
            points.push(PathPoint {
                pose: between(&pair[0], &pair[1], part),
                way: start + part * length,
                given: if piece == pieces { index + 1 } else { index },
            });
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::pose_of_angles;

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
}
