//! Timing of the gripper.

use super::GripperPose;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3};

/// Ratio of gripper displacement to laid length above which laying is slower. Along a straight
/// line this ratio is √2, and about four for the optimal scheme around a bend of 1/L_gb. At
/// constant speed of laying, the rod is thrown out of bends: an A laid at 5 cm/s deviates twice as
/// far from its pattern as with this limit.
const LARGEST_RATIO: f64 = 1.5;

/// Times of the poses of the gripper, s, from 0. Laying proceeds at `speed` (m/s). Where the
/// gripper moves more than 1.5 times as far as the laid length, laying is slower, so that the
/// gripper moves at 1.5 times `speed`.
pub fn times(poses: &[GripperPose], speed: f64) -> Vec<f64> {
    let mut time = 0.0;
    let mut times = Vec::with_capacity(poses.len());
    let mut before: Option<&GripperPose> = None;
    for pose in poses {
        if let Some(before) = before {
            let laid = pose.s - before.s;
            let moved = (pose.position - before.position).norm();
            time += laid.max(moved / LARGEST_RATIO) / speed;
        }
        times.push(time);
        before = Some(pose);
    }
    times
}

/// Arc length laid at a time between the first and the last of `times`, m; constant beyond them.
pub fn laid_after(poses: &[GripperPose], times: &[f64], time: f64) -> f64 {
    let after = times.partition_point(|known| *known < time);
    between(after, times.len(), time, |k| [times[k], poses[k].s])
}

/// Time at which an arc length (m) is laid, s: the inverse of [`laid_after`].
pub fn when_laid(poses: &[GripperPose], times: &[f64], s: f64) -> f64 {
    let after = poses.partition_point(|pose| pose.s < s);
    between(after, times.len(), s, |k| [poses[k].s, times[k]])
}

/// Interpolates the second elements of pairs at the first element `at`, between pair `after` and
/// the one before it; constant beyond the ends.
fn between(after: usize, count: usize, at: f64, pair: impl Fn(usize) -> [f64; 2]) -> f64 {
    match (after, count) {
        (_, 0) => 0.0,
        (0, _) => pair(0)[1],
        _ if after >= count => pair(count - 1)[1],
        _ => {
            let ([from, before], [to, next]) = (pair(after - 1), pair(after));
            before + (at - from) / (to - from) * (next - before)
        }
    }
}

/// Time, s, position, m, and orientation of a gripper.
pub type TimedPose = (f64, Vector3, UnitQuaternion);

/// Poses with the times at which the gripper passes them, s.
pub fn timed(poses: &[GripperPose], times: &[f64]) -> Vec<TimedPose> {
    let pairs = poses.iter().zip(times);
    pairs
        .map(|(pose, time)| (*time, pose.position, pose.rotation))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(s: f64, x: f64) -> GripperPose {
        GripperPose::new(s, x * Vector3::x(), UnitQuaternion::identity())
    }

    #[test]
    fn laying_is_slower_where_the_gripper_moves_far() {
        let poses = [pose(0.0, 0.0), pose(0.1, 0.14), pose(0.2, 0.44)];
        let times = times(&poses, 0.05);
        assert_eq!(times[0], 0.0);
        assert!((times[1] - 2.0).abs() < 1e-12);
        // 0.3 m at 0.075 m/s.
        assert!((times[2] - 6.0).abs() < 1e-12);
        for (time, expected) in [
            (-1.0, 0.0),
            (0.0, 0.0),
            (1.0, 0.05),
            (2.0, 0.1),
            (3.0, 0.125),
            (6.0, 0.2),
            (7.0, 0.2),
        ] {
            let found = laid_after(&poses, &times, time);
            assert!((found - expected).abs() < 1e-12, "{time}: {found}");
            let back = when_laid(&poses, &times, expected);
            assert!(
                (back - time.clamp(0.0, 6.0)).abs() < 1e-12,
                "{time}: {back}"
            );
        }
    }
}
