//! Clamps and their paths.

use super::super::refusals::end_tangent;
use super::tuple;
use rodlab_engine::mechanics::rigid_body::RigidBody;
use rodlab_engine::mechanics::rotation::Pose;
use rodlab_engine::mechanics::scene::{Clamp, Motion, Obstacle, RodDescription};
use rodlab_engine::mechanics::system::obstacle_poses;
use rodlab_engine::mechanics::{UnitQuaternion, Vector3};
use std::fmt::Write;

/// Rotation between two corners of the path of a clamp, rad, at most.
const ROTATION: f64 = 0.1;
/// Number of corners of a path of a clamp that turns, at most.
const CORNERS: f64 = 5000.0;

/// A held node.
pub(super) struct HeldNode {
    node: usize,
    /// Unit tangent at time zero, if the clamp holds it.
    tangent: Option<Vector3>,
    /// Time, s, place and rotation since time zero at the corners of its path.
    path: Vec<(f64, Vector3, UnitQuaternion)>,
}

impl HeldNode {
    /// A held node until the time `end`, s. `rests`: the clamp stays where it is at time zero.
    pub fn of(rod: &RodDescription, clamp: &Clamp, end: f64, rests: bool) -> Self {
        let place = rod.centreline[clamp.node];
        let which = usize::from(clamp.node > 0);
        let tangent = (!rod.closed).then(|| end_tangent(rod, which));
        let motion = &clamp.motion;
        let times = if !motion.moves() {
            Vec::new()
        } else if rests {
            vec![0.0, end]
        } else {
            corners(motion, end)
        };
        // The pose of a body that consists of the node.
        let motion = Motion {
            axis: motion.axis.or(tangent),
            ..motion.clone()
        };
        let body = Obstacle {
            body: RigidBody {
                vertices: vec![place],
                ..RigidBody::default()
            },
            motion,
            ..Obstacle::default()
        };
        let bodies = [body];
        let pose = |time: f64| -> Pose { obstacle_poses(&bodies, time)[0] };
        Self {
            node: clamp.node,
            tangent: tangent.filter(|_| clamp.holds_frame),
            path: (times.into_iter())
                .map(|time| {
                    let pose = pose(if rests { 0.0 } else { time });
                    let place = pose.rotation * place + pose.translation;
                    (time, place, pose.rotation)
                })
                .collect(),
        }
    }

    /// Writes the node as one of the rod with a number.
    pub fn write(&self, text: &mut String, rod: usize) {
        let tangent = self.tangent.map_or_else(|| "None".to_owned(), tuple);
        _ = write!(
            text,
            "    {{\"rod\": {rod}, \"node\": {}, \"tangent\": {tangent}, \"path\": [",
            self.node
        );
        for (time, place, rotation) in &self.path {
            let [x, y, z, w] = [rotation.i, rotation.j, rotation.k, rotation.w].map(|q| q + 0.0);
            let place = tuple(*place);
            let place = place.trim_start_matches('(').trim_end_matches(')');
            _ = write!(
                text,
                "\n        ({time:?}, {place}, {x:?}, {y:?}, {z:?}, {w:?}),"
            );
        }
        *text += if self.path.is_empty() {
            "]},\n"
        } else {
            "\n    ]},\n"
        };
    }
}

/// Times of the corners of a path, s: those of the motion, and others if it turns.
fn corners(motion: &Motion, end: f64) -> Vec<f64> {
    let mut times = vec![0.0, end];
    times.extend(motion.translation.iter().map(|(time, _)| *time));
    times.extend(motion.angle.iter().map(|(time, _)| *time));
    times.extend(motion.orientation.iter().map(|(time, _)| *time));
    let largest = (motion.angle.windows(2))
        .map(|ends| (ends[1].1 - ends[0].1).abs())
        .sum::<f64>();
    let angles = largest
        + motion.angular_velocity.abs() * end
        + std::f64::consts::TAU * motion.orientation.len() as f64;
    let parts = (angles / ROTATION).ceil().min(CORNERS);
    times.extend((1..parts as usize).map(|part| end * part as f64 / parts));
    times.retain(|time| (0.0..=end).contains(time));
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}
