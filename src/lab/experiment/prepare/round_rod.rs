//! The round rods built by kinds of experiments.

use crate::scenario::{BuilderRod, CrossSection, Material};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{Relaxation, RodDescription, Stiffness};

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
