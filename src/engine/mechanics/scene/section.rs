//! Cross-sections that vary along a rod.
//!
//! An edge carries one tension, a node one bending moment, and the twist between the middles of two
//! edges one torque. With the tension N, the edge is longer by ∫ N/EA ds, so its compliance 1/EA is
//! the mean over the edge. The twist at a node is ∫ T/GJ ds between the middles of its edges, and
//! 1/GJ is the mean over either half. Bending moments are linear between nodes that carry the
//! loads, M = Σ M_k φ_k with the hat functions φ_k, which are 1 at node k and 0 at the others. The
//! trapezoidal rule for the moments leaves
//!
//! ```text
//! ½ ∫ M²/EI ds  ≈  ½ Σ M_k² C_k,      C_k = ∫ φ_k/EI ds
//! ```
//!
//! so node k turns by M_k C_k. For any bounded EI, smooth or not, C_k makes the deflection at x
//!
//! ```text
//! Σ C_k g(s_k) = ∫ I_h g/EI ds,       g(s) = M(s) (x − s)
//! ```
//!
//! with the linear interpolation I_h g. The error ∫ (I_h g − g)/EI ds ≈ (h²/12) ∫ g''/EI ds is of
//! second order, wherever between the nodes sections meet: steps need no node of their own. (The
//! mean of 1/EI between the middles of edges has the same order if sections meet at nodes, and
//! otherwise an error up to h²/8 |g'| Δ(1/EI) that depends on the place of the joint between the
//! nodes.) Masses are shared in the same way, ∫ φ_k ρA ds, which keeps the mass and the centre of
//! mass of every edge. For a uniform rod all these means are the values themselves.
//!
//! The surface for contact is that of cylinders, one per edge, with the mean radius of the edge: a
//! tapered rod is a staircase whose steps are of first order in the edge length.

use super::{RodDescription, Stiffness};

/// The cross-section at one point of a rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Elastic stiffness.
    pub stiffness: Stiffness,
    /// Radius of the contact and fluid surface, m.
    pub radius: f64,
    /// Mass per length ρA, kg/m.
    pub mass_per_length: f64,
    /// Moment of inertia about the centreline per length, ρ(I₁ + I₂), kg m.
    pub rotational_inertia_per_length: f64,
    /// Own friction coefficient, if it has one.
    pub friction: Option<f64>,
}

/// The cross-section of one edge in means. Pairs are for the start and the end of the edge; each
/// counts for half of its length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeSection {
    /// Stretching stiffness, N: the harmonic mean of EA.
    pub stretching: f64,
    /// Bending stiffnesses about both directors, N m²: harmonic means of EI₁ and EI₂ with the
    /// weight φ of either end.
    pub bending: [[f64; 2]; 2],
    /// Twisting stiffnesses, N m²: harmonic means of GJ over either half.
    pub twisting: [f64; 2],
    /// Masses per length, kg/m: means of ρA with the weight φ of either end.
    pub mass_per_length: [f64; 2],
    /// Moment of inertia about the centreline per length, kg m.
    pub rotational_inertia_per_length: f64,
    /// Mean radius, m.
    pub radius: f64,
    /// Radii at either end of the edge, m.
    pub end_radii: [f64; 2],
    /// Own friction coefficient in the middle of the edge, if it has one there.
    pub friction: Option<f64>,
}

impl EdgeSection {
    /// An edge with the same section everywhere.
    pub fn uniform(section: &Section) -> Self {
        Self {
            stretching: section.stiffness.stretching,
            bending: [section.stiffness.bending; 2],
            twisting: [section.stiffness.twisting; 2],
            mass_per_length: [section.mass_per_length; 2],
            rotational_inertia_per_length: section.rotational_inertia_per_length,
            radius: section.radius,
            end_radii: [section.radius; 2],
            friction: section.friction,
        }
    }

    /// Largest mean of EI₁ and EI₂ at either end, N m².
    fn stiff_direction(&self) -> f64 {
        let [one, other] = self.bending.map(|ends| ends[0].max(ends[1]));
        one.max(other)
    }
}

/// Points and weights of Gauss' rule with eight points on [−1, 1], which is symmetric. Within one
/// edge that tapers to half its radius, its error is below 1e-12.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_27),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Distance from the ends of an edge at which its end radii are taken, and from its middle at which
/// its friction is, over its length.
const WITHIN: f64 = 1e-9;

/// The edges of a rod with the section `at(s)` at the arc length s (m). `nodes` are the arc lengths
/// of its nodes, and `joints` those at which the section may jump or have a kink, both increasing.
/// The section is evaluated between these places only.
pub fn edge_sections(
    nodes: &[f64],
    joints: &[f64],
    at: &dyn Fn(f64) -> Section,
) -> Vec<EdgeSection> {
    let edges = nodes.windows(2);
    edges
        .map(|ends| edge_section([ends[0], ends[1]], joints, at))
        .collect()
}

/// Sums over an edge, relative to its length.
#[derive(Default)]
struct Sums {
    stretching: f64,
    bending: [[f64; 2]; 2],
    twisting: [f64; 2],
    mass: [f64; 2],
    inertia: f64,
    radius: f64,
}

impl Sums {
    /// Adds a section that counts for the part `weight` of the edge at a place `along` it, 0 to 1.
    fn add(&mut self, section: &Section, along: f64, weight: f64) {
        let stiffness = &section.stiffness;
        self.stretching += weight / stiffness.stretching;
        for (end, hat) in [1.0 - along, along].into_iter().enumerate() {
            let share = 2.0 * hat * weight;
            for (sum, bending) in self.bending[end].iter_mut().zip(stiffness.bending) {
                *sum += share / bending;
            }
            self.mass[end] += share * section.mass_per_length;
        }
        self.twisting[usize::from(along > 0.5)] += 2.0 * weight / stiffness.twisting;
        self.inertia += weight * section.rotational_inertia_per_length;
        self.radius += weight * section.radius;
    }
}

/// The pieces of an edge between its ends, its middle and the joints inside it, in order.
pub fn pieces([start, end]: [f64; 2], joints: &[f64]) -> Vec<[f64; 2]> {
    let joints = joints.iter().copied();
    let inside = joints.filter(|joint| start < *joint && *joint < end);
    let mut places: Vec<f64> = inside.chain([start, 0.5 * (start + end), end]).collect();
    places.sort_by(f64::total_cmp);
    places.windows(2).map(|ends| [ends[0], ends[1]]).collect()
}

fn edge_section(
    [start, end]: [f64; 2],
    joints: &[f64],
    at: &dyn Fn(f64) -> Section,
) -> EdgeSection {
    let length = end - start;
    let mut sums = Sums::default();
    for [from, to] in pieces([start, end], joints) {
        let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
        for (point, weight) in GAUSS {
            for place in [centre - half * point, centre + half * point] {
                let along = (place - start) / length;
                sums.add(&at(place), along, weight * half / length);
            }
        }
    }
    EdgeSection {
        stretching: 1.0 / sums.stretching,
        bending: sums
            .bending
            .map(|end| end.map(|compliance| 1.0 / compliance)),
        twisting: sums.twisting.map(|compliance| 1.0 / compliance),
        mass_per_length: sums.mass,
        rotational_inertia_per_length: sums.inertia,
        radius: sums.radius,
        end_radii: [start + WITHIN * length, end - WITHIN * length].map(|place| at(place).radius),
        friction: at(start + (0.5 + WITHIN) * length).friction,
    }
}

impl RodDescription {
    /// This rod with the sections of its edges; `lengths` are those of the edges, m.
    #[must_use]
    pub fn with_sections(mut self, sections: Vec<EdgeSection>, lengths: &[f64]) -> Self {
        let total: f64 = lengths.iter().sum();
        let mean = |of: &dyn Fn(&EdgeSection) -> f64| {
            let parts = sections.iter().zip(lengths);
            parts
                .map(|(section, length)| of(section) * length)
                .sum::<f64>()
                / total
        };
        let bending =
            |axis: usize| mean(&|edge| 0.5 * (edge.bending[0][axis] + edge.bending[1][axis]));
        self.stiffness = Stiffness {
            stretching: mean(&|edge| edge.stretching),
            bending: [bending(0), bending(1)],
            twisting: mean(&|edge| 0.5 * (edge.twisting[0] + edge.twisting[1])),
        };
        self.mass_per_length =
            mean(&|edge| 0.5 * (edge.mass_per_length[0] + edge.mass_per_length[1]));
        self.rotational_inertia_per_length = mean(&|edge| edge.rotational_inertia_per_length);
        let radii = sections.iter().flat_map(|edge| edge.end_radii);
        self.radius = radii.fold(0.0, f64::max);
        self.sections = sections;
        self
    }

    /// The section of an edge.
    pub fn section(&self, edge: usize) -> EdgeSection {
        match self.sections.get(edge) {
            Some(section) => *section,
            None => EdgeSection::uniform(&Section {
                stiffness: self.stiffness,
                radius: self.radius,
                mass_per_length: self.mass_per_length,
                rotational_inertia_per_length: self.rotational_inertia_per_length,
                friction: self.friction,
            }),
        }
    }

    /// Own friction coefficients of its edges.
    pub fn frictions(&self) -> Vec<Option<f64>> {
        let edges = self
            .centreline
            .len()
            .saturating_sub(usize::from(!self.closed));
        let of_sections = |edge: usize| match self.sections.get(edge) {
            Some(section) => section.friction,
            None => self.friction,
        };
        (0..edges).map(of_sections).collect()
    }

    /// Radius of the surface at a node, m: the larger one if the sections of its edges differ.
    pub fn radius_at(&self, node: usize) -> f64 {
        if self.sections.is_empty() {
            return self.radius;
        }
        let edges = self.sections.len();
        let before = if node == 0 && self.closed {
            edges
        } else {
            node
        };
        let ending = before
            .checked_sub(1)
            .map(|edge| self.sections[edge].end_radii[1]);
        let starting = self.sections.get(node).map(|edge| edge.end_radii[0]);
        ending.into_iter().chain(starting).fold(0.0, f64::max)
    }

    /// Smallest radius, m.
    pub fn least_radius(&self) -> f64 {
        let radii = self.sections.iter().flat_map(|edge| edge.end_radii);
        radii.fold(self.radius, f64::min)
    }

    /// The larger of EI₁ and EI₂, N m², where it is least and where it is largest along the rod.
    pub(crate) fn bending_range(&self) -> [f64; 2] {
        let own = self.stiffness.bending[0].max(self.stiffness.bending[1]);
        let of_edges = || self.sections.iter().map(EdgeSection::stiff_direction);
        [of_edges().reduce(f64::min), of_edges().reduce(f64::max)].map(|one| one.unwrap_or(own))
    }

    /// Smallest EI₁ or EI₂ of the rod, N m².
    pub(crate) fn softest_bending(&self) -> f64 {
        let of_edges = self.sections.iter().flat_map(|edge| edge.bending);
        let softest = of_edges.chain([self.stiffness.bending]).flatten();
        softest.fold(f64::INFINITY, f64::min)
    }

    /// Largest EA of the rod, N.
    pub(crate) fn stiffest_stretching(&self) -> f64 {
        let of_edges = self.sections.iter().map(|edge| edge.stretching);
        of_edges
            .reduce(f64::max)
            .unwrap_or(self.stiffness.stretching)
    }
}
