//! Elasticity of rods as a term: gradient and Hessian of [`crate::mechanics::rod`], in one sweep
//! if both are needed.

use super::build::Assembly;
use super::newton_matrix::Entries;
use super::term::{Configuration, Kind, Term};
use crate::linalg::Element;
use crate::mechanics::SceneError;
use crate::mechanics::rod::{ElasticEnergy, RodGeometry};
use crate::mechanics::scene::Scene;

/// Stretching, bending and twisting.
pub(crate) struct Elasticity;

impl Term for Elasticity {
    fn new(_: &Scene, _: &mut Assembly) -> Result<Self, SceneError> {
        Ok(Self)
    }

    fn kind(&self) -> Kind {
        Kind::Elastic
    }

    fn has_copies(&self) -> bool {
        true
    }

    /// Closing vertices of rings and half vertices at joints.
    fn elements(&self, assembly: &Assembly) -> Vec<Element> {
        assembly.joints.elements(&assembly.rods.elements)
    }

    fn energy(&self, assembly: &Assembly, geometry: &RodGeometry) -> ElasticEnergy {
        assembly.rods.energy(geometry)
    }

    fn add_forces(&self, at: &Configuration, residual: &mut [f64]) {
        at.assembly.rods.add_gradient(at.geometry, residual);
    }

    fn linearize(&mut self, at: &Configuration, residual: &mut [f64], entries: &mut Entries) {
        let matrix = entries.matrix();
        matrix.add_elastic(&at.assembly.rods, at.geometry, residual);
    }
}
