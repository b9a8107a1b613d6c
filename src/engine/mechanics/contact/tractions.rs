//! Friction as additional unknowns of Newton's method.
//!
//! The smoothed law of Coulomb is nearly flat where surfaces slide and steep where they stick, and
//! its scale, the slip tolerance, is far below the speeds that occur. Newton's method on the slip
//! speed alone overshoots rest from either side, and its line search advances in tiny steps. So
//! each pair keeps its traction t (friction per normal force) from the last step, as `multipliers`
//! does for normal forces (see there for the idea). After an iteration t has the value of the
//! linear law, cut to the cone of Coulomb, and the law t(u) is next linearised at the slip u* with
//!
//! ```text
//! t(u*) − c u* = t − c u,   c = ρ h/λ,
//! ```
//!
//! with the inertia ρ of the contact points, the step h and the normal force λ. If |t − c u| < μ,
//! surfaces stick, whatever their state in the last iteration, at the slip that belongs to this
//! traction; otherwise they slide along it. This is Newton's method for Alart and Curnier's
//! function (1991), with the smoothed law in place of the disk. A slip that has turned round
//! within an iteration has passed through rest, and lowers |t − c u|.
//!
//! If c does not exceed the true resistance to the slip, sticking and sliding are found within a
//! few iterations without cycles. Elasticity makes this resistance larger than ρ, since sticking
//! neighbours hold a node, but not for all slips of many contacts at once. So c begins at
//! [`BEGINNING_PART`] times ρ h/λ, and falls if slips reverse.

use super::body_turns::TurnRates;
use super::candidates::carried_over;
use super::contacts::CandidatePair;
use super::friction::{FrictionLaw, tangential};
use super::multipliers::{LinearLaw, Moved};
use super::slots::{SlotValues, Slots};
use super::turning::{Rates, Row};
use crate::mechanics::Vector3;

/// Initial c in units of ρ h/λ, chosen by trial in a pile: a smaller value takes more iterations,
/// a larger one fails in some steps.
const BEGINNING_PART: f64 = 4.0;
/// Number of reversals of the slip of one contact within a step before c falls.
const FREE_REVERSALS: u8 = 3;
/// Factor on c for each further reversal.
const PART_AFTER_REVERSAL: f64 = 0.25;

/// The friction law of one pair in the linear system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LinearTraction {
    /// Slip at which the law is linearised, m/s.
    pub slip: Vector3,
    /// Its value there.
    pub value: Vector3,
    /// Value of the linear law at the present slip.
    pub present: Vector3,
    /// Number of reversals of the slip in the step.
    reversals: u8,
}

impl LinearTraction {
    /// The law linearised at the present slip.
    pub(crate) fn at_present(slip: Vector3, value: Vector3) -> Self {
        Self {
            slip,
            value,
            present: value,
            reversals: 0,
        }
    }
}

/// Displacements since the last linearisation.
#[derive(Clone, Copy)]
pub(super) enum Displaced<'a> {
    /// Displacements of the nodes of a contact.
    Nodes(&'a Moved),
    /// Displacements of all unknowns of a contact with friction at its surfaces.
    All(&'a Row),
    /// Displacements of the nodes of a contact, and rotations of the free bodies on both sides.
    Spun(&'a Moved, [Vector3; 2]),
}

/// The traction of a slot as a linear function of displacements.
#[derive(Clone, Copy, Debug)]
struct Tangent {
    /// Without displacements.
    value: Vector3,
    /// By displacements, 1/m.
    rates: [[f64; 12]; 3],
    /// Slip at which the law was linearised, m/s.
    slip: Vector3,
    reversals: u8,
}

impl Tangent {
    /// Creates a traction that does not depend on displacements.
    fn constant(value: Vector3) -> Self {
        Self {
            value,
            rates: [[0.0; 12]; 3],
            slip: Vector3::zeros(),
            reversals: 0,
        }
    }
}

/// The tractions of all slots, as in [`multipliers`](super::multipliers); unset for slots without
/// contact.
#[derive(Clone, Debug, Default)]
pub(super) struct Tractions {
    /// Tractions at the end of the last accepted step, one per slot.
    committed: Vec<Option<Vector3>>,
    /// Linear laws of the last linearisation.
    tangents: SlotValues<Tangent>,
    /// Derivatives of these laws with respect to the unknowns of contacts with friction at their
    /// surfaces; they replace the derivatives with respect to displacements.
    turning: SlotValues<Rates>,
    /// Derivatives of these laws with respect to the rotations of free bodies.
    spinning: SlotValues<TurnRates>,
}

impl Tractions {
    /// Starts the iterations of a step from the committed tractions.
    pub(crate) fn begin(&mut self, slots: Slots) {
        self.committed.resize(slots.count(), None);
        self.tangents.clear(slots.count());
        self.turning.clear(slots.count());
        self.spinning.clear(slots.count());
        for (slot, known) in self.committed.iter().enumerate() {
            if let Some(traction) = known {
                self.tangents.set(slot, Tangent::constant(*traction));
            }
        }
    }

    /// Initial traction of the iterations at a slot.
    pub(crate) fn begun(&self, slot: usize) -> Vector3 {
        let tangent = self.tangents.get(slot);
        tangent.map_or_else(Vector3::zeros, |tangent| tangent.value)
    }

    /// Sets the initial traction of the iterations at a slot.
    pub(crate) fn begin_with(&mut self, slot: usize, traction: Vector3) {
        self.tangents.set(slot, Tangent::constant(traction));
    }

    /// Tractions at the end of the last accepted step, one per slot.
    pub(crate) fn committed(&self) -> &[Option<Vector3>] {
        &self.committed
    }

    /// Restores stored tractions.
    pub(crate) fn restore(&mut self, committed: Vec<Option<Vector3>>) {
        self.committed = committed;
    }

    /// Commits the tractions of an accepted step, slot by slot; slots that are not given are
    /// unset.
    pub(crate) fn commit(
        &mut self,
        slots: Slots,
        tractions: impl Iterator<Item = (usize, Vector3)>,
    ) {
        self.committed.clear();
        self.committed.resize(slots.count(), None);
        for (slot, traction) in tractions {
            self.committed[slot] = Some(traction);
        }
    }

    /// Carries all tractions over to a new list of candidates; both lists are sorted.
    pub(crate) fn carry_over(&mut self, old: &[CandidatePair], new: &[CandidatePair]) {
        self.committed = carried_over(old, &self.committed, new);
        self.tangents.carry_over(old, new);
        self.turning.carry_over(old, new);
        self.spinning.carry_over(old, new);
    }

    /// The linearised law of a slot at the slip `slip` (m/s) on surfaces with the unit normal
    /// `normal`; `resistance` is ρ h/λ, s/m.
    pub(crate) fn linear_law(
        &self,
        slot: usize,
        law: &FrictionLaw,
        normal: &Vector3,
        slip: &Vector3,
        moved: Displaced,
        resistance: f64,
    ) -> LinearTraction {
        let mut wanted = Vector3::zeros();
        let (mut before, mut reversals) = (Vector3::zeros(), 0);
        if let Some(tangent) = self.tangents.get(slot) {
            let change = match (moved, self.turning.get(slot)) {
                (Displaced::Nodes(moved), _) => {
                    Vector3::from(tangent.rates.map(|rates| moved.along(&rates)))
                }
                (Displaced::Spun(moved, turned), _) => {
                    let by_nodes = Vector3::from(tangent.rates.map(|rates| moved.along(&rates)));
                    let rates = self.spinning.get(slot);
                    by_nodes + rates.map_or_else(Vector3::zeros, |rates| along(rates, &turned))
                }
                (Displaced::All(_), None) => Vector3::zeros(),
                (Displaced::All(moved), Some(rates)) => rates * moved,
            };
            wanted = law.limited(tangential(normal, &(tangent.value + change)));
            (before, reversals) = (tangent.slip, tangent.reversals);
        }
        let excess = i32::from(reversals.saturating_sub(FREE_REVERSALS));
        let resistance = resistance * BEGINNING_PART * PART_AFTER_REVERSAL.powi(excess);
        let at = law.resolved(&(wanted - slip * resistance), resistance);
        let value = law.traction_of_slip(&at);
        LinearTraction {
            slip: at,
            value,
            present: value + law.slope(&at) * (slip - at),
            reversals: reversals.saturating_add(u8::from(before.dot(&at) < 0.0)),
        }
    }

    /// Stores the linear law of a slot; `rates` is the derivative of its traction with respect to
    /// the displacements, 1/m.
    pub(crate) fn keep(&mut self, slot: usize, law: &LinearTraction, rates: &[[f64; 12]; 3]) {
        let tangent = Tangent {
            value: law.present,
            rates: *rates,
            slip: law.slip,
            reversals: law.reversals,
        };
        self.tangents.set(slot, tangent);
    }

    /// Stores the derivative of this traction with respect to the unknowns of a contact with
    /// friction at its surfaces.
    pub(crate) fn keep_turning(&mut self, slot: usize, law: &LinearTraction, rates: &Rates) {
        self.keep(slot, law, &[[0.0; 12]; 3]);
        self.turning.set(slot, *rates);
    }

    /// Stores the derivatives of this traction with respect to displacements, and to the rotations
    /// of the free bodies of the contact.
    pub(crate) fn keep_spun(
        &mut self,
        slot: usize,
        law: &LinearTraction,
        by_nodes: &[[f64; 12]; 3],
        by_turns: &TurnRates,
    ) {
        self.keep(slot, law, by_nodes);
        self.spinning.set(slot, *by_turns);
    }
}

/// Change of a vector with these derivatives under the rotations of two bodies.
fn along(rates: &TurnRates, turned: &[Vector3; 2]) -> Vector3 {
    let of_row = |row: [f64; 6]| {
        let turns = turned.iter().flat_map(|turn| turn.iter());
        row.iter().zip(turns).map(|(rate, turn)| rate * turn).sum()
    };
    Vector3::from(rates.map(of_row))
}

/// Difference between the force of the linearised laws and `force`; `with` computes a force from a
/// normal force and a traction.
pub(super) fn correction<const N: usize>(
    pressure: &LinearLaw,
    friction: &LinearTraction,
    force: [f64; N],
    with: impl Fn(f64, &Vector3) -> [f64; N],
) -> [f64; N] {
    // The product of force and direction, linearised at the point of the Jacobian: N d₀ + N₀ (d −
    // d₀).
    let normal_force = pressure.tangent.force;
    let pressed = with(pressure.force, &friction.value);
    let [slid, base] = [&friction.present, &friction.value].map(|t| with(normal_force, t));
    std::array::from_fn(|k| pressed[k] + (slid[k] - base[k]) - force[k])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::Matrix3;

    const LAW: FrictionLaw = FrictionLaw {
        coefficient: 0.8,
        slip_tolerance: 1e-4,
        grain: None,
    };

    fn pair(i: usize, j: usize) -> CandidatePair {
        CandidatePair {
            edges: [i, j],
            nodes: [i, i + 1, j, j + 1],
            side: 0,
            start: 0,
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

    const STEP: f64 = 1e-3;

    /// One step of Newton's method for t(u), where displacements over [`STEP`] change the slip.
    fn linearised(
        tractions: &mut Tractions,
        normal: &Vector3,
        slip: &Vector3,
        moved: &Moved,
        resistance: f64,
    ) -> LinearTraction {
        let linear =
            tractions.linear_law(0, &LAW, normal, slip, Displaced::Nodes(moved), resistance);
        let slope = LAW.slope(&linear.slip) / STEP;
        let rates = std::array::from_fn(|row| {
            std::array::from_fn(|column| {
                if column < 3 {
                    slope[(row, column)]
                } else {
                    0.0
                }
            })
        });
        tractions.keep(0, &linear, &rates);
        linear
    }

    fn moved(by: Vector3) -> Moved {
        let mut displacements = [Vector3::zeros(); 4];
        displacements[0] = by;
        Moved {
            displacements,
            inertia: 1.0,
            slightly: false,
            predicted: false,
        }
    }

    /// Number of iterations to find the slip u of a body with c (u − w) = t(u), from the slip and
    /// the traction of the previous step; c = m/(h N) in s/m, and w is the slip without friction.
    /// `known` is the given part of c.
    fn iterations(
        inertia: f64,
        known: f64,
        free_slip: Vector3,
        mut slip: Vector3,
        traction: Vector3,
    ) -> usize {
        let mut tractions = starting_from(traction);
        let mut change = Vector3::zeros();
        for iteration in 0..100 {
            let residual = (slip - free_slip) * inertia - LAW.traction_of_slip(&slip);
            if residual.norm() < 1e-6 {
                return iteration;
            }
            let by = moved(change * STEP);
            let linear = linearised(&mut tractions, &Vector3::z(), &slip, &by, known * inertia);
            let matrix = Matrix3::identity() * inertia - LAW.slope(&linear.slip);
            change =
                matrix.try_inverse().unwrap() * (linear.present - (slip - free_slip) * inertia);
            slip += change;
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
        // With c four times too small, exact, and four times too large.
        for (known, allowed) in [(1.0 / 16.0, 8), (0.25, 6), (1.0, 14)] {
            let mut most = 0;
            for inertia in [1.0, 10.0, 1e2, 1e3, 1e4] {
                for (slip, traction) in before {
                    // Speed of the body without friction, for a multiple of the force that
                    // friction can carry.
                    for part in [0.3, 0.9, 1.1, 2.0, 30.0] {
                        let free_slip = Vector3::x() * (part * LAW.coefficient / inertia);
                        let count = iterations(inertia, known, free_slip, slip, traction);
                        most = most.max(count);
                    }
                }
            }
            assert!(most <= allowed, "{known}: {most}");
        }
    }

    #[test]
    fn a_sticking_law_touches_the_friction_law_at_its_traction() {
        let traction = Vector3::new(0.3, -0.4, 0.0);
        let mut tractions = starting_from(traction);
        let slip = LAW.slip_of_traction(&traction);
        let rest = moved(Vector3::zeros());
        let linear = linearised(&mut tractions, &Vector3::z(), &slip, &rest, 10.0);
        assert!((linear.value - traction).norm() < 1e-6);
        assert!((linear.present - LAW.traction_of_slip(&slip)).norm() < 1e-6);
        // A displacement changes the traction by the slope of sticking, within the cone of Coulomb.
        let far = moved(Vector3::x());
        let next = linearised(&mut tractions, &Vector3::z(), &slip, &far, 10.0);
        assert!(next.value.norm() <= LAW.coefficient);
        let pull = (LAW.slope(&linear.slip) * Vector3::x()).normalize();
        assert!((next.value - pull * LAW.coefficient).norm() < 0.02 * LAW.coefficient);
    }

    #[test]
    fn surfaces_that_slide_and_new_pairs_have_the_law_at_their_slip() {
        let slip = Vector3::new(3e-1, 0.0, 0.0);
        let mut sliding = starting_from(Vector3::x() * -LAW.coefficient);
        let mut unknown = Tractions::default();
        unknown.begin(one_slot());
        let rest = moved(Vector3::zeros());
        for (tractions, least) in [(&mut sliding, 0.3), (&mut unknown, 0.28)] {
            let linear = linearised(tractions, &Vector3::z(), &slip, &rest, 10.0);
            assert!((linear.slip.x - 0.3).abs() < 0.3 - least + 1e-9);
            assert!((linear.present - LAW.traction_of_slip(&slip)).norm() < 1e-9);
        }
    }

    #[test]
    fn a_normal_of_another_length_leaves_the_law_consistent() {
        // Fast approach along a normal that is not quite of unit length: the iteration must end on
        // the law.
        let normal = Vector3::z() * (1.0 - 1e-5);
        let velocity = Vector3::new(2e-6, 0.0, 0.05);
        let slip = crate::mechanics::contact::friction::slip(&normal, &velocity);
        let mut tractions = starting_from(Vector3::x() * -0.01);
        let rest = moved(Vector3::zeros());
        for _ in 0..40 {
            linearised(&mut tractions, &normal, &slip, &rest, 1e5);
        }
        let found = linearised(&mut tractions, &normal, &slip, &rest, 1e5);
        assert!((found.present - LAW.traction_of_slip(&slip)).norm() < 1e-9);
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
