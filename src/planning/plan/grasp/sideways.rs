//! A planar rod whose gripper is slightly pushed out of the plane: linear theory.
//!
//! Among all small rotations θ(s) of the cross-sections that vanish at both ends and move the
//! gripper to its new position, the actual one minimises the second variation (see `stability`).
//! With the position as a condition C θ = Δ and its multiplier λ,
//!
//! > K θ + Cᵀ λ = 0,  C θ − m λ = Δ.

use super::Vector3;
use super::stability::{Element, Elimination, variations};

/// Largest sideways displacement of the rod over that of its gripper, which keeps its direction.
/// The absolute value is also returned for unstable rods; it is infinite at the limit of
/// stability.
pub fn largest_sideways(elements: &[Element], twist_stiffness: f64, compliance: f64) -> f64 {
    let variations = variations(elements, twist_stiffness, compliance);
    if variations.is_empty() {
        return 1.0;
    }
    let Elimination { legs, conditions } = Elimination::of(&variations);
    let Some(multiplier) = conditions.lu().solve(&Vector3::y()) else {
        return f64::INFINITY;
    };
    // Solves for the rotations from the gripper back to the contact node; both ends are held.
    let mut rotations = vec![Vector3::zeros(); elements.len() + 1];
    for (node, leg) in legs.iter().enumerate().rev() {
        let Some(inverse) = leg.inverse else {
            return f64::INFINITY;
        };
        let after = rotations[node + 2];
        rotations[node + 1] = -(inverse * (leg.part.transpose() * multiplier + leg.across * after));
    }
    let mut place = Vector3::zeros();
    let mut largest: f64 = 0.0;
    for (variation, ends) in variations.iter().zip(rotations.windows(2)) {
        place += variation.condition * (ends[0] + ends[1]) + variation.multiplier * multiplier;
        largest = largest.max(place.y.abs());
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Elements of a straight rod of length 1 under an axial force.
    fn straight(force: f64) -> Vec<Element> {
        let count = 800;
        let element = Element {
            length: 1.0 / f64::from(count),
            tangent: Vector3::x(),
            moment: Vector3::zeros(),
            force: force * Vector3::x(),
        };
        vec![element; count as usize]
    }

    #[test]
    fn a_rod_with_guided_ends_follows_its_gripper() {
        // A rod clamped at both ends, one of which is guided sideways, has its largest
        // displacement at that end, for any tension.
        for force in [-6.0, 0.0, 50.0] {
            let largest = largest_sideways(&straight(force), 0.7, 1e-6);
            assert!((largest - 1.0).abs() < 1e-6, "{force}: {largest}");
        }
    }

    #[test]
    fn a_column_beyond_its_critical_load_is_displaced_farther_than_its_gripper() {
        // Beyond P = 4π² the rod is unstable and bulges even more. For y'''' + P y'' = 0 with y(0)
        // = y'(0) = y'(1) = 0, y(1) = 1 and p = √P, y = (p x − sin p x + c (cos p x − 1))/(p − sin
        // p + c (cos p − 1)), c = (1 − cos p)/sin p.
        let p: f64 = 8.5;
        assert!(p > 2.0 * PI);
        let c = (1.0 - p.cos()) / p.sin();
        let shape = |x: f64| p * x - (p * x).sin() + c * ((p * x).cos() - 1.0);
        let expected = (0..=1000)
            .map(|index| (shape(f64::from(index) / 1000.0) / shape(1.0)).abs())
            .fold(0.0, f64::max);
        assert!(expected > 1.1);
        let found = largest_sideways(&straight(-p * p), 0.7, 1e-9);
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
    }
}
