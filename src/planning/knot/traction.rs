//! Traction against tightness of an overhand knot: closed laws.
//!
//! F̄ = F h²/EI is the traction with the radius h of the rod, ε = √(h/R) the tightness with the radius R of the loop.

use super::loop_elastica::LoopElastica;
use rodlab_engine::mechanics::kirchhoff::numerics::bisect;
use std::f64::consts::{PI, TAU};

/// σ of the trefoil in Eq. 2.29 of the thesis, as printed by Audoly et al. 2007.
pub const TREFOIL_FRICTION: f64 = 0.492;

/// F̄ = ε⁴/2 + μ σ ε³ (Audoly, Clauvelin & Neukirch, PRL 99, 164301, 2007; thesis Eq. 2.29).
///
/// The first term is the bending energy per length of a circular loop, which is released when the
/// loop shrinks. The second term is the work of friction: the strands slip by the same distance as
/// the ends move, under the total contact force.
pub fn audoly_traction(tightness: f64, friction: f64, sigma: f64) -> f64 {
    0.5 * tightness.powi(4) + friction * sigma * tightness.powi(3)
}

/// n² h/e at the traction n² F̄, where e is the shortening (Jawed, Dieleman, Audoly & Reis, PRL 115, 118302, 2015;
/// thesis Eq. 2.30):
///
/// ```text
/// n² h/e = g(x)/(8√3 π²),  x = (96√3 π² n² F̄/μ)^⅓,  g(x) = x²/(x + λ/R)
/// ```
///
/// Friction dominates in this law: `friction` must be greater than 0. g follows from the elastica
/// of the loop.
pub fn jawed_shortening(scaled_traction: f64, friction: f64) -> f64 {
    let factor = 8.0 * 3f64.sqrt() * PI * PI;
    let gap = libm::cbrt(12.0 * factor * scaled_traction / friction);
    gap * gap / (gap + LoopElastica::over(gap).length()) / factor
}

/// The scaled traction n² F̄ for which [`jawed_shortening`] returns the given n² h/e.
pub fn jawed_traction(scaled_shortening: f64, friction: f64) -> f64 {
    // The shortening increases with the traction; knots of rods lie far inside this range of
    // decades.
    let logarithm = bisect(-35.0, 5.0, |logarithm| {
        jawed_shortening(libm::exp(logarithm), friction) - scaled_shortening
    });
    libm::exp(logarithm)
}

/// A loop and the braid below it: lengths in m, energy over EI in 1/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BraidAndLoop {
    /// Length ℓ of the braid.
    pub braid: f64,
    /// Radius R at the ends of the loop.
    pub radius: f64,
    /// Shape of the loop.
    pub elastica: LoopElastica,
    /// Bending energy over EI.
    pub energy: f64,
}

/// The braid and loop with the shortening e = ℓ + λ (m) and the elliptic parameter m. Two strands
/// of radius `radius` wind around each other by n full turns: they are helices of curvature h
/// (2πn/ℓ)², and the braid has the energy EI h² (2πn)⁴/ℓ³.
pub fn braid_and_loop(
    unknotting_number: usize,
    radius: f64,
    shortening: f64,
    parameter: f64,
) -> BraidAndLoop {
    let elastica = LoopElastica { parameter };
    let end_radius = shortening / (elastica.gap() + elastica.length());
    let braid = elastica.gap() * end_radius;
    let turn = TAU * unknotting_number as f64;
    BraidAndLoop {
        braid,
        radius: end_radius,
        elastica,
        energy: radius.powi(2) * turn.powi(4) / braid.powi(3) + elastica.energy() / end_radius,
    }
}

/// The braid and loop of least energy for a given shortening: the shape of a knot without
/// friction.
pub fn relaxed_loop(unknotting_number: usize, radius: f64, shortening: f64) -> BraidAndLoop {
    let at = |stretched: f64| {
        braid_and_loop(
            unknotting_number,
            radius,
            shortening,
            -libm::expm1(-libm::exp(stretched)),
        )
    };
    // Golden section over ln(−ln(1 − m)); the energy has one minimum.
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    let (mut low, mut high) = (-14.0f64, 3.2f64);
    for _ in 0..80 {
        let width = ratio * (high - low);
        if at(high - width).energy < at(low + width).energy {
            high = low + width;
        } else {
            low = high - width;
        }
    }
    at(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_law_for_all_unknotting_numbers_has_its_loose_limit() {
        // x → 0: g = x²/2π.
        let (friction, traction) = (0.1, 1e-15f64);
        let factor = 8.0 * 3f64.sqrt() * PI * PI;
        let x = (12.0 * factor * traction / friction).cbrt();
        let loose = x * x / TAU / factor;
        assert!((jawed_shortening(traction, friction) / loose - 1.0).abs() < 1e-3);
    }

    #[test]
    fn traction_and_shortening_are_inverse() {
        for traction in [1e-8, 1e-4, 1e-2] {
            let shortening = jawed_shortening(traction, 0.07);
            assert!((jawed_traction(shortening, 0.07) / traction - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_loose_knot_without_friction_pulls_with_half_of_epsilon_to_the_fourth() {
        // F = −dE/de; the braid is negligible compared with the loop as h/e → 0.
        let radius = 1e-9;
        let at = |shortening: f64| relaxed_loop(1, radius, shortening);
        let force = (at(0.999).energy - at(1.001).energy) / 0.002;
        let tightness = (radius / at(1.0).radius).sqrt();
        let expected = audoly_traction(tightness, 0.0, TREFOIL_FRICTION);
        assert!((force * radius * radius / expected - 1.0).abs() < 0.01);
    }

    #[test]
    fn the_relaxed_loop_is_a_minimum() {
        for n in 1..=6 {
            let relaxed = relaxed_loop(n, 1.6e-3, 0.6);
            for factor in [0.98, 1.02] {
                let parameter = 1.0 - factor * (1.0 - relaxed.elastica.parameter);
                let other = braid_and_loop(n, 1.6e-3, 0.6, parameter);
                assert!(other.energy > relaxed.energy);
            }
        }
    }
}
