//! The braid of a knot as two helical strands.

use std::f64::consts::PI;

/// Bending energy of a braid, with a derivation of Eq. 3.8 of the thesis.
///
/// Both strands are helices of radius h about the axis of the braid, where they touch (thesis Eq.
/// 3.7): (x, y, z)/h = (cos t, sin t, b t) with t over T = 2nπ − 2θ, where each end of the braid
/// is turned back by θ. A helix of radius 1 and pitch 2πb has the curvature κ̄ = 1/(1 + b²) and
/// the arc length T √(1 + b²). Two strands with ½ EI κ² each, without twist, have
///
/// ```text
/// Ē_b = E_b h/EI = 2 · ½ κ̄² T √(1 + b²) = 2 (nπ − θ) (1 + b²)^(−3/2)
/// ```
///
/// which is the printed equation. In the printed b = l̄_b/(2nπ − 2θ), l_b is the length of the
/// braid along its axis. The text calls it the arc length; this would give 1 + b² = (l̄_b/T)². The
/// two differ by a few per cent in braids at inversion, where b is about 4. Here l_b is the length
/// along the axis. With l_b → ∞, Ē_b = (2πn)⁴/l̄_b³ at θ = 0, the energy of Audoly et al. 2007.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HelicalBraid {
    /// Half the angle by which a strand winds around the other, nπ − θ, rad, greater than 0.
    pub half_angle: f64,
    /// Length along the axis over the radius of the rod, l̄_b.
    pub length: f64,
}

impl HelicalBraid {
    /// The braid of `turns` full turns, with each end turned back by `rotation` (rad).
    pub fn new(turns: f64, rotation: f64, length: f64) -> Self {
        Self {
            half_angle: turns * PI - rotation,
            length,
        }
    }

    /// Pitch over 2πh: b = l̄_b/(2nπ − 2θ).
    pub fn pitch(&self) -> f64 {
        0.5 * self.length / self.half_angle
    }

    /// Ē_b.
    pub fn energy(&self) -> f64 {
        2.0 * self.half_angle * libm::pow(1.0 + self.pitch().powi(2), -1.5)
    }

    /// −∂Ē_b/∂θ = (2 + 8b²)(1 + b²)^(−5/2): the energy released when the braid is turned back.
    pub fn unwinding_moment(&self) -> f64 {
        let squared = self.pitch().powi(2);
        (2.0 + 8.0 * squared) * libm::pow(1.0 + squared, -2.5)
    }

    /// The pitch b at which b times [`unwinding_moment`](Self::unwinding_moment) is largest: b² =
    /// (1 + √(3/2))/2. For longer braids with the same angle the moment decreases faster than
    /// 1/l_b.
    pub fn steepest_pitch() -> f64 {
        (0.5 * (1.0 + 1.5f64.sqrt())).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn the_moment_is_the_derivative_of_the_energy() {
        for (rotation, length) in [(0.0, 60.0), (1.0, 60.0), (2.0, 5.0)] {
            let energy = |rotation| HelicalBraid::new(3.0, rotation, length).energy();
            let difference = (energy(rotation - 1e-5) - energy(rotation + 1e-5)) / 2e-5;
            let moment = HelicalBraid::new(3.0, rotation, length).unwinding_moment();
            assert!((moment / difference - 1.0).abs() < 1e-8);
        }
    }

    #[test]
    fn a_long_braid_has_the_energy_of_audoly() {
        let length = 1e4f64;
        let expected = (2.0 * TAU).powi(4) / length.powi(3);
        let energy = HelicalBraid::new(2.0, 0.0, length).energy();
        assert!((energy / expected - 1.0).abs() < 1e-4);
    }

    #[test]
    fn the_energy_is_that_of_two_helices_by_their_points() {
        // Curvature by second differences of the tangents of the printed curve.
        let braid = HelicalBraid::new(3.0, 0.7, 40.0);
        let (pitch, steps) = (braid.pitch(), 200_000);
        let step = 2.0 * braid.half_angle / f64::from(steps);
        let speed = (1.0 + pitch * pitch).sqrt();
        let sum: f64 = (0..steps)
            .map(|k| {
                let tangent = |t: f64| [-t.sin() / speed, t.cos() / speed];
                let t = f64::from(k) * step;
                let [before, after] = [tangent(t), tangent(t + step)];
                let turned = (after[0] - before[0]).hypot(after[1] - before[1]);
                turned * turned / (speed * step)
            })
            .sum();
        assert!((braid.energy() / sum - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_steepest_pitch_is_a_maximum() {
        let at = |pitch: f64| {
            pitch
                * HelicalBraid {
                    half_angle: 1.0,
                    length: 2.0 * pitch,
                }
                .unwinding_moment()
        };
        let best = HelicalBraid::steepest_pitch();
        assert!(at(best) > at(0.99 * best) && at(best) > at(1.01 * best));
    }
}
