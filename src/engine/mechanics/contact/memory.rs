//! Contact data of a checkpoint, for a restart.

use super::contact_system::ContactSystem;
use crate::mechanics::Vector3;
use serde::{Deserialize, Serialize};

/// State that influences future contact forces; part of a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactMemory {
    /// Positions of all nodes when the candidates were last built, m; empty before the first
    /// build.
    pub candidate_positions: Vec<[f64; 3]>,
    /// Candidates that the Newton system couples.
    pub coupled: Vec<usize>,
    /// Contact stiffness k.
    pub stiffness: f64,
    /// Normal force of every candidate in the last step, N.
    pub normal_forces: Vec<f64>,
    /// Friction per normal force of every candidate in the last step; `None` for pairs that were
    /// not in contact.
    pub tractions: Vec<Option<[f64; 3]>>,
}

/// Error: the memory belongs to another scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("contact memory of {found} nodes in a scene of {expected}")]
pub(crate) struct MismatchedMemory {
    /// Nodes of this scene.
    pub expected: usize,
    /// Nodes in the memory.
    pub found: usize,
}

impl ContactSystem {
    /// Data of a checkpoint.
    pub(crate) fn memory(&self) -> ContactMemory {
        let positions = self.candidate_positions().iter();
        let tractions = self.carried_tractions().committed().iter();
        ContactMemory {
            candidate_positions: positions.map(|&position| position.into()).collect(),
            coupled: self.coupled_pairs().to_vec(),
            stiffness: self.stiffness(),
            normal_forces: self.multipliers().committed().to_vec(),
            tractions: tractions.map(|known| known.map(Into::into)).collect(),
        }
    }

    /// Restores candidates and stiffness from a checkpoint of the same scene.
    ///
    /// # Errors
    /// If the memory has another number of nodes.
    pub(crate) fn restore(&mut self, memory: &ContactMemory) -> Result<(), MismatchedMemory> {
        let stored = memory.candidate_positions.iter();
        let positions: Vec<Vector3> = stored.map(|&position| position.into()).collect();
        let (expected, found) = (self.surface().node_count(), positions.len());
        if found != 0 && found != expected {
            return Err(MismatchedMemory { expected, found });
        }
        // Unless obstacles move, the candidates follow from the positions alone.
        let is_same =
            self.surface.obstacles().is_empty() && positions == self.candidate_positions();
        if !is_same {
            self.rebuild_candidates(&positions);
        }
        // The indices of the last evaluation refer to other candidates.
        self.clear_results();
        self.constraints.clear();
        self.candidates.coupled.clone_from(&memory.coupled);
        self.set_stiffness(memory.stiffness);
        let tractions = memory.tractions.iter();
        self.restore_multipliers(
            &memory.normal_forces,
            tractions.map(|known| known.map(Into::into)).collect(),
        );
        Ok(())
    }
}
