//! Resistive force theory: drag by local coefficients along and across the rod.
//!
//! A rod with unit tangent t that moves at velocity v through fluid at rest is subject to the
//! force per length f = −ξ_∥ (v·t) t − ξ_⊥ (v − (v·t) t) = −Ξ v. The theory neglects the flow that
//! one part of a rod causes at another, so it is a rough model for coiled or neighbouring rods.

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
    /// [`FluidError::NotSlender`] if the first denominator is not positive (L/h ≤ 2.24).
    pub fn slender_cylinder(viscosity: f64, length: f64, radius: f64) -> Result<Self, FluidError> {
        let logarithm = libm::log(2.0 * length / radius);
        Self::from_denominators(viscosity, length / radius, logarithm - 1.5, logarithm - 0.5)
    }

    /// A wavy filament (Gray and Hancock 1955): ξ_∥ = 2πη/(ln(2λ/h) − 1/2), ξ_⊥ = 4πη/(ln(2λ/h) + 1/2)
    /// with the wavelength λ.
    ///
    /// # Errors
    /// [`FluidError::NotSlender`] if the first denominator is not positive (λ/h ≤ 0.82).
    pub fn gray_hancock(viscosity: f64, wavelength: f64, radius: f64) -> Result<Self, FluidError> {
        let logarithm = libm::log(2.0 * wavelength / radius);
        Self::from_denominators(
            viscosity,
            wavelength / radius,
            logarithm - 0.5,
            logarithm + 0.5,
        )
    }

    /// A helical filament (Lighthill 1976): ξ_∥ = 2πη/ln(0.18 Λ/h), ξ_⊥ = 4πη/(ln(0.18 Λ/h) + 1/2)
    /// with the contour length Λ of one turn.
    ///
    /// # Errors
    /// [`FluidError::NotSlender`] if the first denominator is not positive (Λ/h ≤ 5.56).
    pub fn lighthill(
        viscosity: f64,
        length_of_a_turn: f64,
        radius: f64,
    ) -> Result<Self, FluidError> {
        let logarithm = libm::log(0.18 * length_of_a_turn / radius);
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
        if along <= 0.0 || along.is_nan() {
            return Err(FluidError::NotSlender(slenderness));
        }
        Ok(Self {
            along: 2.0 * PI * viscosity / along,
            across: 4.0 * PI * viscosity / across,
        })
    }

    /// Ξ = ξ_⊥ (1 − t tᵀ) + ξ_∥ t tᵀ for a unit tangent, N s/m².
    pub(crate) fn resistance_per_length(&self, tangent: &Vector3) -> Matrix3 {
        Matrix3::identity() * self.across
            + tangent * tangent.transpose() * (self.along - self.across)
    }
}

/// Coefficients of the edges of a filament in a chain of a length, m. `radii` are those of the
/// edges, m; if it is empty, all have that of the filament.
struct EdgeCoefficients<'a> {
    viscosity: f64,
    length: f64,
    radii: &'a [f64],
    uniform: Option<DragCoefficients>,
}

impl<'a> EdgeCoefficients<'a> {
    fn new(
        viscosity: f64,
        length: f64,
        filament: &Filament,
        radii: &'a [f64],
    ) -> Result<Self, FluidError> {
        let of_filament = || DragCoefficients::slender_cylinder(viscosity, length, filament.radius);
        Ok(Self {
            viscosity,
            length,
            radii,
            uniform: radii.is_empty().then(of_filament).transpose()?,
        })
    }

    fn of_edge(&self, edge: usize) -> Result<DragCoefficients, FluidError> {
        match self.uniform {
            Some(uniform) => Ok(uniform),
            None => {
                DragCoefficients::slender_cylinder(self.viscosity, self.length, self.radii[edge])
            }
        }
    }
}

/// Computes the force on each node (N) and its resistance (N s/m) for the coefficients of
/// [`DragCoefficients::slender_cylinder`] with these contour lengths of the filaments, m, and the
/// radius of each edge, if `radii` has an entry for every edge of a filament: every edge gives half of its length times Ξ to either node. As the force is −D v, the resistance is
/// its exact Jacobian.
pub(super) fn drag(
    viscosity: f64,
    (filaments, radii): (&[Filament], &[Vec<f64>]),
    lengths: &[f64],
    positions: &[Vector3],
    velocities: &[Vector3],
    forces: &mut [Vector3],
    resistance: &mut [Matrix3],
) -> Result<(), FluidError> {
    for ((filament, radii), &length) in filaments.iter().zip(radii).zip(lengths) {
        let first = filament.first_node;
        let edge = |i: usize| positions[first + (i + 1) % filament.nodes] - positions[first + i];
        let coefficients = EdgeCoefficients::new(viscosity, length, filament, radii)?;
        for i in 0..filament.edges() {
            let edge = edge(i);
            let length = edge.norm();
            if length == 0.0 {
                return Err(FluidError::Singular);
            }
            let own = coefficients.of_edge(i)?;
            let half = own.resistance_per_length(&(edge / length)) * (0.5 * length);
            for node in [first + i, first + (i + 1) % filament.nodes] {
                resistance[node] += half;
                forces[node] -= half * velocities[node];
            }
        }
    }
    Ok(())
}

/// Adds the derivatives of the power Σ λ·D v of the resistance D of [`drag`], in a motion λ of the
/// nodes, with respect to their positions. `chains` are the first filaments of the chains that have
/// these `lengths`; nodes that are not `wet` have no drag.
///
/// An edge e = l t contributes ½ (ξ_⊥ l λ·v + (ξ_∥ − ξ_⊥) (λ·e)(e·v)/l) at either node. The
/// coefficients depend on the length L of the chain: dξ_∥/dL = −ξ_∥²/2πηL, dξ_⊥/dL = −ξ_⊥²/4πηL.
///
/// # Errors
/// As [`drag`].
pub(super) fn add_power_gradient(
    viscosity: f64,
    (filaments, radii): (&[Filament], &[Vec<f64>]),
    (lengths, chains): (&[f64], &[usize]),
    wet: &dyn Fn(usize) -> bool,
    positions: &[Vector3],
    [velocities, motion]: [&[Vector3]; 2],
    gradient: &mut [Vector3],
) -> Result<(), FluidError> {
    let mut over_length = vec![0.0; filaments.len()];
    let ends = |filament: &Filament, i: usize| {
        [i, i + 1].map(|node| filament.first_node + node % filament.nodes)
    };
    for (number, filament) in filaments.iter().enumerate() {
        let length = lengths[number];
        let coefficients = EdgeCoefficients::new(viscosity, length, filament, &radii[number])?;
        for i in 0..filament.edges() {
            let own = coefficients.of_edge(i)?;
            let slopes = DragCoefficients {
                along: -own.along * own.along / (2.0 * PI * viscosity * length),
                across: -own.across * own.across / (4.0 * PI * viscosity * length),
            };
            let [start, end] = ends(filament, i);
            let edge = positions[end] - positions[start];
            let (size, tangent) = (edge.norm(), edge.normalize());
            for node in [start, end].into_iter().filter(|node| wet(*node)) {
                let (v, l) = (velocities[node], motion[node]);
                let [along_v, along_l] = [v, l].map(|vector| tangent.dot(&vector));
                let turning = l * along_v + v * along_l - tangent * (along_l * along_v);
                let anisotropy = own.along - own.across;
                let over = (tangent * (own.across * l.dot(&v)) + turning * anisotropy) * 0.5;
                gradient[end] += over;
                gradient[start] -= over;
                let per_length = slopes.resistance_per_length(&tangent);
                over_length[chains[number]] += 0.5 * size * l.dot(&(per_length * v));
            }
        }
    }
    for (filament, chain) in filaments.iter().zip(chains) {
        for i in 0..filament.edges() {
            let [start, end] = ends(filament, i);
            let over = (positions[end] - positions[start]).normalize() * over_length[*chain];
            gradient[end] += over;
            gradient[start] -= over;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Force along and torque about the axis, exerted on the fluid by the thesis' helix turning at
    /// 15 rad/s, in closed form: a 0.01 m, pitch 0.05 m, axial length 0.2 m.
    fn turning_helix(coefficients: DragCoefficients) -> (f64, f64) {
        let (radius, wavenumber, axial, rate) = (0.01, 2.0 * PI / 0.05, 0.2, 15.0);
        let slope: f64 = radius * wavenumber;
        let stretch = (1.0 + slope * slope).sqrt();
        let tangent = Vector3::new(0.0, slope, 1.0) / stretch;
        let velocity = Vector3::new(0.0, rate * radius, 0.0);
        let force = coefficients.resistance_per_length(&tangent) * velocity * (axial * stretch);
        (force.z, force.y * radius)
    }

    #[test]
    fn a_turning_helix_agrees_with_published_coefficients() {
        // Values computed independently for λ = 0.05 m and Λ = 0.0803 m, h = 1 mm, η = 0.1 Pa s.
        let slope = 0.4 * PI;
        let turn = 0.05 * (1.0 + slope * slope).sqrt();
        let gray_hancock = DragCoefficients::gray_hancock(0.1, 0.05, 1e-3).unwrap();
        let lighthill = DragCoefficients::lighthill(0.1, turn, 1e-3).unwrap();
        for (coefficients, force, torque) in [
            (gray_hancock, -0.002185334003, 9.113101541e-5),
            (lighthill, -0.003780665739, 0.000143422717),
        ] {
            let (got_force, got_torque) = turning_helix(coefficients);
            assert!((got_force / force - 1.0).abs() < 1e-8, "{got_force}");
            assert!((got_torque / torque - 1.0).abs() < 1e-8, "{got_torque}");
        }
    }

    #[test]
    fn a_straight_rod_feels_the_force_of_a_slender_cylinder() {
        // 2πηL/(ln(2L/h) − 3/2) and 4πηL/(ln(2L/h) − 1/2) with L/h = 100, η = 1 Pa s, L = 1 m.
        let positions: Vec<_> = (0..11).map(|i| Vector3::x() * (0.1 * i as f64)).collect();
        let filament = Filament {
            first_node: 0,
            nodes: 11,
            closed: false,
            radius: 0.01,
        };
        for (velocity, expected) in [(Vector3::x(), 1.654202296), (Vector3::y(), 2.618911934)] {
            let mut forces = vec![Vector3::zeros(); 11];
            let mut resistance = vec![Matrix3::zeros(); 11];
            drag(
                1.0,
                (&[filament], &[Vec::new()]),
                &[1.0],
                &positions,
                &[velocity; 11],
                &mut forces,
                &mut resistance,
            )
            .unwrap();
            let force: Vector3 = forces.iter().sum();
            assert!((force.dot(&velocity) / -expected - 1.0).abs() < 1e-8);
            for (force, resistance) in forces.iter().zip(&resistance) {
                assert!((force + resistance * velocity).norm() < 1e-14);
            }
        }
    }

    #[test]
    fn stout_rods_are_refused() {
        let stout = DragCoefficients::slender_cylinder(0.1, 2.0, 1.0);
        assert_eq!(stout, Err(FluidError::NotSlender(2.0)));
        assert!(DragCoefficients::slender_cylinder(0.1, f64::NAN, 1.0).is_err());
    }
}
