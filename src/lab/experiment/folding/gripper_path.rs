//! The path of the gripper, with its prescribed errors. The path is computed before the run.

use super::keys::Folding;
use crate::experiment::prepare::Jitter;
use rodlab_engine::mechanics::scene::Motion;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3, rotation};
use rodlab_planning::plan::fold::{FoldError, FoldPlanner, FoldPose};
use serde::{Deserialize, Serialize};

/// Fraction of the run during which the gripper rests, before and after the fold.
const REST: f64 = 0.03;

/// Positions of the gripper over time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GripperPath {
    /// Times of the poses, s; the first is 0.
    pub times: Vec<f64>,
    /// The poses, in L_gb, relative to the position of the edge of the flat sheet.
    pub poses: Vec<FoldPose>,
    /// Assumed slide of the sheet at each pose, m.
    pub slid: Vec<f64>,
    /// Unmodelled displacements along x and z (m) and rotation (rad).
    jitter: Vec<[f64; 3]>,
    /// Assumed L_gb, m.
    pub unit: f64,
    /// Target of the edge, m.
    target: f64,
    /// Height of the middle of a lying sheet, and the additional height on a second layer, m.
    pub height: f64,
    layer: f64,
}

impl GripperPath {
    /// The path of a fold in a run of the duration `end`, s. With a fixed `step`, the times of
    /// poses are multiples of it. `gap` is the distance of layers that rest on each other, m.
    ///
    /// # Errors
    /// The target cannot be reached.
    pub fn new(
        folding: &Folding,
        planner: &FoldPlanner,
        gap: f64,
        end: f64,
        step: Option<f64>,
    ) -> Result<Self, FoldError> {
        let unit = folding.believed().gravito_bending_length;
        let target = folding.target();
        let flat = FoldPose::FLAT;
        let mut poses = vec![flat; 2];
        let planned = planner.poses(target / unit)?.into_iter();
        poses.extend(planned.filter(|pose| *pose != flat));
        let last = poses[poses.len() - 1];
        let begin = REST * end;
        let moved = &poses[1..];
        let mut times = vec![0.0];
        times.extend(timed(moved, [begin, end - begin]));
        poses.push(last);
        times.push(end);
        if let Some(step) = step {
            for time in &mut times {
                *time = step * (*time / step).round();
            }
        }
        // Poses within one step are merged.
        let mut kept: Vec<usize> = vec![0];
        for index in 1..times.len() {
            if times[index] > times[kept[kept.len() - 1]] {
                kept.push(index);
            }
        }
        let times: Vec<f64> = kept.iter().map(|index| times[*index]).collect();
        let trembling = Jitter::new(
            [folding.jitter, folding.jitter_angle],
            folding.jitter_period,
            folding.seed,
        );
        let jitter = times.iter().map(|time| {
            let (way, turn) = trembling.at(*time);
            [way.x, way.z, turn.y]
        });
        Ok(Self {
            jitter: jitter.collect(),
            poses: kept.iter().map(|index| poses[*index]).collect(),
            slid: vec![0.0; times.len()],
            times,
            unit,
            target,
            height: 0.5 * folding.paper.thickness + gap,
            layer: folding.paper.thickness + 2.0 * gap,
        })
    }

    /// Planned position of the gripper at a pose, relative to the flat sheet, and its rotation
    /// about y.
    fn pose(&self, index: usize) -> (Vector3, f64) {
        let FoldPose { gripper, angle } = self.poses[index];
        let [x, z] = gripper.map(|value| self.unit * value);
        let place = Vector3::new(x + self.slid[index], 0.0, z + self.lowest(x));
        (place, angle)
    }

    /// Height of an edge, m: on the table at its start, on the sheet at its target, and linear in
    /// between.
    fn lowest(&self, x: f64) -> f64 {
        self.height + self.layer * (x / self.target).clamp(0.0, 1.0)
    }

    /// The motion of the edge.
    pub fn motion(&self) -> Motion {
        let (start, _) = self.pose(0);
        let places = (0..self.times.len()).map(|index| {
            let (mut place, angle) = self.pose(index);
            let [x, z, turn] = self.jitter[index];
            // The table or the sheet under the gripper stops it.
            let lowest = self.lowest(place.x);
            place += Vector3::new(x, 0.0, z);
            place.z = place.z.max(lowest);
            (self.times[index], place - start, turned(angle + turn))
        });
        let places: Vec<_> = places.collect();
        Motion {
            translation: places
                .iter()
                .map(|(time, place, _)| (*time, *place))
                .collect(),
            orientation: places
                .iter()
                .map(|(time, _, turn)| (*time, *turn))
                .collect(),
            pivot: Some(start),
            ..Motion::default()
        }
    }

    /// Largest planned speed of the gripper, m/s.
    pub fn largest_speed(&self) -> f64 {
        let speeds = (1..self.times.len()).map(|index| {
            let way = self.pose(index).0 - self.pose(index - 1).0;
            way.norm() / (self.times[index] - self.times[index - 1])
        });
        speeds.fold(0.0, f64::max)
    }

    /// Replaces the poses after `from` and up to `to`, in the same time, for a sheet that has slid
    /// by `slid`, m. Later poses keep their planned positions relative to the sheet.
    pub fn replace(&mut self, [from, to]: [usize; 2], poses: &[FoldPose], slid: f64) {
        let ends = [self.times[from], self.times[to]];
        let times = timed(poses, ends);
        let jitter: Vec<[f64; 3]> = times.iter().map(|time| self.jitter_at(*time)).collect();
        let begin = from + 1;
        self.poses.splice(begin..=to, poses[1..].iter().copied());
        self.times.splice(begin..=to, times[1..].iter().copied());
        self.jitter.splice(begin..=to, jitter[1..].iter().copied());
        self.slid.truncate(begin);
        self.slid.resize(self.times.len(), slid);
    }

    /// Ends the path: after a pose the gripper rises by a height, m, and stays there.
    pub fn lift_from(&mut self, from: usize, height: f64) {
        let end = self.times.len() - 1;
        let mut pose = self.poses[from];
        pose.gripper[1] += height / self.unit;
        for index in from + 1..=end {
            self.poses[index] = pose;
            self.slid[index] = self.slid[from];
        }
    }

    fn jitter_at(&self, time: f64) -> [f64; 3] {
        let after = self.times.partition_point(|known| *known < time);
        let after = after.clamp(1, self.times.len() - 1);
        let [begin, end] = [self.times[after - 1], self.times[after]];
        let part = ((time - begin) / (end - begin)).clamp(0.0, 1.0);
        let [one, other] = [self.jitter[after - 1], self.jitter[after]];
        std::array::from_fn(|k| one[k] + part * (other[k] - one[k]))
    }
}

/// Times of poses between two times, in proportion to distance and rotation.
fn timed(poses: &[FoldPose], [begin, end]: [f64; 2]) -> Vec<f64> {
    let mut sum = 0.0;
    let ways = poses.windows(2).map(|pair| {
        sum += pair[0].way_to(&pair[1]).max(1e-9);
        sum
    });
    let ways: Vec<f64> = [0.0].into_iter().chain(ways).collect();
    let whole = ways[ways.len() - 1].max(f64::MIN_POSITIVE);
    let time = |way: &f64| begin + way / whole * (end - begin);
    ways.iter().map(time).collect()
}

fn turned(angle: f64) -> UnitQuaternion {
    rotation::from_vector(angle * Vector3::y())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path() -> GripperPath {
        let pose = |x: f64, z: f64, angle: f64| FoldPose {
            gripper: [x, z],
            angle,
        };
        GripperPath {
            times: vec![0.0, 1.0, 3.0, 4.0],
            poses: vec![
                pose(0.0, 0.0, 0.0),
                pose(1.0, 2.0, 0.5),
                pose(3.0, 1.0, 1.5),
                pose(4.0, 0.0, 3.0),
            ],
            slid: vec![0.0; 4],
            jitter: vec![[0.0; 3]; 4],
            unit: 0.05,
            target: 0.2,
            height: 1e-3,
            layer: 2e-3,
        }
    }

    #[test]
    fn the_largest_speed_is_that_of_the_motion() {
        let path = path();
        let motion = path.motion().translation;
        let speeds = motion.windows(2).map(|pair| {
            let [(from, start), (to, end)] = [pair[0], pair[1]];
            (end - start).norm() / (to - from)
        });
        let fastest = speeds.fold(0.0, f64::max);
        assert!((path.largest_speed() - fastest).abs() < 1e-15);
        // In the first second by L_gb along the table and by two of them up, and by a quarter of a layer.
        let first = libm::hypot(0.05, 0.1 + 0.25 * 2e-3);
        assert!((fastest - first).abs() < 1e-15, "{fastest}");
    }

    #[test]
    fn a_gripper_that_gives_up_rises_by_a_height_and_stays() {
        let mut path = path();
        path.lift_from(1, 0.03);
        let motion = path.motion();
        let start = motion.translation[1].1;
        for index in [2, 3] {
            let risen = motion.translation[index].1 - start;
            assert!((risen - Vector3::z() * 0.03).norm() < 1e-15, "{risen}");
            assert_eq!(motion.orientation[index].1, motion.orientation[1].1);
        }
    }
}
