//! Typed keys of the stability of helical rods.

use super::RADIUS;
use super::resolved::HelixSearch;
use crate::scenario::keys::{Dimensionless, POSITIVE, Vector, keys};
use schemars::JsonSchema;
use serde::Deserialize;

keys! {
    /// Stability limits of clamped helical rods. The search starts at the straight rod and moves
    /// outwards along directions of the (κ, τ, ω) space of curvature, torsion and twisting moment.
    /// The rod has length 1 and bending stiffness 1.
    table HelixStability "helix_stability" {
        /// Number of edges of the rod, at least 8. Default: 100. The error falls with the square
        /// of their length.
        edges: raw(i64) raw,
        /// Whether each direction is also searched with half as many edges, to extrapolate the
        /// limit of a fine mesh.
        extrapolate: flag() default(false),
        /// Approach to each point: "fast" (the default: directly to the equilibrium next to the
        /// helix) or "path" (the ends are moved along the direction from the straight rod, as in
        /// an experiment).
        search: word(HelixSearch) default(HelixSearch::Fast),
        /// Radius over length, for contact of a rod with itself.
        radius: number(Dimensionless, POSITIVE) default(RADIUS),
        /// Twisting over bending stiffness, GJ/EI. Default: 2/3, the value of an incompressible
        /// round rod.
        stiffness_ratio: number(Dimensionless, POSITIVE) default(2.0 / 3.0),
        /// Distance ‖(κ, τ, ω)‖ at which the search ends; a rod stable up to there counts as unbounded. Default: a
        /// quarter of the number of edges.
        largest_distance: number(Dimensionless, POSITIVE) derived,
        /// Directions that the search follows.
        directions: raw(Directions) raw,
        /// Number of directions in each of the sections κτ, κω and τω, in addition to the other
        /// directions. Default: 0.
        section_directions: raw(i64) raw,
    }
}

/// Directions of the (κ, τ, ω) space with κ ≥ 0; their length does not matter.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(tag = "kind", rename = "directions")]
pub enum Directions {
    /// Points of a spherical Fibonacci lattice, evenly spread.
    Fibonacci(Fibonacci),
    /// A grid of angles.
    Grid(Grid),
    /// A list.
    List(List),
}

/// Points of a spherical Fibonacci lattice on the half sphere κ ≥ 0.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "fibonacci")]
pub struct Fibonacci {
    /// Number of directions.
    pub count: Option<i64>,
}

/// Angles from the κ axis, 0 to π/2, combined with angles about it, measured from the τ axis.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "grid")]
pub struct Grid {
    /// Number of angles from the κ axis; the axis itself is not included.
    pub polar: Option<i64>,
    /// Number of angles about the κ axis.
    pub azimuthal: Option<i64>,
}

/// A list of directions; give `file` or `points`.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "list")]
pub struct List {
    /// CSV file with columns kappa, tau, omega, relative to this file.
    pub file: Option<String>,
    /// The directions themselves, [κ, τ, ω] each.
    pub points: Option<Vec<Vector<Dimensionless>>>,
}
