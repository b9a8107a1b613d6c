//! Online correction: replans the rest of the path from the observed position of the rod.
//!
//! A camera, or a simulation in its place, observes positions of the lying rod at arc lengths.
//! From its observed end the rod returns to the pattern over a length ℓ. With the heading error ψ
//! and the distance b to the left of the pattern at this end, the rod is laid with the curvature
//!
//! > κ(s) + (c₀ + c₁ x)(1 − x)²,  x = (s − s₀)/ℓ,  c₀ = −20 b/ℓ² − 8 ψ/ℓ,  c₁ = −12 ψ/ℓ − 4 c₀,
//!
//! which removes both errors at s₀ + ℓ to first order: ψ' and b' = ψ follow from the curvature
//! alone.

use super::DeployedRod;
use crate::plan::pattern::{PatternPoint, Point};
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Minimum number of positions for the fit of a parabola.
const FEWEST: usize = 4;
/// Curvature, over 1/L_gb, below which a bend is too weak to determine the gravito-bending length.
const LEAST_BEND: f64 = 0.2;
/// Gain of the correction of the gravito-bending length, and its largest total change.
const BELIEF: f64 = 0.6;
const LARGEST_CHANGE: f64 = 0.3;

/// The observed end of the lying rod.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObservedContact {
    /// Arc length of the rod, m.
    pub s: f64,
    /// Place, m.
    pub position: Point,
    /// Direction of the rod, counter-clockwise from x, rad.
    pub angle: f64,
}

impl ObservedContact {
    /// Position and direction at the last of the `lying` points (arc length and position, m), from
    /// parabolas through the points within `window` (m) of it; `None` if there are too few.
    pub fn of(lying: &[(f64, Point)], window: f64) -> Option<Self> {
        let end = lying.last()?.0;
        let near = || lying.iter().filter(|(s, _)| end - s <= window);
        if near().count() < FEWEST {
            return None;
        }
        let mut normal = Matrix3::zeros();
        let mut right = [Vector3::zeros(); 2];
        for (s, place) in near() {
            let x = (s - end) / window;
            let powers = Vector3::new(1.0, x, x * x);
            normal += powers * powers.transpose();
            right[0] += place.x * powers;
            right[1] += place.y * powers;
        }
        let inverse = normal.try_inverse()?;
        let [x, y] = right.map(|right| inverse * right);
        Some(Self {
            s: end,
            position: Point::new(x[0], y[0]),
            angle: libm::atan2(y[1], x[1]),
        })
    }

    /// The end extrapolated to `s` (m) along a curve with given curvatures (1/m), whose points
    /// have increasing arc length.
    pub fn carried(&self, along: &[PatternPoint], s: f64) -> Self {
        let mut carried = *self;
        for pair in along.windows(2) {
            let (from, to) = (pair[0].s.max(carried.s), pair[1].s.min(s));
            if to > from {
                let middle = (0.5 * (from + to) - pair[0].s) / (pair[1].s - pair[0].s);
                let curvature =
                    pair[0].curvature + middle * (pair[1].curvature - pair[0].curvature);
                carried.step(curvature, to - from);
            }
        }
        carried
    }

    /// Continues along an arc.
    fn step(&mut self, curvature: f64, length: f64) {
        let turn = curvature * length;
        let half = 0.5 * turn;
        let chord = if half.abs() < 1e-4 {
            length * (1.0 - half * half / 6.0)
        } else {
            length * libm::sin(half) / half
        };
        let (sine, cosine) = libm::sincos(self.angle + half);
        self.position += chord * Point::new(cosine, sine);
        self.angle += turn;
        self.s += length;
    }
}

/// The curve on which the rod returns from `contact` to the pattern, whose `points` begin there.
/// The return takes `return_length` (m) and adds at most `largest_curvature` (1/m) to the curvature
/// of the pattern.
pub fn return_curve(
    points: &[PatternPoint],
    contact: &ObservedContact,
    return_length: f64,
    largest_curvature: f64,
) -> Vec<PatternPoint> {
    let Some(first) = points.first() else {
        return Vec::new();
    };
    let (sine, cosine) = libm::sincos(first.angle);
    let off = contact.position - first.position;
    let aside = cosine * off.y - sine * off.x;
    let heading = contact.angle - first.angle;
    let heading = heading - TAU * (heading / TAU).round();
    let start = -20.0 * aside / (return_length * return_length) - 8.0 * heading / return_length;
    let slope = -12.0 * heading / return_length - 4.0 * start;
    // Limited to the range of the linear theory.
    let largest = start.abs().max((start + slope / 3.0).abs() * 4.0 / 9.0);
    let part = (largest_curvature / largest.max(1e-300)).min(1.0);
    let added = |s: f64| {
        let x = ((s - first.s) / return_length).min(1.0);
        part * (start + slope * x) * (1.0 - x) * (1.0 - x)
    };
    let mut here = ObservedContact {
        s: first.s,
        position: contact.position,
        angle: first.angle + heading,
    };
    let mut curve: Vec<PatternPoint> = Vec::with_capacity(points.len());
    for point in points {
        let curvature = point.curvature + added(point.s);
        if let Some(before) = curve.last() {
            here.step(0.5 * (before.curvature + curvature), point.s - before.s);
        }
        curve.push(PatternPoint {
            position: here.position,
            angle: here.angle,
            curvature,
            ..*point
        });
    }
    curve
}

/// The gravito-bending length assumed in planning, m, corrected by an observed bend. Over `length`
/// (m) the rod turned by `turned` (rad); `aimed` are the planned curvatures (1/m).
///
/// A rod laid with an L_gb that is too large bends too much. The gripper is displaced sideways as
/// L_gb² κ requires, so the rod is laid with (L_gb/L)² times the curvature, where L is its true
/// length. `nominal` is the initial length.
pub fn corrected_length(
    rod: &DeployedRod,
    nominal: f64,
    [turned, aimed]: [f64; 2],
    length: f64,
) -> f64 {
    let unit = rod.gravito_bending_length;
    let (found, asked) = (turned / length, aimed / length);
    let least = LEAST_BEND / unit;
    let excess = (found - asked) * asked / (asked * asked + least * least);
    let corrected = unit * (1.0 - 0.5 * BELIEF * excess.clamp(-1.0, 1.0));
    let [low, high] = [1.0 - LARGEST_CHANGE, 1.0 + LARGEST_CHANGE].map(|part| part * nominal);
    corrected.clamp(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::pattern::{Circle, Line, Pattern};

    #[test]
    fn the_end_of_a_lying_arc_is_seen() {
        let radius = 0.1;
        let lying: Vec<(f64, Point)> = (0..=30)
            .map(|index| {
                let s = 0.008 * f64::from(index);
                let angle = s / radius;
                (s, radius * Point::new(angle.sin(), 1.0 - angle.cos()))
            })
            .collect();
        let seen = ObservedContact::of(&lying, 0.05).unwrap();
        assert_eq!(seen.s, lying[30].0);
        assert!((seen.position - lying[30].1).norm() < 2e-4);
        let turn = seen.angle - 2.4;
        assert!((turn - TAU * (turn / TAU).round()).abs() < 0.02);
        assert_eq!(ObservedContact::of(&lying[..3], 0.05), None);
    }

    #[test]
    fn a_well_laid_rod_continues_along_the_pattern() {
        let circle = Pattern::new(Box::new(Circle { radius: -0.15 }), 0.0).unwrap();
        let points = circle.sampled(0.003);
        let from = 40;
        let contact = ObservedContact {
            s: points[from].s,
            position: points[from].position,
            angle: points[from].angle + TAU,
        };
        for (found, point) in return_curve(&points[from..], &contact, 0.1, 10.0)
            .iter()
            .zip(&points[from..])
        {
            assert!((found.position - point.position).norm() < 1e-9);
            assert!((found.curvature - point.curvature).abs() < 1e-12);
        }
        let carried = contact.carried(&points, points[90].s);
        assert!((carried.position - points[90].position).norm() < 1e-6);
    }

    #[test]
    fn a_rod_beside_its_pattern_returns_to_it() {
        let line = Pattern::new(Box::new(Line { length: 0.5 }), 0.0).unwrap();
        let points = line.sampled(0.002);
        let contact = ObservedContact {
            s: 0.0,
            position: Point::new(0.0, 3e-3),
            angle: -0.04,
        };
        let curve = return_curve(&points, &contact, 0.12, 1e3);
        for point in curve.iter().filter(|point| point.s >= 0.12) {
            assert!(point.position.y.abs() < 2e-5, "{point:?}");
            assert!(point.angle.abs() < 1e-4 && point.curvature == 0.0);
        }
        // Its direction is continuous.
        for pair in curve.windows(2) {
            let turned = pair[1].angle - pair[0].angle;
            let mean = 0.5 * (pair[0].curvature + pair[1].curvature);
            assert!((turned - 0.002 * mean).abs() < 1e-9);
        }
    }

    #[test]
    fn a_rod_far_from_its_pattern_is_not_bent_beyond_measure() {
        let line = Pattern::new(Box::new(Line { length: 0.5 }), 0.0).unwrap();
        let points = line.sampled(0.002);
        let contact = ObservedContact {
            s: 0.0,
            position: Point::new(0.0, 0.1),
            angle: 1.0,
        };
        let curve = return_curve(&points, &contact, 0.12, 9.0);
        let most = curve.iter().map(|point| point.curvature.abs());
        let most = most.fold(0.0, f64::max);
        assert!((0.5 * 9.0..=9.0 * (1.0 + 1e-12)).contains(&most), "{most}");
    }

    #[test]
    fn the_gravito_bending_length_is_found_from_bends() {
        let truth = 0.03;
        let mut rod = DeployedRod {
            gravito_bending_length: 0.033,
            radius: 0.0016,
            length: 0.9,
        };
        for _ in 0..60 {
            let aimed = 0.4 / truth * 0.02;
            let turned = aimed * (rod.gravito_bending_length / truth).powi(2);
            rod.gravito_bending_length = corrected_length(&rod, 0.033, [turned, aimed], 0.02);
        }
        assert!((rod.gravito_bending_length / truth - 1.0).abs() < 1e-3);
        // A straight part gives no information.
        let same = corrected_length(&rod, 0.033, [0.01, 0.0], 0.02);
        assert_eq!(same, rod.gravito_bending_length);
    }
}
