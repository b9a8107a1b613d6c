//! Alternating solution for contact forces by complementarity and for the rods under them.

use super::newton::Stopping;
use crate::mechanics::system::{ForceSearch, Stage, System};

/// Alternations of contact forces and rods after which the step counts as failed.
const CONTACT_PASSES: usize = 30;

/// Passes without contact forces after which the step counts as failed. The next pass has other
/// directions of contacts and may succeed, but each costs as much as many steps.
const UNSOLVED_PASSES: usize = 3;

/// Number of first passes that move the rods by the linearised step with contact forces, as
/// Newton's method for both together would; in later ones the line search of Newton's method moves
/// the rods.
const COMMON_PASSES: usize = 20;
/// Largest move of a position in one of these passes, in radii.
const FARTHEST_CORRECTION: f64 = 2.0;

/// Progress of the alternation between contact forces by complementarity and the rods under them.
#[derive(Default)]
pub(super) struct Passes {
    count: usize,
    /// Number of passes in which no contact forces were found.
    unsolved: usize,
    search: ForceSearch,
}

/// Result of a pass.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Pass {
    /// The forces no longer move a node.
    Balanced,
    /// Forces and rods were corrected together, by the linearised step.
    Corrected,
    /// Only the forces were found; the rods must follow.
    Loaded,
}

/// No contact forces were found.
pub(super) struct NoForces;

impl Passes {
    /// Takes the next pass at the trial unknowns of a stage.
    pub(crate) fn next(
        &mut self,
        system: &mut System,
        trial: &mut [f64],
        stage: &Stage,
        stopping: &Stopping,
    ) -> Result<Pass, NoForces> {
        self.count += 1;
        let moved = system
            .find_contact_forces(trial, stage, &mut self.search, stopping.radius)
            .map_err(|_| NoForces)?;
        self.unsolved += usize::from(moved.is_infinite());
        let pass = if moved <= stopping.displacement {
            Pass::Balanced
        } else if self.count == CONTACT_PASSES || self.unsolved == UNSOLVED_PASSES {
            return Err(NoForces);
        } else if self.count <= COMMON_PASSES {
            Pass::Corrected
        } else {
            Pass::Loaded
        };
        // Correct after a balanced pass as well. Otherwise a velocity that this correction would
        // remove persists from step to step.
        if pass != Pass::Loaded {
            system.take_correction(trial, FARTHEST_CORRECTION * stopping.radius);
        }
        Ok(pass)
    }
}
