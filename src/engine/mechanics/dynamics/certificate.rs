//! Checks of a solved step: no overlap, no passing through, no lost turns of twist, no added
//! energy.

use super::failure::{Crossing, Failure, Forces};
use super::parameters::Scheme;
use crate::mechanics::system::{Stage, System, name_overlap};

/// A step that was solved.
pub(super) struct Step<'a> {
    pub scheme: Scheme,
    pub stage: &'a Stage,
    /// Unknowns at the start of the step; `end` holds those at its end.
    pub start: &'a [f64],
    pub end: &'a [f64],
}

/// Checks whether surfaces overlap beyond the bound in the solved stage. A stiffer contact
/// corrects this, except for forces by complementarity, whose overlap [`Step::check`] finds.
pub(super) fn check_penetration(system: &System, iterations: usize) -> Result<(), Failure> {
    let contact = system.contact();
    let Some(contact) = contact.filter(|_| !system.has_constraints()) else {
        return Ok(());
    };
    let overlap = contact.excessive_penetration();
    overlap.map_or(Ok(()), |overlap| {
        Err(Failure::Penetration {
            iterations,
            overlap: name_overlap(&overlap, contact, &system.assembly),
        })
    })
}

impl Step<'_> {
    /// Certifies that no turns of twist of a rod are lost, that surfaces do not overlap beyond the
    /// bound at the end, and that they have not passed through each other on the way. Contacts and,
    /// with implicit Euler, elastic forces must not have added energy.
    pub(crate) fn check(&self, system: &mut System, iterations: usize) -> Result<(), Failure> {
        if let Some(turn) = system.excessive_turn() {
            return Err(Failure::Turn { iterations, turn });
        }
        // If contact forces are functions of the gaps at the end, these gaps have been checked
        // already.
        let is_evaluated = !self.scheme.rules().extrapolates() && !system.has_constraints();
        if let Some(crossing) = self.crossing(system, is_evaluated) {
            return Err(Failure::Crossing {
                iterations,
                crossing,
            });
        }
        let of_contact = if is_evaluated || system.has_constraints() {
            system.work_of_contact(self.stage, self.end)
        } else {
            system.work_of_contact_in_the_middle(self.stage, self.end)
        };
        let of_elasticity = |system: &mut System| match self.scheme {
            Scheme::ImplicitEuler => system.work_of_elasticity(self.stage, self.end),
            _ => None,
        };
        let brought = of_contact
            .map(|work| (Forces::Contact, work))
            .or_else(|| of_elasticity(system).map(|work| (Forces::Elastic, work)));
        brought.map_or(Ok(()), |(forces, work)| {
            Err(Failure::Work {
                iterations,
                forces,
                work,
            })
        })
    }

    /// Bodies that overlap at the end of the step, or passed through each other on the way.
    fn crossing(&self, system: &mut System, is_evaluated: bool) -> Option<Crossing> {
        let overlap = if is_evaluated {
            None
        } else {
            system.excessive_penetration_at(self.end)
        };
        overlap.map(Crossing::Overlap).or_else(|| {
            let passage = system.passage(self.start, self.end);
            passage.map(Crossing::Passage)
        })
    }
}
