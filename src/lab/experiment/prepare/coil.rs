//! A rod coiled flat in a spiral of Archimedes, whose turns have equal distances,
//!
//! ```text
//! r = r₀ + b φ,     b = spacing/2π
//! ```
//!
//! from its inner end outwards.

use rodlab_engine::mechanics::Vector3;
use std::f64::consts::TAU;

/// A flat coil.
#[derive(Clone, Copy, Debug)]
pub struct Coil {
    /// Middle of the coil, m.
    pub centre: Vector3,
    /// Unit vectors in its plane: the one from which angles are measured, and the one at a right
    /// angle to it, in the sense of winding.
    pub plane: [Vector3; 2],
    /// Angle of its inner end, rad.
    pub phase: f64,
    /// r₀, m.
    pub inner_radius: f64,
    /// Distance of adjacent turns, m.
    pub spacing: f64,
}

impl Coil {
    /// Winding angles, rad, at the nodes of a polyline of equal edges with the given length. No
    /// edge may be longer than the inner radius.
    pub fn turned(&self, length: f64, edges: usize) -> Vec<f64> {
        let edge = length / edges as f64;
        let mut turned = vec![0.0];
        for node in 0..edges {
            turned.push(turned[node] + self.turn(turned[node], edge));
        }
        turned
    }

    /// The point of the coil at a winding angle.
    pub fn point(&self, turned: f64) -> Vector3 {
        self.centre + self.outward(turned) * self.radius(turned)
    }

    /// Unit tangent there.
    pub fn tangent(&self, turned: f64) -> Vector3 {
        let across = self.outward(turned + 0.25 * TAU);
        (self.outward(turned) * self.growth() + across * self.radius(turned)).normalize()
    }

    /// The winding angle of a chord of a given length, by Newton's method.
    fn turn(&self, from: f64, chord: f64) -> f64 {
        let (growth, first) = (self.growth(), self.radius(from));
        let mut turn = chord / libm::hypot(first, growth);
        for _ in 0..50 {
            let second = first + growth * turn;
            let (sine, cosine) = libm::sincos(0.5 * turn);
            // Half of the square of the chord, (r₂ − r₁)² + 4 r₁ r₂ sin²(φ/2), and its derivative.
            let half_square =
                0.5 * growth * growth * turn * turn + 2.0 * first * second * sine * sine;
            let slope = growth * (growth * turn + 2.0 * first * sine * sine)
                + 2.0 * first * second * sine * cosine;
            let step = (half_square - 0.5 * chord * chord) / slope;
            turn -= step;
            if step.abs() <= f64::EPSILON * turn {
                break;
            }
        }
        turn
    }

    fn radius(&self, turned: f64) -> f64 {
        self.inner_radius + self.growth() * turned
    }

    /// b, m/rad.
    fn growth(&self) -> f64 {
        self.spacing / TAU
    }

    fn outward(&self, turned: f64) -> Vector3 {
        let (sine, cosine) = libm::sincos(self.phase + turned);
        self.plane[0] * cosine + self.plane[1] * sine
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_has_its_length_and_turns_that_lie_apart() {
        for (spacing, length, edges) in [(4e-3, 2.0, 800), (0.05, 3.0, 151), (2.0, 0.4, 20)] {
            let coil = Coil {
                centre: Vector3::new(0.1, 0.2, 0.3),
                plane: [Vector3::y(), Vector3::z()],
                phase: 0.7,
                inner_radius: 0.02,
                spacing,
            };
            let turned = coil.turned(length, edges);
            let nodes: Vec<Vector3> = turned.iter().map(|turned| coil.point(*turned)).collect();
            assert_eq!(nodes.len(), edges + 1);
            for pair in nodes.windows(2) {
                let missed = (pair[1] - pair[0]).norm() * edges as f64 / length - 1.0;
                assert!(missed.abs() < 1e-12, "{missed}");
            }
            for (node, turned) in nodes.iter().zip(&turned) {
                let outward = node - coil.centre;
                assert_eq!(outward.x, 0.0);
                let expected = 0.02 + spacing * turned / TAU;
                assert!((outward.norm() / expected - 1.0).abs() < 1e-12);
                let next_turn = coil.point(turned + TAU) - coil.centre;
                assert!((next_turn.norm() - outward.norm() - spacing).abs() < 1e-12);
                let ahead = coil.point(turned + 1e-6) - coil.point(turned - 1e-6);
                assert!((ahead.normalize() - coil.tangent(*turned)).norm() < 1e-7);
            }
        }
    }
}
