//! The round rods built by kinds of experiments.

use crate::scenario::{BuilderRod, CrossSection, Material};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{
    Relaxation, RodDescription, Stiffness, Yielding, YieldingMaterial,
};

/// A round, naturally straight rod of a material along a polyline, at rest.
pub fn round_rod(
    name: &str,
    centreline: Vec<Vector3>,
    material: &Material,
    rod: &BuilderRod,
) -> RodDescription {
    let section = CrossSection::Circle;
    let stiffness = section.stiffness(rod.radius, material);
    let [second_moment_1, second_moment_2] = section.second_moments(rod.radius);
    let stiffness = Stiffness {
        stretching: stiffness.stretching,
        bending: [stiffness.bending_1, stiffness.bending_2],
        twisting: stiffness.twisting,
    };
    let mass_per_length = material.density * section.area(rod.radius);
    RodDescription {
        rotational_inertia_per_length: material.density * (second_moment_1 + second_moment_2),
        retardation_time: material.retardation_time(),
        relaxation: relaxation(material),
        yielding: yielding(&section, rod.radius, material),
        ..RodDescription::uniform(name, centreline, stiffness, rod.radius, mass_per_length)
    }
}

/// Relaxing part of the stiffness of a material, if any.
pub fn relaxation(material: &Material) -> Option<Relaxation> {
    (material.relaxing_modulus > 0.0).then(|| Relaxation {
        ratio: material.relaxing_modulus / material.youngs_modulus,
        time: material.relaxation_time,
    })
}

/// Plastic law of a section of a material that yields; `None` if it does not.
pub fn yielding(section: &CrossSection, radius: f64, material: &Material) -> Option<Yielding> {
    let yielding = YieldingMaterial {
        youngs_modulus: material.youngs_modulus,
        poissons_ratio: material.poissons_ratio,
        yield_stress: material.yield_stress,
        tangent_modulus: material.tangent_modulus,
    };
    (material.yield_stress > 0.0).then(|| match *section {
        CrossSection::Circle => yielding.round([radius, 0.0]),
        CrossSection::Tube { wall } => yielding.round([radius, radius - wall]),
        CrossSection::Rectangle { width, thickness } => yielding.rectangle(width, thickness),
    })
}
