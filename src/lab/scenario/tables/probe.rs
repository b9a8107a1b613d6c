//! Probes, and the condition that ends a run.

use crate::scenario::declaration::keys;
use crate::scenario::section::Section;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

keys! {
    /// A quantity that is measured at every output. Its columns in `series.csv`, and on request in
    /// `summary.csv`, begin with the name of the probe and end with the unit.
    kinds ProbeKeys "probe", "snake_case" => Probe()
    before {
        /// Name of the probe, with which its columns begin: small letters, digits and underscores.
        name: column() required,
    }
    also {}
    ProbeKind {
        /// Position of a node: columns _x_m, _y_m, _z_m.
        Position {
            /// Name of the rod. Default: the only rod there is.
            rod: text() optional,
            /// "start", "end", or the number of a node, counted from zero.
            at: place() required,
        },
        /// Displacement of a node from its placed position: columns _x_m, _y_m, _z_m.
        Displacement {
            /// Name of the rod. Default: the only rod there is.
            rod: text() optional,
            /// "start", "end", or the number of a node, counted from zero.
            at: place() required,
        },
        /// Velocity of a node: columns _x_m_per_s, _y_m_per_s, _z_m_per_s.
        Velocity {
            /// Name of the rod. Default: the only rod there is.
            rod: text() optional,
            /// "start", "end", or the number of a node, counted from zero.
            at: place() required,
        },
        /// Distance of two nodes, or without `at` and `to` the least distance of the centrelines of two rods: column _m.
        Distance {
            /// Name of the rod. Default: the only rod there is.
            rod: text() optional,
            /// Name of the other rod. Default: the same rod.
            to_rod: text() optional,
            /// "start", "end", or the number of a node; requires `to`.
            at: place() optional,
            /// Node of the other rod; requires `at`.
            to: place() optional,
        },
        /// Force and moment that a clamp exerts on the rod at its node: columns _force_x_n, _force_y_n, _force_z_n,
        /// _moment_x_n_m, _moment_y_n_m, _moment_z_n_m. Empty before the first step. Also the force
        /// of an axle on its free body.
        Reaction {
            /// Name of the rod, or of a free body with an `axle`. Default: the only rod there is.
            rod: text() optional,
            /// "start", "end", or the number of a node, counted from zero.
            at: place() required,
        },
        /// Tension of an edge, positive if it is stretched: column _n.
        Tension {
            /// Name of the rod. Default: the only rod there is.
            rod: text() optional,
            /// "start", "end", or the number of an edge. Default: the place of the largest
            /// absolute value along the rod.
            at: place() optional,
        },
        /// Magnitude of the bending moment at a node: column _n_m. Empty at free ends.
        BendingMoment {
            /// Name of the rod. Default: the only rod there is.
            rod: text() optional,
            /// "start", "end", or the number of a node. Default: the place of the largest absolute
            /// value along the rod.
            at: place() optional,
        },
        /// Twisting moment at a node: column _n_m. Empty at free ends.
        TwistingMoment {
            /// Name of the rod. Default: the only rod there is.
            rod: text() optional,
            /// "start", "end", or the number of a node. Default: the place of the largest absolute
            /// value along the rod.
            at: place() optional,
        },
        /// Curvature of the centreline at a node: column _per_m. Empty at free ends.
        Curvature {
            /// Name of the rod. Default: the only rod there is.
            rod: text() optional,
            /// "start", "end", or the number of a node. Default: the place of the largest absolute
            /// value along the rod.
            at: place() optional,
        },
        /// Torsion of the centreline at an edge: column _per_m. Empty at the first and last edge and where it is straight.
        Torsion {
            /// Name of the rod. Default: the only rod there is.
            rod: text() optional,
            /// "start", "end", or the number of an edge. Default: the place of the largest
            /// absolute value along the rod.
            at: place() optional,
        },
        /// Twist of the material frame per length at a node: column _rad_per_m. Empty at free ends.
        Twist {
            /// Name of the rod. Default: the only rod there is.
            rod: text() optional,
            /// "start", "end", or the number of a node. Default: the place of the largest absolute
            /// value along the rod.
            at: place() optional,
        },
        /// Contact force on a rod or free body from another one, a plane, an obstacle, or all of
        /// them: columns _x_n, _y_n, _z_n (the total force), _normal_n and _tangential_n (the
        /// magnitudes of all contacts added up). Empty before the first step.
        ContactForce {
            /// Name of the rod or free body on which the force acts. Default: the only rod there is.
            rod: text() optional,
            /// Name of the rod or free body that presses on it. Its own name selects contact with
            /// itself, whose total force is zero. Default: all rods, bodies, planes and obstacles.
            from_rod: text() optional,
            /// Number of the plane that presses on it, counted from zero, instead of a rod.
            from_plane: index() optional,
            /// Name of the obstacle that presses on it, instead of a rod.
            from_obstacle: text() optional,
        },
        /// Motion of a free body: columns _x_m, _y_m, _z_m of its centre of mass, _turn_x_rad,
        /// _turn_y_rad, _turn_z_rad of the rotation vector since time zero (its length is at most
        /// half a turn), and _kinetic_j of its kinetic energy.
        Body {
            /// Name of the body.
            body: text("the name of a free body") required,
        },
        /// Energies of one rod: columns _kinetic_j, _stretching_j, _bending_j, _twisting_j, _gravitational_j.
        Energy {
            /// Name of the rod. Default: the only rod there is.
            rod: text() optional,
        },
        /// Writhe of the centreline, by Gauss' integral; the ends of an open rod are not joined.
        /// Column without a unit.
        Writhe {
            /// Name of the rod. Default: the only rod there is.
            rod: text() optional,
        },
        /// Linking number of two centrelines, by Gauss' integral: a whole number if both are
        /// closed. Column without a unit.
        LinkingNumber {
            /// Name of the one rod.
            rod: text("the name of a rod") required,
            /// Name of the other rod.
            to_rod: text("the name of another rod") required,
        },
        /// Length of a rod: column _m.
        ArcLength {
            /// Name of the rod. Default: the only rod there is.
            rod: text() optional,
        },
        /// Force of a spring between nodes, positive if it pulls, 0 after it broke: column _n.
        SpringForce {
            /// Name of the joint with the spring.
            joint: text("the name of a joint of kind = \"spring\"") required,
        },
        /// Force of a sheath on its rod in the direction in which it is fed, moment about this
        /// direction, and natural length of the rod outside: columns _force_n, _moment_n_m, _outside_m.
        Sheath {
            /// Name of the sheath.
            sheath: text("the name of a sheath") required,
        },
        /// Tensions of a tendon at its first and at its last eyelet, which differ by friction, and its
        /// length: columns _tension_n, _end_tension_n, _length_m.
        Tendon {
            /// Name of the tendon.
            tendon: text("the name of a tendon") required,
        },
    }
    after {
        /// Value in `summary.csv`: the "last", "max", "min" or "mean" value of the rows. Default: none.
        summary: word(Summary) optional,
    }
}

/// Statistic of a probe in the summary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Summary {
    /// That of the last row.
    Last,
    /// The largest.
    Max,
    /// The smallest.
    Min,
    /// The mean of all rows that have a value.
    Mean,
}

keys! {
    /// A condition that ends the run at the first output at which it holds.
    table StopKeys "stop_when" => StopWhen() {
        /// A column, such as "tip_z_m", or the name of a probe with a single column.
        probe: text("the name of a probe or of one of its columns") required,
        /// The run ends if the column exceeds this number, in the unit of the column.
        above: word(f64) optional,
        /// The run ends if the column falls below this number.
        below: word(f64) optional,
    }
}

/// Resolves all probes.
pub fn probes(top: &Section<'_>, typed: &[ProbeKeys]) -> Vec<Probe> {
    let mut probes: Vec<Probe> = Vec::new();
    for (section, typed) in top.elements("probes", typed) {
        let probe = typed.resolve(&section);
        check(&section, &probe.kind);
        if !probe.name.is_empty() && probes.iter().any(|other| other.name == probe.name) {
            let message = format!(
                "another probe has the name `{}`; names must be unique",
                probe.name
            );
            section.fault("name", message);
        }
        probes.push(probe);
    }
    probes
}

/// Checks several keys of a kind against each other.
fn check(section: &Section<'_>, kind: &ProbeKind) {
    match kind {
        ProbeKind::Distance {
            rod,
            to_rod,
            at,
            to,
        } => match (at, to) {
            (Some(_), Some(_)) => {}
            (None, None) if to_rod.is_none() => section.missing(
                "to_rod",
                "the name of the other rod, or the nodes `at` and `to`",
            ),
            (None, None) if to_rod == rod => section.fault(
                "to_rod",
                "a rod has no distance from itself; give the nodes `at` and `to`",
            ),
            (None, None) => {}
            (at, _) => {
                let (key, rod) = if at.is_some() {
                    ("to", "other")
                } else {
                    ("at", "one")
                };
                let help = format!(
                    "the node of the {rod} rod; without `at` and `to` the least distance of two rods"
                );
                section.missing(key, help);
            }
        },
        ProbeKind::ContactForce {
            from_rod,
            from_plane,
            from_obstacle,
            ..
        } => {
            if from_rod.is_some() && from_plane.is_some() {
                section.fault(
                    "from_plane",
                    "the force is either from a rod or from a plane; leave one of the keys out",
                );
            }
            if from_obstacle.is_some() && (from_rod.is_some() || from_plane.is_some()) {
                section.fault(
                    "from_obstacle",
                    "the force is either from a rod, from a plane or from an obstacle; leave the \
                     other keys out",
                );
            }
        }
        _ => {}
    }
}

/// Resolves the condition that ends a run.
pub fn stop_when(top: &Section<'_>, typed: Option<&StopKeys>) -> Option<StopWhen> {
    let section = top.below("stop_when");
    let condition = typed?.resolve(&section);
    match (condition.above, condition.below) {
        (None, None) => section.missing("above", "a number, `above` or `below` which the run ends"),
        (Some(_), Some(_)) => section.fault(
            "below",
            "either `above` or `below`; leave one of the keys out",
        ),
        _ => {}
    }
    for (key, number) in [("above", condition.above), ("below", condition.below)] {
        if number.is_some_and(|number| !number.is_finite()) {
            section.fault(key, "out of range; allowed: any finite number");
        }
    }
    Some(condition)
}
