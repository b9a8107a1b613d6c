//! Checks that hands and efforts keep their limits, along every motion and during it.
//!
//! [`Cell::prepare_stream`] checks the hands along the whole motion before it starts, whatever
//! planned it, and an [`ArmGuard`] the reports of the joints while it lasts.

use super::resolved::{Arm, Cell};
use nalgebra::Vector3;
use rodlab_robot::{JointState, Part};
use std::cell::RefCell;
use std::collections::VecDeque;

/// Time between the checked places of a motion, s.
const STEP: f64 = 2e-3;
/// Time over which the speed of a hand is measured, s.
const WINDOW: f64 = 0.05;
/// Measured speed, relative to the greatest one, at which a motion ends: reports are noisy.
const MEASURED: f64 = 1.2;
/// Distance from the box, m, at which a motion ends: an arm may leave its trajectory a little.
const OUTSIDE: f64 = 5e-3;

impl Arm {
    /// The joint whose effort is too large, N m or N, as text. Missing efforts are too large.
    fn excessive_effort(&self, efforts: &[f64]) -> Option<String> {
        if self.efforts.is_empty() {
            return None;
        }
        if efforts.len() != self.efforts.len() {
            return Some("it reports no efforts, which `effort` of the cell file limits".into());
        }
        let joints = self
            .chain
            .joints
            .iter()
            .zip(efforts.iter().zip(&self.efforts));
        let mut excessive = joints.filter(|(_, (effort, most))| !(effort.abs() <= **most));
        excessive.next().map(|(joint, (effort, most))| {
            let unit = joint.kind.effort_unit();
            format!(
                "{} has an effort of {effort:.2} {unit}; allowed: {most} {unit}",
                joint.name
            )
        })
    }
}

impl Cell {
    /// Checks the hands along a motion.
    ///
    /// # Errors
    /// A hand leaves the box, or is too fast; the message gives arm and time.
    pub(super) fn safe_hands(&self, parts: &[Part]) -> Result<(), String> {
        if !self.safety.limits_hands() {
            return Ok(());
        }
        for arm in &self.arms {
            let Some(part) = parts.iter().find(|part| part.name == arm.name) else {
                continue;
            };
            let path = part.trajectory.interpolant();
            let count = (path.duration() / STEP).ceil().max(1.0);
            let step = path.duration() / count;
            let mut before: Option<Vector3<f64>> = None;
            for k in 0..=count as usize {
                let time = step * k as f64;
                let hand = arm.hand(&path.at(time)).translation.vector;
                let speed = before.map_or(0.0, |before| (hand - before).norm() / step);
                let outside = self.safety.outside(&hand, 0.0);
                let fault = outside.or_else(|| self.safety.too_fast(speed, 1.0 + 1e-6));
                if let Some(fault) = fault {
                    return Err(format!(
                        "{}: {fault}, {time:.3} s after the start",
                        arm.name
                    ));
                }
                before = Some(hand);
            }
        }
        Ok(())
    }
}

/// Time, s, and place of a hand, m.
type Place = (f64, Vector3<f64>);

/// Monitors the arms of a cell during a motion.
pub struct ArmGuard<'a> {
    cell: &'a Cell,
    /// Times, s, and places of each hand within the last [`WINDOW`].
    seen: RefCell<Vec<VecDeque<Place>>>,
}

impl<'a> ArmGuard<'a> {
    /// The guard of a motion that begins.
    pub fn new(cell: &'a Cell) -> Self {
        Self {
            cell,
            seen: RefCell::new(vec![VecDeque::new(); cell.arms.len()]),
        }
    }

    /// The reason why a report of a part, at a time of the motion, s, must end the motion.
    pub fn fault(&self, part: &str, time: f64, state: &JointState) -> Option<String> {
        let arm = self.cell.arms.iter().position(|arm| arm.name == part)?;
        let effort = self.cell.arms[arm].excessive_effort(&state.efforts);
        effort.or_else(|| self.hand_fault(arm, time, &state.positions))
    }

    fn hand_fault(&self, arm: usize, time: f64, positions: &[f64]) -> Option<String> {
        let safety = &self.cell.safety;
        if !safety.limits_hands() {
            return None;
        }
        let hand = self.cell.arms[arm].hand(positions).translation.vector;
        let seen = &mut self.seen.borrow_mut()[arm];
        if seen.back().is_some_and(|(last, _)| *last >= time) {
            return None;
        }
        seen.push_back((time, hand));
        while seen.len() > 2 && time - seen[1].0 >= WINDOW {
            seen.pop_front();
        }
        let (since, from) = seen[0];
        let speed = match time - since >= WINDOW {
            true => (hand - from).norm() / (time - since),
            false => 0.0,
        };
        let outside = safety.outside(&hand, OUTSIDE);
        outside.or_else(|| safety.too_fast(speed, MEASURED))
    }
}

#[cfg(test)]
mod tests {
    use super::super::safety::Safety;
    use super::*;
    use crate::test_cells::gantry;
    use rodlab_robot::JointTrajectory;

    /// The gantry with limits: 30 cm to each side, and 20 cm/s.
    fn guarded() -> Cell {
        let mut cell = gantry();
        cell.safety = Safety {
            workspace: Some([[-0.3, -0.3, 0.0], [0.3, 0.3, 1.0]]),
            hand_speed: Some(0.2),
            ..Safety::default()
        };
        cell
    }

    /// A motion of the hand from its place at home along x, m, in a time, s.
    fn along_x(cell: &Cell, distance: f64, duration: f64) -> JointTrajectory {
        let arm = &cell.arms[0];
        let points = (0..=100).map(|k| {
            let part = f64::from(k) / 100.0;
            // Without speed and acceleration at both ends; the greatest speed is 15/8 of the mean.
            let part = part * part * part * (10.0 + part * (6.0 * part - 15.0));
            let mut joints = arm.home.clone();
            joints[0] += part * distance;
            joints
        });
        JointTrajectory {
            columns: arm.columns().collect(),
            times: (0..=100).map(|k| duration * f64::from(k) / 100.0).collect(),
            points: points.collect(),
        }
    }

    fn report(positions: Vec<f64>) -> JointState {
        JointState {
            received: std::time::Instant::now(),
            stamp: None,
            positions,
            efforts: Vec::new(),
        }
    }

    fn refused(cell: &Cell, motion: &JointTrajectory) -> Option<String> {
        cell.prepare_stream(std::slice::from_ref(motion)).err()
    }

    #[test]
    fn motions_beyond_the_limits_are_refused_before_they_start() {
        let cell = guarded();
        assert_eq!(refused(&cell, &along_x(&cell, 0.2, 2.0)), None);
        let far = refused(&cell, &along_x(&cell, 0.4, 5.0)).unwrap();
        assert!(far.contains("gantry: the hand at 0.30"), "{far}");
        assert!(far.contains("`safety.workspace`"), "{far}");
        // 15/8 · 0.2 m / 1 s is faster than 0.2 m/s.
        let fast = refused(&cell, &along_x(&cell, 0.2, 1.0)).unwrap();
        assert!(fast.contains("`safety.hand_speed`, 0.2 m/s"), "{fast}");
        // Without limits all of them may start.
        let free = gantry();
        for (distance, duration) in [(0.4, 5.0), (0.2, 1.0)] {
            assert_eq!(refused(&free, &along_x(&free, distance, duration)), None);
        }
    }

    #[test]
    fn planned_motions_keep_the_greatest_speed() {
        let cell = guarded();
        let mut to = cell.arms[0].home.clone();
        to[0] += 0.25;
        let way = cell.approach(0, &cell.arms[0].home, &to, 1.0).unwrap();
        assert_eq!(refused(&cell, &way.unwrap()), None);
    }

    #[test]
    fn reported_joints_beyond_the_limits_end_a_motion() {
        let cell = guarded();
        let guard = ArmGuard::new(&cell);
        let at = |x: f64| {
            let mut joints = cell.arms[0].home.clone();
            joints[0] += x;
            joints
        };
        // 0.2 m/s, with noise of 0.1 mm, is allowed.
        for k in 0..100 {
            let time = 0.01 * f64::from(k);
            let noise = if k % 2 == 0 { 1e-4 } else { -1e-4 };
            assert_eq!(
                guard.fault("gantry", time, &report(at(0.2 * time + noise))),
                None
            );
        }
        let outside = guard.fault("gantry", 1.0, &report(at(0.306))).unwrap();
        assert!(outside.contains("workspace"), "{outside}");
        let guard = ArmGuard::new(&cell);
        let faults = (0..20).map(|k| {
            let time = 0.01 * f64::from(k);
            guard.fault("gantry", time, &report(at(0.3 * time)))
        });
        let first = faults.flatten().next().unwrap();
        assert!(first.contains("faster than"), "{first}");
        // Another part has no hand.
        assert_eq!(guard.fault("axis", 0.0, &report(vec![0.0])), None);
    }

    #[test]
    fn efforts_above_their_limit_end_a_motion() {
        let mut cell = gantry();
        let count = cell.arms[0].chain.joints.len();
        let of = |first: f64| {
            let mut efforts = vec![-5.0; count];
            efforts[0] = first;
            JointState {
                efforts,
                ..report(cell.arms[0].home.clone())
            }
        };
        let reports = [9.9, -10.5, f64::NAN].map(of);
        let none = report(cell.arms[0].home.clone());
        assert_eq!(ArmGuard::new(&cell).fault("gantry", 0.0, &reports[1]), None);
        cell.arms[0].efforts = vec![10.0; count];
        let guard = ArmGuard::new(&cell);
        assert_eq!(guard.fault("gantry", 0.0, &reports[0]), None);
        let joint = &cell.arms[0].chain.joints[0].name;
        let much = guard.fault("gantry", 0.0, &reports[1]).unwrap();
        assert_eq!(
            much,
            format!("{joint} has an effort of -10.50 N; allowed: 10 N")
        );
        assert!(
            guard
                .fault("gantry", 0.0, &reports[2])
                .unwrap()
                .contains("NaN")
        );
        assert!(
            guard
                .fault("gantry", 0.0, &none)
                .unwrap()
                .contains("no efforts")
        );
    }
}
