//! A simulated arm that follows joint trajectories like a real one: with latency, with lag, and
//! within its limits.

use crate::cell::Arm;
use rodlab_robot::{Chain, PartTrajectory, Pose};

/// Largest distance of a joint from its setpoint, rad or m; beyond it the motion fails.
const PATH_TOLERANCE: f64 = 0.3;
/// Distance of a joint from the last point within which the point is reached, rad or m.
const GOAL_TOLERANCE: f64 = 2e-3;
/// Time after the last point within which all joints must reach it, s.
const SETTLING: f64 = 1.0;
/// Largest speed in a trajectory, relative to the limit of a joint; it allows for rounding.
const SPEED_MARGIN: f64 = 1.05;

/// Response of an arm to commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// Time from a command to the first motion, s.
    pub latency: f64,
    /// Time constant of the lag, s: at the speed v, a joint is v × `lag` behind its setpoint.
    pub lag: f64,
}

impl Default for Response {
    /// Twenty milliseconds each, typical for arms with position controllers.
    fn default() -> Self {
        Self {
            latency: 0.02,
            lag: 0.02,
        }
    }
}

/// End of a motion, in the codes of `control_msgs/FollowJointTrajectory`.
#[derive(Clone, Debug, PartialEq)]
pub enum Ended {
    /// At the last point.
    There,
    /// A joint left its path (−4), or did not reach the last point (−5).
    Broken(Refusal),
}

/// Reason why a goal is rejected or was aborted.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// Error code of the result; −1 for an impossible goal, −2 for wrong joints.
    pub code: i64,
    /// Message.
    pub words: String,
}

impl Refusal {
    /// Rejects an impossible goal with a message.
    pub fn invalid(words: impl Into<String>) -> Self {
        Self {
            code: -1,
            words: words.into(),
        }
    }
}

/// An arm in motion or at rest.
pub struct SimulatedArm {
    /// Name of the arm.
    pub name: String,
    chain: Chain,
    base: Pose,
    response: Response,
    joints: Vec<f64>,
    /// Joint positions that it holds while it has no goal.
    held: Vec<f64>,
    speeds: Vec<f64>,
    goal: Option<(PartTrajectory, f64)>,
    /// A new goal that is still within its latency, and its time of arrival.
    next: Option<(PartTrajectory, f64)>,
    frozen: Option<usize>,
}

impl SimulatedArm {
    /// Creates an arm of a cell in its home posture.
    pub fn new(arm: &Arm, response: Response) -> Self {
        Self {
            name: arm.name.clone(),
            chain: arm.chain.clone(),
            base: arm.base,
            response,
            joints: arm.home.clone(),
            held: arm.home.clone(),
            speeds: vec![0.0; arm.home.len()],
            goal: None,
            next: None,
            frozen: None,
        }
    }

    /// Names of the joints.
    pub fn names(&self) -> Vec<&str> {
        let joints = self.chain.joints.iter();
        joints.map(|joint| joint.name.as_str()).collect()
    }

    /// Positions of the joints, rad or m.
    pub fn joints(&self) -> &[f64] {
        &self.joints
    }

    /// Pose of the hand in the cell.
    pub fn hand(&self) -> Pose {
        self.base * self.chain.hand(&self.joints)
    }

    /// Whether the arm follows a trajectory.
    pub fn is_moving(&self) -> bool {
        self.goal.is_some() || self.next.is_some()
    }

    /// Fails if the arm moves, since a rod cannot be clamped or handed over then.
    ///
    /// # Errors
    /// It moves.
    pub fn must_stand(&self) -> Result<(), String> {
        match self.is_moving() {
            true => Err("the arm must be at rest while the rod is handed over".into()),
            false => Ok(()),
        }
    }

    /// Accepts a trajectory that replaces the current one from `now`, s. If its first point is
    /// later, the joints move there from the last setpoint of the previous trajectory.
    ///
    /// # Errors
    /// The joints differ, there are no points, times do not increase, or positions or speeds
    /// exceed the limits.
    pub fn take(&mut self, given: PartTrajectory, now: f64) -> Result<(), Refusal> {
        let trajectory = self.in_order(given)?;
        let times = &trajectory.times;
        if times.is_empty() || times[0] < 0.0 || times.windows(2).any(|pair| !(pair[0] < pair[1])) {
            return Err(Refusal::invalid(
                "the times of the points must start at 0 and increase",
            ));
        }
        for (index, joint) in self.chain.joints.iter().enumerate() {
            let limits = &joint.limits;
            let mut positions = trajectory.points.iter().map(|point| point[index]);
            if let Some(position) = positions.find(|position| !limits.allow(*position)) {
                return Err(Refusal::invalid(format!(
                    "{}: position {position:.4}; allowed: {:.4} to {:.4}",
                    joint.name, limits.lower, limits.upper
                )));
            }
            let moves = trajectory.points.windows(2).zip(times.windows(2));
            let mut speeds =
                moves.map(|(p, t)| ((p[1][index] - p[0][index]) / (t[1] - t[0])).abs());
            if let Some(speed) = speeds.find(|speed| !(*speed <= SPEED_MARGIN * limits.velocity)) {
                return Err(Refusal::invalid(format!(
                    "{}: speed {speed:.4}; allowed: {:.4}",
                    joint.name, limits.velocity
                )));
            }
        }
        self.next = Some((trajectory, now));
        Ok(())
    }

    /// The trajectory with its joints in the order of the chain.
    fn in_order(&self, given: PartTrajectory) -> Result<PartTrajectory, Refusal> {
        let names = self.names();
        let place = |name| given.joints.iter().position(|joint| joint == name);
        let order: Option<Vec<usize>> = names.iter().map(place).collect();
        let order = order.filter(|order| order.len() == given.joints.len());
        let Some(order) = order else {
            return Err(Refusal {
                code: -2,
                words: format!("the joints of {} are {}", self.name, names.join(", ")),
            });
        };
        let points = given.points.iter();
        Ok(PartTrajectory {
            joints: names.iter().map(|name| (*name).to_owned()).collect(),
            times: given.times,
            points: points
                .map(|point| order.iter().map(|&joint| point[joint]).collect())
                .collect(),
        })
    }

    /// Ends the motion at the current position.
    pub fn stop(&mut self) {
        (self.goal, self.next) = (None, None);
        self.held.clone_from(&self.joints);
    }

    /// Stops the fastest joint permanently; returns its name.
    pub fn freeze(&mut self) -> &str {
        let speeds = self.speeds.iter().enumerate();
        let fastest = speeds.max_by(|one, other| one.1.total_cmp(other.1));
        let joint = fastest.map_or(0, |(joint, _)| joint);
        self.frozen = Some(joint);
        &self.chain.joints[joint].name
    }

    /// Advances by `step` to the time `now`, s; returns how a motion ended, if it did.
    pub fn advance(&mut self, now: f64, step: f64) -> Option<Ended> {
        let latency = self.response.latency;
        let elapsed = |begin: f64| now - begin - latency;
        let setpoint = |goal: &Option<(PartTrajectory, f64)>, held: &[f64]| match goal {
            Some((trajectory, begin)) => trajectory.at(elapsed(*begin)),
            None => held.to_vec(),
        };
        let mut target = setpoint(&self.goal, &self.held);
        if let Some((mut next, begin)) = self.next.take_if(|next| elapsed(next.1) >= 0.0) {
            if next.times[0] > 0.0 {
                next.times.insert(0, 0.0);
                next.points.insert(0, target);
            }
            self.goal = Some((next, begin));
            target = setpoint(&self.goal, &self.held);
        }
        let part = -libm::expm1(-step / self.response.lag.max(1e-9));
        for (index, joint) in self.chain.joints.iter().enumerate() {
            let most = SPEED_MARGIN * joint.limits.velocity * step;
            let way = part * (target[index] - self.joints[index]);
            let way = match self.frozen {
                Some(frozen) if frozen == index => 0.0,
                _ => way.clamp(-most, most),
            };
            self.joints[index] += way;
            self.speeds[index] = (way / step).abs();
        }
        let (trajectory, begin) = self.goal.as_ref().filter(|_| self.next.is_none())?;
        let late = elapsed(*begin) - trajectory.duration();
        let names = &trajectory.joints;
        let off = |point: &[f64]| {
            let pairs = self.joints.iter().zip(point).zip(names);
            let off = pairs.map(|((at, should), name)| ((at - should).abs(), name.clone()));
            off.max_by(|one, other| one.0.total_cmp(&other.0))
        };
        let (behind, joint) = off(&target)?;
        let (left, last_joint) = off(&trajectory.points[trajectory.points.len() - 1])?;
        let ended = if behind > PATH_TOLERANCE {
            let words = format!("{joint} is {behind:.3} from its path");
            Ended::Broken(Refusal { code: -4, words })
        } else if late >= 0.0 && left <= GOAL_TOLERANCE {
            Ended::There
        } else if late > SETTLING {
            let words = format!("{last_joint} is {left:.3} from the last point");
            Ended::Broken(Refusal { code: -5, words })
        } else {
            return None;
        };
        if ended == Ended::There {
            self.held.clone_from(&target);
            self.goal = None;
        } else {
            self.stop();
        }
        Some(ended)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_cells::gantry;

    const STEP: f64 = 5e-3;

    fn ramp(seconds: f64) -> PartTrajectory {
        let arm = &gantry().arms[0];
        let point = |k: i32| {
            let mut point = arm.home.clone();
            point[0] += 1e-3 * f64::from(k);
            point
        };
        PartTrajectory {
            joints: arm.chain.joint_names(),
            times: (0..=100).map(|k| seconds * f64::from(k) / 100.0).collect(),
            points: (0..=100).map(point).collect(),
        }
    }

    fn arm() -> SimulatedArm {
        SimulatedArm::new(&gantry().arms[0], Response::default())
    }

    /// Follows a trajectory to its end; returns the largest distance of the first joint from its
    /// setpoint, and how the motion ended.
    fn follow(arm: &mut SimulatedArm, trajectory: &PartTrajectory) -> (f64, Ended) {
        arm.take(trajectory.clone(), 0.0).unwrap();
        let mut worst: f64 = 0.0;
        for step in 1.. {
            let now = STEP * f64::from(step);
            let ended = arm.advance(now, STEP);
            worst = worst.max((arm.joints()[0] - trajectory.at(now)[0]).abs());
            if let Some(ended) = ended {
                return (worst, ended);
            }
        }
        unreachable!()
    }

    #[test]
    fn an_arm_reaches_the_last_point_with_latency_and_lag() {
        let (behind, ended) = follow(&mut arm(), &ramp(2.0));
        assert_eq!(ended, Ended::There);
        // 5 cm/s with a delay of 40 ms: 2 mm; slightly less in steps of 5 ms.
        assert!((1.5e-3..2.1e-3).contains(&behind), "{behind}");
    }

    #[test]
    fn a_goal_that_arrives_in_motion_is_followed_without_a_stop() {
        let (mut arm, whole) = (arm(), ramp(2.0));
        arm.take(whole.clone(), 0.0).unwrap();
        let after = |time: f64| {
            let rest = whole.times.iter().zip(&whole.points);
            let rest = rest.filter(|(known, _)| **known >= time + 0.1);
            let (times, points) = rest
                .map(|(known, point)| (known - time, point.clone()))
                .unzip();
            PartTrajectory {
                joints: whole.joints.clone(),
                times,
                points,
            }
        };
        let mut steps = 0;
        let ended = (1..1000).find_map(|step| {
            let now = STEP * f64::from(step);
            if step % 50 == 0 && now < 1.8 {
                arm.take(after(now), now).unwrap();
            }
            let before = arm.joints()[0];
            let ended = arm.advance(now, STEP);
            let speed = (arm.joints()[0] - before) / STEP;
            if (0.2..1.9).contains(&now) {
                // 5 cm/s; at the start of the new trajectory the joints lag slightly.
                assert!((0.04..0.06).contains(&speed), "{speed} at {now}");
                steps += 1;
            }
            ended
        });
        assert!(steps > 300);
        assert_eq!(ended, Some(Ended::There));
    }

    #[test]
    fn a_frozen_joint_does_not_reach_the_end() {
        let mut arm = arm();
        arm.take(ramp(2.0), 0.0).unwrap();
        for step in 1..=200 {
            assert_eq!(arm.advance(STEP * f64::from(step), STEP), None);
        }
        assert_eq!(arm.freeze(), "x");
        let ended = (201..1000).find_map(|step| arm.advance(STEP * f64::from(step), STEP));
        assert!(
            matches!(&ended, Some(Ended::Broken(Refusal { code: -5, words })) if words.contains("x is")),
            "{ended:?}"
        );
    }

    #[test]
    fn goals_beyond_the_limits_are_refused() {
        let mut arm = arm();
        type Change = fn(&mut PartTrajectory);
        let cases: [(f64, Change, i64, &str); 4] = [
            (2.0, |given| given.joints[0] = "head".into(), -2, "joints"),
            (2.0, |given| given.times[7] = given.times[6], -1, "increase"),
            (0.01, |_| {}, -1, "speed"),
            (2.0, |given| given.points[100][0] = f64::NAN, -1, "position"),
        ];
        for (seconds, change, code, expected) in cases {
            let mut given = ramp(seconds);
            change(&mut given);
            let refusal = arm.take(given, 0.0).unwrap_err();
            assert_eq!(refusal.code, code, "{expected}");
            assert!(refusal.words.contains(expected), "{refusal:?}");
        }
        assert!(!arm.is_moving());
    }

    #[test]
    fn an_arm_that_is_stopped_stays_where_it_is() {
        let mut arm = arm();
        arm.take(ramp(2.0), 0.0).unwrap();
        for step in 1..=200 {
            arm.advance(STEP * f64::from(step), STEP);
        }
        let there = arm.joints().to_vec();
        arm.stop();
        arm.advance(1.005, STEP);
        assert_eq!(arm.joints(), there);
    }
}
