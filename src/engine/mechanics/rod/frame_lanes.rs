//! The frames of [`LANES`] edges at a time.

use super::topology::STRIDE;
use super::transport::parallel_transport;
use super::trigonometry::{is_within_reach, sine_cosine, within_reach};
use super::vertex::EdgeFrame;
use crate::linalg::instruction_set::{InstructionSet, LANES, Lanes, kernel};
use crate::mechanics::Vector3;

/// Vectors, structure of arrays.
pub(super) type VectorLanes = [Lanes; 3];

/// The vector in a lane.
#[inline(always)]
pub(super) fn vector(lanes: &VectorLanes, lane: usize) -> Vector3 {
    // Written out: with `map` over the arrays, the loop over lanes does not vectorise.
    Vector3::new(lanes[0][lane], lanes[1][lane], lanes[2][lane])
}

/// Puts a vector into a lane.
#[inline(always)]
pub(super) fn set_vector(lanes: &mut VectorLanes, lane: usize, vector: &Vector3) {
    for axis in 0..3 {
        lanes[axis][lane] = vector[axis];
    }
}

/// The same vector in every lane.
pub(super) fn every_lane(vector: Vector3) -> VectorLanes {
    [[vector.x; LANES], [vector.y; LANES], [vector.z; LANES]]
}

/// Copies every vector of `from` to the next lane of `to`.
pub(super) fn shift(to: &mut VectorLanes, from: &VectorLanes) {
    for (to, from) in to.iter_mut().zip(from) {
        to[1..].copy_from_slice(&from[..LANES - 1]);
    }
}

/// Framed edges, structure of arrays; meaning and units as in [`EdgeFrame`].
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct FrameLanes {
    tangent: VectorLanes,
    length: Lanes,
    inverse_length: Lanes,
    director_1: VectorLanes,
    director_2: VectorLanes,
    holonomy: VectorLanes,
}

impl FrameLanes {
    /// Edges along x, so that unused lanes hold valid numbers.
    pub(crate) fn new() -> Self {
        Self {
            tangent: every_lane(Vector3::x()),
            length: [1.0; LANES],
            inverse_length: [1.0; LANES],
            director_1: every_lane(Vector3::y()),
            director_2: every_lane(Vector3::z()),
            holonomy: every_lane(Vector3::zeros()),
        }
    }

    /// Puts an edge into a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, edge: &EdgeFrame) {
        set_vector(&mut self.tangent, lane, &edge.tangent);
        self.length[lane] = edge.length;
        self.inverse_length[lane] = edge.inverse_length;
        set_vector(&mut self.director_1, lane, &edge.director_1);
        set_vector(&mut self.director_2, lane, &edge.director_2);
        set_vector(&mut self.holonomy, lane, &edge.holonomy);
    }

    /// Copies every edge of `other` to the next lane.
    pub(crate) fn shift_from(&mut self, other: &Self) {
        shift(&mut self.tangent, &other.tangent);
        self.length[1..].copy_from_slice(&other.length[..LANES - 1]);
        self.inverse_length[1..].copy_from_slice(&other.inverse_length[..LANES - 1]);
        shift(&mut self.director_1, &other.director_1);
        shift(&mut self.director_2, &other.director_2);
        shift(&mut self.holonomy, &other.holonomy);
    }

    /// Unit tangent of the edge in a lane.
    #[inline(always)]
    pub(crate) fn tangent(&self, lane: usize) -> Vector3 {
        vector(&self.tangent, lane)
    }

    /// The edge in a lane.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> EdgeFrame {
        EdgeFrame {
            tangent: vector(&self.tangent, lane),
            length: self.length[lane],
            inverse_length: self.inverse_length[lane],
            director_1: vector(&self.director_1, lane),
            director_2: vector(&self.director_2, lane),
            holonomy: vector(&self.holonomy, lane),
        }
    }
}

/// Components of frames, structure of arrays.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct TransportLanes {
    /// Edge vectors, m.
    edge: VectorLanes,
    /// Tangents (`source`) and reference directors from which to transport.
    source: VectorLanes,
    director: VectorLanes,
    /// Angle from the reference to the material director, rad.
    angle: Lanes,
}

impl TransportLanes {
    /// Edges along x, so that unused lanes hold valid numbers.
    pub(crate) fn new() -> Self {
        Self {
            edge: every_lane(Vector3::x()),
            source: every_lane(Vector3::x()),
            director: every_lane(Vector3::y()),
            angle: [0.0; LANES],
        }
    }

    /// Puts an edge into a lane: its vector, the tangent and reference director from which it is
    /// transported, and its angle, rad.
    pub(crate) fn set(
        &mut self,
        lane: usize,
        edge: &Vector3,
        source: &Vector3,
        director: &Vector3,
        angle: f64,
    ) {
        set_vector(&mut self.edge, lane, edge);
        self.set_source(lane, source, director);
        self.angle[lane] = within_reach(angle);
    }

    /// Sets the tangent and the reference director from which the edge in a lane is transported.
    #[inline(always)]
    pub(crate) fn set_source(&mut self, lane: usize, source: &Vector3, director: &Vector3) {
        set_vector(&mut self.source, lane, source);
        set_vector(&mut self.director, lane, director);
    }

    /// The tangent from which the edge in a lane is transported.
    #[inline(always)]
    pub(crate) fn source(&self, lane: usize) -> Vector3 {
        vector(&self.source, lane)
    }
}

/// Transports the frames of edges between nodes with the unknowns `start` and `end`, one edge per
/// lane: see [`transport`].
pub(super) fn transport_between(
    set: InstructionSet,
    [start, end]: [&[Lanes; STRIDE]; 2],
    from: &mut TransportLanes,
    frames: &mut FrameLanes,
    directors: &mut VectorLanes,
) {
    let [.., angles] = start;
    from.angle = match angles.iter().all(|angle| is_within_reach(*angle)) {
        true => *angles,
        false => angles.map(within_reach),
    };
    transport_spans(set, start, end, from, frames, directors);
}

kernel! {
    fn transport_spans(
        start: &[Lanes; STRIDE],
        end: &[Lanes; STRIDE],
        from: &mut TransportLanes,
        frames: &mut FrameLanes,
        directors: &mut VectorLanes,
    ) {
        for axis in 0..3 {
            for lane in 0..LANES {
                from.edge[axis][lane] = end[axis][lane] - start[axis][lane];
            }
        }
        transport_lanes(from, frames, directors);
    }
}

kernel! {
    /// Transports the reference directors of every lane to the present tangents, and rotates the
    /// material frames relative to them.
    fn transport(from: &TransportLanes, frames: &mut FrameLanes, directors: &mut VectorLanes) {
        transport_lanes(from, frames, directors);
    }
}

#[inline(always)]
fn transport_lanes(from: &TransportLanes, frames: &mut FrameLanes, directors: &mut VectorLanes) {
    for lane in 0..LANES {
        let edge = vector(&from.edge, lane);
        let source = from.source(lane);
        let (sine, cosine) = sine_cosine(from.angle[lane]);
        let length = edge.norm();
        let inverse_length = 1.0 / length;
        let tangent = edge * inverse_length;
        let director = parallel_transport(&vector(&from.director, lane), &source, &tangent);
        let normal = tangent.cross(&director);
        set_vector(directors, lane, &director);
        frames.set(
            lane,
            &EdgeFrame {
                tangent,
                length,
                inverse_length,
                director_1: director * cosine + normal * sine,
                director_2: normal * cosine - director * sine,
                holonomy: source.cross(&tangent) * (-inverse_length / (1.0 + source.dot(&tangent))),
            },
        );
    }
}
