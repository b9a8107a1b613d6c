//! The equations of [`LANES`] systems at once, one in each lane: residual and Jacobian of
//! [`super::System`], computed by the same operations in the same order.
//!
//! The systems have the same rods and the same held unknowns, and differ in values: stiffness,
//! masses, loads, natural strains, moving clamps. Only forces whose terms declare it take part
//! ([`super::term::Term::has_copies`]): elasticity with actuators and dashpots, dead loads,
//! inertia, linear drag. Their Jacobian is a band without other entries.

mod exchange;
mod forces;
mod matrix;
mod sweep;
mod work;

use super::{Stage, System};
use crate::linalg::instruction_set::{InstructionSet, LANES, Lanes};
use crate::linalg::{BandedLanes, LaneVector};
use crate::mechanics::rod::{RodCopies, STRIDE};
use std::collections::HashSet;
use std::ops::Range;

pub(crate) use exchange::{Member, set_lanes};

const NONE: Lanes = [0.0; LANES];
/// Number of systems remembered to be of the same kind; further systems are compared again.
const MOST_KEPT: usize = 1 << 16;

/// Copies of a system and its stage; arrays over unknowns.
pub(crate) struct Copies {
    pub set: InstructionSet,
    rods: RodCopies,
    pub held: Vec<bool>,
    masses: LaneVector,
    /// Masses that nodes share with the next node.
    shared: Vec<Shared>,
    loads: LaneVector,
    /// Empty without drag.
    drag: LaneVector,
    start: LaneVector,
    velocity: LaneVector,
    /// h, 1/h and 1/hₐ.
    step: Lanes,
    per_step: Lanes,
    per_acceleration_step: Lanes,
    pub allowances: Vec<Allowance>,
    /// Residual of the last evaluation.
    pub residual: LaneVector,
    band: BandedLanes,
    sweep: Vec<sweep::Piece>,
    /// Identifiers of systems that were found to be like these.
    fitting: HashSet<u64>,
}

/// Masses that each node of a chain shares with the next.
struct Shared {
    first_node: usize,
    /// Shared masses in the order of the unknowns from the first node on, one entry less than
    /// nodes.
    masses: LaneVector,
}

/// Tolerance of the residual of a rod.
pub(crate) struct Allowance {
    pub unknowns: Range<usize>,
    /// N.
    pub force: Lanes,
    /// Weight of the residual of the rod.
    pub weight: Lanes,
    /// Factor on moments, 1/m.
    pub per_length: Lanes,
}

impl System {
    /// Whether all forces of the system are of the kinds above.
    pub(crate) fn has_copies(&self) -> bool {
        let terms = self.terms.all();
        self.assembly.joints.is_empty() && terms.iter().all(|term| term.has_copies())
    }
}

impl Copies {
    /// Storage for systems like this; `None` if one of its forces has no copies.
    pub(crate) fn new(system: &System) -> Option<Self> {
        let assembly = &system.assembly;
        if !system.has_copies() {
            return None;
        }
        let unknowns = assembly.unknowns.len();
        let rods = RodCopies::new(&assembly.rods)?;
        let none = || LaneVector::new(unknowns);
        let chains = assembly.consistent.chains.iter();
        Some(Self {
            set: InstructionSet::best(),
            sweep: sweep::plan(&rods, &assembly.held),
            rods,
            held: assembly.held.clone(),
            masses: none(),
            shared: chains
                .map(|chain| Shared {
                    first_node: chain.first_node,
                    masses: LaneVector::new(STRIDE * chain.shared.len()),
                })
                .collect(),
            loads: none(),
            drag: LaneVector::new(system.terms.drag.coefficients.len()),
            start: none(),
            velocity: none(),
            step: NONE,
            per_step: NONE,
            per_acceleration_step: NONE,
            allowances: (assembly.rods.rods.iter())
                .map(|rod| Allowance {
                    unknowns: STRIDE * rod.first_node..STRIDE * (rod.first_node + rod.nodes),
                    force: NONE,
                    weight: NONE,
                    per_length: NONE,
                })
                .collect(),
            residual: none(),
            band: BandedLanes::new(unknowns),
            fitting: HashSet::new(),
        })
    }

    /// Whether a system in a stage has the same rods, held unknowns and forces as these copies.
    /// Only grasps change the answer.
    pub(crate) fn are_of(&mut self, system: &System, stage: &Stage) -> bool {
        if system.switched {
            return self.fit(system, stage);
        }
        if self.fitting.contains(&system.number) {
            return true;
        }
        let fits = self.fit(system, stage);
        if fits {
            if self.fitting.len() == MOST_KEPT {
                self.fitting.clear();
            }
            self.fitting.insert(system.number);
        }
        fits
    }

    fn fit(&self, system: &System, stage: &Stage) -> bool {
        let assembly = &system.assembly;
        let chains = &assembly.consistent.chains;
        self.held == assembly.held
            && self.rods.are_of(&assembly.rods)
            && self.drag.len() == system.terms.drag.coefficients.len()
            && self.shared.len() == chains.len()
            && (self.shared.iter().zip(chains)).all(|(own, chain)| {
                own.first_node == chain.first_node
                    && own.masses.len() == STRIDE * chain.shared.len()
            })
            && stage.drag.is_empty()
            && system.has_copies()
    }

    /// Rods that are not held.
    pub(crate) fn rods_that_move(&self) -> impl Iterator<Item = &Allowance> {
        let allowances = self.allowances.iter();
        allowances.filter(|allowance| allowance.force[0].is_finite())
    }

    /// Corrections of the last [`Self::solve`].
    pub(crate) fn direction(&self) -> &[Lanes] {
        self.band.sides()
    }

    /// The same, to be changed.
    pub(crate) fn direction_mut(&mut self) -> &mut [Lanes] {
        self.band.sides_mut()
    }
}
