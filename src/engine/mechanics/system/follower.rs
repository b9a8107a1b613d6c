//! Forces that turn with the rod: constant in the material frame of an edge.
//!
//! The frame of an edge e = x₁ − x₀ of the length l turns with the rotation
//!
//! ```text
//! δω = t × δe/l + (δθ + c·δe) t
//! ```
//!
//! with the holonomy c of the transported frame ([`crate::mechanics::rod::vertex`]). A force F = f₁ m₁ + f₂ m₂ + f₃ t turns
//! with it, δF = δω × F, so that its derivatives are
//!
//! ```text
//! ∂F/∂e = [ (t·F) 1 − t Fᵀ ]/l + (t × F) cᵀ,     ∂F/∂θ = t × F
//! ```
//!
//! The force has no potential: its work around a closed path is not zero, and the Jacobian is not
//! symmetric.

use super::factor::Scale;
use crate::linalg::ElementMatrix;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::rod::vertex::EdgeFrame;
use crate::mechanics::{Matrix3, Vector3};

/// A force in the material frame of an edge, on the nodes at its ends.
#[derive(Clone, Debug)]
pub(crate) struct FollowerForce {
    /// Node at the start of the edge.
    pub start: usize,
    /// Node at its end.
    pub end: usize,
    /// Fractions of the force that act on the two nodes.
    pub shares: [f64; 2],
    /// Components along the two material directors and the tangent, N.
    pub components: Vector3,
    /// Factor over time.
    pub scale: Scale,
}

impl FollowerForce {
    /// The force at `time`, N.
    pub(crate) fn force(&self, time: f64, frame: &EdgeFrame) -> Vector3 {
        let [first, second, along] = (self.components * self.scale.at(time)).into();
        frame.director_1 * first + frame.director_2 * second + frame.tangent * along
    }

    /// Derivatives of the force with respect to the edge vector, N/m, and to the angle of the
    /// edge, N.
    pub(crate) fn jacobian(&self, time: f64, frame: &EdgeFrame) -> (Matrix3, Vector3) {
        let (force, tangent) = (self.force(time, frame), &frame.tangent);
        let about_tangent = tangent.cross(&force);
        let swing = Matrix3::identity() * tangent.dot(&force) - tangent * force.transpose();
        let over_edge = swing / frame.length + about_tangent * frame.holonomy.transpose();
        (over_edge, about_tangent)
    }

    /// The nodes at the ends of the edge with their fractions.
    pub(crate) fn on_nodes(&self) -> impl Iterator<Item = (usize, f64)> {
        [self.start, self.end].into_iter().zip(self.shares)
    }

    /// The unknowns x_start, θ, x_end.
    pub(crate) fn unknowns(&self) -> [usize; 12] {
        element_of_edge(self.start, self.end)
    }
}

/// The unknowns x_start, θ, x_end of an edge.
pub(crate) fn element_of_edge(start: usize, end: usize) -> [usize; 12] {
    let mut element = [usize::MAX; 12];
    for axis in 0..3 {
        element[axis] = STRIDE * start + axis;
        element[4 + axis] = STRIDE * end + axis;
    }
    element[3] = STRIDE * start + 3;
    element
}

/// Subtracts, from an element over x_start, θ, x_end, the derivatives of a force with respect to
/// the edge x_end − x_start and to θ. The two nodes have fractions of the force, and R = −F.
pub(super) fn subtract_on_edge(
    matrix: &mut ElementMatrix,
    shares: [f64; 2],
    over_edge: &Matrix3,
    over_angle: &Vector3,
) {
    for (row, share) in [0, 4].into_iter().zip(shares) {
        for i in 0..3 {
            for j in 0..3 {
                matrix[row + i][j] += share * over_edge[(i, j)];
                matrix[row + i][4 + j] -= share * over_edge[(i, j)];
            }
            matrix[row + i][3] -= share * over_angle[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::mechanics::Vector3;
    use crate::mechanics::rod::STRIDE;
    use crate::mechanics::scene::{LoadKind, RodDescription, Scene};
    use crate::mechanics::system::System;
    use crate::mechanics::test_support::{clamp, section, steady};

    /// A twisted arc, clamped at its start, under every kind of load that turns with it.
    fn scene() -> Scene {
        let node = |k: i32| {
            let angle = 0.3 * f64::from(k);
            Vector3::new(libm::sin(angle), 1.0 - libm::cos(angle), 0.1 * f64::from(k))
        };
        let stiffness = section(30.0, [1.0, 2.0], 1.5);
        let kinds = [
            LoadKind::FollowerForce {
                rod: 0,
                node: 4,
                force: Vector3::new(0.7, -0.4, 0.9),
            },
            LoadKind::FollowerForce {
                rod: 0,
                node: 2,
                force: Vector3::new(-0.2, 0.5, 0.3),
            },
            LoadKind::FollowerMoment {
                rod: 0,
                edge: 3,
                moment: Vector3::new(0.6, -0.8, 0.4),
            },
            LoadKind::FollowerDistributed {
                rod: None,
                force_per_length: Vector3::new(0.3, 0.2, -0.6),
            },
            LoadKind::Moment {
                rod: 0,
                edge: 1,
                moment: Vector3::new(0.1, 0.3, -0.2),
            },
        ];
        Scene {
            rods: vec![RodDescription {
                twist: 0.8,
                ..RodDescription::uniform("arc", (0..5).map(node).collect(), stiffness, 0.01, 1.0)
            }],
            clamps: vec![clamp(0, 0)],
            loads: kinds.into_iter().map(steady).collect(),
            ..Scene::default()
        }
    }

    #[test]
    fn the_jacobian_of_loads_that_turn_with_the_rod_is_exact() {
        let mut system = System::new(&scene()).unwrap();
        // Away from the reference frames, where parallel transport has a holonomy.
        let mut unknowns = system.assembly.unknowns.clone();
        for (k, unknown) in unknowns.iter_mut().enumerate() {
            if !system.assembly.held[k] {
                *unknown += 0.05 * libm::sin(1.7 * k as f64);
            }
        }
        system.linearize(&unknowns, None);
        let jacobian = system.dense_matrix();
        let step = 1e-6;
        let free: Vec<usize> = (0..unknowns.len())
            .filter(|&k| !system.assembly.held[k])
            .collect();
        let mut residual_at = |k: usize, by: f64| {
            let mut moved = unknowns.clone();
            moved[k] += by;
            system.evaluate(&moved, None);
            system.residual.clone()
        };
        for &column in &free {
            let (above, below) = (residual_at(column, step), residual_at(column, -step));
            for &row in &free {
                let difference = (above[row] - below[row]) / (2.0 * step);
                let missed = (difference - jacobian[(row, column)]).abs();
                assert!(
                    missed < 1e-6 * (1.0 + difference.abs()),
                    "node {} entry {}: {missed}",
                    row / STRIDE,
                    row % STRIDE
                );
            }
        }
        assert!(!system.is_symmetric());
    }

    #[test]
    fn the_force_turns_with_the_rod() {
        let mut straight = scene();
        straight.rods[0].centreline = (0..5).map(|k| f64::from(k) * Vector3::x()).collect();
        straight.rods[0].twist = 0.0;
        straight.rods[0].first_director = Some(Vector3::y());
        straight.loads.truncate(1);
        let residual_of = |scene: &Scene| {
            let mut system = System::new(scene).unwrap();
            let unknowns = system.assembly.unknowns.clone();
            system.evaluate(&unknowns, None);
            Vector3::from_column_slice(&system.residual[4 * STRIDE..4 * STRIDE + 3])
        };
        // Directors along y and z, the tangent along x.
        let missed = residual_of(&straight) + Vector3::new(0.9, 0.7, -0.4);
        assert!(missed.norm() < 1e-12, "{missed}");
        // The same rod along y, with its director along −x.
        straight.rods[0].centreline = (0..5).map(|k| f64::from(k) * Vector3::y()).collect();
        straight.rods[0].first_director = Some(-Vector3::x());
        let missed = residual_of(&straight) + Vector3::new(-0.7, 0.9, -0.4);
        assert!(missed.norm() < 1e-12, "{missed}");
    }
}
