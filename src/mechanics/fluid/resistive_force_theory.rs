//! Resistive force theory: drag by local coefficients along and across the rod.
//!
//! A rod with unit tangent t that moves at velocity v through fluid at rest feels the force per length
//! f = −ξ_∥ (v·t) t − ξ_⊥ (v − (v·t) t) = −Ξ v. It neglects that one part of a rod drags fluid past
//! another, so that it is a rough model for coiled or neighbouring rods.

use super::{Filament, FluidError};
use crate::mechanics::{Matrix3, Vector3};
use std::f64::consts::PI;

/// Drag per length and velocity along and across a rod, N s/m².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DragCoefficients {
    /// ξ_∥.
    pub along: f64,
    /// ξ_⊥.
    pub across: f64,
}

impl DragCoefficients {
    /// A straight cylinder of given length and radius (Batchelor 1970, Eq. 8.10 and 8.12; Keller and
    /// Rubinow 1976): ξ_∥ = 2πη/(ln(2L/h) − 3/2), ξ_⊥ = 4πη/(ln(2L/h) − 1/2).
    ///
    /// # Errors
    /// [`FluidError::NotSlender`] where the first denominator is not positive (L/h ≤ 2.24).
    pub fn slender_cylinder(viscosity: f64, length: f64, radius: f64) -> Result<Self, FluidError> {
        let logarithm = (2.0 * length / radius).ln();
        Self::from_denominators(viscosity, length / radius, logarithm - 1.5, logarithm - 0.5)
    }

    /// A wavy filament (Gray and Hancock 1955): ξ_∥ = 2πη/(ln(2λ/h) − 1/2), ξ_⊥ = 4πη/(ln(2λ/h) + 1/2)
    /// with the wavelength λ.
    ///
    /// # Errors
    /// [`FluidError::NotSlender`] where the first denominator is not positive (λ/h ≤ 0.82).
    pub fn gray_hancock(viscosity: f64, wavelength: f64, radius: f64) -> Result<Self, FluidError> {
        let logarithm = (2.0 * wavelength / radius).ln();
        Self::from_denominators(
            viscosity,
            wavelength / radius,
            logarithm - 0.5,
            logarithm + 0.5,
        )
    }

    /// A helical filament (Lighthill 1976): ξ_∥ = 2πη/ln(0.18 Λ/h), ξ_⊥ = 4πη/(ln(0.18 Λ/h) + 1/2) with
    /// the length Λ of the filament in one turn.
    ///
    /// # Errors
    /// [`FluidError::NotSlender`] where the first denominator is not positive (Λ/h ≤ 5.56).
    pub fn lighthill(
        viscosity: f64,
        length_of_a_turn: f64,
        radius: f64,
    ) -> Result<Self, FluidError> {
        let logarithm = (0.18 * length_of_a_turn / radius).ln();
        Self::from_denominators(
            viscosity,
            length_of_a_turn / radius,
            logarithm,
            logarithm + 0.5,
        )
    }

    fn from_denominators(
        viscosity: f64,
        slenderness: f64,
        along: f64,
        across: f64,
    ) -> Result<Self, FluidError> {
        // Written so that a NaN counts as not slender.
        if !(along > 0.0) {
            return Err(FluidError::NotSlender(slenderness));
        }
        Ok(Self {
            along: 2.0 * PI * viscosity / along,
            across: 4.0 * PI * viscosity / across,
        })
    }

    /// Ξ = ξ_⊥ (1 − t tᵀ) + ξ_∥ t tᵀ for a unit tangent, N s/m².
    pub fn resistance_per_length(&self, tangent: &Vector3) -> Matrix3 {
        Matrix3::identity() * self.across
            + tangent * tangent.transpose() * (self.along - self.across)
    }
}

/// Force on each node (N) and its resistance (N s/m) for the coefficients of
/// [`DragCoefficients::slender_cylinder`] with each filament's contour length: every edge gives half of
/// its length times Ξ to either node. As the force is −D v, the resistance is its exact Jacobian.
pub(super) fn drag(
    viscosity: f64,
    filaments: &[Filament],
    positions: &[Vector3],
    velocities: &[Vector3],
    forces: &mut [Vector3],
    resistance: &mut [Matrix3],
) -> Result<(), FluidError> {
    for filament in filaments {
        let first = filament.first_node;
        let edge = |i: usize| positions[first + (i + 1) % filament.nodes] - positions[first + i];
        let length: f64 = (0..filament.edges()).map(|i| edge(i).norm()).sum();
        let coefficients = DragCoefficients::slender_cylinder(viscosity, length, filament.radius)?;
        for i in 0..filament.edges() {
            let edge = edge(i);
            let length = edge.norm();
            if length == 0.0 {
                return Err(FluidError::Singular);
            }
            let half = coefficients.resistance_per_length(&(edge / length)) * (0.5 * length);
            for node in [first + i, first + (i + 1) % filament.nodes] {
                resistance[node] += half;
                forces[node] -= half * velocities[node];
            }
        }
    }
    Ok(())
}
