//! Stability of a suspended rod with both ends held: the inertia of the second variation of its
//! energy.
//!
//! With the force at the gripper as the multiplier of its position, and the stretch eliminated,
//! the rod in equilibrium is a stationary point, over all rotations exp([θ]×) of its
//! cross-sections, of
//!
//! > Π = ∫ ½ EI|t'|² + ½ GJ τ² − n·t − (n·t)²/2k_s ds.
//!
//! A small rotation θ(s) that vanishes at both ends has the strain θ'. With the moment M, it
//! changes this energy to second order by
//!
//! > ½ ∫ θ'·K θ' − M·(θ × θ') + λ[(n·t)|θ|² − (n·θ)(t·θ)] − (n·(θ × t))²/k_s ds,  K = EI(I − t tᵀ) + GJ t tᵀ,
//!
//! and the rod is stable if this is positive for all θ that keep the position of the gripper. Here
//! θ is piecewise linear. The three conditions border the matrix, and each contributes one
//! negative eigenvalue.

use super::Vector3;
use super::shape::Shape;
use rodlab_engine::mechanics::Matrix3;

/// GJ/EI of an incompressible round rod: 1/(1 + ν) with ν = 1/2.
pub const TWIST_STIFFNESS: f64 = 2.0 / 3.0;
/// Number of elements per interval of the mesh of the shape.
const ELEMENTS_PER_INTERVAL: usize = 8;
/// Number of conditions at the gripper.
const CONDITIONS: usize = 3;
/// Smallest 1/k̄_s. In an inextensible straight rod, the distance of the gripper would be no
/// condition on the rotations.
const LEAST_COMPLIANCE: f64 = 1e-12;

/// Data of an element for the second variation, at its middle.
#[derive(Clone, Copy, Debug)]
pub struct Element {
    /// Length of the element.
    pub length: f64,
    /// t.
    pub tangent: Vector3,
    /// M.
    pub moment: Vector3,
    /// n.
    pub force: Vector3,
}

/// Number of unstable modes of the rod with both ends held: zero if it is stable.
pub fn unstable_modes(shape: &Shape) -> usize {
    let elements = shape.intervals.iter().flat_map(|interval| {
        let length = interval.length / ELEMENTS_PER_INTERVAL as f64;
        (0..ELEMENTS_PER_INTERVAL).map(move |part| {
            let middle = interval.start + (part as f64 + 0.5) * length;
            let (tangent, moment) = shape.at(middle);
            Element {
                length,
                tangent,
                moment,
                force: shape.internal_force(middle),
            }
        })
    });
    let elements: Vec<Element> = elements.collect();
    negative_modes(&elements, TWIST_STIFFNESS, shape.problem.stretch_compliance)
}

/// Number of negative eigenvalues of the second variation minus those of the conditions: block
/// LDLᵀ from end to end.
pub fn negative_modes(elements: &[Element], twist_stiffness: f64, compliance: f64) -> usize {
    let compliance = compliance.max(LEAST_COMPLIANCE);
    let variations = variations(elements, twist_stiffness, compliance);
    let Elimination { legs, conditions } = Elimination::of(&variations);
    let negative: usize = legs.iter().map(|leg| negatives(&leg.block)).sum();
    (negative + negatives(&conditions)).saturating_sub(CONDITIONS)
}

/// The second variations of elements.
pub fn variations(elements: &[Element], twist_stiffness: f64, compliance: f64) -> Vec<Variation> {
    let of = |element: &Element| element.variation(twist_stiffness, compliance);
    elements.iter().map(of).collect()
}

/// Eliminates the nodes between the two held ends one after the other.
pub struct Elimination {
    /// Remainder at each node.
    pub legs: Vec<Leg>,
    /// Remaining matrix of the conditions.
    pub conditions: Matrix3,
}

/// Remaining matrix of a node after the elimination of the previous ones.
pub struct Leg {
    /// Its block.
    pub block: Matrix3,
    /// Inverse of the matrix, if it exists.
    pub inverse: Option<Matrix3>,
    /// Coupling block to the next node.
    pub across: Matrix3,
    /// Coupling to the conditions.
    pub part: Matrix3,
}

impl Elimination {
    /// Eliminates the inner nodes of a rod, given the second variations of its elements.
    pub fn of(variations: &[Variation]) -> Self {
        let mut legs = Vec::with_capacity(variations.len());
        let mut conditions = Matrix3::zeros();
        let mut before: Option<(Matrix3, Matrix3)> = None;
        for variation in variations {
            conditions += variation.multiplier;
            // The contact node is held, so nothing is added before the first element.
            before = Some(match before {
                None => (variation.after, variation.condition),
                Some((block, part)) => {
                    let (block, part) = (block + variation.before, part + variation.condition);
                    let across = variation.across;
                    let inverse = block.try_inverse();
                    legs.push(Leg {
                        block,
                        inverse,
                        across,
                        part,
                    });
                    let inverse = inverse.unwrap_or_else(Matrix3::zeros);
                    conditions -= part * inverse * part.transpose();
                    (
                        variation.after - across.transpose() * inverse * across,
                        variation.condition - part * inverse * across,
                    )
                }
            });
        }
        Self { legs, conditions }
    }
}

/// Blocks of an element's second variation, for the rotations of its two ends.
pub struct Variation {
    /// Second derivatives with respect to the rotation of the first end.
    pub before: Matrix3,
    /// Mixed second derivatives: first end, second end.
    pub across: Matrix3,
    /// Second derivatives with respect to the rotation of the second end.
    pub after: Matrix3,
    /// ∂(position of the gripper)/∂θ, the same for both ends.
    pub condition: Matrix3,
    /// Block of the Lagrange multiplier of the gripper's position.
    pub multiplier: Matrix3,
}

impl Element {
    /// Contribution of the element to the second variation.
    pub fn variation(&self, twist_stiffness: f64, compliance: f64) -> Variation {
        let Self {
            length,
            tangent,
            moment,
            force,
        } = self;
        let along = tangent * tangent.transpose();
        let stiffness = (Matrix3::identity() - along + twist_stiffness * along) / *length;
        let pull = force.dot(tangent);
        let stretch = 1.0 + compliance * pull;
        let turning = tangent.cross(force);
        let mixed = force * tangent.transpose();
        // θ at the middle is the mean of the ends, which gives a quarter to each pair of ends.
        let mean = 0.25
            * length
            * (stretch * (pull * Matrix3::identity() - 0.5 * (mixed + mixed.transpose()))
                - compliance * turning * turning.transpose());
        // −½ M·(θ × θ') with θ₁ × θ₂ over the length: θ × θ' = θ₁ × θ₂ / length, for both
        // triangles.
        let twist = 0.5 * moment.cross_matrix();
        let condition = 0.5
            * length
            * (-stretch * tangent.cross_matrix() + compliance * tangent * turning.transpose());
        Variation {
            before: stiffness + mean,
            across: -stiffness + mean + twist,
            after: stiffness + mean,
            condition,
            multiplier: -compliance * *length * along,
        }
    }
}

fn negatives(matrix: &Matrix3) -> usize {
    let symmetric = 0.5 * (matrix + matrix.transpose());
    let values = symmetric.symmetric_eigenvalues();
    values.iter().filter(|value| **value < 0.0).count()
}

#[cfg(test)]
mod tests {
    use super::super::GraspProblem;
    use super::*;
    use std::f64::consts::PI;

    fn straight(force: f64, twisting_moment: f64, twist_stiffness: f64) -> usize {
        let count = 400;
        let element = Element {
            length: 1.0 / f64::from(count),
            tangent: Vector3::x(),
            moment: twisting_moment * Vector3::x(),
            force: force * Vector3::x(),
        };
        negative_modes(&vec![element; count as usize], twist_stiffness, 0.0)
    }

    #[test]
    fn the_clamped_column_buckles_at_four_pi_squared_both_ways() {
        let critical = 4.0 * PI * PI;
        assert_eq!(straight(-0.999 * critical, 0.0, 0.7), 0);
        assert_eq!(straight(-1.001 * critical, 0.0, 0.7), 2);
        assert_eq!(straight(3.0, 0.0, 0.7), 0);
    }

    #[test]
    fn the_clamped_rod_gives_way_under_twist_as_greenhill_says() {
        for twist_stiffness in [0.5, 0.9] {
            assert_eq!(straight(0.0, 0.999 * 8.986_818_9, twist_stiffness), 0);
            assert!(straight(0.0, 1.001 * 8.986_818_9, twist_stiffness) > 0);
            assert!(straight(0.0, -1.001 * 8.986_818_9, twist_stiffness) > 0);
        }
    }

    #[test]
    fn a_ring_that_is_held_is_stable_up_to_a_full_turn() {
        // Clamped planar arcs without force lose stability at 2π (Borum & Bretl 2020).
        let arc = |angle: f64| {
            let count = 600;
            let elements: Vec<Element> = (0..count)
                .map(|index| {
                    let at = angle * (f64::from(index) + 0.5) / f64::from(count);
                    Element {
                        length: 1.0 / f64::from(count),
                        tangent: Vector3::new(at.cos(), at.sin(), 0.0),
                        moment: angle * Vector3::z(),
                        force: Vector3::zeros(),
                    }
                })
                .collect();
            negative_modes(&elements, TWIST_STIFFNESS, 0.0)
        };
        assert_eq!(arc(0.99 * 2.0 * PI), 0);
        assert!(arc(1.01 * 2.0 * PI) > 0);
    }

    #[test]
    fn a_beam_that_is_bent_in_a_plane_gives_way_sideways_as_prandtl_says() {
        // Both ends clamped: M = 2π √(EI GJ)/l.
        let beam = |moment: f64, twist_stiffness: f64| {
            let count = 400;
            let element = Element {
                length: 1.0 / f64::from(count),
                tangent: Vector3::x(),
                moment: moment * Vector3::z(),
                force: Vector3::zeros(),
            };
            negative_modes(&vec![element; count as usize], twist_stiffness, 0.0)
        };
        for twist_stiffness in [0.4, TWIST_STIFFNESS, 0.9] {
            let critical = 2.0 * PI * twist_stiffness.sqrt();
            assert_eq!(beam(0.998 * critical, twist_stiffness), 0);
            assert!(beam(1.002 * critical, twist_stiffness) > 0);
        }
    }
    /// G = E/3 without a change of volume, and J = 2I of a round section. So short a rod bears its weight easily.
    #[test]
    fn rods_of_grasps_twist_as_round_ones_of_a_constant_volume() {
        let problem = GraspProblem {
            suspended_length: 0.1,
            curvature: 0.0,
            stretch_compliance: 0.0,
        };
        let mesh: Vec<f64> = (0..=50).map(|k| 0.1 * f64::from(k) / 50.0).collect();
        let critical = 2.0 * PI * (2.0_f64 / 3.0).sqrt() / 0.1;
        let modes = |moment: f64| {
            let bent = |_| (Vector3::x(), moment * Vector3::z());
            unstable_modes(&Shape::guess(problem, &mesh, [0.0; 2], bent))
        };
        assert_eq!(modes(0.998 * critical), 0);
        assert!(modes(1.002 * critical) > 0);
    }
}
