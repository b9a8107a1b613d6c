//! Curved rods in a plane that lose their stability sideways, by a method independent of the
//! discrete rods.

use rodlab_engine::mechanics::kirchhoff::numerics::{bisect, runge_kutta};

/// Steps of the Runge–Kutta method.
const STEPS: usize = 800;
/// Step of the difference quotient.
const DIFFERENCE: f64 = 1e-7;
const MOST_ITERATIONS: usize = 30;

/// A rod of unit length in a vertical plane, clamped at one end and free at the other, which carries its weight.
///
/// From the free end on, with the moment M and the force N that the material behind s exerts,
///
/// ```text
/// t = (cos θ, sin θ),  θ' = κ = κ̂ + M/B,  M' = −N cos θ,  N = w s upwards
/// ```
///
/// A small rotation α₁ about the normal in the plane and α₃ about the tangent changes the bending across the plane by β₁ and
/// the twist by β₃. Linearised in the frame of the rod, with N₁ = N cos θ and N₃ = N sin θ,
///
/// ```text
/// α₁' = β₁ − κ α₃,  α₃' = β₃ + κ α₁
/// A β₁' = (M − κ C) β₃ + N₃ α₁ − N₁ α₃,  C β₃' = (κ A − M) β₁
/// ```
///
/// where β vanishes at the free end and α at the clamp. The rod is critical if there is such a solution.
pub(super) struct HangingRod {
    /// Stiffness B of bending in the plane, A of bending across it, and C of twist.
    pub stiffness: [f64; 3],
    /// Natural curvature κ̂.
    pub natural_curvature: f64,
    /// Direction of the tangent at the clamp, rad.
    pub clamp: f64,
}

impl HangingRod {
    /// Returns the least weights at which the rod is critical, which differ by more than `step`.
    ///
    /// # Panics
    /// If the planar equilibrium is not found.
    pub fn critical_weights<const N: usize>(&self, step: f64) -> [f64; N] {
        let mut free = self.clamp - self.natural_curvature;
        let mut weight = 0.0;
        std::array::from_fn(|_| {
            loop {
                let next = weight + step;
                let start = free;
                let [here, there] = [weight, next].map(|weight| self.criterion(weight, start));
                free = self.free_angle(next, start);
                let before = std::mem::replace(&mut weight, next);
                if here * there < 0.0 {
                    return bisect(before, next, |weight| self.criterion(weight, start));
                }
            }
        })
    }

    /// Direction of the tangent at the free end, by Newton's method from the guess.
    fn free_angle(&self, weight: f64, guess: f64) -> f64 {
        let misfit = |angle: f64| self.at_clamp(weight, angle)[0] - self.clamp;
        let mut angle = guess;
        for _ in 0..MOST_ITERATIONS {
            let here = misfit(angle);
            if here.abs() < 1e-12 {
                return angle;
            }
            let slope =
                (misfit(angle + DIFFERENCE) - misfit(angle - DIFFERENCE)) / (2.0 * DIFFERENCE);
            angle -= here / slope;
        }
        panic!("the planar equilibrium was not found");
    }

    /// Determinant of α at the clamp over α at the free end.
    fn criterion(&self, weight: f64, guess: f64) -> f64 {
        let angle = self.free_angle(weight, guess);
        let [_, _, a, b, _, _, c, d, _, _] = self.at_clamp(weight, angle);
        a * d - b * c
    }

    /// Angle θ, moment M, and for each of two unit rotations of the free end α₁, α₃, β₁, β₃.
    fn at_clamp(&self, weight: f64, free: f64) -> [f64; 10] {
        let [bending, across, twisting] = self.stiffness;
        let slope = |s: f64, state: &[f64; 10]| {
            let [angle, moment, ..] = *state;
            let (sin, cos) = libm::sincos(angle);
            let [normal, axial] = [weight * s * cos, weight * s * sin];
            let curvature = self.natural_curvature + moment / bending;
            let mut rates = [0.0; 10];
            rates[0] = curvature;
            rates[1] = -normal;
            for first in [2, 6] {
                let [a1, a3, b1, b3] = std::array::from_fn(|k| state[first + k]);
                rates[first] = b1 - curvature * a3;
                rates[first + 1] = b3 + curvature * a1;
                let couple = (moment - curvature * twisting) * b3;
                rates[first + 2] = (couple + axial * a1 - normal * a3) / across;
                rates[first + 3] = (curvature * across - moment) * b1 / twisting;
            }
            rates
        };
        let start = [free, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
        let states = runge_kutta(0.0, 1.0, start, STEPS, slope);
        states[states.len() - 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Greenhill's column and Prandtl's strip, for which there are closed forms.
    #[test]
    fn straight_rods_buckle_at_the_known_weights() {
        let critical = |clamp, bending| {
            let rod = HangingRod {
                stiffness: [bending, 1.0, 1.0],
                natural_curvature: 0.0,
                clamp,
            };
            rod.critical_weights::<1>(0.5)[0]
        };
        // From the top down, and from the right to the left.
        assert!((critical(-FRAC_PI_2, 1e3) - 7.83735).abs() < 1e-5);
        assert!((critical(PI, 1e6) - 12.8538).abs() < 1e-3);
    }
}
