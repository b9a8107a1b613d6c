//! The fluid as the rods feel it: forces on nodes from their positions and velocities.

use super::report::FluidReport;
use super::stokeslet_drag::{StokesletDrag, StokesletMemory};
use super::{Filament, FluidError, FluidModel, resistive_force_theory};
use crate::mechanics::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Far-field errors that the expansions can keep. What they leave out of the regularised kernel and of the
/// segments' lengths is less than the smallest.
const FAR_FIELD_ERRORS: RangeInclusive<f64> = 1e-6..=1e-2;

/// A viscous fluid around filaments.
pub struct Fluid {
    filaments: Vec<Filament>,
    method: Method,
}

enum Method {
    Stokeslets(Box<StokesletDrag>),
    Resistive { viscosity: f64 },
}

/// Everything of a [`Fluid`] that influences its later results; what a checkpoint holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FluidMemory(Option<StokesletMemory>);

impl Fluid {
    /// A fluid around filaments, no two of which share a node.
    ///
    /// # Errors
    /// [`FluidError::BadInput`] for a viscosity, regularisation or radius that is not positive and finite,
    /// for a far-field error that is neither 0 nor from 10⁻⁶ to 10⁻²,
    /// for filaments of less than two nodes and for filaments that overlap.
    pub fn new(model: &FluidModel, filaments: &[Filament]) -> Result<Self, FluidError> {
        check(filaments)?;
        let method = match *model {
            FluidModel::RegularizedStokeslets {
                viscosity,
                regularization,
                far_field_error,
            } => {
                positive("viscosity", viscosity)?;
                positive("regularisation", regularization)?;
                if far_field_error != 0.0 && !FAR_FIELD_ERRORS.contains(&far_field_error) {
                    return Err(FluidError::BadInput(format!(
                        "the far-field error of the fluid must be 0 or from {:e} to {:e}, not {far_field_error:e}",
                        FAR_FIELD_ERRORS.start(),
                        FAR_FIELD_ERRORS.end(),
                    )));
                }
                let drag =
                    StokesletDrag::new(viscosity, regularization, far_field_error, filaments);
                Method::Stokeslets(Box::new(drag))
            }
            FluidModel::Resistive { viscosity } => {
                positive("viscosity", viscosity)?;
                Method::Resistive { viscosity }
            }
        };
        Ok(Self {
            filaments: filaments.to_vec(),
            method,
        })
    }

    /// Force of the fluid on every node (N) and its local resistance D (N s/m, symmetric positive
    /// definite): a change δv of the node's own velocity changes the force on it by about −D δv, for
    /// resistive force theory exactly.
    ///
    /// All slices have one entry per node of the scene, positions in m and velocities in m/s. Nodes
    /// outside all filaments get zero.
    ///
    /// # Errors
    /// See [`FluidError`]; `forces` and `resistance` then hold nothing of use, while the memory stays fit
    /// for another try.
    pub fn drag(
        &mut self,
        positions: &[Vector3],
        velocities: &[Vector3],
        forces: &mut [Vector3],
        resistance: &mut [Matrix3],
    ) -> Result<FluidReport, FluidError> {
        forces.fill(Vector3::zeros());
        resistance.fill(Matrix3::zeros());
        match &mut self.method {
            Method::Stokeslets(drag) => drag.drag(positions, velocities, forces, resistance),
            Method::Resistive { viscosity } => {
                resistive_force_theory::drag(
                    *viscosity,
                    &self.filaments,
                    positions,
                    velocities,
                    forces,
                    resistance,
                )?;
                Ok(FluidReport::default())
            }
        }
    }

    /// What a checkpoint must hold.
    pub fn memory(&self) -> FluidMemory {
        FluidMemory(match &self.method {
            Method::Stokeslets(drag) => Some(drag.memory()),
            Method::Resistive { .. } => None,
        })
    }

    /// Continues from the memory of a fluid around the same filaments, bit for bit as if never stopped.
    ///
    /// # Errors
    /// [`FluidError::ForeignMemory`] where the memory does not fit the filaments and the model.
    pub fn restore(&mut self, memory: FluidMemory) -> Result<(), FluidError> {
        match (&mut self.method, memory.0) {
            (Method::Stokeslets(drag), Some(memory)) => drag.restore(memory),
            (Method::Resistive { .. }, None) => Ok(()),
            _ => Err(FluidError::ForeignMemory),
        }
    }
}

fn positive(quantity: &str, value: f64) -> Result<(), FluidError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(FluidError::BadInput(format!(
        "the {quantity} of the fluid must be positive and finite, not {value}"
    )))
}

fn check(filaments: &[Filament]) -> Result<(), FluidError> {
    let mut ranges = Vec::with_capacity(filaments.len());
    for filament in filaments {
        if filament.nodes < 2 {
            return Err(FluidError::BadInput(
                "a filament in a fluid needs at least two nodes".into(),
            ));
        }
        positive("filament radius", filament.radius)?;
        ranges.push(filament.range());
    }
    ranges.sort_by_key(|range| range.start);
    if ranges.windows(2).any(|pair| pair[1].start < pair[0].end) {
        return Err(FluidError::BadInput(
            "two filaments in a fluid share a node".into(),
        ));
    }
    Ok(())
}
