//! The pairs of edges that the Newton system couples: those in contact.
//!
//! There are four or five times as many candidates, which are kept over many steps, as contacts,
//! and every coupled pair adds entries to the factors of the system. So the system couples only
//! pairs with a contact force since the candidates were built.

use super::contact_system::ContactSystem;
use super::contacts::Bodies;

impl ContactSystem {
    /// Indices of the candidates of two rods that the Newton system couples, sorted.
    pub(crate) fn coupled_pairs(&self) -> &[usize] {
        &self.candidates.coupled
    }

    /// Couples the contacts of the last evaluation as well; returns whether any were new.
    pub(crate) fn couple_contacts(&mut self) -> bool {
        let contacts = self.contacts.iter().map(|contact| contact.candidate);
        let new = self.uncoupled(contacts);
        self.couple(new)
    }

    /// Couples the constraints that were listed last as well; returns whether any were new.
    pub(crate) fn couple_constraints(&mut self) -> bool {
        let candidates = self.constraints.iter().filter_map(|one| match one.bodies {
            Bodies::Edges(candidate) => Some(candidate),
            Bodies::Plane(_) => None,
        });
        let new = self.uncoupled(candidates);
        self.couple(new)
    }

    /// The given candidates that join two rods and are not coupled yet.
    fn uncoupled(&self, candidates: impl Iterator<Item = usize>) -> Vec<usize> {
        let is_of_rods = |one: &usize| self.is_of_rod(self.candidates.pairs()[*one].nodes[3]);
        let is_new = |one: &usize| self.coupled_pairs().binary_search(one).is_err();
        candidates.filter(is_of_rods).filter(is_new).collect()
    }

    fn couple(&mut self, new: Vec<usize>) -> bool {
        if new.is_empty() {
            return false;
        }
        self.candidates.coupled.extend(new);
        self.candidates.coupled.sort_unstable();
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::{ContactParameters, ContactSurface};
    use super::*;
    use crate::mechanics::Vector3;

    /// Two crossing rods of three edges; the middle edges touch, other pairs are candidates only.
    #[test]
    fn what_touches_is_coupled_and_stays_so_until_other_candidates_come() {
        let mut surface = ContactSurface::new();
        let node = |along: Vector3, k: i32| along * (f64::from(k) - 1.5);
        let apart = |gap: f64| Vector3::z() * (2.0 + gap);
        let at = |gap: f64| -> Vec<Vector3> {
            let low = (0..4).map(|k| node(Vector3::x(), k));
            let high = (0..4).map(|k| node(Vector3::y(), k) + apart(gap));
            low.chain(high).collect()
        };
        let near = at(-1e-3);
        surface.add_rod(0, &near[..4], false, 1.0, false);
        surface.add_rod(4, &near[4..], false, 1.0, false);
        let mut contact =
            ContactSystem::new(ContactParameters::default(), surface, Vec::new(), 1.0);
        contact.update_candidates(&near);
        assert_eq!(contact.candidates().len(), 9);
        assert!(contact.coupled_pairs().is_empty());

        contact.evaluate(&near, &near, 1e-3);
        assert_eq!(contact.contacts().len(), 1);
        assert!(contact.couple_contacts());
        let coupled = [contact.contacts()[0].candidate];
        assert_eq!(contact.coupled_pairs(), coupled);
        assert!(!contact.couple_contacts());

        let open = at(0.2);
        assert!(!contact.update_candidates(&open));
        contact.evaluate(&open, &near, 1e-3);
        assert!(contact.contacts().is_empty() && !contact.couple_contacts());
        assert_eq!(contact.coupled_pairs(), coupled);
        let memory = contact.memory();
        assert!(contact.update_candidates(&at(10.0)));
        assert!(contact.coupled_pairs().is_empty());
        contact.restore(&memory).unwrap();
        assert_eq!(contact.coupled_pairs(), coupled);
    }
}
