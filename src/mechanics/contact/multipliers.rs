//! Normal forces that Newton's method carries along as unknowns of their own.
//!
//! Every candidate pair of edges has a slot, and after them every node over every plane (see [`Slots`]).
//!
//!
//! The contact force falls to a third within δ/30 of gap, a distance that rods cross many times within one
//! time step. Newton's method on the gap alone sees no force a little too far out, and one that is out
//! by orders of magnitude a little too far in; it then needs an iteration for every factor of e. So each
//! pair keeps its normal force λ from the last step, and the force law N(g) is linearised not at the present gap g but at
//! the gap that belongs to λ,
//!
//! ```text
//! N ≈ λ + N′(g_λ) (g − g_λ),   N(g_λ) = λ,
//! ```
//!
//! which is Newton's method for the pair of equations R(q, λ) = 0, g(q) = N⁻¹(λ), with λ eliminated: the
//! matrix has the same pattern, and the solution is the same. Interior point methods treat their barriers
//! so. After each iteration λ takes the value of the linear law at the new gap, but loses no more than
//! [`LARGEST_LOSS`] of itself, since no force is negative.
//!
//! Where a contact slides over a node it passes from one pair to the next. The new pair has hardly a force
//! to start from, but a gap that is known well, since it is that of the old pair; so a force that the
//! present gap gives is trusted up to [`TRUSTED_FRACTION`] of the largest force. So is that of a contact that begins: where
//! the predictor overlaps by some δ, the law gives a force that is too large by eight orders of magnitude, each of which
//! would take half an iteration to lose.
//!
//! Two flagella in a bundle (1 ms steps) take 2.7 iterations a step so, against 4.3 with the law at the
//! present gap.

use super::candidates::carried_over;
use super::contacts::CandidatePair;
use super::normal_response::NormalResponse;

/// Part of a multiplier that one iteration may take away.
///
/// Smaller steps keep the iteration near contacts that come back; a contact that truly opens should be gone
/// within two or three iterations.
const LARGEST_LOSS: f64 = 0.98;

/// Part of the largest force of the last step up to which forces of present gaps are trusted.
///
/// The prediction errs by some δ/30, so larger forces may be out by factors, which cost an iteration each;
/// smaller ones are not worth it. In a bundle of two flagella 0.1 takes 2.7 iterations a step, 0.5 takes 2.9, 3
/// takes 3.2, and none at all 3.8.
const TRUSTED_FRACTION: f64 = 0.1;

/// Where the contacts of a scene keep what they carry from step to step: candidate pairs first, then every node over
/// every plane.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slots {
    /// Candidate pairs.
    pub candidates: usize,
    /// Nodes of all rods.
    pub nodes: usize,
    /// Planes.
    pub planes: usize,
}

impl Slots {
    /// Number of slots.
    pub fn count(&self) -> usize {
        self.candidates + self.planes * self.nodes
    }

    /// Slot of a node over a plane.
    pub fn over_plane(&self, plane: usize, node: usize) -> usize {
        self.candidates + plane * self.nodes + node
    }
}

/// How evaluations treat the multipliers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    /// The force law is linearised at the present gap.
    #[default]
    Unused,
    /// The first iteration of a step linearises at the forces of the last step.
    Fresh,
    /// Later ones first bring the forces up to date.
    Advancing,
}

/// The normal forces of all slots.
#[derive(Clone, Debug, Default)]
pub(super) struct Multipliers {
    phase: Phase,
    /// Forces at the end of the last accepted step, N, one per slot.
    committed: Vec<f64>,
    /// Force of present gaps that is trusted, N.
    trusted: f64,
    /// Forces in the present iteration, N.
    present: Vec<f64>,
}

/// The force law of one pair as the linear system sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LinearLaw {
    /// λ and N′(g_λ), for the Jacobian.
    pub tangent: NormalResponse,
    /// Force of the linear law at the present gap, N.
    pub force: f64,
}

impl Multipliers {
    /// Starts the iterations of a step from the committed forces; where there are none, forces up to about `expected`, N,
    /// are to come.
    pub fn begin(&mut self, slots: Slots, expected: f64) {
        self.committed.resize(slots.count(), 0.0);
        self.present.clone_from(&self.committed);
        let largest = self.committed.iter().copied().fold(0.0, f64::max);
        self.trusted = TRUSTED_FRACTION * if largest > 0.0 { largest } else { expected };
        self.phase = Phase::Fresh;
    }

    /// Takes over the forces of an accepted step, slot by slot; those not given are zero.
    pub fn commit(&mut self, slots: Slots, forces: impl Iterator<Item = (usize, f64)>) {
        self.committed.clear();
        self.committed.resize(slots.count(), 0.0);
        for (slot, force) in forces {
            self.committed[slot] = force;
        }
        self.phase = Phase::Unused;
    }

    /// Carries the committed forces over to a new list of candidates; both lists are sorted.
    pub fn carry_over(&mut self, old: &[CandidatePair], new: &[CandidatePair]) {
        self.committed = carried_over(old, &self.committed, new);
        self.phase = Phase::Unused;
    }

    /// Forces at the end of the last accepted step, N, one per slot.
    pub fn committed(&self) -> &[f64] {
        &self.committed
    }

    /// Continues from stored forces.
    pub fn restore(&mut self, committed: &[f64]) {
        self.committed = committed.to_vec();
        self.phase = Phase::Unused;
    }

    /// Linearises at the present gaps from now on.
    pub fn abandon(&mut self) {
        self.phase = Phase::Unused;
    }

    /// Whether iterations use the multipliers.
    pub fn in_use(&self) -> bool {
        self.phase != Phase::Unused
    }

    /// Whether the contact of a slot bears force by its multiplier, wherever it is.
    pub fn is_loaded(&self, slot: usize) -> bool {
        self.in_use() && self.present[slot] > 0.0
    }

    /// The next evaluation with Jacobians brings the forces up to date.
    pub fn advance(&mut self) {
        if self.phase == Phase::Fresh {
            self.phase = Phase::Advancing;
        }
    }

    /// The law of a slot at `gap`, whose own response there is `response`; `None` where it is
    /// linearised at that gap. `law` gives the response of a gap, `inverse` the gap of a force.
    pub fn linear_law(
        &mut self,
        slot: usize,
        gap: f64,
        response: &NormalResponse,
        law: impl Fn(f64) -> NormalResponse,
        inverse: impl Fn(f64) -> f64,
    ) -> Option<LinearLaw> {
        if !self.in_use() {
            return None;
        }
        let known = self.present[slot];
        let trusted = response.force.min(self.trusted);
        if known == 0.0 && trusted == response.force {
            self.present[slot] = trusted;
            return None;
        }
        let at = |force: f64| {
            let gap_of_force = inverse(force);
            let tangent = law(gap_of_force);
            (
                tangent,
                tangent.force + tangent.force_slope * (gap - gap_of_force),
            )
        };
        let next = if known > 0.0 && self.phase == Phase::Advancing {
            at(known).1.max((1.0 - LARGEST_LOSS) * known)
        } else {
            known
        };
        let force = next.max(trusted);
        self.present[slot] = force;
        let (tangent, linear) = at(force);
        Some(LinearLaw {
            tangent,
            force: linear,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(i: usize, j: usize) -> CandidatePair {
        CandidatePair {
            edges: [i, j],
            nodes: [i, i + 1, j, j + 1],
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

    /// The law N(g) = e⁻ᵍ.
    fn law(gap: f64) -> NormalResponse {
        NormalResponse {
            energy: 0.0,
            force: (-gap).exp(),
            force_slope: -(-gap).exp(),
        }
    }

    fn inverse(force: f64) -> f64 {
        -force.ln()
    }

    #[test]
    fn a_linear_law_touches_the_force_law_at_its_force() {
        let mut multipliers = Multipliers::default();
        multipliers.restore(&[2.0]);
        multipliers.begin(slots(1), 1.0);
        // At the gap of the force itself the two agree; half a unit farther the tangent is lower.
        let linear = multipliers
            .linear_law(0, inverse(2.0), &law(inverse(2.0)), law, inverse)
            .unwrap();
        assert!((linear.force - 2.0).abs() < 1e-15);
        let gap = inverse(2.0) + 0.5;
        let linear = multipliers
            .linear_law(0, gap, &law(gap), law, inverse)
            .unwrap();
        assert!((linear.force - 1.0).abs() < 1e-15);
        // The next iteration starts from there, and never from less than nothing.
        multipliers.advance();
        multipliers.linear_law(0, gap, &law(gap), law, inverse);
        assert!((multipliers.present[0] - 1.0).abs() < 1e-15);
        multipliers.linear_law(0, gap + 9.0, &law(gap + 9.0), law, inverse);
        assert!((multipliers.present[0] - 0.02).abs() < 1e-15);
        // A gap that comes near is trusted up to a tenth of the largest force, which was 2.
        multipliers.linear_law(0, inverse(5.0), &law(inverse(5.0)), law, inverse);
        assert!((multipliers.present[0] - 0.2).abs() < 1e-15);
    }

    #[test]
    fn a_contact_that_begins_with_overlap_bears_what_is_believed() {
        let mut multipliers = Multipliers::default();
        multipliers.begin(slots(2), 3.0);
        let deep = multipliers.linear_law(0, -9.0, &law(-9.0), law, inverse);
        assert!((multipliers.present[0] - 0.3).abs() < 1e-15);
        let line = 0.3 * (1.0 - (-9.0 - inverse(0.3)));
        assert!((deep.unwrap().force / line - 1.0).abs() < 1e-14);
        // One that is far enough bears what its gap says.
        let far = multipliers.linear_law(1, 2.0, &law(2.0), law, inverse);
        assert_eq!((far, multipliers.present[1]), (None, law(2.0).force));
    }
}
