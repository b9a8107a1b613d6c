//! Keys of tendons.

use crate::scenario::keys::{FINITE, NON_NEGATIVE, POSITIVE, Quantity, keys};
use crate::scenario::units::{Dimensionless, Force, Length, Time};

keys! {
    /// A cable without mass that runs straight from eyelet to eyelet and slides in them: a tendon of a
    /// robot, a rope over pulleys without radius, the line of a winch. Give its `tension`, or its
    /// `stretching_stiffness`.
    table TendonKeys "tendon" {
        /// Name for probes and messages. Default: "tendon 0", "tendon 1", ...
        name: text() derived,
        /// The eyelets, in the order in which the tendon runs through them: points that do not
        /// move, nodes, and rows of nodes. It is fixed to the first and the last one, or leaves the
        /// scene there.
        #[serde(default)]
        through: tables(Vec<EyeletKeys>) raw,
        /// Tension at given times, [[time, tension], ...], linear between them and constant
        /// outside: a tendon that a force pulls.
        tension: raw(Vec<(Quantity<Time>, Quantity<Force>)>) raw,
        /// Coefficient of friction μ in the inner eyelets of a tendon that is pulled or taken in at
        /// the first eyelet and fixed to the last: where the tendon turns by φ and slides, the
        /// tension changes by the factor e^(−μφ) or e^(μφ). Not in runs that find equilibria.
        friction: number(Dimensionless, NON_NEGATIVE) default(0.0),
        /// Length that the tendon is moved in an eyelet until it slides. Default: a
        /// hundred-thousandth of its placed length.
        presliding: number(Length, POSITIVE) optional,
        /// Stiffness EA of a tendon that stretches: its tension is EA (length/rest length − 1), and
        /// zero where it is slack.
        stretching_stiffness: number(Force, POSITIVE) optional,
        /// Length without tension of a tendon that stretches. Default: its length as placed.
        rest_length: number(Length, POSITIVE) optional,
        /// Length that a winch has taken in at given times, [[time, length], ...], linear between
        /// them and constant outside: the rest length is shorter by it. Negative values pay out.
        /// Default: none.
        taken_in: corners(Length) derived,
    }
}

keys! {
    /// An eyelet of a tendon, or a row of them along a rod: give a `position`, or a `rod` with `at`.
    table EyeletKeys "eyelet" {
        /// A point that does not move.
        position: vector(Length) optional,
        /// Name of the rod.
        rod: text() optional,
        /// Node of the eyelet: "start", "end" or a number.
        at: place() optional,
        /// Last node of a row of eyelets that begins at the node `at`. Default: one eyelet.
        to: place() optional,
        /// Distance of the eyelets of a row, in nodes; the last node has one in any case.
        every: count(1..=usize::MAX) default(1),
        /// Vector from the node to the eyelet: components along the two material directors. Default:
        /// [0, 0], the centreline.
        offset: numbers(Length, 2, FINITE) default([0.0; 2]),
        /// Turns of the offset about the rod, in the sense of a right-handed screw, from `at` to
        /// `to`, evenly over the nodes.
        turns: number(Dimensionless, FINITE) default(0.0),
    }
}
