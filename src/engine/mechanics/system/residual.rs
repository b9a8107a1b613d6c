//! Which term of the residual is to blame for a divergence.

use super::{Stage, System, add_inertia};

/// The terms of the residual, for the message that says which one diverged.
pub(crate) const TERMS: [&str; 4] = ["inertia and drag", "elastic", "external load", "contact"];

impl System {
    /// Name of the term that is largest at one unknown.
    pub(crate) fn largest_term(
        &mut self,
        unknowns: &[f64],
        stage: Option<&Stage>,
        unknown: usize,
    ) -> &'static str {
        let total = self.residual[unknown];
        let mut elastic = vec![0.0; self.residual.len()];
        self.update_geometry(unknowns);
        self.assembly
            .rods
            .add_gradient(&self.geometry, &mut elastic);
        (self.springs).add_gradient(&self.assembly.joints, &mut elastic);
        let mut inertia = vec![0.0; self.residual.len()];
        if let Some(stage) = stage {
            add_inertia(&self.assembly, &self.loads, stage, unknowns, &mut inertia);
        }
        let load = -self.dead_forces[unknown];
        let known = [inertia[unknown], elastic[unknown], load];
        // One term that is not a number leaves no other to blame.
        if let Some(term) = known.iter().position(|term| !term.is_finite()) {
            return TERMS[term];
        }
        let sizes = known.into_iter().chain(
            self.contact
                .is_some()
                .then(|| total - known.iter().sum::<f64>()),
        );
        let largest = sizes
            .enumerate()
            .max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()));
        TERMS[largest.map_or(0, |(term, _)| term)]
    }
}
