//! Probes as typed.

use crate::scenario::place::TypedPlace;
use crate::scenario::resolved::Summary;
use schemars::JsonSchema;
use serde::Deserialize;

/// A quantity that is measured at every output: columns of `series.csv`, whose names begin with that of the probe and
/// end with the unit, and on request of `summary.csv`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(tag = "kind", rename = "probe")]
pub enum Probe {
    /// Position of a node: columns _x_m, _y_m, _z_m.
    Position(NodeProbe),
    /// Displacement of a node from where it was placed: columns _x_m, _y_m, _z_m.
    Displacement(NodeProbe),
    /// Velocity of a node: columns _x_m_per_s, _y_m_per_s, _z_m_per_s.
    Velocity(NodeProbe),
    /// Distance of two nodes, or without `at` and `to` the least distance of the centrelines of two rods: column _m.
    Distance(DistanceProbe),
    /// Force and moment that a clamp exerts on the rod at its node: columns _force_x_n, _force_y_n, _force_z_n,
    /// _moment_x_n_m, _moment_y_n_m, _moment_z_n_m. Empty before the first step.
    Reaction(NodeProbe),
    /// Tension of an edge, positive where it is stretched: column _n.
    Tension(EdgeProbe),
    /// Size of the bending moment at a node: column _n_m. Empty at free ends.
    BendingMoment(SectionProbe),
    /// Twisting moment at a node: column _n_m. Empty at free ends.
    TwistingMoment(SectionProbe),
    /// Curvature of the centreline at a node: column _per_m. Empty at free ends.
    Curvature(SectionProbe),
    /// Torsion of the centreline at an edge: column _per_m. Empty at the first and last edge and where it is straight.
    Torsion(EdgeProbe),
    /// Twist of the material frame per length at a node: column _rad_per_m. Empty at free ends.
    Twist(SectionProbe),
    /// Contact force on a rod from another, from a plane, or from all: columns _x_n, _y_n, _z_n (the sum), _normal_n
    /// and _tangential_n (the sizes of all contacts added up). Empty before the first step.
    ContactForce(ContactForceProbe),
    /// Energies of one rod: columns _kinetic_j, _stretching_j, _bending_j, _twisting_j, _gravitational_j.
    Energy(RodProbe),
    /// Writhe of the centreline, by Gauss' integral; an open rod is not closed for it. Column without a unit.
    Writhe(RodProbe),
    /// Linking number of two centrelines, by Gauss' integral: a whole number where both are closed. Column without a
    /// unit.
    LinkingNumber(LinkingProbe),
    /// Length of a rod: column _m.
    ArcLength(RodProbe),
    /// Force of a spring between nodes, positive where it pulls, 0 after it broke: column _n.
    SpringForce(SpringProbe),
}

/// A probe at a node.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "node_probe")]
pub struct NodeProbe {
    /// Name with which the columns begin: small letters, digits and underscores.
    pub name: Option<String>,
    /// Name of the rod. Default: the only rod there is.
    pub rod: Option<String>,
    /// "start", "end", or the number of a node, counted from zero.
    pub at: Option<TypedPlace>,
    /// What stands in `summary.csv`: the "last", "max", "min" or "mean" value of the rows. Default: nothing.
    pub summary: Option<Summary>,
}

/// A probe at a node, or of the largest value along a rod.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "section_probe")]
pub struct SectionProbe {
    /// Name with which the columns begin: small letters, digits and underscores.
    pub name: Option<String>,
    /// Name of the rod. Default: the only rod there is.
    pub rod: Option<String>,
    /// "start", "end", or the number of a node. Default: where the value is largest in size along the rod.
    pub at: Option<TypedPlace>,
    /// What stands in `summary.csv`: the "last", "max", "min" or "mean" value of the rows. Default: nothing.
    pub summary: Option<Summary>,
}

/// A probe at an edge, or of the largest value along a rod.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "edge_probe")]
pub struct EdgeProbe {
    /// Name with which the columns begin: small letters, digits and underscores.
    pub name: Option<String>,
    /// Name of the rod. Default: the only rod there is.
    pub rod: Option<String>,
    /// "start", "end", or the number of an edge. Default: where the value is largest in size along the rod.
    pub at: Option<TypedPlace>,
    /// What stands in `summary.csv`: the "last", "max", "min" or "mean" value of the rows. Default: nothing.
    pub summary: Option<Summary>,
}

/// A probe of a distance.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "distance_probe")]
pub struct DistanceProbe {
    /// Name with which the columns begin: small letters, digits and underscores.
    pub name: Option<String>,
    /// Name of the rod. Default: the only rod there is.
    pub rod: Option<String>,
    /// "start", "end", or the number of a node; goes with `to`.
    pub at: Option<TypedPlace>,
    /// Name of the other rod. Default: the same rod.
    pub to_rod: Option<String>,
    /// Node of the other rod; goes with `at`.
    pub to: Option<TypedPlace>,
    /// What stands in `summary.csv`: the "last", "max", "min" or "mean" value of the rows. Default: nothing.
    pub summary: Option<Summary>,
}

/// A probe of contact forces.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "contact_force_probe")]
pub struct ContactForceProbe {
    /// Name with which the columns begin: small letters, digits and underscores.
    pub name: Option<String>,
    /// Name of the rod on which the force acts. Default: the only rod there is.
    pub rod: Option<String>,
    /// Name of the rod that presses on it; its own name for contact with itself, whose sum is zero. Default: all rods,
    /// planes and obstacles.
    pub from_rod: Option<String>,
    /// Number of the plane that presses on it, counted from zero, instead of a rod.
    pub from_plane: Option<i64>,
    /// Name of the obstacle that presses on it, instead of a rod.
    pub from_obstacle: Option<String>,
    /// What stands in `summary.csv`: the "last", "max", "min" or "mean" value of the rows. Default: nothing.
    pub summary: Option<Summary>,
}

/// A probe of a whole rod.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "rod_probe")]
pub struct RodProbe {
    /// Name with which the columns begin: small letters, digits and underscores.
    pub name: Option<String>,
    /// Name of the rod. Default: the only rod there is.
    pub rod: Option<String>,
    /// What stands in `summary.csv`: the "last", "max", "min" or "mean" value of the rows. Default: nothing.
    pub summary: Option<Summary>,
}

/// A probe of two rods.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "linking_probe")]
pub struct LinkingProbe {
    /// Name with which the columns begin: small letters, digits and underscores.
    pub name: Option<String>,
    /// Name of the one rod.
    pub rod: Option<String>,
    /// Name of the other rod.
    pub to_rod: Option<String>,
    /// What stands in `summary.csv`: the "last", "max", "min" or "mean" value of the rows. Default: nothing.
    pub summary: Option<Summary>,
}

/// A probe of a spring.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "spring_probe")]
pub struct SpringProbe {
    /// Name with which the columns begin: small letters, digits and underscores.
    pub name: Option<String>,
    /// Name of the joint that is the spring.
    pub joint: Option<String>,
    /// What stands in `summary.csv`: the "last", "max", "min" or "mean" value of the rows. Default: nothing.
    pub summary: Option<Summary>,
}

/// A condition that ends the run with the output at which it holds.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, rename = "stop_when")]
pub struct StopWhen {
    /// The probe, where it has one column, or the column, such as "tip_z_m".
    pub probe: Option<String>,
    /// The run ends where the column exceeds this number, in the unit of the column.
    pub above: Option<f64>,
    /// The run ends where the column falls below this number.
    pub below: Option<f64>,
}
