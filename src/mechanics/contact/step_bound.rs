//! How far a step may go without crossing the barrier of incremental potential contact.

use super::candidates::approach;
use super::continuous_collision::{KEPT_GAP, safe_part};
use super::implicit_contact::ImplicitContact;
use crate::mechanics::Vector3;

/// Most times that the candidates are built on one way. Every time the nodes may move by a radius of the
/// thickest rod; a way that is longer is cut.
const LEGS: usize = 16;

/// How far nodes may move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargestStep {
    /// Part of the way that is free, from 0 to 1.
    pub part: f64,
    /// Whether the candidates had to be built anew on the way and are now others.
    pub candidates_changed: bool,
}

impl ImplicitContact {
    /// Largest part of the straight way of all nodes from `start` by `displacements` (m) along which no pair of
    /// surfaces that may touch comes nearer than a tenth of its present gap; all of it with the implicit
    /// contact model, which may penetrate.
    ///
    /// All pairs count that come near anywhere on the way: where the nodes leave the margin of the
    /// candidates, these are built anew on the way. They are complete at the end of the free part.
    ///
    /// Surfaces that touch or overlap at `start` may not move at all.
    pub fn largest_step(&mut self, start: &[Vector3], displacements: &[Vector3]) -> LargestStep {
        let mut step = LargestStep {
            part: 1.0,
            candidates_changed: false,
        };
        if !self.parameters().is_barrier() {
            return step;
        }
        let free = self.free_part_over_planes(start, displacements);
        let mut place = std::mem::take(&mut self.place);
        place.clear();
        place.extend_from_slice(start);
        step.part = 0.0;
        for _ in 0..LEGS {
            let leg = self.candidates.covered_part(&place, displacements);
            let leg = leg.min(free - step.part);
            let safe = self.free_part_between_edges(&place, displacements, leg);
            step.part += safe;
            if safe < leg || step.part >= free {
                break;
            }
            for ((place, start), displacement) in place.iter_mut().zip(start).zip(displacements) {
                *place = start + displacement * step.part;
            }
            step.candidates_changed |= self.renew_candidates(&place);
        }
        self.place = place;
        step
    }

    /// The part up to `longest` that the candidates allow.
    fn free_part_between_edges(
        &mut self,
        start: &[Vector3],
        displacements: &[Vector3],
        longest: f64,
    ) -> f64 {
        let reach = self.parameters().reach();
        self.candidates.motion(start, &mut self.motion);
        for (motion, displacement) in self.motion.iter_mut().zip(displacements) {
            *motion += longest * displacement.norm();
        }
        let mut part = longest;
        for (pair, earlier) in self.candidates.pairs().iter().zip(self.candidates.gaps()) {
            if earlier - approach(pair, &self.motion) < reach {
                let nodes = pair.nodes.map(|node| start[node]);
                let moves = pair.nodes.map(|node| displacements[node]);
                part = safe_part(&nodes, &moves, self.surface.threshold(pair.edges), part);
            }
        }
        part
    }

    /// The part that the planes allow: the nodes approach them at constant speed.
    fn free_part_over_planes(&self, start: &[Vector3], displacements: &[Vector3]) -> f64 {
        let mut part = 1.0;
        for plane in self.planes() {
            for surface in self.surface.nodes() {
                let gap = plane.distance(&start[surface.node]) - surface.radius;
                let fall = -displacements[surface.node].dot(&plane.normal);
                let room = ((1.0 - KEPT_GAP) * gap).max(0.0);
                if gap <= 0.0 {
                    return 0.0;
                }
                if fall * part > room {
                    part = room / fall;
                }
            }
        }
        part
    }
}
