//! Strains along a virtual motion: their first variations.
//!
//! If the edges e⁰ and e¹ of a vertex move by δeʲ and their frames spin by φʲ = δθʲ + cʲ·δeʲ about
//! the tangents (see [`super::vertex`]),
//!
//! ```text
//! δt = (1 − t⊗t) δe/l,   δm₁ = φ m₂ − (m₁·δt) t,   δm₂ = −φ m₁ − (m₂·δt) t
//! δκb = [2 (δt⁰×t¹ + t⁰×δt¹) − (δt⁰·t¹ + t⁰·δt¹) κb]/χ
//! δκ¹ʲ = δm₂ʲ·κb + m₂ʲ·δκb,   δκ²ʲ = −δm₁ʲ·κb − m₁ʲ·δκb
//! δτ = φ¹ − φ⁰ + ½ κb·(δe⁰/l⁰ + δe¹/l¹)
//! ```
//!
//! (t·κb = 0, so that the rotation of the tangents drops out of δm·κb), and for the angle λκ,
//! δ(λκ) = λ δκ + κ λ' δ|κb|².

use super::discretization::Vertex;
use super::turning_angle::AngleRatio;
use super::vertex::{EdgeFrame, VertexStrains};
use crate::mechanics::Vector3;

/// Virtual motion of an edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeMotion {
    /// δe/l.
    stretch: Vector3,
    /// δt.
    tangent: Vector3,
    /// φ, rad.
    spin: f64,
}

impl EdgeMotion {
    /// No motion: an edge held by a wall.
    pub(crate) const NONE: Self = Self {
        stretch: Vector3::new(0.0, 0.0, 0.0),
        tangent: Vector3::new(0.0, 0.0, 0.0),
        spin: 0.0,
    };

    /// Rotation of a unit vector with its frame, which turns by `turn`.
    pub(crate) fn turned(frame: &EdgeFrame, turn: &Vector3) -> Self {
        let tangent = turn.cross(&frame.tangent);
        Self {
            stretch: tangent,
            tangent,
            spin: turn.dot(&frame.tangent),
        }
    }

    /// Motion of an edge whose ends move apart by `change` while its angle changes by `angle`.
    pub(crate) fn new(frame: &EdgeFrame, change: &Vector3, angle: f64) -> Self {
        let stretch = change * frame.inverse_length;
        Self {
            stretch,
            tangent: stretch - frame.tangent * frame.tangent.dot(&stretch),
            spin: angle + frame.holonomy.dot(change),
        }
    }
}

impl Vertex {
    /// Changes of the strains κ¹⁰, κ²⁰, κ¹¹, κ²¹, in the measure of the vertex, and τ.
    pub(crate) fn strains_along(
        &self,
        [before, after]: [&EdgeFrame; 2],
        strains: &VertexStrains,
        [motion_before, motion_after]: [&EdgeMotion; 2],
    ) -> [f64; 5] {
        let (t0, t1) = (&before.tangent, &after.tangent);
        let (d0, d1) = (&motion_before.tangent, &motion_after.tangent);
        let inverse_chi = 1.0 / (1.0 + t0.dot(t1));
        let binormal = t0.cross(t1) * (2.0 * inverse_chi);
        let turned = (d0.cross(t1) + t0.cross(d1)) * 2.0 - binormal * (d0.dot(t1) + t0.dot(d1));
        let turned = turned * inverse_chi;
        let of_edge = |frame: &EdgeFrame, spin: f64| {
            let [first, second] = [&frame.director_1, &frame.director_2];
            [
                second.dot(&turned) - spin * first.dot(&binormal),
                -first.dot(&turned) - spin * second.dot(&binormal),
            ]
        };
        let [k0, k1] = of_edge(before, motion_before.spin);
        let [k2, k3] = of_edge(after, motion_after.spin);
        let ratio = AngleRatio::of(0.5 / inverse_chi, self.strain.share());
        let twist = motion_after.spin - motion_before.spin
            + 0.5 * binormal.dot(&(motion_before.stretch + motion_after.stretch));
        let [c0, c1, c2, c3] = ratio.turning_along(&strains.curvature, &[k0, k1, k2, k3]);
        [c0, c1, c2, c3, twist]
    }
}
