//! The law of a contact by complementarity near a solution.

use super::contacts::{CandidatePair, EdgeJacobian};
use crate::mechanics::Vector3;

/// The two bodies of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ActiveBodies {
    Pair(CandidatePair),
    /// A plane, and the node as the surface counts it.
    Plane {
        plane: usize,
        own: usize,
    },
}

/// A contact that presses: its law near the solution.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ActiveLaw {
    pub(super) bodies: ActiveBodies,
    /// The nodes; of a plane one, four times.
    pub(super) nodes: [usize; 4],
    /// Normal force, N, and friction per normal force.
    pub(super) pressure: f64,
    pub(super) traction: Vector3,
    /// Force on the first body, N.
    pub(super) force: Vector3,
    /// Stiffness along and across the normal, N/m.
    pub(super) stiffness: [f64; 2],
    pub(super) slides: bool,
    /// Gap and slip at the solution, m.
    pub(super) gap: f64,
    pub(super) slip: Vector3,
    /// Length in which the law changes, m.
    pub(super) length: f64,
    /// Positions of the corners at the solution, and the derivatives of the force on them there, N/m.
    pub(super) corners: Corners,
    pub(super) over: [EdgeJacobian; 2],
}

/// Positions of the four corners of a contact, now and at the start of the step, m.
pub(super) type Corners = [[Vector3; 4]; 2];
pub(super) const NOW: usize = 0;
pub(super) const START: usize = 1;
