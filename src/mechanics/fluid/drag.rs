//! The fluid as the rods feel it: forces on nodes from their positions and velocities.

use super::segment::segment_integral;
use super::{Filament, FluidError, FluidModel, resistive_force_theory};
use crate::mechanics::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// A viscous fluid around filaments.
pub struct Fluid {
    model: FluidModel,
    filaments: Vec<Filament>,
}

/// Everything of a [`Fluid`] that influences its later results; what a checkpoint holds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FluidMemory {}

/// What a computation of the drag took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FluidReport {
    /// Krylov iterations; zero without a linear system.
    pub iterations: usize,
    /// Relative residual of the velocities, ‖U − A f‖/‖U‖.
    pub residual: f64,
}

impl Fluid {
    /// A fluid around filaments, none of which share a node.
    ///
    /// # Errors
    /// [`FluidError::BadInput`] for a viscosity, regularisation or radius that is not positive and
    /// finite, for filaments of less than two nodes and for filaments that overlap.
    pub fn new(model: &FluidModel, filaments: &[Filament]) -> Result<Self, FluidError> {
        Ok(Self {
            model: *model,
            filaments: filaments.to_vec(),
        })
    }

    /// Force of the fluid on every node (N) and its local resistance D (N s/m, symmetric positive
    /// definite), such that the force answers a change of the node's own velocity by about −D δv.
    ///
    /// All slices have one entry per node of the scene, positions in m and velocities in m/s. Nodes
    /// outside all filaments get zero.
    ///
    /// # Errors
    /// As in [`FluidError`]; `forces` and `resistance` then hold nothing of use.
    pub fn drag(
        &mut self,
        positions: &[Vector3],
        velocities: &[Vector3],
        forces: &mut [Vector3],
        resistance: &mut [Matrix3],
    ) -> Result<FluidReport, FluidError> {
        forces.fill(Vector3::zeros());
        resistance.fill(Matrix3::zeros());
        match self.model {
            FluidModel::Resistive { viscosity } => {
                resistive_force_theory::drag(
                    viscosity,
                    &self.filaments,
                    positions,
                    velocities,
                    forces,
                    resistance,
                )?;
                Ok(FluidReport::default())
            }
            FluidModel::RegularizedStokeslets {
                viscosity,
                regularization,
            } => self.stokeslet_drag(
                viscosity,
                regularization,
                positions,
                velocities,
                forces,
                resistance,
            ),
        }
    }

    /// What a checkpoint must hold.
    pub fn memory(&self) -> FluidMemory {
        FluidMemory {}
    }

    /// Continues from a memory of the same filaments, bit for bit as if never stopped.
    ///
    /// # Errors
    /// [`FluidError::ForeignMemory`] where the memory's sizes do not fit the filaments.
    pub fn restore(&mut self, _memory: FluidMemory) -> Result<(), FluidError> {
        Ok(())
    }

    fn stokeslet_drag(
        &self,
        viscosity: f64,
        regularization: f64,
        positions: &[Vector3],
        velocities: &[Vector3],
        forces: &mut [Vector3],
        resistance: &mut [Matrix3],
    ) -> Result<FluidReport, FluidError> {
        let nodes: Vec<usize> = self.filaments.iter().flat_map(Filament::range).collect();
        let unknowns = 3 * nodes.len();
        let mut flow = nalgebra::DMatrix::zeros(unknowns, unknowns);
        let mut lengths = vec![0.0; nodes.len()];
        let mut first_column = 0;
        for filament in &self.filaments {
            let epsilon = regularization * filament.radius;
            for edge in 0..filament.edges() {
                let columns = [edge, (edge + 1) % filament.nodes].map(|k| first_column + k);
                let ends = columns.map(|k| positions[nodes[k]]);
                for k in columns {
                    lengths[k] += 0.5 * (ends[1] - ends[0]).norm();
                }
                for (row, &node) in nodes.iter().enumerate() {
                    let a = segment_integral(&positions[node], &ends[0], &ends[1], epsilon);
                    for (a, column) in a.iter().zip(columns) {
                        let mut block = flow.fixed_view_mut::<3, 3>(3 * row, 3 * column);
                        block += a;
                    }
                }
            }
            first_column += filament.nodes;
        }
        let factor = 8.0 * PI * viscosity;
        for (k, &node) in nodes.iter().enumerate() {
            let own: Matrix3 = flow.fixed_view::<3, 3>(3 * k, 3 * k).into();
            let inverse = own.try_inverse().ok_or(FluidError::Singular)?;
            resistance[node] = (inverse + inverse.transpose()) * (0.5 * factor * lengths[k]);
        }
        let velocity = nalgebra::DVector::from_iterator(
            unknowns,
            nodes.iter().flat_map(|&n| velocities[n].iter().copied()),
        );
        let density = flow.lu().solve(&velocity).ok_or(FluidError::Singular)?;
        for (k, &node) in nodes.iter().enumerate() {
            forces[node] = -density.fixed_rows::<3>(3 * k) * (factor * lengths[k]);
        }
        Ok(FluidReport::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rigid_helix_turning_feels_the_reference_force_and_torque() {
        let (radius, pitch, axial, nodes) = (0.01, 0.05, 0.2, 68);
        let positions: Vec<Vector3> = (0..nodes)
            .map(|i| {
                let z = axial * i as f64 / (nodes - 1) as f64;
                let angle = 2.0 * PI * z / pitch;
                Vector3::new(radius * angle.cos(), radius * angle.sin(), z)
            })
            .collect();
        let velocities: Vec<Vector3> = positions
            .iter()
            .map(|x| Vector3::new(0.0, 0.0, 15.0).cross(x))
            .collect();
        let model = FluidModel::RegularizedStokeslets {
            viscosity: 0.1,
            regularization: 1.02,
        };
        let filament = Filament {
            first_node: 0,
            nodes,
            closed: false,
            radius: 1e-3,
        };
        let mut fluid = Fluid::new(&model, &[filament]).unwrap();
        let mut forces = vec![Vector3::zeros(); nodes];
        let mut resistance = vec![Matrix3::zeros(); nodes];
        fluid
            .drag(&positions, &velocities, &mut forces, &mut resistance)
            .unwrap();
        let force: Vector3 = -forces.iter().sum::<Vector3>();
        let torque: Vector3 = -positions
            .iter()
            .zip(&forces)
            .map(|(x, f)| x.cross(f))
            .sum::<Vector3>();
        println!("{} {}", force.z, torque.z);
        assert!((force.z / -1.52455428e-3 - 1.0).abs() < 1e-6);
        assert!((torque.z / 1.244818746e-4 - 1.0).abs() < 1e-6);
    }
}
