//! State of the cell after an early end: the step, the laid part of the rod, the places of the hands, and the advice to the user.

use crate::cell::Cell;
use rodlab_planning::plan::deployment::GripperPose;
use rodlab_robot::Pose;
use serde::Serialize;

/// State of the cell and the rods after an early end.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stopped {
    /// Step that was in progress.
    pub during: String,
    /// Laid part of each rod along its path.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub laid: Vec<LaidLength>,
    /// Places of the hands.
    pub hands: Vec<HandPlace>,
    /// Advice to the user.
    pub next: String,
}

/// Laid part of a rod along its path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LaidLength {
    /// Length of the rod laid so far, m; `None` where the arm does not report its joints.
    pub laid_m: Option<f64>,
    /// Length of the whole path, m.
    pub path_m: f64,
}

/// Place of a hand.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HandPlace {
    /// Name of the arm.
    pub arm: String,
    /// Position in the frame of the cell, m; `None` where the arm does not report its joints.
    pub position_m: Option<[f64; 3]>,
    #[serde(skip)]
    pose: Option<Pose>,
}

impl HandPlace {
    /// The hand of an arm at the joint positions that its driver reports now.
    pub fn of(cell: &Cell, arm: usize) -> Self {
        let known = &cell.arms[arm];
        let joints = cell.stands(arm);
        let pose = joints.map(|joints| known.hand(&joints));
        let pose = pose
            .inspect_err(|reason| tracing::warn!("{}: {reason}", known.name))
            .ok();
        Self {
            arm: known.name.clone(),
            position_m: pose.map(|pose| pose.translation.vector.into()),
            pose,
        }
    }
}

/// The path along which a rod is laid.
pub struct LaidAlong<'a> {
    /// Poses of the gripper along the path.
    pub poses: &'a [GripperPose],
    /// The frame of the path in the cell.
    pub frame: Pose,
    /// Gravito-bending length of the rod, m.
    pub unit: f64,
}

impl LaidAlong<'_> {
    /// The length of the path, m.
    fn length(&self) -> f64 {
        self.poses.last().map_or(0.0, |pose| pose.s)
    }

    /// Returns the state in which either the whole rod or nothing is laid.
    pub fn whole(&self, lies: bool) -> LaidLength {
        let path_m = self.length();
        LaidLength {
            laid_m: Some(if lies { path_m } else { 0.0 }),
            path_m,
        }
    }

    /// Length laid up to a hand.
    pub fn until(&self, hand: &HandPlace) -> LaidLength {
        LaidLength {
            laid_m: hand.pose.and_then(|pose| self.nearest(&pose)),
            path_m: self.length(),
        }
    }

    /// Length laid up to the pose of a hand in the cell.
    pub fn at(&self, hand: &Pose) -> LaidLength {
        LaidLength {
            laid_m: self.nearest(hand),
            path_m: self.length(),
        }
    }

    /// Arc length of the pose that is nearest to that of a hand, m. Since a path may cross itself,
    /// rotations count too, weighted by the gravito-bending length.
    fn nearest(&self, hand: &Pose) -> Option<f64> {
        let here = self.frame.inverse() * hand;
        let away = |pose: &GripperPose| {
            let shift = (pose.position - here.translation.vector).norm();
            shift + self.unit * pose.rotation.angle_to(&here.rotation)
        };
        let nearest = self.poses.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        nearest.map(|pose| pose.s)
    }
}

impl Stopped {
    /// Rows of a report.
    pub fn rows(&self) -> Vec<(&'static str, String)> {
        let mut rows = vec![("stopped while", self.during.clone())];
        for rod in &self.laid {
            let path = format!("{:.1} mm of its path", 1e3 * rod.path_m);
            rows.push((
                "rod laid",
                match rod.laid_m {
                    Some(laid) => format!("{:.1} of {path}", 1e3 * laid),
                    None => format!("unknown part of {path}"),
                },
            ));
        }
        for hand in &self.hands {
            let place = match hand.position_m {
                Some([x, y, z]) => format!("at {x:.4}, {y:.4}, {z:.4} m in the cell"),
                None => "not reported".into(),
            };
            rows.push(("hand", format!("{}: {place}", hand.arm)));
        }
        rows.push(("next", self.next.clone()));
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};

    /// Poses along a closed square of 10 cm; the hand turns at its corners.
    fn square() -> Vec<GripperPose> {
        let turn = |side: u32| f64::from(side) * std::f64::consts::FRAC_PI_2;
        let mut position = Vector3::zeros();
        let mut poses = Vec::new();
        for k in 0..=40 {
            let side = (k / 10).min(3);
            let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn(side));
            poses.push(GripperPose {
                s: 0.01 * f64::from(k),
                position,
                rotation,
                grasp: None,
                contact_demand: None,
            });
            position += rotation * Vector3::new(0.01, 0.0, 0.0);
        }
        poses
    }

    fn hand(pose: Option<Pose>, position_m: Option<[f64; 3]>) -> HandPlace {
        HandPlace {
            arm: "gantry".into(),
            position_m,
            pose,
        }
    }

    #[test]
    fn the_laid_length_is_that_of_the_pose_at_which_the_hand_is() {
        let poses = square();
        let frame = Pose::translation(0.3, 0.2, 0.1);
        let along = LaidAlong {
            poses: &poses,
            frame,
            unit: 0.03,
        };
        // The first and the last pose have the same position but different orientations.
        for index in [0, 7, 25, 40] {
            let GripperPose {
                s,
                position,
                rotation,
                ..
            } = &poses[index];
            let pose = frame * Pose::from_parts((*position).into(), *rotation);
            assert_eq!(along.until(&hand(Some(pose), None)).laid_m, Some(*s));
        }
        assert_eq!(along.until(&hand(None, None)).laid_m, None);
        assert_eq!(along.whole(true).laid_m, Some(0.4));
    }

    #[test]
    fn a_report_gives_the_laid_length_and_the_place_of_the_hand() {
        let hand = hand(None, Some([0.1, 0.2, 0.03]));
        let laid = LaidLength {
            laid_m: Some(0.12),
            path_m: 0.3,
        };
        let stopped = Stopped {
            during: "laying it".into(),
            laid: vec![laid],
            hands: vec![hand],
            next: "begin with --checked".into(),
        };
        let text = format!("{:?}", stopped.rows());
        let place = "0.1000, 0.2000, 0.0300 m";
        for words in ["laying", "120.0 of 300.0 mm", place, "--checked"] {
            assert!(text.contains(words), "{words}: {text}");
        }
    }
}
