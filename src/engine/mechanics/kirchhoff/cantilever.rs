//! Planar cantilevers with large deflection: the elastica under its own weight or a load at its
//! tip.

use super::elastica::{Elastica, Forces, Place, State};
use super::numerics::bisect;
use std::f64::consts::FRAC_PI_2;

/// Load of the cantilever.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CantileverLoad {
    /// Weight per length w: γ = w L³/EI.
    OwnWeight(f64),
    /// Force F at the tip: α = F L²/EI.
    TipForce(f64),
}

/// The shape of a horizontal cantilever of unit length, from the tip on: x towards the tip, z and θ downwards.
#[derive(Clone, Debug)]
pub struct Cantilever {
    elastica: Elastica,
    tip: Place,
    root: State,
}

impl Cantilever {
    /// Solves θ'' = −q cos θ, θ'(tip) = 0, θ(root) = 0 by shooting from the tip, with the
    /// transverse load q that acts between the tip and a point at the distance s from it, q = γ s
    /// or q = α (Bisshopp & Drucker 1945).
    pub fn new(load: CantileverLoad) -> Self {
        let (vertical, load) = match load {
            CantileverLoad::OwnWeight(gamma) => (0.0, gamma),
            CantileverLoad::TipForce(alpha) => (alpha, 0.0),
        };
        let forces = Forces {
            horizontal: 0.0,
            vertical,
        };
        let elastica = Elastica { forces, load };
        let tip = |angle: f64| Place {
            state: State {
                angle,
                ..State::default()
            },
            ..Place::default()
        };
        let root = |angle: f64| elastica.place_from(tip(angle), 1.0).state;
        // A horizontal tip corresponds to a root that points upwards, a vertical tip to a vertical
        // root.
        let angle = bisect(0.0, FRAC_PI_2, |angle| root(angle).angle);
        Self {
            elastica,
            tip: tip(angle),
            root: root(angle),
        }
    }

    /// Position [x, y] at arc length s between 0 and 1 from the root on, y downwards.
    pub fn position(&self, s: f64) -> [f64; 2] {
        let here = self.elastica.place_from(self.tip, 1.0 - s).state;
        [self.root.x - here.x, self.root.z - here.z]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::kirchhoff::numerics::gauss_legendre;
    use crate::mechanics::test_support::reference_rows;

    #[test]
    fn a_tip_load_satisfies_the_first_integral() {
        for alpha in [1.0, 2.0, 5.0, 10.0] {
            let shape = Cantilever::new(CantileverLoad::TipForce(alpha));
            let (tip, root) = (shape.tip.state.angle, shape.root.curvature);
            // θ'²/2 = α (sin θ_tip − sin θ), so the length is an integral over the angle; the
            // substitution sin θ = sin θ_tip (1 − u²) removes the square-root singularity at the
            // tip.
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
        type Load = fn(f64) -> CantileverLoad;
        for (file, load) in [
            (
                "beams/heavy_cantilever_tip.csv",
                CantileverLoad::OwnWeight as Load,
            ),
            (
                "beams/tip_load_cantilever.csv",
                CantileverLoad::TipForce as Load,
            ),
        ] {
            let Some(rows) = reference_rows(file) else {
                return;
            };
            let mut count = 0;
            for row in rows.iter().filter(|row| row[0] <= 100.0) {
                let tip = Cantilever::new(load(row[0])).position(1.0);
                assert!((tip[0] - row[1]).abs() < 1e-9 && (tip[1] - row[2]).abs() < 1e-9);
                count += 1;
            }
            assert!(count > 5);
        }
    }
}
