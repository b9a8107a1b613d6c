//! The least friction that can hold a rod in the curve in which it lies on a table.
//!
//! With the curvature κ(s), the bending stiffness B = EI/(ρAg) = 2 L_gb³ and the tension T, both per
//! weight of a unit length, a planar rod lies in equilibrium under the friction
//!
//! f_t = −p′,  f_n = B (κ″ + κ³/2) − κ p,  with p = T + B κ²/2,
//!
//! along its tangent and its normal. Thesis Eq. 5.2 is |f_n| ≤ μ for T = 0. But the table may also
//! hold a tension: the rod can keep its curve if and only if there is some p(s) with
//! p′² + (B (κ″ + κ³/2) − κ p)² ≤ μ². The pairs (p, p′) allowed at a point form a convex set, so the
//! values of p that are reached from the free start, where T = 0, form an interval at each point.

use super::DeployedRod;
use crate::plan::pattern::PatternPoint;

/// Largest number of points of a pattern that are used.
const MOST_POINTS: usize = 4000;
/// Relative accuracy of the least demand.
const ACCURACY: f64 = 1e-4;

/// Returns the least coefficient of friction that holds a lying rod in its whole curve, with the
/// tension that suits it best. The result is at most the largest √(κ″² + κ²κ′²) · 2 L_gb³, the
/// demand without tension.
///
/// `points` are at equal distances. The tension at the end, where the suspended part of the rod
/// begins, is free.
pub fn least_lying_demand(rod: &DeployedRod, points: &[PatternPoint]) -> f64 {
    let stiffness = 2.0 * rod.gravito_bending_length.powi(3);
    let stride = points.len().div_ceil(MOST_POINTS).max(1);
    let points: Vec<&PatternPoint> = points.iter().step_by(stride).collect();
    let demand_without_tension = |point: &&PatternPoint| {
        let along = point.curvature * point.curvature_slope;
        stiffness * libm::hypot(point.curvature_bend, along)
    };
    let demands = points.iter().map(demand_without_tension);
    let [mut too_low, mut enough] = [0.0, demands.fold(0.0, f64::max)];
    while enough - too_low > ACCURACY * enough {
        let friction = 0.5 * (too_low + enough);
        if is_held(&points, stiffness, friction) {
            enough = friction;
        } else {
            too_low = friction;
        }
    }
    enough
}

/// Whether some tension holds the curve at a coefficient of `friction`.
fn is_held(points: &[&PatternPoint], stiffness: f64, friction: f64) -> bool {
    let Some(first) = points.first() else {
        return true;
    };
    let begin = 0.5 * stiffness * first.curvature.powi(2);
    let mut reached = Some([begin, begin]);
    for pair in points.windows(2) {
        let here = Lying::at(pair[0], stiffness, friction);
        let length = pair[1].s - pair[0].s;
        reached = reached
            .and_then(|interval| here.allowed(interval))
            .map(|interval| [-1.0, 1.0].map(|way| here.farthest(interval, way, length)));
    }
    let last = points
        .last()
        .map(|last| Lying::at(last, stiffness, friction));
    let allowed = |interval| last.and_then(|last| last.allowed(interval));
    reached.and_then(allowed).is_some()
}

/// The condition at a point: p′² + (c − κp)² ≤ μ².
#[derive(Clone, Copy)]
struct Lying {
    curvature: f64,
    /// c = B (κ″ + κ³/2).
    push: f64,
    friction: f64,
}

impl Lying {
    fn at(point: &PatternPoint, stiffness: f64, friction: f64) -> Self {
        let curvature = point.curvature;
        Self {
            curvature,
            push: stiffness * (point.curvature_bend + 0.5 * curvature.powi(3)),
            friction,
        }
    }

    /// The values of p with a normal friction −u for u = κp − c.
    fn with_normal(&self, normal: f64) -> f64 {
        (self.push + normal) / self.curvature
    }

    /// The part of an interval of p where the normal friction is at most μ; `None` if it is empty.
    fn allowed(&self, [low, high]: [f64; 2]) -> Option<[f64; 2]> {
        if self.curvature == 0.0 {
            return (self.push.abs() <= self.friction).then_some([low, high]);
        }
        let ends = [-self.friction, self.friction].map(|normal| self.with_normal(normal));
        let allowed = [
            low.max(ends[0].min(ends[1])),
            high.min(ends[0].max(ends[1])),
        ];
        (allowed[0] <= allowed[1]).then_some(allowed)
    }

    /// The farthest p, in the direction `way` = ±1, that a step of `length` reaches from an allowed
    /// interval: the largest of ±(p ± ℓ √(μ² − (c − κp)²)), which is concave in p.
    fn farthest(&self, [low, high]: [f64; 2], way: f64, length: f64) -> f64 {
        let start = if self.curvature == 0.0 {
            if way > 0.0 { high } else { low }
        } else {
            let steepest = self.friction / (1.0 + (self.curvature * length).powi(2)).sqrt();
            let best = self.with_normal(way * self.curvature.signum() * steepest);
            best.clamp(low, high)
        };
        let normal = self.push - self.curvature * start;
        start + way * length * (self.friction.powi(2) - normal.powi(2)).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::pattern::Point;
    use std::f64::consts::PI;

    const LENGTH: f64 = 20.0;

    /// A rod with L_gb = 1 m.
    fn rod() -> DeployedRod {
        DeployedRod {
            gravito_bending_length: 1.0,
            ..DeployedRod::GREEN
        }
    }

    /// Points of a curve given by its curvature and two derivatives.
    fn points(count: usize, curvature: impl Fn(f64) -> [f64; 3]) -> Vec<PatternPoint> {
        let point = |k: usize| {
            let s = LENGTH * k as f64 / (count - 1) as f64;
            let [curvature, curvature_slope, curvature_bend] = curvature(s);
            PatternPoint {
                s,
                position: Point::zeros(),
                angle: 0.0,
                curvature,
                curvature_slope,
                curvature_bend,
            }
        };
        (0..count).map(point).collect()
    }

    /// κ = K sin⁴(πs/L) cos(2π(s − L/2)/λ), for which the ends are free, by differences.
    fn wave(amplitude: f64, wavelength: f64) -> impl Fn(f64) -> [f64; 3] {
        let of = move |s: f64| {
            let window = (PI * s / LENGTH).sin().powi(4);
            amplitude * window * (2.0 * PI * (s - 0.5 * LENGTH) / wavelength).cos()
        };
        move |s| {
            let h = 1e-3;
            let [before, here, after] = [of(s - h), of(s), of(s + h)];
            [
                here,
                (after - before) / (2.0 * h),
                (after - 2.0 * here + before) / (h * h),
            ]
        }
    }

    #[test]
    fn a_circle_and_a_line_lie_without_friction() {
        for curvature in [0.0, 0.4, -1.0] {
            let points = points(500, |_| [curvature, 0.0, 0.0]);
            assert_eq!(least_lying_demand(&rod(), &points), 0.0);
        }
    }

    #[test]
    fn a_planar_elastica_lies_without_friction() {
        // B (κ″ + κ³/2) = κ p with constant p; with κ = 2 sech s, κ″ + κ³/2 = κ, so p = B. It is
        // the loop of an infinite rod under the tension B.
        let elastica = |s: f64| {
            let u = s - 0.5 * LENGTH;
            let (sech, tanh) = (1.0 / u.cosh(), u.tanh());
            let curvature = 2.0 * sech;
            [
                curvature,
                -curvature * tanh,
                curvature * (1.0 - 2.0 * sech * sech),
            ]
        };
        let points = points(4000, elastica);
        let without_tension = points.iter().map(|point| {
            let along = point.curvature * point.curvature_slope;
            2.0 * libm::hypot(point.curvature_bend, along)
        });
        assert!(without_tension.fold(0.0, f64::max) > 3.0);
        // The start has no tension, so friction builds p up to B = 2 along the straight part, which
        // is some 9 m long; a slope of 2/9.
        let demand = least_lying_demand(&rod(), &points);
        assert!(demand > 0.2 && demand < 0.26, "{demand}");
    }

    #[test]
    fn tension_halves_the_demand_of_a_wave() {
        for (amplitude, wavelength) in [(0.1, 10.0), (0.5, 10.0), (0.5, 5.0)] {
            let fine = points(4000, wave(amplitude, wavelength));
            let by_eq_5_2 = fine.iter().map(|point| 2.0 * point.curvature_bend.abs());
            let by_eq_5_2 = by_eq_5_2.fold(0.0, f64::max);
            let demand = least_lying_demand(&rod(), &fine);
            assert!(
                demand < 0.6 * by_eq_5_2 && demand > 0.25 * by_eq_5_2,
                "{demand} {by_eq_5_2}"
            );
            // It does not depend on the points, nor on the direction along the curve.
            let coarse = least_lying_demand(&rod(), &points(1000, wave(amplitude, wavelength)));
            assert!((coarse / demand - 1.0).abs() < 1e-2, "{coarse} {demand}");
        }
    }

    #[test]
    fn a_found_tension_satisfies_the_condition() {
        // Integrates p backwards from the end, inside the reached intervals, and checks the cone.
        let stiffness = 2.0;
        let all = points(4000, wave(0.5, 10.0));
        let friction = 1.01 * least_lying_demand(&rod(), &all);
        let all: Vec<&PatternPoint> = all.iter().collect();
        let begin = 0.5 * stiffness * all[0].curvature.powi(2);
        let mut intervals = vec![[begin, begin]];
        for pair in all.windows(2) {
            let here = Lying::at(pair[0], stiffness, friction);
            let interval = here.allowed(*intervals.last().unwrap()).unwrap();
            *intervals.last_mut().unwrap() = interval;
            let length = pair[1].s - pair[0].s;
            intervals.push([-1.0, 1.0].map(|way| here.farthest(interval, way, length)));
        }
        let last = all.len() - 1;
        let allowed = Lying::at(all[last], stiffness, friction).allowed(intervals[last]);
        let mut p = allowed.map(|[low, high]| 0.5 * (low + high)).unwrap();
        for k in (0..last).rev() {
            let next = p.clamp(intervals[k][0], intervals[k][1]);
            let slope = (p - next) / (all[k + 1].s - all[k].s);
            let point = all[k];
            let normal = stiffness * (point.curvature_bend + 0.5 * point.curvature.powi(3))
                - point.curvature * next;
            assert!(
                slope.hypot(normal) <= 1.02 * friction,
                "{k}: {slope} {normal}"
            );
            p = next;
        }
        assert!((p - begin).abs() < 1e-12);
    }
}
