//! The equations of [`LANES`] systems at once, one in each lane: residual and Jacobian of [`super::System`], of the same operations in
//! the same order.
//!
//! The systems have the same rods with the same unknowns held, and differ in numbers: stiffness, masses, loads, natural strains,
//! clamps that move. Of the forces, those take part whose terms state it ([`super::term::Term::has_copies`]): elasticity with actuators
//! and dashpots, dead loads, inertia, linear drag. They fill a band, and nothing else.

use super::{Stage, System};
use crate::linalg::instruction_set::{InstructionSet, LANES, Lanes, kernel};
use crate::linalg::{BandedLanes, HALF_BANDWIDTH};
use crate::mechanics::rod::{RodCopies, STRIDE};
use std::ops::Range;

const NONE: Lanes = [0.0; LANES];

/// Copies of a system and its stage; arrays over unknowns.
pub(crate) struct Copies {
    pub set: InstructionSet,
    rods: RodCopies,
    pub held: Vec<bool>,
    masses: Vec<Lanes>,
    chains: Vec<ChainCopies>,
    loads: Vec<Lanes>,
    /// Empty without drag.
    drag: Vec<Lanes>,
    start: Vec<Lanes>,
    velocity: Vec<Lanes>,
    /// 1/h and 1/hₐ.
    per_step: Lanes,
    per_acceleration_step: Lanes,
    pub allowances: Vec<Allowance>,
    /// Residual of the last evaluation.
    pub residual: Vec<Lanes>,
    pub band: BandedLanes,
}

/// Masses that each node shares with the next.
struct ChainCopies {
    first_node: usize,
    shared: Vec<[Lanes; STRIDE]>,
}

/// Residual that counts as none on a rod.
pub(crate) struct Allowance {
    pub unknowns: Range<usize>,
    /// N.
    pub force: Lanes,
    /// Weight of the residual of the rod.
    pub weight: Lanes,
    /// By which moments are multiplied, 1/m.
    pub per_length: Lanes,
}

impl System {
    /// Whether all of its forces are of the kinds above.
    pub(crate) fn has_copies(&self) -> bool {
        let terms = self.terms.all();
        self.assembly.joints.is_empty() && terms.iter().all(|term| term.has_copies())
    }
}

impl Copies {
    /// Storage for systems like this; `None` where one of its forces has no copies.
    pub(crate) fn new(system: &System) -> Option<Self> {
        let assembly = &system.assembly;
        if !system.has_copies() {
            return None;
        }
        let unknowns = assembly.unknowns.len();
        let rods = RodCopies::new(&assembly.rods)?;
        let none = || vec![NONE; unknowns];
        let chains = assembly.consistent.chains.iter();
        Some(Self {
            set: InstructionSet::best(),
            rods,
            held: assembly.held.clone(),
            masses: none(),
            chains: chains
                .map(|chain| ChainCopies {
                    first_node: chain.first_node,
                    shared: vec![[NONE; STRIDE]; chain.shared.len()],
                })
                .collect(),
            loads: none(),
            drag: vec![NONE; system.terms.drag.coefficients.len()],
            start: none(),
            velocity: none(),
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
        })
    }

    /// Whether a system in a stage has the rods, the held unknowns and the forces of these.
    pub(crate) fn are_of(&self, system: &System, stage: &Stage) -> bool {
        let assembly = &system.assembly;
        let chains = &assembly.consistent.chains;
        self.held == assembly.held
            && self.rods.are_of(&assembly.rods)
            && self.drag.len() == system.terms.drag.coefficients.len()
            && self.chains.len() == chains.len()
            && (self.chains.iter().zip(chains)).all(|(own, chain)| {
                own.first_node == chain.first_node && own.shared.len() == chain.shared.len()
            })
            && stage.drag.is_empty()
            && system.has_copies()
    }

    /// Puts a system in its stage into a lane; its tolerances must be set.
    pub(crate) fn set(&mut self, lane: usize, system: &System, stage: &Stage) {
        let (assembly, terms) = (&system.assembly, &system.terms);
        self.rods.set(
            lane,
            system.acting_rods(),
            &system.reference,
            &system.ghosts,
        );
        for (own, values) in [
            (&mut self.masses, &assembly.masses),
            (&mut self.loads, &terms.loads.present),
            (&mut self.drag, &terms.drag.coefficients),
            (&mut self.start, &stage.start),
            (&mut self.velocity, &stage.velocity),
        ] {
            set_lane(own, lane, values);
        }
        for (own, chain) in self.chains.iter_mut().zip(&assembly.consistent.chains) {
            for (own, shared) in own.shared.iter_mut().zip(&chain.shared) {
                set_lane(own, lane, shared);
            }
        }
        self.per_step[lane] = 1.0 / stage.step;
        self.per_acceleration_step[lane] = 1.0 / stage.acceleration_step;
        for (rod, own) in self.allowances.iter_mut().enumerate() {
            (own.force[lane], own.weight[lane]) = system.allowance(rod);
            own.per_length[lane] = 1.0 / assembly.scales[rod].shortest_edge;
        }
    }

    /// Computes frames and strains at `unknowns`.
    pub(crate) fn update_geometry(&mut self, unknowns: &[Lanes]) {
        self.rods.update(unknowns);
    }

    /// Evaluates the residuals at `unknowns`, those of the last [`Self::update_geometry`].
    pub(crate) fn evaluate(&mut self, unknowns: &[Lanes]) {
        self.residual.fill(NONE);
        self.rods.add_gradient(&mut self.residual);
        self.add_other_forces(unknowns);
    }

    /// Evaluates residuals and Jacobians there.
    pub(crate) fn linearize(&mut self, unknowns: &[Lanes]) {
        self.residual.fill(NONE);
        self.band.clear();
        self.rods
            .add_derivatives(&mut self.residual, &mut self.band);
        self.add_other_forces(unknowns);
        self.add_other_jacobians();
        for (k, _) in self.held.iter().enumerate().filter(|(_, held)| **held) {
            self.band.hold(k);
        }
    }

    /// Loads, inertia and drag.
    fn add_other_forces(&mut self, unknowns: &[Lanes]) {
        let motion = Motion {
            unknowns,
            start: &self.start,
            velocity: &self.velocity,
            per_step: &self.per_step,
            per_acceleration_step: &self.per_acceleration_step,
        };
        let (set, residual) = (self.set, &mut self.residual[..]);
        add_loads_and_inertia(set, &motion, &self.loads, &self.masses, residual);
        for chain in &self.chains {
            add_shared_inertia(set, &motion, chain.first_node, &chain.shared, residual);
        }
        add_drag(set, &motion, &self.drag, residual);
    }

    fn add_other_jacobians(&mut self) {
        let steps = [&self.per_acceleration_step, &self.per_step];
        let (set, columns) = (self.set, self.band.columns_mut());
        add_masses(set, steps, &self.masses, columns);
        for chain in &self.chains {
            let columns = &mut columns[STRIDE * chain.first_node..];
            add_shared_masses(set, steps, &chain.shared, columns);
        }
        add_resistance(set, &self.per_step, &self.drag, columns);
    }
}

/// The motion of a stage, (q − qₙ)/h and vₙ.
pub(super) struct Motion<'a> {
    unknowns: &'a [Lanes],
    start: &'a [Lanes],
    velocity: &'a [Lanes],
    per_step: &'a Lanes,
    per_acceleration_step: &'a Lanes,
}

impl Motion<'_> {
    /// (q − qₙ)/h − vₙ of an unknown.
    #[inline(always)]
    fn change(&self, unknown: usize, lane: usize) -> f64 {
        let moved = self.unknowns[unknown][lane] - self.start[unknown][lane];
        moved * self.per_step[lane] - self.velocity[unknown][lane]
    }
}

kernel! {
    /// Adds −F + M/hₐ ((q − qₙ)/h − vₙ) with the masses lumped at each unknown.
    fn add_loads_and_inertia(motion: &Motion, loads: &[Lanes], masses: &[Lanes], residual: &mut [Lanes]) {
        for (k, entry) in residual.iter_mut().enumerate() {
            for lane in 0..LANES {
                let mass = masses[k][lane] * motion.per_acceleration_step[lane];
                entry[lane] -= loads[k][lane];
                entry[lane] += mass * motion.change(k, lane);
            }
        }
    }
}

kernel! {
    /// Adds what the accelerations make of the masses that neighbours share: see [`super::mass`].
    fn add_shared_inertia(motion: &Motion, first_node: usize, shared: &[[Lanes; STRIDE]], residual: &mut [Lanes]) {
        let mut own = [NONE; STRIDE];
        for k in 0..STRIDE {
            for lane in 0..LANES {
                let change = motion.change(STRIDE * first_node + k, lane);
                own[k][lane] = motion.per_acceleration_step[lane] * change;
            }
        }
        for (node, shared) in (first_node..).zip(shared) {
            for k in 0..STRIDE {
                let unknown = STRIDE * node + k;
                for lane in 0..LANES {
                    let change = motion.change(unknown + STRIDE, lane);
                    let next = motion.per_acceleration_step[lane] * change;
                    let force = shared[k][lane] * (next - own[k][lane]);
                    residual[unknown][lane] += force;
                    residual[unknown + STRIDE][lane] -= force;
                    own[k][lane] = next;
                }
            }
        }
    }
}

kernel! {
    /// Adds C (q − qₙ)/h.
    fn add_drag(motion: &Motion, coefficients: &[Lanes], residual: &mut [Lanes]) {
        for (k, coefficient) in coefficients.iter().enumerate() {
            for lane in 0..LANES {
                let moved = motion.unknowns[k][lane] - motion.start[k][lane];
                residual[k][lane] += coefficient[lane] * moved * motion.per_step[lane];
            }
        }
    }
}

/// Columns of a band.
type Columns = [[Lanes; HALF_BANDWIDTH + 1]];

kernel! {
    /// Adds M/(hₐ h), lumped; `steps` are 1/hₐ and 1/h.
    fn add_masses(steps: [&Lanes; 2], masses: &[Lanes], columns: &mut Columns) {
        for (column, mass) in columns.iter_mut().zip(masses) {
            for lane in 0..LANES {
                column[0][lane] += mass[lane] * steps[0][lane] * steps[1][lane];
            }
        }
    }
}

kernel! {
    /// The same with the masses that neighbours share, from the first column of their chain on; rows still sum to the lumped masses
    /// (`Assembly::add_shared_masses`).
    fn add_shared_masses(steps: [&Lanes; 2], shared: &[[Lanes; STRIDE]], columns: &mut Columns) {
        let mut before = [NONE; STRIDE];
        for (node, shared) in shared.iter().enumerate() {
            for k in 0..STRIDE {
                let column = &mut columns[STRIDE * node + k];
                for lane in 0..LANES {
                    let mass = steps[0][lane] * steps[1][lane] * shared[k][lane];
                    let sum = column[STRIDE][lane] + mass;
                    let kept = sum - column[STRIDE][lane];
                    column[STRIDE][lane] = sum;
                    column[0][lane] -= before[k][lane] + kept;
                    before[k][lane] = kept;
                }
            }
        }
        for k in 0..STRIDE {
            for lane in 0..LANES {
                columns[STRIDE * shared.len() + k][0][lane] -= before[k][lane];
            }
        }
    }
}

kernel! {
    /// Adds C/h.
    fn add_resistance(per_step: &Lanes, coefficients: &[Lanes], columns: &mut Columns) {
        for (column, coefficient) in columns.iter_mut().zip(coefficients) {
            for lane in 0..LANES {
                column[0][lane] += coefficient[lane] * per_step[lane];
            }
        }
    }
}

/// Writes numbers into a lane.
pub(crate) fn set_lane(lanes: &mut [Lanes], lane: usize, values: &[f64]) {
    for (own, value) in lanes.iter_mut().zip(values) {
        own[lane] = *value;
    }
}
