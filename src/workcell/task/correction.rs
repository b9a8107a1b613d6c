//! Online correction: the arm lays a length of rod and stops, the camera takes a picture, and the
//! rest is replanned.

use super::deploy_plan::DeployPlan;
use super::error::WorkError;
use super::working_arm::WorkingArm;
use super::workplace::Workplace;
use crate::cell::{Cell, PlanError};
use image::RgbImage;
use nalgebra::Translation3;
use rodlab_files::results::thread_cpu_time;
use rodlab_planning::plan::deployment::{CorrectedPath, ObservedContact, OptimalGrasps};
use rodlab_robot::{JointTrajectory, Pose};
use rodlab_vision::Point;
use std::time::Duration;

/// Length that is laid between two pictures, and length over which the rod returns to its pattern,
/// in gravito-bending lengths, as in `[deployment.correction]`.
const LENGTHS: [f64; 2] = [0.8, 3.5];
/// Length of rod that is ignored in pictures before the place where the rod should leave the
/// table, in gravito-bending lengths: this place is uncertain.
const UNSURE: f64 = 0.3;
/// Spacing of the points by which the end of the lying rod is measured, m.
const SPACING: f64 = 2e-3;
/// Largest distance of the start of the rod in a picture from its expected place, m. Beyond it,
/// the hanging part hides the start.
const MOST_OFF: f64 = 0.01;
/// The first line of `corrections.csv`.
const COLUMNS: &str = "laid_m,seen_m,x_m,y_m,angle_rad,gravito_bending_length_m,processor_time_s\n";
/// Points per second of a motion.
const RATE: u32 = 100;

/// Correction of the path.
#[derive(Clone, Copy, Debug)]
pub struct Correction {
    /// Length that is laid between two pictures, m.
    pub every: f64,
    /// Greatest speed of the hand, m/s.
    pub speed: f64,
}

impl Correction {
    /// The default correction for a rod of a gravito-bending length, m, and a speed of the hand, m/s.
    pub fn usual(gravito_bending_length: f64, speed: f64) -> Self {
        Self {
            every: LENGTHS[0] * gravito_bending_length,
            speed,
        }
    }

    /// The motion from one pose of the path to another.
    fn way(
        &self,
        plan: &DeployPlan,
        cell: &Cell,
        path: &CorrectedPath,
        [from, to]: [usize; 2],
        joints: &[f64],
    ) -> Result<JointTrajectory, PlanError> {
        let poses = path.poses()[from..=to].iter();
        let poses = poses.map(|(position, rotation)| {
            plan.motion.frame * Pose::from_parts(Translation3::from(*position), *rotation)
        });
        let poses: Vec<Pose> = poses.collect();
        cell.continuation(plan.arm, &poses, joints, self.speed, RATE)
    }

    /// Lays a rod in steps from the first pose of its path to the last one. Writes measurements
    /// and plans to `corrections.csv`.
    ///
    /// # Errors
    /// A step failed, or an interruption was requested.
    pub fn lay(&self, plan: &DeployPlan, at: &Workplace<'_>) -> Result<(), WorkError> {
        let unit = plan.rod.gravito_bending_length;
        let poses = plan.path.poses.iter();
        let poses = poses.map(|pose| (pose.position, pose.rotation)).collect();
        let lengths = [self.every, LENGTHS[1] * unit];
        let path = CorrectedPath::new(plan.rod, plan.path.points.clone(), poses, lengths);
        let mut path = path.with_horizon();
        let mut joints = plan.motion.laying.points[0].clone();
        let mut looks = String::from(COLUMNS);
        let last = plan.path.points.len() - 1;
        let mut here = 0;
        for number in 1.. {
            let next = path.after(here).min(last);
            let way = self.way(plan, at.cell, &path, [here, next], &joints)?;
            let arm = WorkingArm { at, arm: plan.arm };
            arm.lay(&format!("laying/{number:03}"), &way, &plan.along())?;
            joints.clone_from(&way.points[way.points.len() - 1]);
            here = next;
            if here == last {
                break;
            }
            let picture = at.look()?;
            let begin = thread_cpu_time();
            let contact = end_of_the_lying(plan, at.cell, &path, here, &picture);
            if let Some(contact) = &contact {
                let after = path.after(here).min(last);
                path.correct(here, after, contact, OptimalGrasps::Exact);
            }
            let used = thread_cpu_time().zip(begin).map(|(end, begin)| end - begin);
            looks += &row(&path, here, contact.as_ref(), used);
            at.write("corrections.csv", looks.as_bytes())?;
        }
        Ok(())
    }
}

/// Measures the end of the lying part of the rod in a picture, with the gripper at pose `index` of
/// its path; `None` if the lying part, or its visible part, is too short.
fn end_of_the_lying(
    plan: &DeployPlan,
    cell: &Cell,
    path: &CorrectedPath,
    index: usize,
    picture: &RgbImage,
) -> Option<ObservedContact> {
    let unsure = UNSURE * path.rod().gravito_bending_length;
    let lies = path.pattern()[index].s - path.risen() - unsure;
    let curve = plan.seen(picture, cell);
    let curve = curve.and_then(|seen| seen.from(plan.start()));
    let curve = curve.inspect_err(|error| tracing::warn!("not corrected at {lies:.3} m: {error}"));
    let curve = curve.ok()?;
    let begins = (curve.first()? - plan.start()).norm();
    let lying = along(&curve, lies)?;
    let window = path.window();
    if lies < window || begins > MOST_OFF {
        return None;
    }
    let contact = ObservedContact::of(&lying, window)?;
    path.is_plausible(&contact).then_some(contact)
}

/// Arc lengths and places along a curve up to a length, m; `None` if the curve is shorter.
fn along(curve: &[Point], length: f64) -> Option<Vec<(f64, Point)>> {
    let count = (length / SPACING).ceil().max(1.0);
    let mut wanted = (0..=count as usize).map(|k| length * k as f64 / count);
    let mut places = Vec::new();
    let mut next = wanted.next()?;
    let mut before = 0.0;
    for pair in curve.windows(2) {
        let step = (pair[1] - pair[0]).norm();
        while before + step >= next {
            let part = if step > 0.0 {
                (next - before) / step
            } else {
                0.0
            };
            places.push((next, pair[0] + part * (pair[1] - pair[0])));
            match wanted.next() {
                Some(after) => next = after,
                None => return Some(places),
            }
        }
        before += step;
    }
    None
}

/// The row of `corrections.csv` of a picture with the gripper at pose `index`: the measurement,
/// the estimate of the rod, and the time for vision and planning.
fn row(
    path: &CorrectedPath,
    index: usize,
    contact: Option<&ObservedContact>,
    used: Option<Duration>,
) -> String {
    let laid = path.pattern()[index].s;
    let seen = contact.map_or_else(
        || ",,,".into(),
        |contact| {
            let [x, y]: [f64; 2] = contact.position.into();
            format!("{:.6},{x:.6},{y:.6},{:.6}", contact.s, contact.angle)
        },
    );
    let length = path.rod().gravito_bending_length;
    let used = used.map_or_else(String::new, |used| format!("{:.6}", used.as_secs_f64()));
    format!("{laid:.6},{seen},{length:.6},{used}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_lie_at_their_arc_lengths() {
        let curve = [[0.0, 0.0], [0.003, 0.004], [0.003, 0.014]].map(Point::from);
        let places = along(&curve, 0.01).unwrap();
        assert_eq!(places.len(), 6);
        for (s, place) in &places {
            let expected = match s {
                s if *s <= 0.005 => Point::new(0.6 * s, 0.8 * s),
                s => Point::new(0.003, s - 0.001),
            };
            assert!((place - expected).norm() < 1e-12, "{s}: {place}");
        }
        assert_eq!(along(&curve, 0.0151), None);
    }
}
