//! Motion of an arm from its current joints to the start of another motion.

use super::plan::PlanError;
use super::resolved::{Cell, Driver, ros_version};
use rodlab_robot::{
    GripperDriver, JointTrajectory, Ros1Gripper, Ros2GripperAddress, RosbridgeGripper, parametrise,
};
use std::time::{Duration, Instant};

/// Number of points of a straight path of the joints.
const POINTS: usize = 100;
/// Points per second of the motion.
const RATE: u32 = 100;
/// Hand travel equivalent to a joint rotation of 1 rad, m.
const WAY_PER_RADIAN: f64 = 0.3;
/// Distance below which joints count as at their target, rad or m.
const THERE: f64 = 1e-6;
/// Longest wait for a first report of the joints.
const PATIENCE: Duration = Duration::from_secs(2);
/// Time between two polls of a driver.
const LOOK: Duration = Duration::from_millis(2);

impl Cell {
    /// Joint positions of an arm, as its driver reports them.
    ///
    /// # Errors
    /// A message: the arm has no driver, the driver does not report, or no report arrives in time.
    pub fn stands(&self, arm: usize) -> Result<Vec<f64>, String> {
        let arm = &self.arms[arm];
        self.positions(&arm.name, arm.driver.as_ref(), &arm.chain.joint_names())
    }

    /// Angle of an external axis, rad, as its driver reports it. A motor without a sensor reports
    /// its setpoint.
    ///
    /// # Errors
    /// As [`Self::stands`].
    pub fn axis_stands(&self, axis: usize) -> Result<f64, String> {
        let axis = &self.axes[axis];
        let joints = [axis.name.clone()];
        let found = self.positions(&axis.name, axis.driver.as_ref(), &joints)?;
        Ok(found[0])
    }

    /// Waits while the released object comes to rest, on the clock of the robot if it has one, otherwise on the system clock. Ends early
    /// on request.
    pub fn rest(&self, arm: usize, duration: Duration, is_interrupted: &dyn Fn() -> bool) {
        let arm = &self.arms[arm];
        let begin = Instant::now();
        let heard = self.heard(&arm.name, arm.driver.as_ref(), &arm.chain.joint_names());
        let mut clock = heard.ok().and_then(|(driver, _)| {
            let (first, _) = driver.clock()?;
            Some((driver, first))
        });
        while !is_interrupted() {
            // A clock whose connection is lost is not used.
            let known = clock.as_mut().and_then(|(driver, first)| {
                driver.state().ok()?;
                let (now, received) = driver.clock()?;
                (received.elapsed() < self.streaming.watchdog).then_some(now - *first)
            });
            if known.is_none() {
                clock = None;
            }
            let elapsed = known.unwrap_or_else(|| begin.elapsed().as_secs_f64());
            if elapsed >= duration.as_secs_f64() {
                return;
            }
            std::thread::sleep(LOOK);
        }
    }

    fn positions(
        &self,
        name: &str,
        driver: Option<&Driver>,
        joints: &[String],
    ) -> Result<Vec<f64>, String> {
        Ok(self.heard(name, driver, joints)?.1)
    }

    /// Returns a connected driver of joints and the joint positions that it reports.
    pub(super) fn heard(
        &self,
        name: &str,
        driver: Option<&Driver>,
        joints: &[String],
    ) -> Result<(Box<dyn rodlab_robot::Driver>, Vec<f64>), String> {
        let missing = || format!("{name}: no driver in the cell file");
        let known = driver.ok_or_else(missing)?;
        let mut driver = self.driver(known).ok_or_else(missing)?;
        let in_words = |error: rodlab_robot::DriverError| format!("{name}: {error}");
        if !driver.reports_state() {
            return Err(format!("{name}: its driver does not report positions"));
        }
        driver.connect(joints).map_err(in_words)?;
        let begin = Instant::now();
        let patience = self.streaming.watchdog.max(PATIENCE);
        while begin.elapsed() < patience {
            if let Some(state) = driver.state().map_err(in_words)? {
                return Ok((driver, state.positions));
            }
            std::thread::sleep(LOOK);
        }
        Err(format!(
            "{name}: no report of all of its joints ({}) in {} s; compare the names in the cell file with the robot's",
            joints.join(", "),
            patience.as_secs()
        ))
    }

    /// Plans a motion of an arm between two joint positions, along straight lines in joint space.
    /// The hand moves at about `speed`, m/s, or slower. Collisions are checked when the motion is
    /// prepared for a stream. `None` if the arm is there already.
    ///
    /// # Errors
    /// A joint has no limit of acceleration or jerk.
    pub fn approach(
        &self,
        arm: usize,
        from: &[f64],
        to: &[f64],
        speed: f64,
    ) -> Result<Option<JointTrajectory>, PlanError> {
        let known = &self.arms[arm];
        let Some(joints) = straight(from, to) else {
            return Ok(None);
        };
        let ways = known.chain.joints.iter().zip(from.iter().zip(to));
        let way = ways.map(|(joint, (a, b))| match joint.kind {
            rodlab_robot::JointKind::Revolute => WAY_PER_RADIAN * (b - a).abs(),
            rodlab_robot::JointKind::Prismatic => (b - a).abs(),
        });
        let whole: f64 = way.sum();
        let last = (joints.len() - 1) as f64;
        let way = (0..joints.len()).map(|k| k as f64 / last * whole);
        let way: Vec<f64> = way.collect();
        let motion = parametrise(&joints, &way, &known.limits(), self.safety.planned(speed))?;
        Ok(Some(self.sampled(arm, RATE, &motion.samples)))
    }

    /// The gripper of an arm, with its opening when it holds nothing and its commanded opening
    /// when it holds an object, m.
    pub fn gripper(&self, arm: usize) -> Option<(Box<dyn GripperDriver>, [f64; 2])> {
        let arm = &self.arms[arm];
        let gripper = arm.gripper.as_ref()?;
        let action = gripper.action.clone();
        let max_effort = gripper.max_effort;
        let driver: Box<dyn GripperDriver> = match arm.driver.as_ref()? {
            Driver::Rosbridge { address, ros, .. } => Box::new(RosbridgeGripper {
                address: address.clone(),
                version: ros_version(*ros),
                action,
                max_effort,
            }),
            Driver::Ros1 { master, .. } => Box::new(Ros1Gripper {
                master: master.clone(),
                action,
                max_effort,
            }),
            Driver::Ros2(arm) => Ros2GripperAddress {
                domain: arm.domain,
                middleware: arm.middleware,
                interface: arm.interface,
                action,
                max_effort,
            }
            .driver()?,
            _ => return None,
        };
        Some((driver, [gripper.open, gripper.closed]))
    }
}

/// Points of a motion along straight lines in joint space; `None` if the joints are there already.
pub(crate) fn straight(from: &[f64], to: &[f64]) -> Option<Vec<Vec<f64>>> {
    let pairs = || from.iter().zip(to);
    let farthest = pairs().map(|(a, b)| (b - a).abs()).fold(0.0, f64::max);
    let between = |k: usize| {
        let part = k as f64 / POINTS as f64;
        pairs().map(|(a, b)| a + part * (b - a)).collect()
    };
    (farthest >= THERE).then(|| (0..=POINTS).map(between).collect())
}
