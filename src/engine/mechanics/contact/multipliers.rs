//! Normal forces as additional unknowns of Newton's method.
//!
//! Every candidate pair of edges has a slot; the slots of every node over every plane come after
//! these (see [`super::slots`]).
//!
//! The contact force falls to a third within δ/30 of gap, a distance that rods cross many times
//! within one time step. Consider Newton's method on the gap alone. An iterate slightly too far out
//! has no force at all, and one slightly too far in has a force that is orders of magnitude too
//! large; then the method needs an iteration for every factor of e. So each pair keeps its normal
//! force λ from the last step, and Newton's method solves the pair of equations
//!
//! ```text
//! R(q, λ) = 0,   λ = N(g(q)),
//! ```
//!
//! with λ eliminated: the matrix has the same pattern, and the solution is the same. Interior
//! point methods treat their barriers in this way. After an iteration λ has the value of the
//! linear law at the displacements from the linear system, which omits the curvature of the gap g,
//! so λ and N(g) may differ. The law is next linearised between them, at the force λ* and the gap
//! g* with
//!
//! ```text
//! λ* = N(g*),   λ* − ρ g* = λ − ρ g,
//! ```
//!
//! with the inertia ρ = 1/Σ(w² h²/m) of the two bodies at their contact points: the force λ opens
//! a gap of λ/ρ within a step. This is a step of the primal–dual active set method (Hintermüller,
//! Ito and Kunisch 2002, Eq. 2.3). A contact presses if λ > ρ g, whatever its state in the last
//! iteration, with a force of the size that removes the overlap; otherwise it is open.
//!
//! The first iteration of a step has no previous linear law. If the prediction is good, its gaps
//! give the new forces to second order in the step, and the law is linearised there. If the force
//! at the predicted gap is not of the size of the last step's force, gaps are not accurate enough
//! for that, and the step above begins with the last force.
//!
//! Active sets may cycle: release a contact, find it crossed, and close it again. A contact that
//! opens therefore keeps the part [`KEPT_PART`] of its force for one iteration, until corrections
//! are small.

use super::candidates::carried_over;
use super::contacts::CandidatePair;
use super::normal_law::NormalLaw;
use super::normal_response::NormalResponse;
use super::slots::{SlotValues, Slots};
use crate::mechanics::Vector3;

/// Part of the force that a contact keeps in the iteration in which it opens.
///
/// With zero, some steps of a pile cycle through active sets. A contact that truly opens should
/// lose its force within two or three iterations.
const KEPT_PART: f64 = 0.02;

/// Largest ratio between the force at the predicted gap and that of the last step for which the
/// first linearisation uses the predicted gap.
///
/// Chosen by trial in knots that are pulled tight: 2 saves most of the iterations that 4 saves,
/// and 100 saves no more.
const TRUSTED_RATIO: f64 = 4.0;

/// Largest ratio of two successive forces of a slot for which the rotation of its contact is
/// included.
///
/// Without this rotation, the contact points of nearly parallel edges move back and forth along
/// them without end, though the force is already correct. Chosen by trial: in piles of 60 and of 200 rods other
/// steps fail with 1.1, 1.5 and 4, but few with each value.
const KNOWN_RATIO: f64 = 1.1;

/// Displacements of the nodes of a contact since the last linearisation, m, and their resistance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moved {
    /// Displacements of the four nodes; contact with a plane uses only the first.
    pub displacements: [Vector3; 4],
    /// Inertia ρ of the contact points, N/m.
    pub inertia: f64,
    /// Whether corrections have become small.
    pub slightly: bool,
    /// Whether this is the first linearisation of the step, at the prediction.
    pub predicted: bool,
}

impl Moved {
    /// A linear form of the displacements.
    pub(crate) fn along(&self, rates: &[f64; 12]) -> f64 {
        let nodes = self.displacements.iter().zip(rates.as_chunks::<3>().0);
        nodes
            .map(|(moved, [x, y, z])| x * moved.x + y * moved.y + z * moved.z)
            .sum()
    }
}

/// The force law of one contact in the linear system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LinearLaw {
    /// λ* and N′(g*), for the Jacobian.
    pub tangent: NormalResponse,
    /// Force of the linear law at the present gap, N.
    pub force: f64,
}

/// The normal force of a slot as a linear function of displacements.
#[derive(Clone, Copy, Debug, Default)]
struct Tangent {
    /// Without displacements, N.
    value: f64,
    /// By displacements, N/m.
    rates: [f64; 12],
    /// Force λ* at which the law was linearised, N.
    force: f64,
}

impl Tangent {
    /// Creates a force that does not depend on displacements.
    fn constant(force: f64) -> Self {
        Self {
            value: force,
            force,
            ..Self::default()
        }
    }
}

/// The normal forces of all slots.
#[derive(Clone, Debug, Default)]
pub(super) struct Multipliers {
    in_use: bool,
    /// Forces at the end of the last accepted step, N, one per slot.
    committed: Vec<f64>,
    /// Linear laws of the last linearisation; slots without a law have no force.
    tangents: SlotValues<Tangent>,
}

impl Multipliers {
    /// Starts the iterations of a step from the committed forces.
    pub(crate) fn begin(&mut self, slots: Slots) {
        self.committed.resize(slots.count(), 0.0);
        self.tangents.clear(slots.count());
        for (slot, force) in self.committed.iter().enumerate() {
            if *force > 0.0 {
                self.tangents.set(slot, Tangent::constant(*force));
            }
        }
        self.in_use = true;
    }

    /// Initial force of the iterations at a slot, N.
    pub(crate) fn begun(&self, slot: usize) -> f64 {
        self.force(slot)
    }

    /// Starts the iterations without forces.
    pub(crate) fn begin_without(&mut self) {
        self.tangents.forget();
    }

    /// Starts the iterations with a force at a slot, N.
    pub(crate) fn begin_with(&mut self, slot: usize, force: f64) {
        self.tangents.set(slot, Tangent::constant(force));
    }

    /// Commits the forces of an accepted step, slot by slot; slots that are not given are set to
    /// zero.
    pub(crate) fn commit(&mut self, slots: Slots, forces: impl Iterator<Item = (usize, f64)>) {
        self.committed.clear();
        self.committed.resize(slots.count(), 0.0);
        for (slot, force) in forces {
            self.committed[slot] = force;
        }
        self.in_use = false;
    }

    /// Carries all forces over to a new list of candidates; both lists are sorted.
    pub(crate) fn carry_over(&mut self, old: &[CandidatePair], new: &[CandidatePair]) {
        self.committed = carried_over(old, &self.committed, new);
        self.tangents.carry_over(old, new);
    }

    /// Forces at the end of the last accepted step, N, one per slot.
    pub(crate) fn committed(&self) -> &[f64] {
        &self.committed
    }

    /// Restores stored forces.
    pub(crate) fn restore(&mut self, committed: &[f64]) {
        self.committed = committed.to_vec();
        self.in_use = false;
    }

    /// Linearises at the present gaps from now on.
    pub(crate) fn abandon(&mut self) {
        self.in_use = false;
    }

    /// Whether iterations use the multipliers.
    pub(crate) fn in_use(&self) -> bool {
        self.in_use
    }

    /// Force of the last linearisation of a slot, N.
    fn force(&self, slot: usize) -> f64 {
        self.tangents.get(slot).map_or(0.0, |tangent| tangent.force)
    }

    /// Whether the multiplier of a slot carries a force, at any gap.
    pub(crate) fn is_loaded(&self, slot: usize) -> bool {
        self.in_use && self.force(slot) > 0.0
    }

    /// Whether the force (N) for the linearisation of a slot is close to that of the last
    /// linearisation, or before that to the initial force of the iterations.
    pub(crate) fn is_known(&self, slot: usize, force: f64) -> bool {
        self.in_use && are_alike(force, self.force(slot), KNOWN_RATIO)
    }

    /// The law of a slot at `gap`, m.
    pub(crate) fn linear_law(
        &self,
        slot: usize,
        gap: f64,
        law: &NormalLaw,
        moved: &Moved,
    ) -> LinearLaw {
        let without = Tangent::default();
        let tangent = self.tangents.get(slot).unwrap_or(&without);
        let wanted = tangent.value + moved.along(&tangent.rates);
        let here = moved.predicted.then(|| law.response(gap).force);
        let (mut force, mut at) = match here.filter(|here| are_alike(*here, wanted, TRUSTED_RATIO))
        {
            Some(here) => (here, gap),
            None => law.resolved(wanted, gap, moved.inertia),
        };
        let kept = KEPT_PART * tangent.force;
        if force < kept && kept > law.least_force() && !moved.slightly {
            (force, at) = (kept, law.gap_of_force(kept));
        }
        let tangent = if force > 0.0 {
            law.response(at)
        } else {
            NormalResponse::default()
        };
        LinearLaw {
            tangent,
            force: tangent.force + tangent.force_slope * (gap - at),
        }
    }

    /// Stores the linear law of a slot; `gradient` is the derivative of its gap with respect to
    /// the displacements.
    pub(crate) fn keep(&mut self, slot: usize, law: &LinearLaw, gradient: &[f64; 12]) {
        let tangent = Tangent {
            value: law.force,
            rates: gradient.map(|rate| law.tangent.force_slope * rate),
            force: law.tangent.force,
        };
        self.tangents.set(slot, tangent);
    }
}

/// Whether two forces are within a ratio of each other.
fn are_alike(first: f64, second: f64, ratio: f64) -> bool {
    first < ratio * second && second < ratio * first
}

#[cfg(test)]
mod tests {
    use super::super::parameters::{ContactModel, ContactParameters};
    use super::*;
    use crate::mechanics::test_support::{SOFT_MODELS, contact};

    fn pair(i: usize, j: usize) -> CandidatePair {
        CandidatePair {
            edges: [i, j],
            nodes: [i, i + 1, j, j + 1],
            side: 0,
            start: 0,
        }
    }

    #[test]
    fn forces_follow_their_pairs_to_a_new_list() {
        let mut multipliers = Multipliers::default();
        multipliers.restore(&[1.0, 2.0, 3.0]);
        let old = [pair(0, 4), pair(1, 4), pair(2, 7)];
        multipliers.carry_over(
            &old,
            &[pair(0, 3), pair(1, 4), pair(2, 6), pair(2, 7), pair(3, 9)],
        );
        assert_eq!(multipliers.committed(), [0.0, 2.0, 0.0, 3.0, 0.0]);
    }

    fn slots(candidates: usize) -> Slots {
        Slots {
            candidates,
            ..Slots::default()
        }
    }

    #[test]
    fn forces_of_planes_stay_behind_those_of_any_list_of_pairs() {
        let mut multipliers = Multipliers::default();
        multipliers.restore(&[1.0, 2.0, 7.0, 8.0]);
        multipliers.carry_over(&[pair(0, 4), pair(1, 4)], &[pair(1, 4)]);
        assert_eq!(multipliers.committed(), [2.0, 7.0, 8.0]);
    }

    const TOLERANCE: f64 = 1e-5;

    fn laws() -> [NormalLaw; 2] {
        SOFT_MODELS.map(|model| {
            let parameters = ContactParameters {
                stiffness_factor: if model == ContactModel::ImplicitContact {
                    1e5
                } else {
                    1.0
                },
                ..contact(model, TOLERANCE)
            };
            NormalLaw::new(&parameters, 1e-3, parameters.stiffness_per_force(1e-3))
        })
    }

    /// Two bodies on a line with the resistance `inertia`, N/m.
    fn moved(by: f64, inertia: f64) -> Moved {
        let mut displacements = [Vector3::zeros(); 4];
        displacements[0].x = by;
        Moved {
            displacements,
            inertia,
            slightly: false,
            predicted: false,
        }
    }

    /// Number of iterations to find the gap of a mass with inertia `inertia`, which would be at
    /// `free` without contact and carried `force` in the last step.
    fn iterations(law: &NormalLaw, inertia: f64, free: f64, force: f64) -> usize {
        let mut multipliers = Multipliers::default();
        multipliers.restore(&[force]);
        multipliers.begin(slots(1));
        let (mut gap, mut step) = (free, 0.0);
        for iteration in 0..60 {
            let (wanted, found) = (inertia * (gap - free), law.response(gap).force);
            if (wanted - found).abs() < 1e-6 * wanted.max(1e-3) {
                return iteration;
            }
            let moved = Moved {
                predicted: iteration == 0,
                ..moved(step, inertia)
            };
            let linear = multipliers.linear_law(0, gap, law, &moved);
            let mut gradient = [0.0; 12];
            gradient[0] = 1.0;
            multipliers.keep(0, &linear, &gradient);
            step = (linear.force - wanted) / (inertia - linear.tangent.force_slope);
            gap += step;
        }
        usize::MAX
    }

    #[test]
    fn contacts_close_open_and_rest_within_few_iterations() {
        let mut most = 0;
        for law in laws() {
            for inertia in [1.0, 15.0, 1e3] {
                for force in [0.0, 1e-4, 1e-2, 1.0] {
                    for free in [-1e-3, -1e-5, 1e-7, 5e-6, 1e-5, 1e-4, 1e-3] {
                        most = most.max(iterations(&law, inertia, free, force));
                    }
                }
            }
        }
        assert!(most <= 9, "{most}");
    }

    #[test]
    fn a_prediction_is_trusted_where_it_bears_a_force_like_the_last() {
        for law in laws() {
            let mut multipliers = Multipliers::default();
            multipliers.restore(&[2.0]);
            multipliers.begin(slots(1));
            let mut prediction = Moved {
                predicted: true,
                ..moved(0.0, 10.0)
            };
            for (force, trusted) in [(0.4, false), (0.6, true), (7.0, true), (9.0, false)] {
                let gap = law.gap_of_force(force);
                let linear = multipliers.linear_law(0, gap, &law, &prediction);
                let error = (linear.tangent.force / force - 1.0).abs();
                assert_eq!(error < 1e-9, trusted, "{force}: {error}");
            }
            // Later iterations begin with their own linear law.
            prediction.predicted = false;
            let later = multipliers.linear_law(0, law.gap_of_force(0.6), &law, &prediction);
            assert!((later.tangent.force / 2.0 - 1.0).abs() < 1e-2);
        }
    }

    #[test]
    fn a_linear_law_touches_the_force_law_at_its_force() {
        for law in laws() {
            let mut multipliers = Multipliers::default();
            multipliers.restore(&[2.0]);
            multipliers.begin(slots(1));
            // A gap that matches the force needs no correction.
            let gap = law.gap_of_force(2.0);
            let linear = multipliers.linear_law(0, gap, &law, &moved(0.0, 10.0));
            assert!((linear.tangent.force - 2.0).abs() < 1e-9 && (linear.force - 2.0).abs() < 1e-9);
            // A contact that is far apart opens, at first only in part.
            let opening = multipliers.linear_law(0, 1.0, &law, &moved(0.0, 10.0));
            assert!((opening.tangent.force / (KEPT_PART * 2.0) - 1.0).abs() < 1e-9);
            let slightly = Moved {
                slightly: true,
                ..moved(0.0, 10.0)
            };
            let open = multipliers.linear_law(0, 1.0, &law, &slightly);
            assert_eq!((open.tangent.force, open.force), (0.0, 0.0));
        }
    }

    #[test]
    fn a_contact_that_begins_with_overlap_bears_what_removes_it() {
        for law in laws() {
            let mut multipliers = Multipliers::default();
            multipliers.begin(slots(1));
            let deep = multipliers.linear_law(0, -1e-3, &law, &moved(0.0, 15.0));
            assert!((deep.tangent.force / (15.0 * 1e-3) - 1.0).abs() < 0.02);
        }
    }
}
