//! Forces and Jacobians of all contacts at one configuration.

use super::body_turns::Spin;
use super::contact_system::ContactSystem;
use super::friction::FrictionLaw;
use super::multipliers::{LinearLaw, Moved};
use super::normal_law::NormalLaw;
use super::normal_response::NormalResponse;
use super::tractions::{Displaced, LinearTraction};
use super::turning::Turning;
use crate::mechanics::Vector3;

/// Least gap at which a barrier is evaluated while multipliers are in use, in units of δ. The
/// force there is about 10⁴ times that of contacts at rest, so no balance is possible.
const COUNTED_PART: f64 = 1e-4;

/// What an evaluation finds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Request {
    Forces,
    ForcesAndJacobians,
    /// The Jacobians where the forces were evaluated last.
    Jacobians,
}

impl Request {
    pub(super) fn has_jacobians(self) -> bool {
        self != Self::Forces
    }
}

/// The positions at which contact is evaluated.
#[derive(Clone, Copy)]
pub(super) struct Motion<'a> {
    pub positions: &'a [Vector3],
    pub previous: &'a [Vector3],
    pub time_step: f64,
}

impl Motion<'_> {
    pub(crate) fn velocity(&self, node: usize) -> Vector3 {
        (self.positions[node] - self.previous[node]) / self.time_step
    }

    /// The friction law, if the coefficient is positive and the time step finite.
    pub(crate) fn friction(&self, coefficient: f64, slip_tolerance: f64) -> Option<FrictionLaw> {
        (coefficient > 0.0 && self.time_step.is_finite()).then_some(FrictionLaw {
            coefficient,
            slip_tolerance,
            grain: None,
        })
    }
}

/// Initial values of the linearised laws of a contact.
pub(super) struct Touch<'a> {
    /// Rotation of the surfaces, if friction acts at them, and the positions of all nodes, m.
    pub turning: Option<(&'a Turning, &'a [Vector3])>,
    /// Rotation of free bodies, if there is friction.
    pub spin: Option<Spin>,
    pub gap: f64,
    pub law: NormalLaw,
    pub response: NormalResponse,
    /// Friction law, and the size of the step, s.
    pub friction: Option<(FrictionLaw, f64)>,
    pub normal: Vector3,
    pub slip: Vector3,
    pub traction: Vector3,
}

impl ContactSystem {
    /// Finds the active contacts at `positions` and evaluates energy, forces and Jacobians.
    ///
    /// Friction acts on the velocity (`positions` − `previous`)/`time_step`, and is omitted if
    /// `time_step` is infinite (statics).
    ///
    /// Centrelines that cross (Δ = 0) have no direction of separation. Their forces are NaN, and
    /// the line search rejects them.
    pub fn evaluate(&mut self, positions: &[Vector3], previous: &[Vector3], time_step: f64) {
        self.evaluate_contacts(positions, previous, time_step, Request::ForcesAndJacobians);
    }

    /// Like [`Self::evaluate`] but without Jacobians, for line searches; `Self::jacobians` and
    /// `Self::plane_jacobians` are empty afterwards.
    pub fn evaluate_forces(&mut self, positions: &[Vector3], previous: &[Vector3], time_step: f64) {
        self.evaluate_contacts(positions, previous, time_step, Request::Forces);
    }

    /// The Jacobians that [`Self::evaluate`] returns where [`Self::evaluate_forces`] was called
    /// last, with the same arguments.
    pub(crate) fn evaluate_jacobians(
        &mut self,
        positions: &[Vector3],
        previous: &[Vector3],
        time_step: f64,
    ) {
        self.evaluate_contacts(positions, previous, time_step, Request::Jacobians);
    }

    fn evaluate_contacts(
        &mut self,
        positions: &[Vector3],
        previous: &[Vector3],
        time_step: f64,
        request: Request,
    ) {
        let is_known = request == Request::Jacobians;
        let without_force = is_known.then(|| std::mem::take(&mut self.without_force));
        self.clear_results();
        let (positions, previous) = (self.placed(positions), self.placed(previous));
        let positions = positions.as_ref();
        let motion = Motion {
            positions,
            previous: &previous,
            time_step,
        };
        if !self.active_laws.is_empty() {
            return self.evaluate_active_laws(motion, request.has_jacobians());
        }
        if self.parameters.is_complementarity() {
            return self.evaluate_constraints(motion);
        }
        self.evaluate_pairs(&motion, request);
        self.evaluate_planes(&motion, request.has_jacobians());
        if let Some(without_force) = without_force {
            self.without_force = without_force;
        }
        if request.has_jacobians() && self.multipliers.in_use() {
            self.iterate.linearised_at(positions);
            if let Some(turns) = &mut self.surface_turns {
                turns.linearised();
            }
            self.body_turns.mark();
        }
    }

    pub(super) fn clear_results(&mut self) {
        self.contacts.clear();
        self.tractions.clear();
        self.jacobians.clear();
        self.linear_corrections.clear();
        self.plane_contacts.clear();
        self.plane_tractions.clear();
        self.plane_jacobians.clear();
        self.plane_linear_corrections.clear();
        self.without_force.clear();
        self.turned.clear();
        self.spun.clear();
        self.plane_spun.clear();
        self.energy = 0.0;
        self.turning_work = 0.0;
        self.contact_count = 0;
    }

    /// Linearises the laws of a slot at its multipliers; `moved` are the displacements of its
    /// nodes.
    pub(super) fn linear_laws(
        &self,
        slot: usize,
        touch: &Touch,
        moved: impl Fn(&Self) -> Moved,
    ) -> (LinearLaw, LinearTraction) {
        let at_present = LinearTraction::at_present(touch.slip, touch.traction);
        if !self.multipliers.in_use() {
            let pressure = LinearLaw {
                tangent: touch.response,
                force: touch.response.force,
            };
            return (pressure, at_present);
        }
        let moved = moved(self);
        let pressure = self
            .multipliers
            .linear_law(slot, touch.gap, &touch.law, &moved);
        let force = pressure.tangent.force;
        let friction = match touch.friction {
            Some((law, time_step)) if force > 0.0 => {
                let (normal, slip) = (&touch.normal, &touch.slip);
                let turned = touch
                    .turning
                    .map(|(turning, now)| self.turned_since(turning, now));
                let (inertia, displaced) = match &turned {
                    Some((mobility, row)) => {
                        let both = 1.0 / moved.inertia + mobility;
                        (1.0 / both, Displaced::All(row))
                    }
                    None => match touch.spin {
                        Some(spin) => (moved.inertia, Displaced::Spun(&moved, spin.moved)),
                        None => (moved.inertia, Displaced::Nodes(&moved)),
                    },
                };
                let resistance = inertia * time_step / force;
                self.carried_tractions
                    .linear_law(slot, &law, normal, slip, displaced, resistance)
            }
            _ => at_present,
        };
        (pressure, friction)
    }

    /// Records the change of the force of a slot since the last step, with the number of its rods.
    pub(super) fn compare_with_last(
        &mut self,
        slot: usize,
        rods: usize,
        pressure: &LinearLaw,
        friction: &LinearTraction,
    ) {
        let traction = self.carried_tractions.committed()[slot];
        let before = (
            self.multipliers.committed()[slot],
            traction.unwrap_or_else(Vector3::zeros),
        );
        self.iterate
            .compare(rods, before, (pressure.tangent.force, friction.value));
    }

    /// The gap at which forces are evaluated, m. Iterations with multipliers may pass through a
    /// barrier before they reach the solution in front of it, and the force there would not be
    /// finite.
    pub(super) fn counted_gap(&self, gap: f64) -> f64 {
        if self.parameters.is_barrier() && self.multipliers.in_use() {
            gap.max(COUNTED_PART * self.parameters.distance_tolerance)
        } else {
            gap
        }
    }
}
