//! Contact forces by complementarity and the rods under them, found in turn.

use super::newton::Stopping;
use crate::mechanics::system::{ForceSearch, Stage, System};

/// Times that contact forces and the rods under them are found in turn before the step counts as failed.
const CONTACT_PASSES: usize = 30;

/// Passes without contact forces after which the step counts as failed: the next one, with other
/// directions of contacts, may succeed, but each costs as much as many steps.
const UNSOLVED_PASSES: usize = 3;

/// The first of them, which move the rods by the linearised step with contact forces, as Newton's method would for
/// both together; later ones leave that to its line search.
const COMMON_PASSES: usize = 20;
/// Farthest that one of these moves a position, in radii.
const FARTHEST_CORRECTION: f64 = 2.0;

/// The passes in which contact forces by complementarity and the rods under them are found in turn.
#[derive(Default)]
pub(super) struct Passes {
    count: usize,
    /// Passes whose contact forces were not found.
    unsolved: usize,
    search: ForceSearch,
}

/// Result of a pass.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Pass {
    /// Forces that no longer move a node.
    Balanced,
    /// Forces and rods of the linearised step together.
    Corrected,
    /// Forces, for the rods to follow.
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
        // The last one, too: what it would stop, or else continues as predicted, step after step.
        if pass != Pass::Loaded {
            system.take_correction(trial, FARTHEST_CORRECTION * stopping.radius);
        }
        Ok(pass)
    }
}
