//! Which term of the residual is to blame for a divergence.

use super::{Stage, System, add_inertia};

/// The terms of the residual, for the message that says which one diverged.
pub const TERMS: [&str; 4] = ["inertia and drag", "elastic", "external load", "contact"];

impl System {
    /// Name of the term that is largest at one unknown.
    pub fn largest_term(
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
        let mut inertia = vec![0.0; self.residual.len()];
        if let Some(stage) = stage {
            add_inertia(&self.assembly, &self.loads, stage, unknowns, &mut inertia);
        }
        let load = -self.dead_forces[unknown];
        let known = [inertia[unknown], elastic[unknown], load];
        let contact = total - known.iter().sum::<f64>();
        let sizes = [known[0], known[1], known[2], contact];
        let largest = (0..4).max_by(|&a, &b| sizes[a].abs().total_cmp(&sizes[b].abs()));
        TERMS[largest.unwrap_or(0)]
    }
}
