//! The foot of a node on a smooth part of a mesh.
//!
//! Only nodes of rods touch a smooth part of a mesh, each in one point. The search for it walks from
//! face to face across the sides beyond which the node lies; see [`super::patch`] for the
//! coordinates that decide this. Creases and borders are touched by edges, as those of other
//! meshes.

use super::contacts::CandidatePair;
use super::foot::Points;
use super::patch::{Patch, PatchBend, PatchPoint};
use super::surface::ContactSurface;
use crate::mechanics::Vector3;
use crate::mechanics::rigid_body::NO_FACE;

/// Maximum number of faces that a search visits.
const MOST_FACES: usize = 256;
/// Weight of a corner above which a point that belongs to neither of two faces by rounding error
/// counts as over both.
const ROUNDING: f64 = -1e-9;

impl ContactSurface {
    /// Whether a body is a curved face.
    pub(super) fn is_smooth_face(&self, body: usize) -> bool {
        let face = body.checked_sub(self.edges().len());
        face.is_some_and(|face| self.smooth_faces.face(face).is_some())
    }

    /// The curved patch of a face; `None` for a flat face.
    fn patch(&self, face: usize, points: &Points) -> Option<Patch> {
        let smooth = self.smooth_faces.face(face)?;
        Some(Patch {
            corners: (smooth.vertices).map(|vertex| points.vertices[vertex as usize]),
            normals: (smooth.normals).map(|normal| points.normals[normal as usize]),
        })
    }

    /// The foot of the node of a pair with a smooth part of a mesh; `None` if the node is not over
    /// it.
    pub(super) fn foot_on_patch(
        &self,
        pair: &CandidatePair,
        points: &Points,
    ) -> Option<PatchPoint> {
        self.foot_over(pair, &points.at(pair.nodes[0]), points)
    }

    /// Like [`Self::foot_on_patch`] for the node at another position.
    pub(super) fn foot_over(
        &self,
        pair: &CandidatePair,
        position: &Vector3,
        points: &Points,
    ) -> Option<PatchPoint> {
        self.foot_from(pair.start as usize, pair.facing(), position, points)
    }

    /// The foot of a point on the smooth part that contains a face; `None` for a flat face, and if
    /// the point is not over the smooth part.
    pub(super) fn foot_from(
        &self,
        start: usize,
        side: f64,
        point: &Vector3,
        points: &Points,
    ) -> Option<PatchPoint> {
        let (mut face, mut before) = (start, None);
        for _ in 0..MOST_FACES {
            let patch = self.patch(face, points)?;
            let found = patch.coordinates(point);
            let weights = match &found {
                Ok(at) => at.weights,
                Err(weights) => *weights,
            };
            let [least, second] = lowest(&weights);
            if let Ok(at) = &found
                && weights[least] >= 0.0
            {
                return Some(patch.foot(face, at, side));
            }
            let across = &self.smooth_faces.face(face)?.across;
            let beyond = |k: usize| {
                let next = across[k];
                (weights[k] < 0.0 && next != NO_FACE).then_some(next as usize)
            };
            let next = beyond(least).or_else(|| beyond(second))?;
            if before == Some(next) {
                let at = found.ok().filter(|_| weights[least] >= ROUNDING)?;
                return Some(patch.foot(face, &at, side));
            }
            (before, face) = (Some(face), next);
        }
        None
    }

    /// How a foot on the side of a pair moves with its node.
    pub(super) fn bend_at(
        &self,
        pair: &CandidatePair,
        foot: &PatchPoint,
        points: &Points,
    ) -> PatchBend {
        let patch = self.patch(foot.face, points);
        patch.map_or_else(PatchBend::none, |patch| patch.bend(&foot.at, pair.facing()))
    }

    /// Moves the vertices of a curved face (the last three points) along its normals to the height
    /// of the surface under a foot.
    pub(super) fn raise(&self, nodes: &mut [Vector3; 4], foot: &PatchPoint, points: &Points) {
        if let Some(patch) = self.patch(foot.face, points) {
            for (vertex, normal) in nodes[1..].iter_mut().zip(&patch.normals) {
                *vertex += normal * foot.surface_height;
            }
        }
    }

    /// A pair with a smooth part of a mesh with the vertices of the face that is touched.
    pub(super) fn settled(&self, pair: &CandidatePair, foot: &PatchPoint) -> CandidatePair {
        CandidatePair {
            nodes: self.faces()[foot.face].with(pair.nodes[0]),
            ..*pair
        }
    }
}

/// Indices of the lowest and the second lowest of three values.
fn lowest(values: &[f64; 3]) -> [usize; 2] {
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    [order[0], order[1]]
}
