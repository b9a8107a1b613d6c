//! Bodies other than rods in the fluid of a scene.

use super::Assembly;
use crate::mechanics::fluid::{FluidModel, Sphere};
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::topology::position;
use crate::mechanics::scene::Scene;
use std::f64::consts::PI;

impl Assembly {
    /// Spheres that rods carry at their nodes.
    pub(crate) fn spheres(&self) -> Vec<Sphere> {
        let frames = self.joints.frames.iter();
        let spheres = frames.filter_map(|frame| {
            let ((centre, radius), (first_tip, _)) = (frame.ball?, frame.body?);
            Some(Sphere {
                centre,
                radius,
                first_tip: first_tip / STRIDE,
                arm: frame.length,
            })
        });
        spheres.collect()
    }

    /// Resistance of the fluid to the spin of edges about their axes: a coefficient for each
    /// unknown, N m s, from the torque 4πη r² ω per length of a long cylinder. A half edge inside
    /// a sphere at its end turns with the sphere and adds none.
    pub(crate) fn spin_resistance(&self, scene: &Scene) -> Option<Vec<f64>> {
        let viscosity = match scene.fluid {
            Some(
                FluidModel::RegularizedStokeslets { viscosity, .. }
                | FluidModel::Resistive { viscosity },
            ) if scene.spin_drag => viscosity,
            _ => return None,
        };
        let spheres = self.spheres();
        let is_outside = |node: usize| {
            let x = position(&self.unknowns, node);
            !spheres
                .iter()
                .any(|sphere| sphere.contains(&(x - position(&self.unknowns, sphere.centre))))
        };
        let mut coefficients = vec![0.0; STRIDE * self.rods.nodes];
        for edge in &self.rods.edges {
            let (index, along) = self.locate(edge.start);
            let rod = &scene.rods[index];
            if rod.held {
                continue;
            }
            let radius = rod.section(along).radius;
            let ends = [edge.start, edge.end].into_iter();
            let wet = 0.5 * ends.filter(|&node| is_outside(node)).count() as f64;
            coefficients[STRIDE * edge.start + 3] =
                4.0 * PI * viscosity * radius * radius * edge.natural_length * wet;
        }
        Some(coefficients)
    }
}
