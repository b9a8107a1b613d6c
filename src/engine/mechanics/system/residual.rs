//! Term of the residual that caused a divergence.

use super::term::Kind;
use super::{Stage, System};

/// Kinds of terms, for the message that names the term that diverged; of two equal terms the later
/// one.
const KINDS: [(Kind, &str); 4] = [
    (Kind::Motion, "inertia and drag"),
    (Kind::Elastic, "elastic"),
    (Kind::Load, "external load"),
    (Kind::Contact, "contact"),
];

impl System {
    /// Name of the kind of the term that is largest at one unknown.
    pub(crate) fn largest_term(
        &mut self,
        unknowns: &[f64],
        stage: Option<&Stage>,
        unknown: usize,
    ) -> &'static str {
        self.update_geometry(unknowns);
        let at = self.at(unknowns, stage);
        let sizes = KINDS.map(|(kind, name)| {
            let mut forces = vec![0.0; unknowns.len()];
            for term in self.terms.all() {
                if term.kind() == kind {
                    term.add_forces(&at, &mut forces);
                }
            }
            (forces[unknown].abs(), name)
        });
        // If one term is not a number, it is the cause.
        let broken = sizes.iter().find(|(size, _)| !size.is_finite());
        let largest = sizes.iter().max_by(|(a, _), (b, _)| a.total_cmp(b));
        broken.or(largest).map_or("", |(_, name)| name)
    }

    /// Adds the forces of inertia and drag alone, which are linear in the unknowns, in those at
    /// the start of a stage and in the velocity there.
    pub(crate) fn add_motion_forces(&self, unknowns: &[f64], stage: &Stage, forces: &mut [f64]) {
        let at = self.at(unknowns, Some(stage));
        for term in self.terms.all() {
            if term.kind() == Kind::Motion {
                term.add_forces(&at, forces);
            }
        }
    }
}
