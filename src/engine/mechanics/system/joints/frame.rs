//! A frame that turns with a joint or body: rods are clamped to it.
//!
//! The rotation of the frame is R = exp([φ]×) B with a rotation vector φ and a rotation B that is
//! constant over many steps. The unknowns are the components of ℓφ, with a length ℓ that makes them
//! as large as the moves of nodes. Moments T, in the fixed frame, are Jᵀ(φ) T/ℓ over the unknowns
//! ([`crate::mechanics::rotation`]). The frame of a hinge turns by an additional angle α, R' = R
//! exp(α [a]×).
//!
//! A body with the moments of inertia I₁, I₂, I₃ moves like three masses mₖ = ½ (I₁ + I₂ + I₃ − 2
//! Iₖ)/ℓ² at the tips of its principal axes, pₖ = ℓ R eₖ relative to its centre: its rotational
//! energy is ½ Σ mₖ ṗₖ². The tips are stored among the unknowns, so that time schemes keep their
//! history, but they are not unknowns themselves: they follow from φ.

use crate::mechanics::rod::topology::position;
use crate::mechanics::rod::{GhostEdge, STRIDE};
use crate::mechanics::scene::HingeSpring;
use crate::mechanics::{Matrix3, UnitQuaternion, Vector3, rotation};

/// Turn of a frame above which its rotation vector is reset, rad: far from a full turn, where J is
/// singular.
const LARGEST_TURN: f64 = 1.0;

/// Places of four unknowns of a frame with a body: the rotation, and the tips of the principal axes.
pub(crate) const BODY_PLACES: usize = 4;

/// The mass of a body with a centre away from its node: see [`super::super::eccentric`].
#[derive(Clone, Debug)]
pub struct EccentricMass {
    /// Index of the node among those of all rods.
    pub node: usize,
    /// Index, among the unknowns, of the first tip of its principal axes.
    pub first_tip: usize,
    /// kg.
    pub mass: f64,
    /// Vector from the node to the centre, along the principal axes, divided by their length ℓ.
    pub parts: [f64; 3],
}

/// The vertices of a free body, which turn with its frame about its centre of mass. On an axle, a
/// hinge ties the frame to one that never turns, and the inertia of the body is that of its angle.
#[derive(Clone, Debug)]
pub struct Vertices {
    /// Node of the centre of mass; those of the vertices follow it.
    pub centre: usize,
    /// Distance of the surface from the vertices, m.
    pub radius: f64,
    /// Vectors from the centre to the vertices as placed, m.
    pub arms: Vec<Vector3>,
}

impl Vertices {
    /// The nodes of the vertices.
    pub(crate) fn nodes(&self) -> std::ops::Range<usize> {
        self.centre + 1..self.centre + 1 + self.arms.len()
    }
}

/// A frame and the rods clamped to it.
#[derive(Clone, Debug)]
pub struct TurningFrame {
    /// Index of the first of its unknowns: ℓφ, followed by the angle of a hinge (rad). For the
    /// frame of a hinge only the angle is free.
    pub first_unknown: usize,
    /// ℓ, m.
    pub length: f64,
    /// B.
    pub base: UnitQuaternion,
    /// Rotation when the reference frames were committed.
    pub committed: UnitQuaternion,
    /// Angle of the hinge at the last evaluation, and when the reference frames were committed, rad.
    pub angles: [f64; 2],
    /// Length of φ at the last evaluation, rad.
    pub turned: f64,
    /// Index of the frame to which a hinge ties this frame, and the axis a of the hinge as placed.
    pub hinge: Option<(usize, Vector3)>,
    /// The spring about that hinge.
    pub spring: Option<HingeSpring>,
    /// Index of the first unknown of the tips of the principal axes, which are `axes` as placed.
    pub body: Option<(usize, [Vector3; 3])>,
    /// The node that carries the body, and the radius of the body, m, if it is a ball.
    pub ball: Option<(usize, f64)>,
    /// The mass of the body, if its centre is away from the node.
    pub eccentric: Option<EccentricMass>,
    /// The vertices of the body, if no rod carries it.
    pub vertices: Option<Vertices>,
    /// Ghost edges that turn with the frame, as placed.
    pub ghosts: Vec<(usize, GhostEdge)>,
    /// Elements of the half vertices of these ghost edges.
    pub elements: Vec<usize>,
    /// The element of the unknowns of the frame.
    pub element: usize,
    /// A node of the scene at which a rod is clamped to the frame; the forces of this rod set the
    /// tolerance of the frame.
    pub node: usize,
    /// The clamp that holds the frame: its rotation is then prescribed, and equal to B.
    pub clamp: Option<usize>,
}

impl TurningFrame {
    /// Creates a frame as placed, without rods clamped to it.
    pub(crate) fn new(first_unknown: usize, hinge: Option<(usize, Vector3)>) -> Self {
        Self {
            first_unknown,
            length: f64::INFINITY,
            base: UnitQuaternion::identity(),
            committed: UnitQuaternion::identity(),
            angles: [0.0; 2],
            turned: 0.0,
            hinge,
            spring: None,
            body: None,
            ball: None,
            eccentric: None,
            vertices: None,
            ghosts: Vec::new(),
            elements: Vec::new(),
            element: 0,
            node: 0,
            clamp: None,
        }
    }

    /// Whether it never turns, and carries axles.
    pub(crate) fn is_ground(&self) -> bool {
        let turns_with = !self.ghosts.is_empty() || self.vertices.is_some();
        self.hinge.is_none() && !turns_with
    }

    /// φ.
    pub(crate) fn rotation_vector(&self, unknowns: &[f64]) -> Vector3 {
        self.vector_of(unknowns) / self.length
    }

    /// Angle of the hinge, rad.
    pub(crate) fn hinge_angle(&self, unknowns: &[f64]) -> f64 {
        unknowns[self.first_unknown + 3]
    }

    /// Rotation about the hinge since the reference frames were committed, rad.
    pub(crate) fn hinge_turn(&self) -> f64 {
        self.angles[0] - self.angles[1]
    }

    /// Tips of the principal axes of a body, relative to its centre, m.
    pub(crate) fn tips(&self, rotation: &UnitQuaternion) -> Option<(usize, [Vector3; 3])> {
        let (first, axes) = self.body?;
        Some((first, axes.map(|axis| rotation * axis * self.length)))
    }

    /// Whether the rotation vector is free and has become long.
    pub(crate) fn is_long(&self, unknowns: &[f64]) -> bool {
        self.hinge.is_none() && self.rotation_vector(unknowns).norm() >= LARGEST_TURN
    }

    /// Resets the rotation vector, with the present rotation as base. The change of chart is exact
    /// for the first motion, which has the present unknowns and velocities, and for earlier
    /// motions.
    pub(crate) fn begin_anew(&mut self, motions: &mut [[&mut [f64]; 2]]) {
        let Some([unknowns, _]) = motions.first() else {
            return;
        };
        let now = self.rotation_vector(unknowns);
        let back = rotation::from_vector(now).inverse();
        for [unknowns, velocity] in motions {
            let [place, rate] = [&*unknowns, &*velocity].map(|of| self.vector_of(of));
            let [place, rate] = self.in_chart([place, rate], &back);
            for axis in 0..3 {
                unknowns[self.first_unknown + axis] = place[axis];
                velocity[self.first_unknown + axis] = rate[axis];
            }
        }
        self.base = back.inverse() * self.base;
    }

    /// ℓφ in the unknowns, or its rate in their velocities.
    pub(crate) fn vector_of(&self, unknowns: &[f64]) -> Vector3 {
        position(unknowns, self.first_unknown / STRIDE)
    }

    /// ℓφ and its rate in the chart whose base is that of this frame, turned by the inverse of
    /// `back`.
    pub(crate) fn in_chart(
        &self,
        [place, rate]: [Vector3; 2],
        back: &UnitQuaternion,
    ) -> [Vector3; 2] {
        let old = place / self.length;
        let spin = rotation::left_jacobian(&old) * rate;
        let new = rotation::to_vector(&(rotation::from_vector(old) * back));
        let inverse = rotation::left_jacobian(&new).try_inverse();
        let rate = inverse.unwrap_or_else(Matrix3::identity) * spin;
        [new * self.length, rate]
    }
}
