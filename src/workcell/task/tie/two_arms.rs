//! Motions of two arms on one clock: both move, or one moves while the other rests.

use crate::cell::Cell;
use rodlab_robot::JointTrajectory;

/// Time step between points, s.
const STEP: f64 = 0.01;

/// A motion of two arms to which motions are appended.
pub struct TwoArms<'a> {
    cell: &'a Cell,
    arms: [usize; 2],
    /// Joint positions of each arm at the end of the motion.
    joints: [Vec<f64>; 2],
    points: Vec<Vec<f64>>,
}

impl<'a> TwoArms<'a> {
    /// Starts a motion at given joint positions of each arm.
    pub fn from(cell: &'a Cell, arms: [usize; 2], joints: [Vec<f64>; 2]) -> Self {
        let points = vec![joints.concat()];
        Self {
            cell,
            arms,
            joints,
            points,
        }
    }

    /// Joint positions of one arm at the end of the motion.
    pub fn joints(&self, which: usize) -> &[f64] {
        &self.joints[which]
    }

    /// Appends paths of each arm in sequence, from its last joints, with a point every 10 ms. The
    /// arm that finishes first rests.
    pub fn go(&mut self, ways: [&[JointTrajectory]; 2]) {
        let points = ways.map(|ways| {
            let points = ways.iter().flat_map(|way| &way.points);
            points.cloned().collect::<Vec<_>>()
        });
        let count = points[0].len().max(points[1].len());
        for k in 0..count {
            for (joints, points) in self.joints.iter_mut().zip(&points) {
                if let Some(point) = points.get(k) {
                    joints.clone_from(point);
                }
            }
            self.points.push(self.joints.concat());
        }
    }

    /// Both arms rest for a time, s.
    pub fn rest(&mut self, time: f64) {
        let count = (time / STEP).ceil() as usize;
        let joints = self.joints.concat();
        self.points.extend((0..count).map(|_| joints.clone()));
    }

    /// The motion so far, from time zero.
    pub fn trajectory(&self) -> JointTrajectory {
        let columns = self
            .arms
            .iter()
            .flat_map(|&arm| self.cell.arms[arm].columns());
        JointTrajectory {
            columns: columns.collect(),
            times: (0..self.points.len()).map(|k| k as f64 * STEP).collect(),
            points: self.points.clone(),
        }
    }
}

/// Joins motions with the same columns in sequence.
pub fn joined<'a>(motions: impl IntoIterator<Item = &'a JointTrajectory>) -> JointTrajectory {
    let mut motions = motions.into_iter();
    let mut whole = motions.next().expect("a motion").clone();
    for motion in motions {
        let end = whole.times[whole.times.len() - 1] + STEP;
        let later = motion.times.iter().map(|time| end + time);
        whole.times.extend(later);
        whole.points.extend(motion.points.iter().cloned());
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arm_that_finishes_first_rests() {
        let cell = crate::test_cells::cell("two_gantries");
        let homes = [0, 1].map(|arm: usize| cell.arms[arm].home.clone());
        let mut both = TwoArms::from(&cell, [0, 1], homes.clone());
        let moved = |arm: usize, x: f64| {
            let mut to = homes[arm].clone();
            to[0] += x;
            let way = cell.approach(arm, &homes[arm], &to, 0.1);
            way.unwrap().unwrap()
        };
        let [short, long] = [moved(0, 0.05), moved(1, -0.2)];
        both.go([std::slice::from_ref(&short), std::slice::from_ref(&long)]);
        both.rest(0.2);
        let whole = both.trajectory();
        assert_eq!(whole.points.len(), 1 + long.points.len() + 20);
        assert_eq!(whole.columns.len(), 12);
        let at = |k: usize| [whole.points[k][0], whole.points[k][6]];
        let last = whole.points.len() - 1;
        assert!((at(last)[0] - homes[0][0] - 0.05).abs() < 1e-9);
        assert!((at(last)[1] - homes[1][0] + 0.2).abs() < 1e-9);
        assert_eq!(at(short.points.len() + 1)[0], at(last)[0]);
        assert!(at(short.points.len() + 1)[1] > at(last)[1]);
        // The motion passes the checks of a stream.
        cell.prepare_stream(std::slice::from_ref(&whole)).unwrap();
        let twice = joined([&whole, &whole]);
        assert_eq!(twice.points.len(), 2 * whole.points.len());
        assert!(twice.times.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
