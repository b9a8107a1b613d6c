//! The motions of both arms that tie a knot, planned and checked before anything moves.
//!
//! Between grips both arms move in one motion, and at grips both stand. While the end is led to where it must go under, the other
//! arm comes from above to the strand there; it lifts the strand, waits until the end has passed, and puts it down; it rises,
//! and goes to the next strand or home.

use super::plan::KnotPlan;
use super::two_arms::{TwoArms, joined};
use crate::cell::{Cell, Place, PlanError, PlanReport, PlanRequest};
use crate::plan::deployment::GripperPose;
use crate::plan::tying::GripperPoses;
use crate::robot::{JointTrajectory, Pose, pose, subdivide};
use crate::task::room::is_in_room;
use crate::task::working_arm::Grip;
use nalgebra::Translation3;

/// How far above a strand the hand is that comes to it, or has let it go, m.
const RISE: f64 = 0.06;
/// Points per second of motions.
const RATE: u32 = 100;
/// Rest between the motion of one arm and that of the other, s: they begin a little apart, as messages do.
const REST: f64 = 0.3;
/// Ways shorter than this are none, m.
const NO_WAY: f64 = 1e-6;
/// Times of a schedule nearer than this are the same, s.
const SAME: f64 = 1e-6;
/// Distance of the points by which the length of a way is told, m.
const SPACING: f64 = 1e-3;
/// Points of a motion between those at which the distance of the arms to everything is looked at.
const STRIDE: usize = 5;

/// What is to be planned.
pub struct TieMotionRequest<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Indices of the arm that lays and leads, and of the one that lifts.
    pub arms: [usize; 2],
    /// Where the frame of the pattern lies in the cell.
    pub place: Place,
    /// Greatest speed of a hand that holds the rod, m/s.
    pub speed: f64,
    /// The same of one that holds nothing, m/s.
    pub free_speed: f64,
    /// Least distance to anything else, m.
    pub margin: f64,
}

/// A motion of both arms between two grips.
pub struct Stretch {
    /// Name of its folder.
    pub name: String,
    /// The motion.
    pub motion: JointTrajectory,
    /// What the gripper of the arm that lifts does then.
    pub then: Option<Grip>,
}

/// The planned motions.
pub struct TieMotion {
    /// The rod is laid.
    pub laying: JointTrajectory,
    /// What comes then.
    pub stretches: Vec<Stretch>,
    /// The hand that has let go of the end rises.
    pub rising: JointTrajectory,
    /// Laying and what comes then as one motion of both arms, for people to see.
    pub whole: JointTrajectory,
    /// Numbers of the path of the arm that lays and leads.
    pub report: PlanReport,
    /// Least distance of both to each other and to anything else when the rod is laid, m; 0.2 stands for that and more.
    pub least_clearance: f64,
    /// The frame of the pattern in the cell.
    pub frame: Pose,
}

/// The tying while it is put together, stretch by stretch.
struct Tying<'a> {
    request: &'a TieMotionRequest<'a>,
    frame: Pose,
    both: TwoArms<'a>,
}

impl TieMotionRequest<'_> {
    /// Plans the laying along poses, and the tying then.
    ///
    /// # Errors
    /// The pattern leaves table or picture, an arm cannot follow its path, or something comes too near to something else.
    pub fn plan(&self, laying: &[GripperPose], knot: &KnotPlan) -> Result<TieMotion, PlanError> {
        let [layer, lifter] = self.arms;
        let to_lay = laying.iter();
        let to_lay: Vec<Pose> = to_lay
            .map(|pose| Pose::from_parts(Translation3::from(pose.position), pose.rotation))
            .collect();
        let end: Vec<Pose> = poses(&knot.end).collect();
        let path = to_lay.iter().chain(&end).copied().collect();
        let report = self.best(layer, path, self.place)?;
        let (first, report) = report;
        let frame = pose(report.place_position, report.place_quaternion);
        let frame = frame.expect("the pose of a plan");
        self.in_room(&frame, knot)?;
        let home = &self.cell.arms[lifter].home;
        let to_lay: Vec<Pose> = to_lay.iter().map(|pose| frame * pose).collect();
        let cell = self.cell;
        let laid = cell.continuation(layer, &to_lay, &first, self.speed, RATE)?;
        let there = laid.points[laid.points.len() - 1].clone();
        let mut tying = Tying {
            request: self,
            frame,
            both: TwoArms::from(cell, self.arms, [there, home.clone()]),
        };
        let stretches = tying.stretches(knot)?;
        let last = tying.both.joints(0).to_vec();
        let rising = tying.raised(0, &last)?;
        let mut beside = TwoArms::from(cell, self.arms, [first, home.clone()]);
        beside.go([std::slice::from_ref(&laid), &[]]);
        let before = beside.trajectory();
        let tied = || stretches.iter().map(|stretch| &stretch.motion);
        let least_clearance = tied()
            .map(|motion| self.clearance(motion))
            .try_fold(f64::INFINITY, |least, found| Ok(least.min(found?)))
            .map_err(PlanError::Path)?;
        Ok(TieMotion {
            whole: joined(std::iter::once(&before).chain(tied())),
            laying: laid,
            stretches,
            rising,
            report,
            least_clearance,
            frame,
        })
    }

    /// The best joints at the first pose of a path that an arm is to follow, and its numbers.
    fn best(
        &self,
        arm: usize,
        path: Vec<Pose>,
        place: Place,
    ) -> Result<(Vec<f64>, PlanReport), PlanError> {
        let plan = self.cell.plan(&PlanRequest {
            arm,
            path,
            place,
            margin: self.margin,
            speed: self.speed,
            rate: RATE,
        })?;
        Ok((plan.trajectory.points[0].clone(), plan.report))
    }

    /// The rod must lie on the table, and be seen.
    fn in_room(&self, frame: &Pose, knot: &KnotPlan) -> Result<(), PlanError> {
        let mut points = knot.points.iter();
        let outside = points.find(|point| !is_in_room(self.cell, frame, **point));
        outside.map_or(Ok(()), |point| {
            Err(PlanError::Input(format!(
                "at {:.3},{:.3} the pattern leaves the table, or the picture of the camera, in which its knot is to be seen: \
                 --place puts it elsewhere, --size makes it smaller",
                point.x, point.y
            )))
        })
    }

    /// Least distance of the arms to each other and to anything else along a motion of both.
    fn clearance(&self, motion: &JointTrajectory) -> Result<f64, String> {
        let surroundings = self.cell.surroundings();
        let mut postures = surroundings.homes();
        let columns = self
            .arms
            .map(|arm| motion.columns_of(&self.cell.arms[arm].name));
        let mut least = crate::robot::FAR;
        for (point, time) in motion.points.iter().zip(&motion.times).step_by(STRIDE) {
            for (arm, columns) in self.arms.iter().zip(&columns) {
                postures[*arm] = columns.iter().map(|column| point[*column]).collect();
            }
            let Some(near) = surroundings.nearest(&postures, None) else {
                continue;
            };
            if near.distance < self.margin {
                let [one, other] = &near.between;
                return Err(format!(
                    "{one} comes within {:.3} m of {other} when both arms tie, {time:.1} s after one of their motions has begun; \
                     allowed: {} m, --margin says how much",
                    near.distance.max(0.0),
                    self.margin
                ));
            }
            least = least.min(near.distance);
        }
        Ok(least)
    }
}

impl Tying<'_> {
    /// All motions from the end of the laying on.
    fn stretches(&mut self, knot: &KnotPlan) -> Result<Vec<Stretch>, PlanError> {
        let mut stretches = Vec::new();
        let mut time = 0.0;
        let mut above: Option<Vec<f64>> = None;
        let lifts = knot.lifts.iter().zip(&knot.schedule.lifts);
        for (number, (lift, (_, corners))) in (1..).zip(lifts) {
            let [begin, lifted, lower, end] = *corners;
            let strand: Vec<Pose> = self.in_cell(&lift.poses);
            let over = Translation3::new(0.0, 0.0, RISE) * strand[0];
            let path = std::iter::once(over).chain(strand.iter().copied());
            let (there, _) =
                self.request
                    .best(self.request.arms[1], path.collect(), Place::At([0.0; 4]))?;
            let leading = self.led(knot, [time, begin])?;
            let mut coming = self.parting(above.take())?;
            let from = coming.last().map_or(self.both.joints(1), last_of).to_vec();
            coming.extend(self.straight(&from, &there)?);
            let lowering = [over, strand[0]];
            coming.extend(self.way(1, &lowering, &there, self.request.speed)?);
            self.both.go([&leading, &coming]);
            stretches.push(self.ended(format!("tying/{number}_leading"), Some(Grip::Close)));
            for times in [[begin, lifted], [lifted, lower], [lower, end]] {
                let led = self.led(knot, times)?;
                let part = between(&lift.poses, times);
                let from = self.both.joints(1).to_vec();
                let moved = self.timed(1, &part, &from, times)?;
                self.both.go([&led, &moved]);
                self.both.rest(REST);
            }
            stretches.push(self.ended(format!("tying/{number}_lifting"), Some(Grip::Open)));
            above = Some(self.both.joints(1).to_vec());
            time = end;
        }
        let leading = self.led(knot, [time, knot.schedule.duration()])?;
        let mut home = self.parting(above)?;
        let from = home.last().map_or(self.both.joints(1), last_of).to_vec();
        home.extend(self.straight(&from, &self.home())?);
        self.both.go([&leading, &home]);
        stretches.push(self.ended("tying/end".into(), None));
        Ok(stretches)
    }

    /// What has been put together so far as a motion of its own; the next one begins where it ends.
    fn ended(&mut self, name: String, then: Option<Grip>) -> Stretch {
        self.both.rest(REST);
        let joints = [0, 1].map(|which| self.both.joints(which).to_vec());
        let next = TwoArms::from(self.request.cell, self.request.arms, joints);
        let motion = std::mem::replace(&mut self.both, next).trajectory();
        Stretch { name, motion, then }
    }

    fn home(&self) -> Vec<f64> {
        self.request.cell.arms[self.request.arms[1]].home.clone()
    }

    fn in_cell(&self, poses: &GripperPoses) -> Vec<Pose> {
        self::poses(poses).map(|pose| self.frame * pose).collect()
    }

    /// The end led between two times of the schedule, from where the arm is.
    fn led(&self, knot: &KnotPlan, times: [f64; 2]) -> Result<Vec<JointTrajectory>, PlanError> {
        self.timed(0, &between(&knot.end, times), self.both.joints(0), times)
    }

    /// A way along poses that takes as long as it should, or longer where that would be too fast.
    fn timed(
        &self,
        which: usize,
        poses: &GripperPoses,
        from: &[f64],
        [begin, end]: [f64; 2],
    ) -> Result<Vec<JointTrajectory>, PlanError> {
        let path = self.in_cell(poses);
        let length = length(&path);
        if length < NO_WAY {
            return Ok(Vec::new());
        }
        let speed = (length / (end - begin)).min(self.request.speed);
        Ok(self.way(which, &path, from, speed)?.into_iter().collect())
    }

    /// The arm that lifts rises from the strand that it has let go, if it has.
    fn parting(&self, from: Option<Vec<f64>>) -> Result<Vec<JointTrajectory>, PlanError> {
        let risen = from.map(|from| self.raised(1, &from)).transpose()?;
        Ok(risen.into_iter().collect())
    }

    fn raised(&self, which: usize, from: &[f64]) -> Result<JointTrajectory, PlanError> {
        let arm = &self.request.cell.arms[self.request.arms[which]];
        let hand = arm.base * arm.chain.hand(from);
        let path = [hand, Translation3::new(0.0, 0.0, RISE) * hand];
        let way = self.way(which, &path, from, self.request.speed)?;
        Ok(way.expect("a way of some length"))
    }

    /// The arm that lifts goes from joints to joints, each straight.
    fn straight(&self, from: &[f64], to: &[f64]) -> Result<Option<JointTrajectory>, PlanError> {
        let arm = self.request.arms[1];
        self.request
            .cell
            .approach(arm, from, to, self.request.free_speed)
    }

    fn way(
        &self,
        which: usize,
        path: &[Pose],
        from: &[f64],
        speed: f64,
    ) -> Result<Option<JointTrajectory>, PlanError> {
        if length(path) < NO_WAY {
            return Ok(None);
        }
        let arm = self.request.arms[which];
        let way = self.request.cell.continuation(arm, path, from, speed, RATE);
        way.map(Some)
    }
}

fn last_of(way: &JointTrajectory) -> &[f64] {
    &way.points[way.points.len() - 1]
}

fn poses(poses: &GripperPoses) -> impl Iterator<Item = Pose> {
    let poses = poses.iter();
    poses.map(|(_, position, rotation)| Pose::from_parts(Translation3::from(*position), *rotation))
}

/// The poses between two times.
fn between(poses: &GripperPoses, [begin, end]: [f64; 2]) -> GripperPoses {
    let within = |time: f64| time >= begin - SAME && time <= end + SAME;
    poses
        .iter()
        .filter(|pose| within(pose.0))
        .copied()
        .collect()
}

/// Length of a way of the hand, m; a turn by 1 rad counts 0.1 m.
fn length(path: &[Pose]) -> f64 {
    subdivide(path, SPACING)
        .last()
        .map_or(0.0, |point| point.way)
}
