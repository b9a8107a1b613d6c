//! Rotation of free bodies in steps of implicit Euler.
//!
//! The masses mₖ at the tips pₖ of the axes of a body ([`super::joints`], `frame`) have the chord
//! velocities vₖ = (pₖ − pₖⁿ)/h. Their inertia mₖ (vₖ − vₖⁿ)/h has the moment of pₖ × vₖⁿ, in which
//! the earlier momentum has turned with the body: a rotation ω would be damped at the rate ω² h. With
//!
//! ```text
//! Σ mₖ (pₖ − pₖⁿ) × vₖⁿ/h
//! ```
//!
//! in addition, the balance is (L − Lⁿ)/h = T for L = Σ mₖ pₖ × vₖ = −Σ mₖ pₖ × pₖⁿ/h, whose free
//! motion is that of J. Moser and A. P. Veselov (1991, Communications in Mathematical Physics 139,
//! 217): angular momentum is conserved, and spin is not damped. Moments act at the end of a step, as
//! forces do.

use super::{Assembly, Stage};
use crate::mechanics::Vector3;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::{add_to_node, position};

impl Assembly {
    /// Adds that moment, N m, to those on the frames of free bodies.
    pub(super) fn add_moments_of_spin(
        &self,
        stage: &Stage,
        unknowns: &[f64],
        residual: &mut [f64],
    ) {
        if !stage.keeps_spin {
            return;
        }
        for (_, frame, _) in self.joints.free_frames() {
            let Some((first, _)) = frame.body else {
                continue;
            };
            let of_tip = |tip: usize| {
                let place = first / STRIDE + tip;
                let [start, velocity] = stage.tip_at_start(place);
                let moved = position(unknowns, place) - start;
                moved.cross(&velocity) * self.masses[STRIDE * place]
            };
            let sum: Vector3 = (0..3).map(of_tip).sum();
            let moment = sum / stage.acceleration_step;
            add_to_node(residual, frame.first_unknown / STRIDE, &moment);
        }
    }
}
