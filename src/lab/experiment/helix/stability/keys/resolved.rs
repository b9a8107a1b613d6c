//! The resolved helix-stability experiment.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Stability limits of clamped helical rods of length 1 and bending stiffness 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HelixStability {
    /// Edges of the rod.
    pub edges: usize,
    /// Whether the limit of a fine mesh is extrapolated with a mesh of half as many edges.
    pub extrapolate: bool,
    /// How the rod approaches each point.
    pub search: HelixSearch,
    /// Radius over length.
    pub radius: f64,
    /// GJ/EI.
    pub stiffness_ratio: f64,
    /// Distance ‖(κ, τ, ω)‖ at which the search ends.
    pub largest_distance: f64,
    /// The directions.
    pub directions: Directions,
    /// Number of directions in each of the three sections.
    pub section_directions: usize,
}

impl HelixStability {
    /// Minimum number of edges that resolves a helix.
    pub const FEWEST_EDGES: usize = 8;
    /// Largest distance per edge. At this distance the angle between edges is half a radian.
    pub const LARGEST_TURN: f64 = 0.5;
}

/// How the rod approaches a point of the (κ, τ, ω) space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum HelixSearch {
    /// Directly to the equilibrium next to the helix.
    Fast,
    /// From the straight rod, by moving its ends along the direction.
    Path,
}

/// Directions (κ, τ, ω) with κ ≥ 0.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Directions {
    /// A spherical Fibonacci lattice on the half sphere.
    Fibonacci {
        /// Number of directions.
        count: usize,
    },
    /// A grid of angles from the κ axis and angles about it.
    Grid {
        /// Number of angles from the κ axis.
        polar: usize,
        /// Number of angles about the κ axis.
        azimuthal: usize,
    },
    /// A list.
    List {
        /// Vectors (κ, τ, ω) of any length except zero.
        points: Vec<[f64; 3]>,
    },
}

impl Directions {
    /// The unit vectors (κ, τ, ω).
    pub fn unit_vectors(&self) -> Vec<[f64; 3]> {
        match self {
            // Equal areas: the height κ of points on a sphere is uniformly distributed; successive
            // points are rotated by the golden angle.
            Self::Fibonacci { count } => (0..*count)
                .map(|k| {
                    let kappa = 1.0 - (k as f64 + 0.5) / *count as f64;
                    let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
                    on_sphere(libm::acos(kappa), k as f64 * golden_angle)
                })
                .collect(),
            Self::Grid { polar, azimuthal } => (1..=*polar)
                .flat_map(|i| {
                    let from_axis = FRAC_PI_2 * i as f64 / *polar as f64;
                    (0..*azimuthal)
                        .map(move |j| on_sphere(from_axis, TAU * j as f64 / *azimuthal as f64))
                })
                .collect(),
            Self::List { points } => points
                .iter()
                .map(|point| {
                    let norm = point.iter().map(|c| c * c).sum::<f64>().sqrt();
                    point.map(|component| component / norm)
                })
                .collect(),
        }
    }
}

/// The unit vector (κ, τ, ω) at an angle from the κ axis, and an angle about it measured from the
/// τ axis.
fn on_sphere(from_axis: f64, about_axis: f64) -> [f64; 3] {
    // The equator is a section of straight rods: sets the curvature left by rounding to zero.
    let kappa = if from_axis == FRAC_PI_2 {
        0.0
    } else {
        libm::cos(from_axis)
    };
    [
        kappa,
        libm::sin(from_axis) * libm::cos(about_axis),
        libm::sin(from_axis) * libm::sin(about_axis),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_unit_vectors_of_the_half_sphere_and_evenly_spread() {
        let lists = [
            Directions::Fibonacci { count: 1000 },
            Directions::Grid {
                polar: 9,
                azimuthal: 36,
            },
            Directions::List {
                points: vec![[1.0, 1.0, -1.0], [0.0, 0.0, 3.0]],
            },
        ];
        for directions in &lists {
            for direction in directions.unit_vectors() {
                let norm: f64 = direction.iter().map(|c| c * c).sum();
                assert!((norm - 1.0).abs() < 1e-14 && direction[0] >= 0.0);
            }
        }
        // Moments of a uniform hemisphere.
        let points = lists[0].unit_vectors();
        let mean = |value: fn(&[f64; 3]) -> f64| points.iter().map(value).sum::<f64>() / 1000.0;
        assert!((mean(|p| p[0]) - 0.5).abs() < 1e-3);
        assert!((mean(|p| p[1] * p[1]) - 1.0 / 3.0).abs() < 2e-3);
        assert!(mean(|p| p[1] * p[2]).abs() < 2e-3);
    }
}
