//! Poses of the gripper that moves the end of a rod, and of the one that lifts strands.

use super::{Handling, Pass, Passage, Place, Schedule};
use crate::plan::deployment::{DeployedRod, TimedPose};
use crate::plan::pattern::{PatternPoint, Point};
use rodlab_engine::mechanics::kirchhoff::numerics::smooth_step;
use rodlab_engine::mechanics::scene::piecewise_linear;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3, rotation};

/// Time between poses, s.
const INTERVAL: f64 = 0.1;
/// Height of the end above the table, in radii, which keeps it clear of the table for a gripper
/// with a jitter of a third of a radius.
const LOW: f64 = 2.2;
/// Height of the end above the top of a strand that it passes, in radii.
const HIGH: f64 = 4.0;
/// Distance from such a strand within which the end is high, and distance beyond which it is low,
/// in gravito-bending lengths.
const HIGH_WITHIN: f64 = 0.7;
const LOW_BEYOND: f64 = 1.75;
/// Length over which the end moves from its last pose of laying to the path, in gravito-bending
/// lengths.
const TRANSITION: f64 = 1.0;
/// Height above the top of another strand at which a strand is released on it, in radii. At a
/// height of one it would rest on it; it falls from slightly above.
const PUT_DOWN: f64 = 2.5;

/// Times (s), positions (m) and orientations of a clamp.
pub type GripperPoses = Vec<TimedPose>;

/// A gripper that lifts a strand and puts it down.
#[derive(Clone, Debug, PartialEq)]
pub struct LiftPath {
    /// Number of the rod whose strand it is, from 0.
    pub rod: usize,
    /// Times of grasp and release, s.
    pub held: [f64; 2],
    /// Poses of the gripper; the x axis is the tangent of the strand as drawn.
    pub poses: GripperPoses,
}

/// Rods to tie, and the positions of their patterns.
pub struct TyingTask<'a> {
    /// The rods.
    pub rods: &'a [DeployedRod],
    /// The crossings.
    pub passages: &'a [Passage],
    /// Pose at a position along a pattern.
    pub pattern: &'a dyn Fn(Place) -> PatternPoint,
}

impl TyingTask<'_> {
    /// The poses of the gripper that moves an end, starting at the `first` position and rotation.
    pub fn end_path(&self, schedule: &Schedule, first: (Vector3, UnitQuaternion)) -> GripperPoses {
        let number = schedule.rod;
        let rod = &self.rods[number];
        let unit = rod.gravito_bending_length;
        let along = |s: f64| (self.pattern)(Place { rod: number, s });
        let begin = along(rod.length);
        let aside = first.0 - at_height(&begin.position, first.0.z);
        let turned = rotation::to_vector(&(yaw(&begin).inverse() * first.1));
        let pose = |time: f64| {
            let s = piecewise_linear(&schedule.end, time).unwrap_or(rod.length);
            let point = along(s);
            let part = smooth_step((s - rod.length) / (TRANSITION * unit));
            let height = first.0.z + part * (self.end_height(number, s) - first.0.z);
            let position = at_height(&point.position, height) + (1.0 - part) * aside;
            let rotation = yaw(&point) * rotation::from_vector((1.0 - part) * turned);
            (time, position, rotation)
        };
        times(&schedule.end).into_iter().map(pose).collect()
    }

    /// The paths of the gripper that lifts strands, one per strand.
    pub fn lift_paths(&self, schedule: &Schedule, handling: &Handling) -> Vec<LiftPath> {
        let led = &self.rods[schedule.rod];
        let lift = |&(number, times): &(usize, [f64; 4])| {
            let [begin, lifted, lower, end] = times;
            let place = self.passages[number].first;
            let strand = (self.pattern)(place);
            let radius = self.rods[place.rod].radius;
            let corners = [
                (begin, radius),
                (lifted, radius + handling.lift),
                (lower, radius + handling.lift),
                (end, 2.0 * led.radius + PUT_DOWN * radius),
            ];
            let pose = |time: f64| {
                let height = smoothly(&corners, time);
                (time, at_height(&strand.position, height), yaw(&strand))
            };
            LiftPath {
                rod: place.rod,
                held: [begin, end],
                poses: self::times(&corners).into_iter().map(pose).collect(),
            }
        };
        schedule.lifts.iter().map(lift).collect()
    }

    /// Height of the end of a rod over the table, m.
    fn end_height(&self, number: usize, s: f64) -> f64 {
        let rod = &self.rods[number];
        let low = LOW * rod.radius;
        let over = |passage: &&Passage| passage.second.rod == number && passage.pass == Pass::Over;
        let humps = self.passages.iter().filter(over).map(|passage| {
            let away = (s - passage.second.s).abs() / rod.gravito_bending_length;
            let high = 2.0 * self.rods[passage.first.rod].radius + HIGH * rod.radius;
            smooth_step((LOW_BEYOND - away) / (LOW_BEYOND - HIGH_WITHIN)) * (high - low)
        });
        low + humps.fold(0.0, f64::max)
    }
}

/// The corners of a schedule and times between them.
fn times(corners: &[(f64, f64)]) -> Vec<f64> {
    let mut times: Vec<f64> = corners.iter().map(|(time, _)| *time).take(1).collect();
    for pair in corners.windows(2) {
        let [from, to] = [pair[0].0, pair[1].0];
        let count = ((to - from) / INTERVAL).ceil().max(1.0);
        times.extend((1..=count as usize).map(|k| from + (to - from) * k as f64 / count));
    }
    times
}

/// A value that changes smoothly from corner to corner and rests at each.
fn smoothly(corners: &[(f64, f64)], time: f64) -> f64 {
    let after = corners.partition_point(|corner| corner.0 <= time);
    let (Some(before), Some(next)) = (corners.get(after.wrapping_sub(1)), corners.get(after))
    else {
        let nearest = if after == 0 {
            corners.first()
        } else {
            corners.last()
        };
        return nearest.map_or(0.0, |corner| corner.1);
    };
    before.1 + smooth_step((time - before.0) / (next.0 - before.0)) * (next.1 - before.1)
}

fn at_height(place: &Point, height: f64) -> Vector3 {
    Vector3::new(place.x, place.y, height)
}

fn yaw(point: &PatternPoint) -> UnitQuaternion {
    rotation::from_vector(point.angle * Vector3::z())
}

#[cfg(test)]
mod tests {
    use super::super::drawn::trefoil;
    use super::super::{TiedRod, TyingError, laid_length, passages};
    use super::*;
    use crate::plan::deployment::{GripperPose, OptimalGrasps, Scheme, trajectory};
    use crate::plan::pattern::Pattern;

    const ROD: DeployedRod = DeployedRod {
        gravito_bending_length: 0.0286,
        radius: 0.0032,
        length: 0.84,
    };

    fn last(curve: &Pattern) -> GripperPose {
        let point = curve.at(laid_length(&ROD));
        let poses = trajectory(&[point], &ROD, Scheme::Optimal, OptimalGrasps::Exact);
        poses.unwrap().remove(0)
    }

    #[test]
    fn the_end_goes_low_under_a_lifted_strand_and_high_over_another() {
        let curve = trefoil();
        let handling = Handling::usual([&ROD]);
        let words = [Pass::Over, Pass::Under, Pass::Over];
        let tied = TiedRod {
            rod: &ROD,
            curve: &curve,
        };
        let passages = passages(&[tied], &words).unwrap();
        let schedule = Schedule::new(0, &tied, &passages, &handling);
        // The end waits a gravito-bending length before the strand while this is lifted for two seconds.
        let (number, [begin, lifted, ..]) = schedule.lifts[0];
        assert_eq!((number, schedule.lifts.len()), (1, 1));
        assert!((lifted - begin - 2.0).abs() < 1e-12);
        let waits = passages[1].second.s - ROD.gravito_bending_length;
        for (_, s) in schedule
            .end
            .iter()
            .filter(|(time, _)| (begin..=lifted).contains(time))
        {
            assert!((s - waits).abs() < 1e-12, "{s} {waits}");
        }
        let task = TyingTask {
            rods: &[ROD],
            passages: &passages,
            pattern: &|place| curve.at(place.s),
        };
        let last = last(&curve);
        let end = task.end_path(&schedule, (last.position, last.rotation));
        // It begins at the end of laying, and ends with the pattern.
        assert!((end[0].1 - last.position).norm() < 1e-12);
        assert!(end[0].2.angle_to(&last.rotation) < 1e-9);
        let arrived = end.last().unwrap();
        let point = curve.at(curve.length()).position;
        assert!((arrived.1.xy() - point).norm() < 1e-12);
        assert!((arrived.1.z - LOW * ROD.radius).abs() < 1e-12);
        for pair in end.windows(2) {
            let seconds = pair[1].0 - pair[0].0;
            assert!(seconds > 0.0 && seconds < 1.001 * INTERVAL);
            // Along the path at its speed, with motion up and down.
            assert!((pair[1].1 - pair[0].1).norm() < 2.0 * handling.speed * seconds);
        }
        // One strand is lifted, at the second crossing, while the end passes below it.
        let lifts = task.lift_paths(&schedule, &handling);
        assert_eq!(lifts.len(), 1);
        let [begin, put_down] = lifts[0].held;
        let strand = |time: f64| {
            let after = lifts[0].poses.partition_point(|pose| pose.0 < time);
            lifts[0].poses[after.min(lifts[0].poses.len() - 1)].1
        };
        let nearest = |place: &Point| {
            let away = |pose: &&(f64, Vector3, UnitQuaternion)| (pose.1.xy() - place).norm();
            let near = end
                .iter()
                .min_by(|one, other| away(one).total_cmp(&away(other)));
            *near.unwrap()
        };
        let (under, over) = (nearest(&passages[1].place), nearest(&passages[2].place));
        assert!(begin < under.0 && under.0 < put_down);
        let clear = strand(under.0).z - under.1.z;
        assert!(clear > 2.0 * ROD.radius, "{clear}");
        assert!((strand(under.0).xy() - passages[1].place).norm() < 1e-3);
        // There is space for the rod over the other strand, which is two radii thick.
        assert!(over.1.z > 4.0 * ROD.radius, "{}", over.1.z);
        assert!(under.0 < over.0);
    }

    #[test]
    fn patterns_that_cannot_be_tied_have_a_reason() {
        use Pass::{Over, Under};
        let curve = trefoil();
        let fault = |rod: &DeployedRod, words: &[Pass]| {
            let curve = &curve;
            passages(&[TiedRod { rod, curve }], words).unwrap_err()
        };
        assert_eq!(
            fault(&ROD, &[Over, Under]),
            TyingError::Words {
                crossings: 3,
                words: 2
            }
        );
        // Laid strands pass over.
        let laid = fault(&ROD, &[Under, Under, Over]);
        assert!(
            matches!(laid, TyingError::LaidOver { number: 1, .. }),
            "{laid}"
        );
        let length = |length: f64| DeployedRod { length, ..ROD };
        let long = fault(&length(1.2), &[Over, Under, Over]);
        assert!(matches!(long, TyingError::NoPath { .. }), "{long}");
        let covered = fault(&length(0.87), &[Over, Under, Over]);
        assert!(
            matches!(covered, TyingError::LaidOver { number: 2, .. }),
            "{covered}"
        );
        let short = fault(&length(0.3), &[Over, Under, Over]);
        assert!(
            matches!(short, TyingError::NothingThere { number: 3, .. }),
            "{short}"
        );
    }
}
