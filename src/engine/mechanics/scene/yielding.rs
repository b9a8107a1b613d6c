//! Sections that yield: elastic–plastic bending and twisting.
//!
//! A material with Young's modulus E yields at the stress σ_y and hardens with the tangent modulus
//! E_t. It is the elastic modulus E_t beside a perfectly plastic fibre of the modulus E − E_t, which
//! yields at the strain σ_y/E (linear kinematic hardening). In the bending of a section with the
//! curvature κ the fibres at the distance y from the neutral axis have the strain κy. All fibres in
//! a band of distances make up a *layer*. With a perfectly plastic fibre it has
//!
//! ```text
//! stiffness     k = (E − E_t) ∫ y² dA
//! yield moment  m = σ_y (1 − E_t/E) ∫ |y| dA,     yield curvature  m/k
//! ```
//!
//! and the moment of the section is the sum over its layers, M = E_t I κ + Σ k (κ − κ_p), with the
//! plastic curvature κ_p of each layer. Sums over layers give the elastic stiffness E I and the full
//! plastic moment σ_y ∫ |y| dA exactly; between them the moment is that of a polygon with
//! 32 corners. A section whose load is removed keeps a curvature, and it unloads and yields
//! backwards at twice the strain, as Masing's rule requires.
//!
//! The same holds for the twist of a round section with the rings at the distance r from its
//! axis, the shear modulus G, and the yield stress σ_y/√3 of von Mises.
//!
//! A round section bends in any direction: the curvature and moment of a layer are vectors, and a
//! layer yields where the length of its moment is m. (This is exact if the direction is fixed.)
//! The sides of a rectangle yield independently of each other, and so do bending and twist. Stretching
//! does not yield.

use std::f64::consts::PI;

/// Number of layers of a section in bending, and in twisting.
const BANDS: usize = 32;
/// √3.
const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// Fibres of a section that yield together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Stiffness relative to that of the section.
    pub share: f64,
    /// Curvature or twist per length at which the fibres yield, rad/m.
    pub limit: f64,
}

/// How a section bends plastically.
#[derive(Clone, Debug, PartialEq)]
pub enum PlasticBending {
    /// In all directions alike.
    Round(Vec<Layer>),
    /// About m₁ and about m₂, independently of each other.
    AboutDirectors([Vec<Layer>; 2]),
}

/// Plastic law of a section.
#[derive(Clone, Debug, PartialEq)]
pub struct Yielding {
    /// In bending.
    pub bending: PlasticBending,
    /// In twisting; empty if twist is elastic.
    pub twisting: Vec<Layer>,
}

/// A material that yields.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct YieldingMaterial {
    /// Young's modulus E, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio ν.
    pub poissons_ratio: f64,
    /// Yield stress σ_y, Pa.
    pub yield_stress: f64,
    /// Tangent modulus E_t beyond it, Pa, less than E.
    pub tangent_modulus: f64,
}

impl YieldingMaterial {
    /// Law of a round section with an outer and an inner radius, m; the latter is 0 unless the section is hollow.
    pub fn round(&self, [outer, inner]: [f64; 2]) -> Yielding {
        let hollow = |integral: &dyn Fn(f64, f64) -> f64, y: f64| {
            integral(outer, y.min(outer)) - integral(inner, y.min(inner))
        };
        let bending = self.layers(
            self.yield_stress / self.youngs_modulus,
            bands(0.0, outer),
            |y| [hollow(&first_moment, y), hollow(&second_moment, y)],
        );
        let shear_modulus = 0.5 * self.youngs_modulus / (1.0 + self.poissons_ratio);
        let twisting = self.layers(
            self.yield_stress / (SQRT_3 * shear_modulus),
            bands(inner, outer),
            |r| [2.0 / 3.0 * PI * r * r * r, 0.5 * PI * r * r * r * r],
        );
        Yielding {
            bending: PlasticBending::Round(bending),
            twisting,
        }
    }

    /// Law of a rectangle whose sides along m₁ and m₂ are `width` and `thickness`, m. Its twist is
    /// elastic.
    pub fn rectangle(&self, width: f64, thickness: f64) -> Yielding {
        let of_side = |side: f64| {
            let strain = self.yield_stress / self.youngs_modulus;
            self.layers(strain, bands(0.0, 0.5 * side), |y| {
                [0.5 * y * y, y * y * y / 3.0]
            })
        };
        Yielding {
            bending: PlasticBending::AboutDirectors([of_side(thickness), of_side(width)]),
            twisting: Vec::new(),
        }
    }

    /// Layers between distances at which `integrals` returns ∫ |y| dA and ∫ y² dA from zero, for fibres that
    /// yield at a strain.
    fn layers(
        &self,
        strain: f64,
        distances: impl Iterator<Item = f64>,
        integrals: impl Fn(f64) -> [f64; 2],
    ) -> Vec<Layer> {
        let integrals: Vec<_> = distances.map(integrals).collect();
        let [first, last] = [integrals[0], integrals[integrals.len() - 1]];
        let plastic = 1.0 - self.tangent_modulus / self.youngs_modulus;
        let layers = integrals.windows(2).map(|ends| {
            let [moment, stiffness] = [0, 1].map(|k| ends[1][k] - ends[0][k]);
            Layer {
                share: plastic * stiffness / (last[1] - first[1]),
                limit: strain * moment / stiffness,
            }
        });
        layers.collect()
    }
}

/// Ends of the bands between two distances.
fn bands(from: f64, to: f64) -> impl Iterator<Item = f64> {
    (0..=BANDS).map(move |k| from + (to - from) * k as f64 / BANDS as f64)
}

/// ∫ |y| dA of a circle between the distances −y and y from a diameter, m³.
fn first_moment(radius: f64, y: f64) -> f64 {
    let square = radius * radius;
    4.0 / 3.0 * (square * radius - libm::pow((square - y * y).max(0.0), 1.5))
}

/// ∫ y² dA of a circle between the distances −y and y from a diameter, m⁴.
fn second_moment(radius: f64, y: f64) -> f64 {
    if radius == 0.0 {
        return 0.0;
    }
    let square = radius * radius;
    let root = (square - y * y).max(0.0).sqrt();
    let angle = libm::asin((y / radius).min(1.0));
    0.5 * (y * (2.0 * y * y - square) * root + square * square * angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::test_support::assert_close;

    const STEEL: YieldingMaterial = YieldingMaterial {
        youngs_modulus: 200e9,
        poissons_ratio: 0.3,
        yield_stress: 400e6,
        tangent_modulus: 0.0,
    };

    /// Moment or torque over the stiffness at a curvature or twist that grew from zero.
    fn strain_carried(layers: &[Layer], strain: f64) -> f64 {
        let elastic = 1.0 - layers.iter().map(|layer| layer.share).sum::<f64>();
        let yielding = layers
            .iter()
            .map(|layer| layer.share * strain.min(layer.limit));
        elastic * strain + yielding.sum::<f64>()
    }

    fn round(radii: [f64; 2]) -> (Vec<Layer>, Vec<Layer>) {
        let law = STEEL.round(radii);
        match law.bending {
            PlasticBending::Round(bending) => (bending, law.twisting),
            PlasticBending::AboutDirectors(_) => panic!("a round section"),
        }
    }

    #[test]
    fn layers_make_up_the_elastic_stiffness_and_the_plastic_moment() {
        for radii in [[1e-3, 0.0], [1e-3, 0.6e-3]] {
            let [outer, inner] = radii;
            let (bending, twisting) = round(radii);
            for layers in [&bending, &twisting] {
                assert_close(strain_carried(layers, 1e-6), 1e-6, 1e-12);
            }
            let inertia = 0.25 * PI * (outer.powi(4) - inner.powi(4));
            let moment = STEEL.youngs_modulus * inertia * strain_carried(&bending, 1e9);
            let cubes = outer.powi(3) - inner.powi(3);
            assert_close(moment, STEEL.yield_stress * 4.0 / 3.0 * cubes, 1e-12);
            let shear_modulus = 0.5 * STEEL.youngs_modulus / 1.3;
            let torque = shear_modulus * 2.0 * inertia * strain_carried(&twisting, 1e9);
            let full = STEEL.yield_stress / SQRT_3 * 2.0 / 3.0 * PI * cubes;
            assert_close(torque, full, 1e-12);
        }
    }

    /// A rectangle: M = M_y (3 − (κ_y/κ)²)/2. A circle in torsion: T = T_y (4 − (τ_y/τ)³)/3.
    #[test]
    fn moments_between_are_those_of_closed_forms_within_a_percent() {
        let law = STEEL.rectangle(8e-3, 1e-3);
        let PlasticBending::AboutDirectors([about_1, about_2]) = law.bending else {
            panic!("a rectangle");
        };
        for (layers, side) in [(about_1, 1e-3), (about_2, 8e-3)] {
            let limit = STEEL.yield_stress / STEEL.youngs_modulus / (0.5 * side);
            for over in [1.1_f64, 1.3, 1.5, 2.0, 3.0, 5.0] {
                let exact = 0.5 * limit * (3.0 - over.powi(-2));
                assert_close(strain_carried(&layers, over * limit), exact, 0.01);
            }
        }
        let (_, twisting) = round([1e-3, 0.0]);
        let shear_modulus = 0.5 * STEEL.youngs_modulus / 1.3;
        let limit = STEEL.yield_stress / (SQRT_3 * shear_modulus * 1e-3);
        for over in [1.1_f64, 1.3, 1.5, 2.0, 3.0, 5.0] {
            let exact = limit * (4.0 - over.powi(-3)) / 3.0;
            assert_close(strain_carried(&twisting, over * limit), exact, 0.01);
        }
    }
}
