//! Linearised law of a contact of the complementarity model near a solution.

use super::contacts::{CandidatePair, EdgeJacobian};
use crate::mechanics::Vector3;

/// The two bodies of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ActiveBodies {
    Pair(CandidatePair),
    /// A plane, and the index of the node among the nodes of the surface.
    Plane {
        plane: usize,
        own: usize,
    },
}

/// A contact that presses, with its law near the solution.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ActiveLaw {
    pub(super) bodies: ActiveBodies,
    /// The four nodes; contact with a plane lists its node four times.
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
    /// Length scale on which the law changes, m.
    pub(super) length: f64,
    /// Positions of the corners at the solution, and derivatives of the force with respect to
    /// them, N/m.
    pub(super) corners: Corners,
    pub(super) over: [EdgeJacobian; 2],
}

/// Positions of the four corners of a contact, now and at the start of the step, m.
pub(super) type Corners = [[Vector3; 4]; 2];
pub(super) const NOW: usize = 0;
pub(super) const START: usize = 1;
