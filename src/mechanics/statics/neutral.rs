//! Motions without stiffness: a ring that rolls through itself, a column that bends over in any plane, a rod
//! that nothing holds.
//!
//! The energy does not change along them, wherever the rod is, so that forces have no part in them but
//! rounding errors, which the inverse of the Hessian would magnify without bound. They are the null vectors of
//! the Hessian all along a path, which tells them from the one that belongs to a critical point.

use super::spectrum::{inner, inverse_iteration, scale_angles};
use crate::linalg::SingularMatrix;
use crate::mechanics::system::System;
use serde::{Deserialize, Serialize};

/// Largest eigenvalue of such a motion over the shift of the Hessian.
const LARGEST_EIGENVALUE: f64 = 0.1;

/// The null vectors of a Hessian.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct NeutralModes {
    /// B-orthonormal, with B as in [`super::spectrum`].
    vectors: Vec<Vec<f64>>,
    /// Weight of the squares of angles in B, m².
    weight: f64,
}

impl NeutralModes {
    /// None as yet.
    pub fn new(weight: f64) -> Self {
        Self {
            vectors: Vec::new(),
            weight,
        }
    }

    /// Finds all of them with the factors of the Hessian at an equilibrium, to which `shift` (N/m) was added.
    pub fn find(&mut self, system: &mut System, unknowns: usize, shift: f64) {
        self.vectors.clear();
        while self.vectors.len() < unknowns {
            let mut vector = vec![0.0; unknowns];
            let Some(eigenvalue) = inverse_iteration(system, &mut vector, self) else {
                return;
            };
            if (eigenvalue - shift).abs() > LARGEST_EIGENVALUE * shift {
                return;
            }
            self.vectors.push(vector);
        }
    }

    /// Follows the Hessian, whose factors `system` holds, by one inverse iteration.
    ///
    /// # Errors
    /// A system that is singular to working precision.
    pub fn refine(&mut self, system: &mut System) -> Result<(), SingularMatrix> {
        for k in 0..self.vectors.len() {
            let (before, rest) = self.vectors.split_at_mut(k);
            let vector = &mut rest[0];
            scale_angles(vector, self.weight);
            system.solve(vector)?;
            remove(before, vector, self.weight);
            let norm = inner(vector, vector, self.weight).sqrt();
            vector.iter_mut().for_each(|entry| *entry /= norm);
        }
        Ok(())
    }

    /// Takes out of `vector` what lies along them.
    pub fn remove_from(&self, vector: &mut [f64]) {
        remove(&self.vectors, vector, self.weight);
    }

    /// Adds a B-orthonormal vector to those that are taken out.
    pub fn push(&mut self, vector: Vec<f64>) {
        self.vectors.push(vector);
    }

    /// Weight of the squares of angles, m².
    pub fn weight(&self) -> f64 {
        self.weight
    }
}

fn remove(vectors: &[Vec<f64>], from: &mut [f64], weight: f64) {
    for vector in vectors {
        let part = inner(vector, from, weight);
        for (entry, own) in from.iter_mut().zip(vector) {
            *entry -= part * own;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::Vector3;
    use crate::mechanics::scene::{RodDescription, Scene, Stiffness};
    use crate::mechanics::statics::find_equilibrium;
    use std::f64::consts::TAU;

    const EDGES: usize = 24;

    /// A free ring that is straight by nature.
    fn ring(bending: [f64; 2]) -> Scene {
        let node = |k: usize| {
            let angle = TAU * k as f64 / EDGES as f64;
            Vector3::new(angle.cos(), angle.sin(), 0.0)
        };
        let centreline = (0..EDGES).map(node).collect();
        let stiffness = Stiffness {
            stretching: 1e4,
            bending,
            twisting: 1.0,
        };
        Scene {
            rods: vec![RodDescription {
                closed: true,
                first_director: Some(Vector3::z()),
                ..RodDescription::uniform("ring", centreline, stiffness, 1e-2, 1.0)
            }],
            ..Scene::default()
        }
    }

    #[test]
    fn a_round_ring_moves_rigidly_and_rolls_and_a_flat_one_does_not_roll() {
        for (bending, expected) in [([1.0, 1.0], 7), ([1.0, 5.0], 6)] {
            let mut system = System::new(&ring(bending)).unwrap();
            let mut unknowns = system.assembly.unknowns.clone();
            find_equilibrium(&mut system, &mut unknowns, 1e-9).unwrap();
            let (shift, weight) = (1e-6, system.assembly.shortest_edge.powi(2));
            system.linearize(&unknowns, None);
            system.shift(shift, shift * weight);
            assert_eq!(system.factor().unwrap().unwrap().negative, 0);
            let mut modes = NeutralModes::new(weight);
            modes.find(&mut system, unknowns.len(), shift);
            assert_eq!(modes.vectors.len(), expected);
            // A shift of the whole ring is one of them, or a sum of some.
            let mut rigid: Vec<f64> = (0..unknowns.len()).map(|k| f64::from(k % 4 == 1)).collect();
            modes.remove_from(&mut rigid);
            assert!(rigid.iter().all(|entry| entry.abs() < 1e-6));
        }
    }
}
