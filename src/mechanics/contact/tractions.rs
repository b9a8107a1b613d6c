//! Friction that Newton's method carries along as unknowns of its own.
//!
//! The smoothed law of Coulomb is all but flat where surfaces slide and steep where they stick, and its
//! scale, the slip tolerance, is far below the speeds that occur: Newton's method on the slip speed alone
//! overshoots rest from either side, and its line search crawls towards it. So each pair keeps its traction t
//! (friction per normal force) from the last step, and where t says that the surfaces stick, the law t(u) is linearised
//! not at the present slip u but at the slip that belongs to t,
//!
//! ```text
//! t ≈ t₀ + t′(u₀) (u − u₀),   t(u₀) = t₀,
//! ```
//!
//! as `multipliers` does for normal forces (there is more on the idea). After each iteration t takes the value of the
//! linear law at the new slip, cut to the cone of Coulomb. Surfaces count as sticking where ‖t‖ is below
//! [`STICKING_PART`] of μ, and where t drives the slip instead of opposing it: slip that has turned round within an
//! iteration has passed through rest. Where they slide the law is linearised at the present slip.
//!
//! Two flagella in a tangle at μ = 1 take 8 iterations per millisecond so, against 80 with the law at the present slip.

use super::candidates::carried_over;
use super::contacts::CandidatePair;
use super::friction::FrictionLaw;
use super::multipliers::Slots;
use crate::mechanics::{Matrix3, Vector3};

/// Part of the friction coefficient up to which a traction counts as that of sticking surfaces.
///
/// Nearer to one the stiffness of sticking at that traction, which falls like 1 − ‖t‖²/μ², is too small to stop slip.
const STICKING_PART: f64 = 0.999;

/// The friction law of one pair as the linear system sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LinearTraction {
    /// Slip at which the law is linearised, m/s.
    pub slip: Vector3,
    /// Its value there.
    pub value: Vector3,
    /// Value of the linear law at the present slip.
    pub present: Vector3,
    /// The traction that is carried along.
    pub carried: Vector3,
}

/// A linear law t(u) = value + slope (u − slip).
#[derive(Clone, Copy, Debug)]
struct Tangent {
    value: Vector3,
    slope: Matrix3,
    slip: Vector3,
}

impl Tangent {
    fn at(&self, slip: &Vector3) -> Vector3 {
        self.value + self.slope * (slip - self.slip)
    }
}

/// The tractions of all slots, as in [`multipliers`](super::multipliers); those without contact are not known.
#[derive(Clone, Debug, Default)]
pub(super) struct Tractions {
    /// At the end of the last accepted step, one per slot.
    committed: Vec<Option<Vector3>>,
    /// Linear laws of the last linearisation.
    tangents: Vec<Option<Tangent>>,
}

impl Tractions {
    /// Starts the iterations of a step from the committed tractions.
    pub fn begin(&mut self, slots: Slots) {
        self.committed.resize(slots.count(), None);
        self.tangents.clear();
        let constant = |value: &Vector3| Tangent {
            value: *value,
            slope: Matrix3::zeros(),
            slip: Vector3::zeros(),
        };
        self.tangents.extend(
            self.committed
                .iter()
                .map(|known| known.as_ref().map(constant)),
        );
    }

    /// At the end of the last accepted step, one per slot.
    pub fn committed(&self) -> &[Option<Vector3>] {
        &self.committed
    }

    /// Continues from stored tractions.
    pub fn restore(&mut self, committed: Vec<Option<Vector3>>) {
        self.committed = committed;
    }

    /// Takes over the tractions of an accepted step, slot by slot; those not given are not known.
    pub fn commit(&mut self, slots: Slots, tractions: impl Iterator<Item = (usize, Vector3)>) {
        self.committed.clear();
        self.committed.resize(slots.count(), None);
        for (slot, traction) in tractions {
            self.committed[slot] = Some(traction);
        }
    }

    /// Carries the committed tractions over to a new list of candidates; both lists are sorted.
    pub fn carry_over(&mut self, old: &[CandidatePair], new: &[CandidatePair]) {
        self.committed = carried_over(old, &self.committed, new);
    }

    /// The law of a slot at the slip `slip` (m/s) on surfaces with the unit normal `normal`.
    pub fn linear_law(
        &mut self,
        slot: usize,
        law: &FrictionLaw,
        normal: &Vector3,
        slip: &Vector3,
    ) -> LinearTraction {
        let tangent = &mut self.tangents[slot];
        let carried = match tangent {
            Some(tangent) => {
                let linear = tangent.at(slip);
                let tangential = linear - normal * linear.dot(normal);
                cut(tangential, law.coefficient)
            }
            None => law.traction_of_slip(slip),
        };
        let sticking = STICKING_PART * law.coefficient;
        let at = if tangent.is_some() && (carried.norm() < sticking || carried.dot(slip) > 0.0) {
            law.slip_of_traction(&cut(carried, sticking))
        } else {
            *slip
        };
        let next = Tangent {
            value: law.traction_of_slip(&at),
            slope: law.slope(&at),
            slip: at,
        };
        *tangent = Some(next);
        LinearTraction {
            slip: at,
            value: next.value,
            present: next.at(slip),
            carried,
        }
    }
}

/// The vector, shortened to `length` where it is longer.
fn cut(vector: Vector3, length: f64) -> Vector3 {
    let norm = vector.norm();
    if norm > length {
        vector * (length / norm)
    } else {
        vector
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: FrictionLaw = FrictionLaw {
        coefficient: 0.8,
        slip_tolerance: 1e-4,
    };

    fn pair(i: usize, j: usize) -> CandidatePair {
        CandidatePair {
            edges: [i, j],
            nodes: [i, i + 1, j, j + 1],
        }
    }

    fn one_slot() -> Slots {
        Slots {
            candidates: 1,
            ..Slots::default()
        }
    }

    fn starting_from(traction: Vector3) -> Tractions {
        let mut tractions = Tractions::default();
        tractions.restore(vec![Some(traction)]);
        tractions.begin(one_slot());
        tractions
    }

    /// Iterations that find the slip u of a body with c (u − w) = t(u), from the slip and the traction of a step
    /// before; c = m/(h N) in s/m, and w is the slip without friction.
    fn iterations(inertia: f64, free_slip: Vector3, mut slip: Vector3, traction: Vector3) -> usize {
        let mut tractions = starting_from(traction);
        for iteration in 0..100 {
            let residual = (slip - free_slip) * inertia - LAW.traction_of_slip(&slip);
            if residual.norm() < 1e-6 {
                return iteration;
            }
            let linear = tractions.linear_law(0, &LAW, &Vector3::z(), &slip);
            let matrix = Matrix3::identity() * inertia - LAW.slope(&linear.slip);
            let right_side = linear.present - (slip - free_slip) * inertia;
            slip += matrix.try_inverse().unwrap() * right_side;
        }
        usize::MAX
    }

    #[test]
    fn sliding_begins_turns_and_ends_within_few_iterations() {
        let sliding = |direction: Vector3| (direction * 0.1, direction * -LAW.coefficient);
        let sticking = |part: f64| {
            let traction = Vector3::x() * (-part * LAW.coefficient);
            (LAW.slip_of_traction(&traction), traction)
        };
        let before = [
            sliding(Vector3::x()),
            sliding(-Vector3::x()),
            sliding(Vector3::new(0.6, 0.8, 0.0)),
            sticking(0.0),
            sticking(0.5),
            sticking(0.9),
        ];
        let mut most = 0;
        for inertia in [1.0, 10.0, 1e2, 1e3, 1e4] {
            for (slip, traction) in before {
                // Without friction the body would pass with so much of the force that friction can bear.
                for part in [0.3, 0.9, 1.1, 2.0, 30.0] {
                    let free_slip = Vector3::x() * (part * LAW.coefficient / inertia);
                    let count = iterations(inertia, free_slip, slip, traction);
                    most = most.max(count);
                }
            }
        }
        assert!(most <= 10, "{most}");
    }

    #[test]
    fn a_sticking_law_touches_the_friction_law_at_its_traction() {
        let traction = Vector3::new(0.3, -0.4, 0.0);
        let mut tractions = starting_from(traction);
        // Far from the slip of the traction, and opposed by it.
        let slip = Vector3::new(-2e-3, 1e-3, 0.0);
        let linear = tractions.linear_law(0, &LAW, &Vector3::z(), &slip);
        assert!((linear.value - traction).norm() < 1e-14);
        assert!((LAW.traction_of_slip(&linear.slip) - traction).norm() < 1e-14);
        let slope = LAW.slope(&linear.slip);
        let expected = traction + slope * (slip - linear.slip);
        assert!((linear.present - expected).norm() < 1e-12 * expected.norm());
        // The next iteration has the value of the linear law, within the cone of Coulomb.
        let next = tractions.linear_law(0, &LAW, &Vector3::z(), &slip);
        assert!((next.carried - cut(expected, LAW.coefficient)).norm() < 1e-14);
    }

    #[test]
    fn surfaces_that_slide_and_new_pairs_have_the_law_at_their_slip() {
        let slip = Vector3::new(3e-4, 0.0, 0.0);
        let mut sliding = starting_from(Vector3::x() * -LAW.coefficient);
        let mut unknown = Tractions::default();
        unknown.begin(one_slot());
        for tractions in [&mut sliding, &mut unknown] {
            let linear = tractions.linear_law(0, &LAW, &Vector3::z(), &slip);
            assert_eq!(linear.slip, slip);
            assert_eq!(linear.present, LAW.traction_of_slip(&slip));
        }
    }

    #[test]
    fn tractions_follow_their_pairs_to_a_new_list() {
        let [first, second] = [Vector3::x(), Vector3::y()].map(Some);
        let mut tractions = Tractions::default();
        tractions.restore(vec![first, None, second]);
        let old = [pair(0, 4), pair(1, 4), pair(2, 7)];
        tractions.carry_over(&old, &[pair(0, 3), pair(0, 4), pair(1, 4), pair(2, 7)]);
        assert_eq!(tractions.committed(), [None, first, None, second]);
    }
}
