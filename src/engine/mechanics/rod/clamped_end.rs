//! Weights of vertices next to a clamp in the integrals of bending and twisting energy.
//!
//! A vertex carries the moment M of the rod at its node, exactly if the loads are at nodes, and
//! turns by M l̄/EI with the Voronoi length l̄. The complementary energy ½ ∫ M²/EI ds is therefore
//! summed by the trapezoidal rule, with the half vertex of a clamp as its end. By the
//! Euler–Maclaurin formula, the error of the sum follows from
//!
//! ```text
//! ∫₀ f ds = h (f₀/2 + f₁ + f₂ + ...) + (h²/12) f'(0) − (h⁴/720) f‴(0) + ...,     f = M²/EI
//! ```
//!
//! which vanishes at free and hinged ends, where M = 0 makes f' = 2 M M'/EI vanish. At a clamp it
//! is h² M₀ M₀'/6EI: the rod turns too far by this amount, and oscillates too slowly, with an
//! error of second order in h. Gregory's end weights take f'(0) from the first three vertices, (−3
//! f₀ + 4 f₁ − f₂)/2h. This is exact if M is linear, as it is next to a clamp, near which the rod
//! is at rest (M'' = ρA ẅ = 0 and M‴ = 0 there):
//!
//! ```text
//! h (½, 1, 1, 1, ...)  →  h (½ − 1/8, 1 + 1/6, 1 − 1/24, 1, ...) = h (3/8, 7/6, 23/24, 1, ...)
//! ```
//!
//! So a clamp only changes three lengths by which EI is divided: [`VertexWeights`]. With the mass
//! of edges that move linearly, vibrations are then of fourth order. For edges of the lengths a
//! and b from the clamp on, the same quadratic gives a²/12 f'(0) = −a(2a+b)/12(a+b) f₀ +
//! a(a+b)/12b f₁ − a³/12b(a+b) f₂. (Two edges between two clamps get the weights of Simpson's
//! rule. A coupling of the first two vertices, h (⅓ M₀² + ⅙ M₀M₁ + M₁²), would be of the same
//! order, but with three times the error and a kernel of its own.)
//!
//! **Twist.** Angles belong to edges, whose midpoints are half an edge from the clamp. There θ = 0
//! and so T' = ρJ θ̈ = 0: the trapezoidal sum of ½ ∫ T²/GJ is right. But the moment of inertia of
//! the first edge, which should be shared with an edge mirrored in the clamp, is too large by h
//! ρJ/6. With the lengths h (½ − d, 1 + d, 1, ...) the total rotation of the rod stays the same,
//! but its first edge rotates by h (½ − d) T/GJ. The kinetic energy is then that of the mirrored
//! rod if
//!
//! ```text
//! (½ − d)² − (1 + d)²/12 = ¼ − 1/12 − 1/24,     11 d² − 14 d + ½ = 0,     d = 0.0368
//! ```
//!
//! Weights change the stiffness, not the natural strains: the stress-free shape stays the same.
//!
//! If the first edge is more than twice as long as the second, and for one edge between two
//! clamps, the weights stay the same.

use super::discretization::{ElasticRods, Vertex, VertexWeights};
use super::turning_angle::BendingStrain;

/// Largest ratio of the first edge to the second: beyond 2.3 the weight of the third vertex would
/// vanish.
const LARGEST_RATIO: f64 = 2.0;

/// Reduction of the weight of the first edge from one half in the twist at a clamp: d = (14 − √174)/22.
const TWIST_LESS: f64 = 0.036_777_001_896_685_47;

/// Largest natural strain of a vertex that counts as straight, rad: so small that the angle and
/// twice the tangent of its half differ by 3e-5, and so large that fits of the natural curvature of
/// a nearly straight rod do not meet the change of the strain, where its shape jumps.
const STRAIGHT: f64 = 0.02;

/// Correction by Gregory's rule of the lengths (m) of the first three vertices in the integral of
/// bending, if edges of the lengths `first` and `second` (m) follow the end.
fn added_by_gregory(first: f64, second: f64) -> [f64; 3] {
    let both = first + second;
    [
        -first * (first + both) / (12.0 * both),
        first * both / (12.0 * second),
        -first.powi(3) / (12.0 * second * both),
    ]
}

impl ElasticRods {
    /// Completes the vertices of one rod, which start at index `first`: makes the angle their
    /// strain if the rod is naturally straight, and weights those next to clamps.
    pub(crate) fn refine(&mut self, first: usize) {
        let own = &mut self.vertices[first..];
        let natural = own.iter().flat_map(|vertex| vertex.natural.curvature);
        if natural.into_iter().all(|strain| strain.abs() < STRAIGHT) {
            own.iter_mut()
                .for_each(|vertex| vertex.strain = BendingStrain::Angle);
        }
        self.weigh_clamped_ends(first);
    }

    fn weigh_clamped_ends(&mut self, first: usize) {
        let vertices = &self.vertices[first..];
        let mut added = vec![[0.0; 2]; vertices.len()];
        for (wall, vertex) in vertices.iter().enumerate() {
            let starts = vertex.before >= self.nodes;
            if !starts && vertex.after < self.nodes {
                continue;
            }
            // The vertex at the far end of an edge, and the edge beyond it.
            let beyond = |edge: usize| {
                let ends = |vertex: &Vertex| match starts {
                    true => (vertex.before, vertex.after),
                    false => (vertex.after, vertex.before),
                };
                let found = vertices.iter().position(|vertex| ends(vertex).0 == edge)?;
                Some((found, ends(&vertices[found]).1))
            };
            let edge = if starts { vertex.after } else { vertex.before };
            let Some((second, next_edge)) = beyond(edge) else {
                continue;
            };
            if next_edge >= self.nodes {
                continue;
            }
            let [length, next] = [edge, next_edge].map(|edge| self.natural_length(edge));
            if length > LARGEST_RATIO * next {
                continue;
            }
            // A free or hinged end has neither a third vertex nor a moment.
            let third = beyond(next_edge).map(|(third, _)| third);
            let numbers = [Some(wall), Some(second), third];
            for (number, length) in numbers.into_iter().zip(added_by_gregory(length, next)) {
                if let Some(number) = number {
                    added[number][0] += length;
                }
            }
            added[wall][1] -= TWIST_LESS * length;
            added[second][1] += TWIST_LESS * length;
        }
        for (number, added) in added.into_iter().enumerate() {
            let vertex = &self.vertices[first + number];
            let halves = [vertex.before, vertex.after].map(|edge| match edge < self.nodes {
                true => 0.5 * self.natural_length(edge),
                false => 0.0,
            });
            let voronoi: f64 = halves.iter().sum();
            let weights = VertexWeights {
                bending: 1.0 + added[0] / voronoi,
                twisting: 1.0 + added[1] / voronoi,
            };
            let vertex = &mut self.vertices[first + number];
            vertex.weights = weights;
            for bending in &mut vertex.stiffness.bending {
                *bending /= weights.bending;
            }
            vertex.stiffness.twisting /= weights.twisting;
        }
    }

    /// Natural length of a real edge, m.
    fn natural_length(&self, edge: usize) -> f64 {
        let index = self.edges.binary_search_by_key(&edge, |edge| edge.start);
        self.edges[index.expect("a real edge")].natural_length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_edge_spins_as_beside_a_mirror() {
        let d = TWIST_LESS;
        assert!((11.0 * d * d - 14.0 * d + 0.5).abs() < 1e-15);
        let kinetic = (0.5 - d).powi(2) - (1.0 + d).powi(2) / 12.0;
        assert!((kinetic - 0.125).abs() < 1e-15);
    }

    #[test]
    fn three_weights_integrate_what_a_clamp_bends() {
        for (first, second, third) in [(1.0, 1.0, 1.0), (0.3, 0.5, 0.7), (0.4, 0.25, 0.2)] {
            let places = [0.0, first, first + second];
            let ends = [0.5 * first, 0.5 * (first + second), 0.5 * (second + third)];
            let weights: Vec<f64> = (ends.iter().zip(added_by_gregory(first, second)))
                .map(|(length, added)| length + added)
                .collect();
            assert!(weights.iter().all(|weight| *weight > 0.0), "{weights:?}");
            // The error of the trapezoidal sum at this end is −a²/12 f'(0) for f = 1, x, x².
            for (power, slope) in [(0, 0.0), (1, 1.0), (2, 0.0)] {
                let sum = |lengths: &[f64]| -> f64 {
                    let values = places.iter().map(|x: &f64| x.powi(power));
                    values.zip(lengths).map(|(f, length)| f * length).sum()
                };
                let expected = sum(&ends) + first * first / 12.0 * slope;
                assert!((sum(&weights) - expected).abs() < 1e-15);
            }
        }
        let uniform = added_by_gregory(24.0, 24.0);
        assert_eq!(uniform, [-3.0, 4.0, -1.0]);
    }
}
