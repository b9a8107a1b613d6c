//! A perfectly flexible, inextensible cable that hangs in a current.
//!
//! With the length s from the lower end, the unit tangent t upwards and the tension T, the forces
//! on the part below s balance:
//!
//! ```text
//! d(T t)/ds = w z − f(t),   dx/ds = t,   T t = W z at the lower end
//! f = ½ ρ d Cₙ |Uₙ| Uₙ + ½ ρ π d Cₜ |Uₜ| Uₜ
//! ```
//!
//! for the weight w per length, the weight W at the end, and the parts Uₙ and Uₜ of the velocity of
//! the water across and along the cable (Berteaux 1976).

use rodlab_engine::mechanics::Vector3;
use std::f64::consts::PI;

/// A cable and its current.
#[derive(Clone, Copy, Debug)]
pub struct Cable {
    /// L, m.
    pub length: f64,
    /// d, m.
    pub diameter: f64,
    /// w, N/m.
    pub weight_per_length: f64,
    /// W, N.
    pub weight: f64,
    /// ρ, kg/m³.
    pub density: f64,
    /// Cₙ.
    pub normal: f64,
    /// Cₜ.
    pub tangential: f64,
    /// U, m/s.
    pub velocity: Vector3,
}

impl Cable {
    /// Drag on a unit of length with a tangent, N/m.
    fn drag(&self, tangent: &Vector3) -> Vector3 {
        let along = self.velocity.dot(tangent);
        let across = self.velocity - tangent * along;
        let factor = 0.5 * self.density * self.diameter;
        across * (factor * self.normal * across.norm())
            + tangent * (factor * PI * self.tangential * along.abs() * along)
    }

    /// Vector from the upper end to the lower one, m, by the rule of Runge and Kutta.
    pub fn end(&self, steps: usize) -> Vector3 {
        let step = self.length / steps as f64;
        let rate = |pull: &Vector3| {
            let tangent = pull.normalize();
            let loaded = Vector3::z() * self.weight_per_length - self.drag(&tangent);
            (loaded, tangent)
        };
        let (mut pull, mut x) = (Vector3::z() * self.weight, Vector3::zeros());
        for _ in 0..steps {
            let first = rate(&pull);
            let second = rate(&(pull + first.0 * (0.5 * step)));
            let third = rate(&(pull + second.0 * (0.5 * step)));
            let fourth = rate(&(pull + third.0 * step));
            pull += (first.0 + second.0 * 2.0 + third.0 * 2.0 + fourth.0) * (step / 6.0);
            x += (first.1 + second.1 * 2.0 + third.1 * 2.0 + fourth.1) * (step / 6.0);
        }
        -x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A weight far heavier than the cable leaves a parabola of the uniform drag f: the lower end
    /// is f L²/2W behind the upper one.
    #[test]
    fn a_heavy_weight_leaves_a_parabola() {
        let cable = Cable {
            length: 2.0,
            diameter: 0.01,
            weight_per_length: 0.0,
            weight: 1e4,
            density: 1000.0,
            normal: 1.2,
            tangential: 0.05,
            velocity: Vector3::x(),
        };
        let drag = 0.5 * 1000.0 * 0.01 * 1.2;
        let end = cable.end(100);
        assert!((end.x / (drag * 4.0 / 2e4) - 1.0).abs() < 1e-5, "{end}");
        assert!((end.z + 2.0).abs() < 1e-5);
    }

    /// Without a weight at the end the cable is straight, at the critical angle at which the drag
    /// across it balances its weight across it.
    #[test]
    fn a_light_weight_leaves_a_line_at_the_critical_angle() {
        let cable = Cable {
            length: 1.0,
            diameter: 0.01,
            weight_per_length: 5.0,
            weight: 1e-9,
            density: 1000.0,
            normal: 1.2,
            tangential: 0.0,
            velocity: Vector3::x(),
        };
        // w sin φ = f cos² φ with the angle φ from the vertical and f = 6 N/m.
        let end = cable.end(100_000);
        let angle = libm::atan2(end.x, -end.z);
        let (sine, cosine) = libm::sincos(angle);
        assert!(
            (5.0 * sine / (6.0 * cosine * cosine) - 1.0).abs() < 1e-3,
            "{angle}"
        );
    }
}
