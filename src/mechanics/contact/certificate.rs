//! The certificate of an accepted step: nothing has passed through anything else on the way to it.
//!
//! Between the ends of a step the nodes are taken to move along straight lines. At both ends the surfaces overlap by no
//! more than the fraction p of their distance of touch T = h_i + h_j that the parameters allow, Δ ≥ (1 − p) T. Two edges
//! whose nodes move by no more than M approach by 2M s in the part s of the step, so that in between
//!
//! Δ ≥ max{(1 − p) T − 2M s, (1 − p) T − 2M (1 − s)} ≥ (1 − p) T − M,
//!
//! and centrelines are certain to keep [`KEPT_PART`] of the distance allowed wherever M ≤ (1 − [`KEPT_PART`])(1 − p) T: for
//! most steps of most scenes the certificate costs one comparison per node. Beyond that, the pairs whose paths come near
//! each other are found by boxes around the whole paths, and tested by continuous collision detection.
//!
//! Planes need no more than the ends: the distance of a node from a plane is linear in time.

use super::contact_system::ContactSystem;
use super::contacts::CandidatePair;
use super::continuous_collision::fraction_beyond;
use super::proximity::ContactPair;
use crate::mechanics::Vector3;

/// Part of the least distance allowed at the ends of a step that centrelines keep within it. Zero would be enough to tell
/// passing from not passing; a half leaves continuous collision detection few advances, and costs no step whose nodes move
/// by less than 0.95 radii.
const KEPT_PART: f64 = 0.5;

/// A tenth of the distance kept: how much nearer than needed a pair may be certified.
const TOLERANCE: f64 = 0.1;

impl ContactSystem {
    /// Two edges that pass through each other, or nearly so, where all nodes move along straight lines from `start` to
    /// `end`, m; `None` where it is certain that there are none.
    ///
    /// At `start` and `end` no surfaces may overlap by more than `maximum_penetration`.
    pub fn passage(&mut self, start: &[Vector3], end: &[Vector3]) -> Option<ContactPair> {
        let allowed = 1.0 - self.parameters.maximum_penetration;
        let moved = start.iter().zip(end).map(|(a, b)| (b - a).norm_squared());
        let largest = moved.fold(0.0, f64::max);
        let certain = (1.0 - KEPT_PART) * allowed * self.surface.least_threshold();
        if largest <= certain * certain {
            return None;
        }
        let mut pairs = std::mem::take(&mut self.swept_pairs);
        self.broad_phase
            .find_swept(&self.surface, start, end, &mut pairs);
        let passing = pairs
            .iter()
            .find_map(|pair| self.passage_of(pair, start, end));
        self.swept_pairs = pairs;
        passing
    }

    fn passage_of(
        &self,
        pair: &CandidatePair,
        start: &[Vector3],
        end: &[Vector3],
    ) -> Option<ContactPair> {
        let nodes = pair.nodes.map(|node| start[node]);
        let displacements = pair.nodes.map(|node| end[node] - start[node]);
        let threshold = self.surface.threshold(pair.edges);
        let kept = KEPT_PART * (1.0 - self.parameters.maximum_penetration) * threshold;
        let fraction = fraction_beyond(&nodes, &displacements, [kept, TOLERANCE * kept], 1.0);
        (fraction < 1.0).then_some(ContactPair::Edges(pair.edges))
    }
}
