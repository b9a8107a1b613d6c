//! Planar cantilevers that bend far: the elastica under its own weight or a load at its tip.

use super::numerics::{bisect, runge_kutta};
use std::f64::consts::FRAC_PI_2;

/// Steps of the integration; at γ = 100 the error of the tip is below 1e-11.
const STEPS: usize = 4000;

/// What bends the cantilever down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CantileverLoad {
    /// Its weight per length w: γ = w L³/EI.
    OwnWeight(f64),
    /// A force F at its tip: α = F L²/EI.
    TipForce(f64),
}

/// The shape of a horizontal cantilever of unit length.
#[derive(Clone, Debug)]
pub struct Cantilever {
    /// Equally spaced points from root to tip: x along the root's tangent, y downwards, θ below the
    /// horizontal, κ = θ'.
    points: Vec<[f64; 4]>,
}

impl Cantilever {
    /// Solves θ'' = −q(s) cos θ, θ(0) = 0, θ'(1) = 0, with the transverse load that acts beyond s,
    /// q = γ (1 − s) or q = α (Bisshopp & Drucker 1945), by shooting from the tip.
    pub fn new(load: CantileverLoad) -> Self {
        let load_beyond = |s: f64| match load {
            CantileverLoad::OwnWeight(gamma) => gamma * (1.0 - s),
            CantileverLoad::TipForce(alpha) => alpha,
        };
        let shoot = |tip_angle: f64| {
            runge_kutta(
                1.0,
                0.0,
                [0.0, 0.0, tip_angle, 0.0],
                STEPS,
                |s, &[_, _, theta, curvature]| {
                    let (sin, cos) = libm::sincos(theta);
                    [cos, sin, curvature, -load_beyond(s) * cos]
                },
            )
        };
        // A horizontal tip means a root that points upwards, a vertical tip a vertical root.
        let tip_angle = bisect(0.0, FRAC_PI_2, |tip| shoot(tip)[STEPS][2]);
        let mut points = shoot(tip_angle);
        points.reverse();
        let [x, y, ..] = points[0];
        for point in &mut points {
            point[0] -= x;
            point[1] -= y;
        }
        Self { points }
    }

    /// Position [x, y] at arc length s between 0 and 1, y downwards; s is rounded to the grid of 1/4000.
    pub fn position(&self, s: f64) -> [f64; 2] {
        let [x, y, ..] = self.points[(s * STEPS as f64).round() as usize];
        [x, y]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::kirchhoff::numerics::gauss_legendre;

    #[test]
    fn a_tip_load_satisfies_the_first_integral() {
        for alpha in [1.0, 2.0, 5.0, 10.0] {
            let shape = Cantilever::new(CantileverLoad::TipForce(alpha));
            let ([_, _, tip, _], root) = (shape.points[STEPS], shape.points[0][3]);
            // θ'²/2 = α (sin θ_tip − sin θ), so the length is an integral over the angle; with
            // sin θ = sin θ_tip (1 − u²) its root at the tip is lifted.
            assert!((root * root - 2.0 * alpha * tip.sin()).abs() < 1e-9);
            let length: f64 = gauss_legendre(60)
                .iter()
                .map(|(u, weight)| {
                    let sine = tip.sin() * (1.0 - u * u);
                    weight * 2.0 * (tip.sin() / (2.0 * alpha * (1.0 - sine * sine))).sqrt()
                })
                .sum();
            assert!((length - 1.0).abs() < 1e-9, "{alpha} {length}");
        }
    }

    #[test]
    fn a_light_beam_sags_as_linear_theory_says() {
        let drop = Cantilever::new(CantileverLoad::OwnWeight(1e-3)).position(1.0)[1];
        assert!((drop / (1e-3 / 8.0) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn tips_agree_with_the_reference_solutions() {
        let folder = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../..",
            "/../shared/reference/beams/"
        );
        type Load = fn(f64) -> CantileverLoad;
        for (file, load) in [
            (
                "heavy_cantilever_tip.csv",
                CantileverLoad::OwnWeight as Load,
            ),
            ("tip_load_cantilever.csv", CantileverLoad::TipForce as Load),
        ] {
            let Ok(text) = std::fs::read_to_string(format!("{folder}{file}")) else {
                println!("skipped: {file} is not here");
                return;
            };
            let rows = text.lines().filter_map(|line| {
                let row: Result<Vec<f64>, _> = line.split(',').map(str::parse).collect();
                row.ok()
            });
            let mut count = 0;
            for row in rows.filter(|row| row[0] <= 100.0) {
                let tip = Cantilever::new(load(row[0])).position(1.0);
                assert!((tip[0] - row[1]).abs() < 1e-9 && (tip[1] - row[2]).abs() < 1e-9);
                count += 1;
            }
            assert!(count > 5);
        }
    }
}
