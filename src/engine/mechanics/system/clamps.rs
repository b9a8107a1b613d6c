//! Clamps: prescribed positions and frames as functions of time.

use super::Event;
use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::transport::{
    any_normal, normal_part, parallel_transport, rotated, signed_angle, unwrapped,
};
use crate::mechanics::rod::{GhostEdge, ReferenceFrames, STRIDE};
use crate::mechanics::scene::{Clamp, Motion, piecewise_linear, piecewise_turning};
use crate::mechanics::{UnitQuaternion, Vector3, rotation};
use serde::{Deserialize, Serialize};

/// Largest turn of a clamp in one piece of the path along which its turns are counted, rad: below
/// half a turn, so that the frames determine it.
const PIECE: f64 = 0.5;

/// Ratio of the direct distance to the path through a corner above which a motion counts as
/// straight at the corner.
const STRAIGHT_ON: f64 = 0.99;

/// 1 − cos of the angle below which an axis and a tangent count as equal.
const SAME_AXIS: f64 = 1e-14;

/// A clamp with all references resolved.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Drive {
    /// Node of the whole scene.
    pub node: usize,
    /// Whether its position is prescribed.
    pub holds_position: bool,
    /// Position at time zero or when the clamp took hold, m.
    pub position: Vector3,
    /// Tangent and director at that time.
    pub frame: GhostEdge,
    /// Ghost edges that follow the frame.
    pub ghosts: Vec<usize>,
    /// Edges with both ends held; their material frames follow too.
    pub edges: Vec<HeldEdge>,
    /// Whether the clamp was released and holds no node.
    pub released: bool,
    motion: Motion,
    axis: Vector3,
    pivot: Vector3,
}

/// An edge with both nodes held, one of them with its frame.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct HeldEdge {
    /// Node of the whole scene at the start of the edge.
    pub start: usize,
    /// Node where it ends.
    pub end: usize,
    /// First material director at time zero.
    pub director: Vector3,
    /// Angle of its frame at the last time to which the clamp was driven, rad; includes whole
    /// turns.
    angle: f64,
    /// This angle when the reference frames were committed, rad.
    committed_angle: f64,
}

impl HeldEdge {
    /// The edge from node `start` to `end`, with its material director and the angle of its frame as placed.
    pub(crate) fn new([start, end]: [usize; 2], director: Vector3, angle: f64) -> Self {
        Self {
            start,
            end,
            director,
            angle,
            committed_angle: angle,
        }
    }

    /// Turns its first director to `director`, by `spin` (rad) since the frames of `reference` were
    /// committed, relative to parallel transport. The positions of its nodes must already be set.
    pub(super) fn turn(
        &mut self,
        director: &Vector3,
        spin: f64,
        reference: &ReferenceFrames,
        unknowns: &mut [f64],
    ) {
        let along = position(unknowns, self.end) - position(unknowns, self.start);
        let tangent = along.normalize();
        let source = &reference.tangent[self.start];
        let carried = parallel_transport(&reference.director[self.start], source, &tangent);
        let angle = signed_angle(&carried, director, &tangent);
        self.angle = unwrapped(angle, self.committed_angle + spin);
        unknowns[STRIDE * self.start + 3] = self.angle;
    }

    /// The reference frames were committed at the last angle.
    pub(super) fn commit(&mut self) {
        self.committed_angle = self.angle;
    }

    /// The reference frames are those that were committed with `unknowns`.
    pub(super) fn resume(&mut self, unknowns: &[f64]) {
        self.committed_angle = unknowns[STRIDE * self.start + 3];
    }
}

impl Drive {
    /// A clamp at a node that is at `position` with tangent and director `frame` at time zero.
    pub(crate) fn new(clamp: &Clamp, node: usize, position: Vector3, frame: GhostEdge) -> Self {
        Self {
            node,
            holds_position: clamp.holds_position,
            position,
            frame,
            ghosts: Vec::new(),
            edges: Vec::new(),
            released: false,
            axis: clamp.motion.axis.unwrap_or(frame.tangent),
            pivot: clamp.motion.pivot.unwrap_or(position),
            motion: clamp.motion.clone(),
        }
    }

    /// Moves the clamp to another position and frame than placed; `director_of` gives the
    /// directors of the edges.
    pub(crate) fn take_hold(
        &mut self,
        position: Vector3,
        frame: GhostEdge,
        director_of: impl Fn(usize) -> Vector3,
    ) {
        (self.position, self.frame) = (position, frame);
        self.follow(self.motion.clone());
        for edge in &mut self.edges {
            *edge = HeldEdge::new([edge.start, edge.end], director_of(edge.start), 0.0);
        }
    }

    /// Constant rate of rotation, rad/s.
    pub(crate) fn angular_velocity(&self) -> f64 {
        self.motion.angular_velocity
    }

    /// Replaces the prescribed motion.
    pub(crate) fn follow(&mut self, motion: Motion) {
        self.axis = motion.axis.unwrap_or(self.frame.tangent);
        self.pivot = motion.pivot.unwrap_or(self.position);
        self.motion = motion;
    }

    /// A motion that begins at `start` at the time `from` and reaches `position` and `frame` at
    /// the time `until`, s, where it stays. If `frame` is `None` it keeps its orientation.
    pub(crate) fn way_to(
        &self,
        position: Vector3,
        frame: Option<UnitQuaternion>,
        start: Vector3,
        [from, until]: [f64; 2],
    ) -> Motion {
        let turned = self.rotation(from);
        let target = frame.map_or(turned, |frame| frame * self.placed().inverse());
        let mut motion = Motion {
            translation: way(
                [from, until],
                [start, position].map(|at| at - self.position),
            ),
            ..Motion::default()
        };
        // A motion that keeps the initial orientation needs no schedule for it.
        let identity = UnitQuaternion::identity();
        if turned != identity || target != identity {
            motion.orientation = way([from, until], [turned, target]);
        }
        motion
    }

    /// The frame at time zero or when the clamp took hold: the rotation that maps the axes to both
    /// directors and the tangent.
    fn placed(&self) -> UnitQuaternion {
        let GhostEdge {
            tangent, director, ..
        } = self.frame;
        let axes = [director, tangent.cross(&director), tangent];
        UnitQuaternion::from_basis_unchecked(&axes)
    }

    /// The frame at a time, s, in the form of [`Self::placed`].
    pub(crate) fn frame_at(&self, time: f64) -> UnitQuaternion {
        self.rotation(time) * self.placed()
    }

    /// Adds the corners of the motion, for a rod of a given radius (m), to `events`.
    pub(crate) fn list_events(&self, radius: f64, events: &mut Vec<Event>) {
        let motion = &self.motion;
        // The speed of a rotating body grows with the distance from the pivot; the surface of the
        // rod is at least one radius away.
        let arm = (self.position - self.pivot).norm().max(radius);
        list_motion(motion, arm, events);
    }

    /// The rotation R(t) at a time.
    fn turning(&self, time: f64) -> Turning {
        Turning {
            axis: self.axis,
            angle: piecewise_linear(&self.motion.angle, time).unwrap_or(0.0)
                + self.motion.angular_velocity * time,
            orientation: piecewise_turning(&self.motion.orientation, time),
        }
    }

    /// Rotation of the frame at a time (s) since the start of the clamp.
    pub(crate) fn rotation(&self, time: f64) -> UnitQuaternion {
        let turning = self.turning(time);
        let about_axis = rotation::from_vector(turning.axis * turning.angle);
        let oriented = turning.orientation;
        oriented.map_or(about_axis, |orientation| orientation * about_axis)
    }

    /// Sets the prescribed position and frames at `time`; the reference frames are those of the
    /// time `committed`, s.
    pub(crate) fn apply(
        &self,
        time: f64,
        committed: f64,
        unknowns: &mut [f64],
        ghosts: &mut [GhostEdge],
    ) {
        if self.released {
            return;
        }
        let turning = self.turning(time);
        if self.holds_position {
            let arm = self.position - self.pivot;
            let translation =
                piecewise_linear(&self.motion.translation, time).unwrap_or_else(Vector3::zeros);
            let position = self.pivot + turning.of(&arm) + translation;
            unknowns[STRIDE * self.node..STRIDE * self.node + 3]
                .copy_from_slice(position.as_slice());
        }
        let spin = self.spin(committed, time);
        for &ghost in &self.ghosts {
            let tangent = turning.of(&self.frame.tangent).normalize();
            let director = turning.of(&self.frame.director);
            let director = normal_part(&director, &tangent).unwrap_or_else(|| any_normal(&tangent));
            ghosts[ghost] = GhostEdge {
                tangent,
                director,
                spin,
            };
        }
    }

    /// Sets the angles of held edges at `time`, including all turns since the frames of
    /// `reference` were committed at the time `committed`. The positions of all nodes must already
    /// be set.
    pub(crate) fn turn_edges(
        &mut self,
        time: f64,
        committed: f64,
        reference: &ReferenceFrames,
        unknowns: &mut [f64],
    ) {
        if self.edges.is_empty() {
            return;
        }
        let (turning, spin) = (self.turning(time), self.spin(committed, time));
        for edge in &mut self.edges {
            let director = turning.of(&edge.director);
            edge.turn(&director, spin, reference, unknowns);
        }
    }

    /// The reference frames were committed at the time to which the clamp was last driven.
    pub(crate) fn commit(&mut self) {
        self.edges.iter_mut().for_each(HeldEdge::commit);
    }

    /// The reference frames are those of a configuration that was committed before.
    pub(crate) fn resume(&mut self, unknowns: &[f64]) {
        for edge in &mut self.edges {
            edge.resume(unknowns);
        }
    }

    /// Rotation of the clamped frame about its tangent relative to parallel transport between two
    /// times, rad. The rotation is summed along the schedule, so that whole turns count however
    /// long the step is.
    fn spin(&self, from: f64, to: f64) -> f64 {
        let motion = &self.motion;
        if motion.orientation.is_empty() {
            if motion.angle.is_empty() && motion.angular_velocity == 0.0 {
                return 0.0;
            }
            let along = self.axis.dot(&self.frame.tangent);
            if 1.0 - along.abs() < SAME_AXIS {
                return along * (self.turning(to).angle - self.turning(from).angle);
            }
        }
        let (first, last) = (from.min(to), from.max(to));
        let corners = motion.angle.iter().map(|corner| corner.0);
        let mut times: Vec<f64> = (corners.chain(motion.orientation.iter().map(|corner| corner.0)))
            .filter(|&time| first < time && time < last)
            .chain([first, last])
            .collect();
        times.sort_by(f64::total_cmp);
        let spins = times
            .windows(2)
            .map(|ends| self.spin_of_piece(ends[0], ends[1]));
        let spin: f64 = spins.sum();
        if to < from { -spin } else { spin }
    }

    /// Rotation as in `spin` between two times without a corner of the schedule between them.
    fn spin_of_piece(&self, from: f64, to: f64) -> f64 {
        let (start, end) = (self.turning(from), self.turning(to));
        let swing = match (start.orientation, end.orientation) {
            (Some(start), Some(end)) => rotation::angle(&start.rotation_to(&end)),
            _ => 0.0,
        };
        let turned = (end.angle - start.angle).abs() + swing;
        let parts = (turned / PIECE).ceil().max(1.0);
        let frame = |part: f64| {
            let turning = self.turning(from + part / parts * (to - from));
            (
                turning.of(&self.frame.tangent),
                turning.of(&self.frame.director),
            )
        };
        let mut spin = 0.0;
        let mut before = frame(0.0);
        for part in 1..=parts as usize {
            let after = frame(part as f64);
            let carried = parallel_transport(&before.1, &before.0, &after.0);
            spin += signed_angle(&carried, &after.1, &after.0);
            before = after;
        }
        spin
    }
}

/// A path between two times, s, or only its end if the times are equal.
fn way<T>([from, until]: [f64; 2], [start, end]: [T; 2]) -> Vec<(f64, T)> {
    if until == from {
        vec![(until, end)]
    } else {
        vec![(from, start), (until, end)]
    }
}

/// Adds the corners of the motion of a body with the radius `arm` (m) around the pivot.
pub(super) fn list_motion(motion: &Motion, arm: f64, events: &mut Vec<Event>) {
    list_corners(&motion.translation, |from, to| (to - from).norm(), events);
    list_corners(&motion.angle, |from, to| (to - from).abs() * arm, events);
    list_corners(
        &motion.orientation,
        |from, to| rotation::angle(&from.rotation_to(to)) * arm,
        events,
    );
}

/// Adds the corners of a piecewise linear motion; `way` returns the path length between two
/// corners, m. A corner counts with the sum of the speeds on its two sides, which bounds the jump
/// of the velocity. If the direction does not change at the corner, it counts with their
/// difference.
pub(super) fn list_corners<T>(
    corners: &[(f64, T)],
    way: impl Fn(&T, &T) -> f64,
    events: &mut Vec<Event>,
) {
    for (k, (time, value)) in corners.iter().enumerate() {
        let speed = |(from, start): &(f64, T), (to, end): &(f64, T)| {
            let moved = way(start, end);
            if moved == 0.0 {
                0.0
            } else {
                moved / (to - from)
            }
        };
        let before = k.checked_sub(1).map(|k| &corners[k]);
        let after = corners.get(k + 1);
        let speeds = [
            before.map_or(0.0, |before| speed(before, &corners[k])),
            after.map_or(0.0, |after| speed(&corners[k], after)),
        ];
        let turns_back = match (before, after) {
            (Some(before), Some(after)) => {
                let through = way(&before.1, value) + way(value, &after.1);
                way(&before.1, &after.1) < STRAIGHT_ON * through
            }
            _ => true,
        };
        let velocity_jump = if turns_back {
            speeds[0] + speeds[1]
        } else {
            (speeds[0] - speeds[1]).abs()
        };
        events.push(Event {
            time: *time,
            velocity_jump,
        });
    }
}

/// A rotation: first about an axis, then to an orientation.
pub(super) struct Turning {
    pub axis: Vector3,
    pub angle: f64,
    pub orientation: Option<UnitQuaternion>,
}

impl Turning {
    fn of(&self, vector: &Vector3) -> Vector3 {
        let turned = rotated(vector, &self.axis, self.angle);
        match self.orientation {
            Some(orientation) => orientation * turned,
            None => turned,
        }
    }
}
