//! Friction of a tendon in its eyelets.
//!
//! The tendon is pulled or taken in at its first eyelet and fixed to its last. Where it turns
//! by the angle φₖ in the eyelet k, the tension falls or rises by Euler's formula for belts,
//!
//! ```text
//! Tₖ₊₁ = Tₖ e^(−μ φₖ zₖ),     −1 ≤ zₖ ≤ 1
//! ```
//!
//! where z = 1 if the tendon slides towards its first eyelet, and −1 if it slides back. Before it
//! slides, it sticks like a spring (the model of L. Prandtl 1928 for each eyelet): with the length Λₖ
//! of the tendon beyond the eyelet, whose decrease is what has moved through it,
//!
//! ```text
//! zₖ = clamp(zₖ⁰ + (Λₖ⁰ − Λₖ)/δ, −1, 1),     Λₖ = Σ_{j>k} rⱼ/(1 + Tⱼ/EA)
//! ```
//!
//! with the values z⁰ and Λ⁰ at the start of the step and the presliding length δ; Λ is counted
//! without stretch. So a tendon that rests keeps its differences of tension.
//!
//! **Tensions** follow from that in the last part, τ: each Λₖ depends on the tensions after it only.
//! τ is such that T in the first part is that given, or that Σ rₖ/(1 + Tₖ/EA) is the rest length L.
//! The sum falls as τ grows. Forces have no potential, and their Jacobian is not symmetric: with
//! the derivatives at constant τ and those over τ, from the last part to the first,
//!
//! ```text
//! ∂Tₖ = Tₖ/Tₖ₊₁ ∂Tₖ₊₁ + μ Tₖ (z ∂φ − φ ∂Λ/δ),     the last summand where |z| < 1
//! ```
//!
//! The angle is rounded at zero, φ → √(φ² + ε²) − ε, since it has a corner where the tendon is
//! straight.

use super::StraightPart;
use crate::mechanics::Vector3;
use crate::mechanics::scene::CoulombFriction;

/// ε, rad.
const ROUNDING: f64 = 1e-5;
/// Sine of an angle below which it counts as that of a tendon that turns back, whose angle has no
/// derivative.
const TURNS_BACK: f64 = 1e-9;

/// Presliding length of a tendon for which none is given, over its placed length.
const PRESLIDING: f64 = 1e-5;

/// Friction in the inner eyelets of a tendon.
#[derive(Clone, Debug)]
pub(super) struct Capstans {
    law: CoulombFriction,
    /// δ, m.
    presliding: f64,
    /// Those of the inner eyelets, from the first on.
    inner: Vec<Capstan>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Capstan {
    /// φ, rad.
    angle: f64,
    /// ∂φ over the directions of the parts before and after, rad.
    slopes: [Vector3; 2],
    /// Λ, m, and z.
    beyond: f64,
    state: f64,
    /// Λ⁰ and z⁰.
    committed: [f64; 2],
}

impl Capstans {
    pub(super) fn new(law: CoulombFriction, eyelets: usize) -> Self {
        Self {
            law,
            presliding: f64::NAN,
            inner: vec![Capstan::default(); eyelets.saturating_sub(2)],
        }
    }

    /// Number of inner eyelets.
    pub(super) fn count(&self) -> usize {
        self.inner.len()
    }

    /// Sets the angles between the straight parts of the tendon.
    pub(super) fn turn(&mut self, parts: &[StraightPart]) {
        for (capstan, parts) in self.inner.iter_mut().zip(parts.windows(2)) {
            let [before, after] = [&parts[0], &parts[1]];
            (capstan.angle, capstan.slopes) = rounded_angle(&before.direction, &after.direction);
        }
    }

    /// Sets the length beyond an inner eyelet, m, and with it its state.
    pub(super) fn slide(&mut self, inner: usize, beyond: f64) {
        let capstan = &mut self.inner[inner];
        capstan.beyond = beyond;
        let [start, state] = capstan.committed;
        capstan.state = (state + (start - beyond) / self.presliding).clamp(-1.0, 1.0);
    }

    /// Largest ratio of two tensions, e^(μ Σ φ).
    pub(super) fn largest_ratio(&self) -> f64 {
        let turn: f64 = self.inner.iter().map(|capstan| capstan.angle).sum();
        libm::exp(self.law.coefficient * turn)
    }

    /// Begins at the present state.
    pub(super) fn commit(&mut self) {
        for capstan in &mut self.inner {
            capstan.committed = [capstan.beyond, capstan.state];
        }
    }

    /// Begins with the present lengths, ℓ (m) in all, and with no part of the friction mobilised.
    pub(super) fn begin(&mut self, length: f64) {
        self.presliding = self.law.presliding.unwrap_or(PRESLIDING * length);
        for capstan in &mut self.inner {
            capstan.committed = [capstan.beyond, 0.0];
            capstan.state = 0.0;
        }
    }

    /// Λ⁰ and z⁰ of all eyelets.
    pub(super) fn memory(&self) -> Vec<f64> {
        self.inner.iter().flat_map(|one| one.committed).collect()
    }

    /// Restores what [`Self::memory`] returned. Returns whether the number of eyelets fits.
    pub(super) fn restore(&mut self, memory: &[f64]) -> bool {
        let (pairs, rest) = memory.as_chunks::<2>();
        let fits = rest.is_empty() && pairs.len() == self.inner.len();
        for (capstan, pair) in self.inner.iter_mut().zip(pairs) {
            capstan.committed = *pair;
        }
        fits
    }

    /// μ.
    pub(super) fn coefficient(&self) -> f64 {
        self.law.coefficient
    }

    /// Ratio of the tension after an inner eyelet to that before it.
    pub(super) fn ratio(&self, inner: usize) -> f64 {
        let capstan = &self.inner[inner];
        libm::exp(-self.law.coefficient * capstan.angle * capstan.state)
    }

    /// z of an inner eyelet, ∂φ over the directions of the parts on its two sides, and φ/δ where it
    /// sticks, else 0.
    pub(super) fn slopes(&self, inner: usize) -> (f64, [Vector3; 2], f64) {
        let Capstan {
            state,
            slopes,
            angle,
            ..
        } = self.inner[inner];
        let sticks = if state.abs() < 1.0 {
            angle / self.presliding
        } else {
            0.0
        };
        (state, slopes, sticks)
    }
}

/// Angle between two directions, rounded at zero, with its derivatives over both.
fn rounded_angle(before: &Vector3, after: &Vector3) -> (f64, [Vector3; 2]) {
    let (sine, cosine) = (before.cross(after).norm(), before.dot(after));
    let angle = libm::atan2(sine, cosine);
    let root = libm::hypot(angle, ROUNDING);
    // φ/sin φ is one at zero.
    let over_sine = match sine > TURNS_BACK {
        true => angle / sine,
        false if cosine > 0.0 => 1.0,
        false => 0.0,
    };
    let factor = -over_sine / root;
    (root - ROUNDING, [after * factor, before * factor])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slopes_of_the_rounded_angle_are_its_derivatives() {
        let step = 1e-8;
        for angle in [1e-5, 2e-3, 0.4, 1.6, 3.0] {
            let before = Vector3::new(0.36, 0.48, 0.8);
            let across = before.cross(&Vector3::x()).normalize();
            let after = before * libm::cos(angle) + across * libm::sin(angle);
            let (_, slopes) = rounded_angle(&before, &after);
            for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
                // Directions stay unit vectors.
                let turned =
                    |vector: &Vector3, by: f64| (vector + axis.cross(vector) * by).normalize();
                for (side, slope) in slopes.iter().enumerate() {
                    let at = |by: f64| match side {
                        0 => rounded_angle(&turned(&before, by), &after).0,
                        _ => rounded_angle(&before, &turned(&after, by)).0,
                    };
                    let found = (at(step) - at(-step)) / (2.0 * step);
                    let expected = slope.dot(&axis.cross([&before, &after][side]));
                    assert!(
                        (found - expected).abs() < 1e-6,
                        "{angle} {found} {expected}"
                    );
                }
            }
        }
    }
}
