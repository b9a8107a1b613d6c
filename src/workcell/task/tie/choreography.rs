//! Combines the motions of both arms in sequence.
//!
//! Between grips both arms move in one motion. While a gripper opens or closes, both arms are at
//! rest. While an end is moved to the place where it must pass under a strand, the other arm comes
//! from above to this strand. This arm lifts the strand, waits until the end has passed, and puts
//! the strand down. The arm then rises, and moves to the next strand or home.

use super::plan::{KnotPlan, Lead, PlannedRod};
use super::request::{RATE, TieMotionRequest};
use super::two_arms::TwoArms;
use crate::cell::{Place, PlanError};
use crate::task::working_arm::Grip;
use nalgebra::Translation3;
use rodlab_planning::plan::tying::GripperPoses;
use rodlab_robot::{JointTrajectory, Pose, subdivide};

/// Height above a strand at which a hand approaches it, or to which it rises after the release, m.
const RISE: f64 = 0.06;
/// Rest between the motions of the two arms, s, since their messages arrive at slightly different
/// times.
const REST: f64 = 0.3;
/// Length below which a path is ignored, m.
const NO_WAY: f64 = 1e-6;
/// Times of a schedule that differ by less than this count as equal, s.
const SAME: f64 = 1e-6;
/// Spacing of the points by which the length of a path is computed, m.
const SPACING: f64 = 1e-3;

/// Motions by which a rod is laid.
pub struct Laying {
    /// Motion of both arms while the laying arm comes from home; `None` for the first rod, which
    /// that arm approaches from its current joints.
    pub approach: Option<JointTrajectory>,
    /// Motion of the laying arm while it lays the rod.
    pub motion: JointTrajectory,
    /// Motion of both arms while the laying arm returns home after the release; `None` for the
    /// last rod, whose end that arm then leads.
    pub parting: Option<JointTrajectory>,
}

/// A motion of both arms between two grips.
pub struct Stretch {
    /// Name of the folder of the motion.
    pub name: String,
    /// The motion.
    pub motion: JointTrajectory,
    /// Arm (0 or 1) and command of the grip after the motion.
    pub then: Option<(usize, Grip)>,
}

/// The motions of both arms during planning.
pub struct Choreography<'a> {
    request: &'a TieMotionRequest<'a>,
    frame: Pose,
    both: TwoArms<'a>,
    /// Completed motions.
    pub done: Vec<JointTrajectory>,
}

impl<'a> Choreography<'a> {
    /// Starts with the first arm in given joints, at the start of the first rod, and the second
    /// arm at home.
    pub fn from(request: &'a TieMotionRequest<'a>, frame: Pose, first: Vec<f64>) -> Self {
        let joints = [first, request.home(1).clone()];
        Self {
            request,
            frame,
            both: TwoArms::from(request.cell, request.arms, joints),
            done: Vec::new(),
        }
    }
}

impl Choreography<'_> {
    /// Plans how the rods are laid.
    ///
    /// # Errors
    /// An arm cannot follow its path.
    pub fn layings(&mut self, knot: &KnotPlan) -> Result<Vec<Laying>, PlanError> {
        let mut layings = Vec::new();
        for (number, planned) in knot.rods.iter().enumerate() {
            let which = number % 2;
            let approach = if number == 0 {
                None
            } else {
                let path = held(knot, number)
                    .iter()
                    .map(|pose| self.frame * pose)
                    .collect();
                let (first, _) = self.request.best(which, path, Place::At([0.0; 4]))?;
                let coming = self.straight(which, self.both.joints(which), &first)?;
                self.go(which, coming.as_slice());
                Some(self.ended())
            };
            let path = laying(planned).map(|pose| self.frame * pose);
            let path: Vec<Pose> = path.collect();
            let from = self.both.joints(which).to_vec();
            let motion = self.way(which, &path, &from, self.request.speed)?;
            self.go(which, motion.as_slice());
            self.ended();
            let motion = motion.ok_or_else(|| {
                PlanError::Input("the pattern is too short to be laid along".into())
            })?;
            let parting = if number + 1 == knot.rods.len() {
                None
            } else {
                self.homewards(which)?;
                Some(self.ended())
            };
            layings.push(Laying {
                approach,
                motion,
                parting,
            });
        }
        Ok(layings)
    }

    /// Plans how ends are led and strands lifted. Returns the motions, and the arm that holds an
    /// end at last.
    ///
    /// # Errors
    /// An arm cannot follow its path.
    pub fn stretches(&mut self, knot: &KnotPlan) -> Result<(usize, Vec<Stretch>), PlanError> {
        let mut stretches = Vec::new();
        let mut last = 0;
        for (index, lead) in knot.leads.iter().enumerate() {
            let [leader, lifter] = [0, 1].map(|other| (lead.schedule.rod + other) % 2);
            if index > 0 {
                let end = self.in_cell(&lead.end);
                let coming = self.to_what_lies(leader, &end, Vec::new())?;
                self.go(leader, &coming);
                let taken = Some((leader, Grip::Close));
                stretches.push(self.stretch(stretches.len(), "taking", taken));
            }
            let mut time = 0.0;
            let mut rising = Vec::new();
            for (lift, (_, corners)) in lead.lifts.iter().zip(&lead.schedule.lifts) {
                let [begin, lifted, lower, end] = *corners;
                let strand = self.in_cell(&lift.poses);
                let leading = self.led(leader, lead, [time, begin])?;
                let coming = self.to_what_lies(lifter, &strand, rising)?;
                self.go_both(leader, [&leading, &coming]);
                let taken = Some((lifter, Grip::Close));
                stretches.push(self.stretch(stretches.len(), "leading", taken));
                for times in [[begin, lifted], [lifted, lower], [lower, end]] {
                    let leading = self.led(leader, lead, times)?;
                    let part = between(&lift.poses, times);
                    let moved = self.timed(lifter, &part, times)?;
                    self.go_both(leader, [&leading, &moved]);
                    self.both.rest(REST);
                }
                let let_go = Some((lifter, Grip::Open));
                stretches.push(self.stretch(stretches.len(), "lifting", let_go));
                rising = vec![self.raised(lifter)?];
                time = end;
            }
            let leading = self.led(leader, lead, [time, lead.schedule.duration()])?;
            let from = rising.last().map_or(self.both.joints(lifter), last_of);
            let home = self.straight(lifter, from, self.request.home(lifter))?;
            rising.extend(home);
            self.go_both(leader, [&leading, &rising]);
            let is_last = index + 1 == knot.leads.len();
            let let_go = (!is_last).then_some((leader, Grip::Open));
            stretches.push(self.stretch(stretches.len(), "end", let_go));
            if !is_last {
                self.homewards(leader)?;
                stretches.push(self.stretch(stretches.len(), "parting", None));
            }
            last = leader;
        }
        Ok((last, stretches))
    }

    /// Returns the motions since the last call as one motion; the next one begins at its end.
    pub fn ended(&mut self) -> JointTrajectory {
        self.both.rest(REST);
        let joints = [0, 1].map(|which| self.both.joints(which).to_vec());
        let next = TwoArms::from(self.request.cell, self.request.arms, joints);
        let motion = std::mem::replace(&mut self.both, next).trajectory();
        self.done.push(motion.clone());
        motion
    }

    fn stretch(&mut self, before: usize, what: &str, then: Option<(usize, Grip)>) -> Stretch {
        Stretch {
            name: format!("tying/{:02}_{what}", before + 1),
            motion: self.ended(),
            then,
        }
    }

    /// Moves one arm while the other one rests.
    fn go(&mut self, which: usize, ways: &[JointTrajectory]) {
        self.go_both(which, [ways, &[]]);
    }

    /// Moves both arms, each along its own paths.
    fn go_both(&mut self, which: usize, [ways, others]: [&[JointTrajectory]; 2]) {
        self.both.go(match which {
            0 => [ways, others],
            _ => [others, ways],
        });
    }

    /// Appends to the paths `before` of an arm an approach from above to the first of `poses` of
    /// its hand, in the cell.
    fn to_what_lies(
        &self,
        which: usize,
        poses: &[Pose],
        mut before: Vec<JointTrajectory>,
    ) -> Result<Vec<JointTrajectory>, PlanError> {
        let over = Translation3::new(0.0, 0.0, RISE) * poses[0];
        let path = std::iter::once(over).chain(poses.iter().copied()).collect();
        let (there, _) = self.request.best(which, path, Place::At([0.0; 4]))?;
        let from = before.last().map_or(self.both.joints(which), last_of);
        let coming = self.straight(which, from, &there)?;
        before.extend(coming);
        before.extend(self.way(which, &[over, poses[0]], &there, self.request.speed)?);
        Ok(before)
    }

    /// Raises an arm after its release, and moves it home.
    ///
    /// # Errors
    /// The hand cannot rise, or the arm cannot return home.
    pub fn homewards(&mut self, which: usize) -> Result<(), PlanError> {
        let mut ways = vec![self.raised(which)?];
        let home = self.straight(which, last_of(&ways[0]), self.request.home(which))?;
        ways.extend(home);
        self.go(which, &ways);
        Ok(())
    }

    fn in_cell(&self, poses: &GripperPoses) -> Vec<Pose> {
        self::poses(poses).map(|pose| self.frame * pose).collect()
    }

    /// Plans how an arm leads the end between two times of the schedule, from its current joints.
    fn led(
        &self,
        which: usize,
        lead: &Lead,
        times: [f64; 2],
    ) -> Result<Vec<JointTrajectory>, PlanError> {
        self.timed(which, &between(&lead.end, times), times)
    }

    /// A path along poses from the current joints of the arm. The motion takes the given duration,
    /// or longer if that would be too fast.
    fn timed(
        &self,
        which: usize,
        poses: &GripperPoses,
        [begin, end]: [f64; 2],
    ) -> Result<Vec<JointTrajectory>, PlanError> {
        let path = self.in_cell(poses);
        let length = length(&path);
        if length < NO_WAY {
            return Ok(Vec::new());
        }
        let speed = (length / (end - begin)).min(self.request.speed);
        let way = self.way(which, &path, self.both.joints(which), speed)?;
        Ok(way.into_iter().collect())
    }

    /// Raises the hand of an arm from its current pose.
    fn raised(&self, which: usize) -> Result<JointTrajectory, PlanError> {
        let TieMotionRequest { cell, speed, .. } = *self.request;
        let from = self.both.joints(which);
        cell.rising(self.request.arms[which], RISE, from, speed, RATE)
    }

    /// Moves an arm that holds nothing between two joint positions, along a straight line in joint
    /// space.
    fn straight(
        &self,
        which: usize,
        from: &[f64],
        to: &[f64],
    ) -> Result<Option<JointTrajectory>, PlanError> {
        let (cell, arm) = (self.request.cell, self.request.arms[which]);
        cell.approach(arm, from, to, self.request.free_speed)
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

/// Poses of the gripper that lays a rod, in the frame of the pattern.
fn laying(planned: &PlannedRod) -> impl Iterator<Item = Pose> {
    let poses = planned.laying.iter();
    poses.map(|pose| Pose::from_parts(Translation3::from(pose.position), pose.rotation))
}

/// All poses of the gripper that lays a rod, while it holds the rod.
pub fn held(knot: &KnotPlan, number: usize) -> Vec<Pose> {
    let is_held_on = number + 1 == knot.rods.len();
    let lead = knot.leads.first().filter(|_| is_held_on);
    let led = lead.into_iter().flat_map(|lead| poses(&lead.end));
    laying(&knot.rods[number]).chain(led).collect()
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

/// Length of a path of the hand, m; a turn by 1 rad counts 0.1 m.
fn length(path: &[Pose]) -> f64 {
    subdivide(path, SPACING)
        .last()
        .map_or(0.0, |point| point.way)
}
