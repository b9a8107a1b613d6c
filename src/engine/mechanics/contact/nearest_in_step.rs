//! Nearest points of candidate pairs in a step: whether a node is in front of a solid follows from
//! the start of the step.

use super::contact_system::ContactSystem;
use super::contacts::{CandidatePair, EDGE};
use super::foot::{Foot, Points};
use super::nearest_points::NearestPoints;
use crate::mechanics::Vector3;

impl ContactSystem {
    /// Sets the positions of the nodes at the start of a step, m.
    pub(crate) fn begin_at(&mut self, nodes: &[Vector3]) {
        let mut start = std::mem::take(&mut self.start);
        start.clear();
        start.extend_from_slice(&self.placed(nodes));
        self.start = start;
    }

    /// Nearest points of a candidate during the iterations of a step. A solid repels a node behind
    /// its face if the node was in front of it at the start of the step, or without steps, when the
    /// candidates were built.
    pub(super) fn nearest_in_step(
        &self,
        pair: &CandidatePair,
        points: &Points,
        smoothing: f64,
    ) -> Option<NearestPoints> {
        let nearest = NearestPoints::on_either_side(&self.surface, pair, points, smoothing)?;
        if nearest.is_behind(&self.surface, pair) {
            let nodes = match self.start.is_empty() {
                true => self.candidates.positions(),
                false => &self.start,
            };
            let start = self.obstacles.points_at_start(nodes);
            if self.was_behind(pair, &nearest, &start)? {
                return None;
            }
        }
        Some(nearest)
    }

    /// Whether the node of a pair was behind the face of a solid at the start of the step; `None`
    /// for a face without area.
    fn was_behind(
        &self,
        pair: &CandidatePair,
        nearest: &NearestPoints,
        start: &Points,
    ) -> Option<bool> {
        let on_patch = pair
            .is_with_patch()
            .then(|| self.surface.foot_on_patch(pair, start));
        let height = match on_patch.flatten() {
            Some(foot) => foot.distance,
            None => {
                let face = nearest.settled(&self.surface, pair);
                Foot::in_plane(&start.of(face.nodes), 1.0)?.distance
            }
        };
        Some(height < 0.0)
    }

    /// Distance between the surfaces of a pair at which the gap of the force law is zero, m.
    pub(super) fn standoff(&self, pair: &CandidatePair) -> f64 {
        if pair.side == EDGE {
            self.parameters.standoff()
        } else {
            0.0
        }
    }
}
