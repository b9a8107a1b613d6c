//! Quantities that probes can measure.

use super::distance::least_distance;
use super::gauss::{linking_number, writhe};
use crate::run::Sample;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::dynamics::{Resultants, Simulation};
use rodlab_engine::mechanics::rod::RodRange;
use serde::{Deserialize, Serialize};

/// The measured quantity. Rods are numbered as in the scene, nodes and edges over the whole scene;
/// the edge of a node is the one that starts there. A quantity along a rod is measured at one node
/// or edge; `None` means the value with the largest absolute value along the rod, with its sign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Quantity {
    /// Position of a node, m.
    Position {
        /// The node.
        node: usize,
    },
    /// Displacement of a node from where it was placed, m.
    Displacement {
        /// The node.
        node: usize,
        /// Placed position of the node, m.
        from: Vector3,
    },
    /// Velocity of a node, m/s.
    Velocity {
        /// The node.
        node: usize,
    },
    /// Distance of two nodes, m.
    NodeDistance {
        /// The nodes.
        nodes: [usize; 2],
    },
    /// Least distance of the centrelines of two rods, m.
    RodDistance {
        /// The rods.
        rods: [usize; 2],
    },
    /// Force (N) and moment (N m) of a clamp on the rod.
    Reaction {
        /// The held node.
        node: usize,
    },
    /// Tension EA (l/l̃ − 1), N.
    Tension {
        /// The rod.
        rod: usize,
        /// The edge.
        edge: Option<usize>,
    },
    /// Magnitude of the bending moment, N m.
    BendingMoment {
        /// The rod.
        rod: usize,
        /// The node.
        node: Option<usize>,
    },
    /// Twisting moment, N m.
    TwistingMoment {
        /// The rod.
        rod: usize,
        /// The node.
        node: Option<usize>,
    },
    /// Curvature of the centreline, 1/m.
    Curvature {
        /// The rod.
        rod: usize,
        /// The node.
        node: Option<usize>,
    },
    /// Torsion of the centreline, 1/m.
    Torsion {
        /// The rod.
        rod: usize,
        /// The edge.
        edge: Option<usize>,
    },
    /// Twist of the material frame per length, rad/m.
    Twist {
        /// The rod.
        rod: usize,
        /// The node.
        node: Option<usize>,
    },
    /// Contact force on a rod, N: the total force, and the sums of the magnitudes of the normal
    /// and the tangential forces.
    ContactForce {
        /// The rod.
        rod: usize,
        /// The body that presses on the rod.
        from: ContactPartner,
    },
    /// Energies of a rod, J.
    Energy {
        /// The rod.
        rod: usize,
    },
    /// Writhe of a centreline.
    Writhe {
        /// The rod.
        rod: usize,
    },
    /// Linking number of two centrelines.
    LinkingNumber {
        /// The rods.
        rods: [usize; 2],
    },
    /// Length of a rod, m.
    ArcLength {
        /// The rod.
        rod: usize,
    },
    /// Force of a spring between nodes, N.
    SpringForce {
        /// The spring.
        spring: usize,
    },
    /// Tensions of a tendon at its first and at its last eyelet, N, and its length, m.
    Tendon {
        /// The tendon.
        tendon: usize,
    },
    /// Force, N, and moment, N m, of a sheath on its rod, and length of the rod outside, m.
    Sheath {
        /// The sheath.
        sheath: usize,
    },
    /// Magnitude of the force of a part of the scene on its first node, N.
    NodeForce {
        /// The force.
        force: usize,
    },
    /// Position of a free body, m, its rotation vector, rad, and its kinetic energy, J.
    Body {
        /// The body.
        body: usize,
    },
}

/// Body that presses on a rod.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ContactPartner {
    /// Another rod, or the rod itself.
    Rod(usize),
    /// A plane.
    Plane(usize),
    /// An obstacle.
    Obstacle(usize),
    /// All rods, planes and obstacles.
    Anything,
}

/// Component and unit of a column, both suffixes to the name of the probe.
type Part = (&'static str, &'static str);

const LENGTHS: [Part; 3] = [("_x", "_m"), ("_y", "_m"), ("_z", "_m")];
const VELOCITIES: [Part; 3] = [("_x", "_m_per_s"), ("_y", "_m_per_s"), ("_z", "_m_per_s")];
const REACTIONS: [Part; 6] = [
    ("_force_x", "_n"),
    ("_force_y", "_n"),
    ("_force_z", "_n"),
    ("_moment_x", "_n_m"),
    ("_moment_y", "_n_m"),
    ("_moment_z", "_n_m"),
];
const CONTACT_FORCES: [Part; 5] = [
    ("_x", "_n"),
    ("_y", "_n"),
    ("_z", "_n"),
    ("_normal", "_n"),
    ("_tangential", "_n"),
];
const BODY: [Part; 7] = [
    ("_x", "_m"),
    ("_y", "_m"),
    ("_z", "_m"),
    ("_turn_x", "_rad"),
    ("_turn_y", "_rad"),
    ("_turn_z", "_rad"),
    ("_kinetic", "_j"),
];
const ENERGIES: [Part; 5] = [
    ("_kinetic", "_j"),
    ("_stretching", "_j"),
    ("_bending", "_j"),
    ("_twisting", "_j"),
    ("_gravitational", "_j"),
];

/// Angle between two edges below which their binormal does not define torsion.
const STRAIGHT: f64 = 1e-9;

impl Quantity {
    /// Whether the quantity depends only on the positions and velocities of nodes and frames, not
    /// on stiffness or forces.
    pub fn is_of_shape(&self) -> bool {
        match self {
            Self::Position { .. }
            | Self::Displacement { .. }
            | Self::Velocity { .. }
            | Self::NodeDistance { .. }
            | Self::RodDistance { .. }
            | Self::Curvature { .. }
            | Self::Torsion { .. }
            | Self::Twist { .. }
            | Self::Writhe { .. }
            | Self::LinkingNumber { .. }
            | Self::ArcLength { .. } => true,
            Self::Reaction { .. }
            | Self::Tension { .. }
            | Self::BendingMoment { .. }
            | Self::TwistingMoment { .. }
            | Self::ContactForce { .. }
            | Self::Energy { .. }
            | Self::SpringForce { .. }
            | Self::Tendon { .. }
            | Self::Sheath { .. }
            | Self::NodeForce { .. }
            | Self::Body { .. } => false,
        }
    }

    /// Whether contact forces or energies of contact are part of the quantity.
    pub fn is_of_contact(&self) -> bool {
        matches!(self, Self::ContactForce { .. } | Self::Energy { .. })
    }

    /// Components and units of the columns.
    pub fn columns(&self) -> &'static [Part] {
        match self {
            Self::Position { .. } | Self::Displacement { .. } => &LENGTHS,
            Self::Velocity { .. } => &VELOCITIES,
            Self::NodeDistance { .. } | Self::RodDistance { .. } | Self::ArcLength { .. } => {
                &[("", "_m")]
            }
            Self::Reaction { .. } => &REACTIONS,
            Self::Tension { .. } | Self::SpringForce { .. } | Self::NodeForce { .. } => {
                &[("", "_n")]
            }
            Self::Tendon { .. } => &[
                ("_tension", "_n"),
                ("_end_tension", "_n"),
                ("_length", "_m"),
            ],
            Self::Sheath { .. } => &[("_force", "_n"), ("_moment", "_n_m"), ("_outside", "_m")],
            Self::BendingMoment { .. } | Self::TwistingMoment { .. } => &[("", "_n_m")],
            Self::Curvature { .. } | Self::Torsion { .. } => &[("", "_per_m")],
            Self::Twist { .. } => &[("", "_rad_per_m")],
            Self::ContactForce { .. } => &CONTACT_FORCES,
            Self::Energy { .. } => &ENERGIES,
            Self::Body { .. } => &BODY,
            Self::Writhe { .. } | Self::LinkingNumber { .. } => &[("", "")],
        }
    }

    /// The current values, one for each column. `None` if undefined: forces before the first step,
    /// moments at free ends, torsion of straight parts.
    pub fn measure(&self, sample: &Sample<'_>) -> Vec<Option<f64>> {
        let simulation = sample.simulation;
        let positions = simulation.positions();
        let vector = |vector: Vector3| vector.iter().copied().map(Some).collect();
        match *self {
            Self::Position { node } => vector(positions[node]),
            Self::Displacement { node, from } => vector(positions[node] - from),
            Self::Velocity { node } => vector(simulation.velocities()[node]),
            Self::NodeDistance {
                nodes: [one, other],
            } => {
                vec![Some((positions[one] - positions[other]).norm())]
            }
            Self::RodDistance { rods: [one, other] } => {
                let (one, other) = (centreline(simulation, one), centreline(simulation, other));
                vec![Some(least_distance(one, other))]
            }
            Self::Reaction { .. } | Self::ContactForce { .. } if sample.steps == 0 => {
                vec![None; self.columns().len()]
            }
            Self::Reaction { node } => {
                let force = simulation.reaction(node);
                let moment = simulation.reaction_moment(node);
                force.iter().chain(&moment).copied().map(Some).collect()
            }
            Self::Tension { rod, edge } => {
                vec![largest(simulation, rod, edge, |edge| {
                    simulation.tension(edge)
                })]
            }
            Self::Torsion { rod, edge } => {
                let range = &simulation.rod_ranges()[rod];
                vec![largest(simulation, rod, edge, |edge| {
                    torsion(positions, range, edge)
                })]
            }
            Self::BendingMoment { rod, node } => {
                resultant(simulation, rod, node, |all| all.bending_moment)
            }
            Self::TwistingMoment { rod, node } => {
                resultant(simulation, rod, node, |all| all.twisting_moment)
            }
            Self::Curvature { rod, node } => resultant(simulation, rod, node, |all| all.curvature),
            Self::Twist { rod, node } => resultant(simulation, rod, node, |all| all.twist),
            Self::ContactForce { rod, from } => contact_force(simulation, rod, from),
            Self::Energy { rod } => {
                let energies = simulation.energies_of(rod);
                let parts = [
                    energies.kinetic,
                    energies.stretching,
                    energies.bending,
                    energies.twisting,
                    energies.gravitational,
                ];
                parts.map(Some).into()
            }
            Self::Writhe { rod } => {
                let (points, closed) = centreline(simulation, rod);
                vec![Some(writhe(points, closed))]
            }
            Self::LinkingNumber { rods: [one, other] } => {
                let (one, other) = (centreline(simulation, one), centreline(simulation, other));
                vec![Some(linking_number(one, other))]
            }
            Self::ArcLength { rod } => {
                let range = &simulation.rod_ranges()[rod];
                let length = |edge| (positions[range.end_of(edge)] - positions[edge]).norm();
                vec![Some(range.edge_indices().map(length).sum())]
            }
            Self::SpringForce { spring } => vec![Some(simulation.spring_force(spring))],
            Self::Tendon { tendon } => vec![
                Some(simulation.tendon_tension(tendon)),
                Some(simulation.tendon_end_tension(tendon)),
                Some(simulation.tendon_length(tendon)),
            ],
            Self::Sheath { sheath } => {
                let [force, moment] = simulation.sheath_force(sheath);
                let outside = simulation.length_outside(sheath);
                [force, moment, outside].map(Some).to_vec()
            }
            Self::NodeForce { force } => vec![Some(simulation.node_force(force).norm())],
            Self::Body { body } => {
                let motion = simulation.body_motion(body);
                let vectors = motion.position.iter().chain(&motion.turn).copied();
                vectors.chain([motion.kinetic_energy]).map(Some).collect()
            }
        }
    }
}

/// Nodes of a rod, and whether it is closed.
fn centreline(simulation: &Simulation, rod: usize) -> (&[Vector3], bool) {
    let range = &simulation.rod_ranges()[rod];
    (&simulation.positions()[range.node_indices()], range.closed)
}

/// The value at one place, or the one with the largest absolute value along a rod.
fn largest(
    simulation: &Simulation,
    rod: usize,
    place: Option<usize>,
    value: impl Fn(usize) -> Option<f64>,
) -> Option<f64> {
    if let Some(place) = place {
        return value(place);
    }
    let places = simulation.rod_ranges()[rod].node_indices();
    let values = places.filter_map(value);
    values.max_by(|a, b| a.abs().total_cmp(&b.abs()))
}

fn resultant(
    simulation: &Simulation,
    rod: usize,
    node: Option<usize>,
    of: impl Fn(&Resultants) -> f64,
) -> Vec<Option<f64>> {
    let all = simulation.resultants();
    let value = |node: usize| all[node].as_ref().map(&of);
    vec![largest(simulation, rod, node, value)]
}

/// Torsion at an edge: the angle between the binormals at its ends, over its length; `None` if the
/// centreline is straight there or ends.
fn torsion(positions: &[Vector3], range: &RodRange, edge: usize) -> Option<f64> {
    let (first, last) = (range.first_node, range.first_node + range.nodes - 1);
    let before = match edge {
        edge if edge > first => edge - 1,
        _ if range.closed => last,
        _ => return None,
    };
    let after = range.end_of(edge);
    if !range.edge_indices().contains(&after) || !range.edge_indices().contains(&edge) {
        return None;
    }
    let vector = |edge: usize| positions[range.end_of(edge)] - positions[edge];
    let tangents = [before, edge, after].map(|edge| vector(edge).normalize());
    let binormals = [
        tangents[0].cross(&tangents[1]),
        tangents[1].cross(&tangents[2]),
    ];
    if binormals.iter().any(|binormal| binormal.norm() < STRAIGHT) {
        return None;
    }
    let sine = binormals[0].cross(&binormals[1]).dot(&tangents[1]);
    let angle = libm::atan2(sine, binormals[0].dot(&binormals[1]));
    Some(angle / vector(edge).norm())
}

fn contact_force(simulation: &Simulation, rod: usize, from: ContactPartner) -> Vec<Option<f64>> {
    let ranges = simulation.rod_ranges();
    let is_on = |rod: usize, node: usize| ranges[rod].node_indices().contains(&node);
    let (mut sum, mut normal, mut tangential) = (Vector3::zeros(), 0.0, 0.0);
    for pair in simulation.contacts().iter() {
        // The bodies of a pair, as the rod and the other body, with the sign of the force on the
        // rod.
        let ends = [(0, 3, 1.0), (3, 0, -1.0)];
        let ends = ends.map(|(own, other, sign)| (pair.nodes[own], pair.nodes[other], sign));
        let mut is_counted = false;
        for (own, other, sign) in ends {
            let counts = match from {
                ContactPartner::Rod(partner) => is_on(rod, own) && is_on(partner, other),
                ContactPartner::Anything => is_on(rod, own),
                ContactPartner::Obstacle(obstacle) => {
                    is_on(rod, own) && simulation.obstacle_at(pair) == Some(obstacle)
                }
                ContactPartner::Plane(_) => false,
            };
            if !counts {
                continue;
            }
            let force = pair.force_on_first() * sign;
            sum += force;
            // A contact of a rod with itself counts once, though both its edges belong to the rod.
            if !is_counted {
                normal += pair.normal_force;
                tangential += (force - pair.normal * force.dot(&pair.normal)).norm();
                is_counted = true;
            }
        }
    }
    for touch in simulation.plane_contacts().iter() {
        let counts = match from {
            ContactPartner::Plane(plane) => touch.plane == plane,
            ContactPartner::Anything => true,
            ContactPartner::Rod(_) | ContactPartner::Obstacle(_) => false,
        };
        if !counts || !is_on(rod, touch.node) {
            continue;
        }
        let force = Vector3::from(touch.force);
        let across = force.dot(&simulation.planes()[touch.plane].normal);
        sum += force;
        normal += across;
        let along = simulation.planes()[touch.plane].normal * across;
        tangential += (force - along).norm();
    }
    [sum.x, sum.y, sum.z, normal, tangential].map(Some).into()
}
