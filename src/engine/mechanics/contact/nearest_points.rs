//! The nearest points of a candidate pair: of two edges, or of a node and a face of an obstacle.

use super::closest_points::ClosestPoints;
use super::contacts::{CandidatePair, ContactMotion, EDGE, TUBE};
use super::distance::{DistanceDerivatives, WEIGHT_RATES};
use super::foot::{Foot, Points};
use super::patch::{PatchBend, PatchPoint};
use super::rim::RimPoint;
use super::surface::ContactSurface;
use crate::mechanics::Vector3;

/// Nearest points of two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum NearestPoints {
    /// On two edges, or of a node and the axis of a tube around it.
    Edges(ClosestPoints),
    /// A node, and its foot on a face.
    Face(Foot),
    /// A node, and its foot on a curved face.
    Patch(PatchPoint),
    /// A piece of a rod, and the rim of a tube.
    Rim(RimPoint),
}

impl NearestPoints {
    /// Nearest points of a pair at `points`, smoothed over parallel edges by c (m²). `None` if the
    /// node of a pair is not over its face, is behind the face of a solid, or is not within the ends
    /// of its tube, or if a rim does not act.
    pub(crate) fn of(
        surface: &ContactSurface,
        pair: &CandidatePair,
        points: &Points,
        smoothing: f64,
    ) -> Option<Self> {
        let nearest = Self::on_either_side(surface, pair, points, smoothing)?;
        (!nearest.is_behind(surface, pair)).then_some(nearest)
    }

    /// Whether the node of the pair is behind the face of a solid.
    pub(super) fn is_behind(&self, surface: &ContactSurface, pair: &CandidatePair) -> bool {
        let is_at_mesh = pair.is_with_face() || pair.is_with_patch();
        is_at_mesh && self.distance() < 0.0 && surface.is_with_solid(pair)
    }

    /// Like `of`, but also if the node is behind the face of a solid; the distance is then negative.
    pub(crate) fn on_either_side(
        surface: &ContactSurface,
        pair: &CandidatePair,
        points: &Points,
        smoothing: f64,
    ) -> Option<Self> {
        let nodes = points.of(pair.nodes);
        match pair.side {
            EDGE => Some(Self::Edges(ClosestPoints::smoothed(&nodes, smoothing))),
            TUBE => ClosestPoints::in_tube(&nodes).map(Self::Edges),
            side if pair.is_with_rim() => {
                RimPoint::of(side, &nodes, &surface.rim_of(pair, points)).map(Self::Rim)
            }
            _ if pair.is_with_patch() => surface.foot_on_patch(pair, points).map(Self::Patch),
            side => Foot::of(&nodes, f64::from(side)).map(Self::Face),
        }
    }

    /// Distance, m; negative for a node in a tube or on the other side of a face.
    pub(crate) fn distance(&self) -> f64 {
        match self {
            Self::Edges(closest) => closest.distance(),
            Self::Face(foot) => foot.distance,
            Self::Patch(point) => point.distance,
            Self::Rim(point) => point.distance(),
        }
    }

    /// Weights of the four nodes in the separation.
    pub(crate) fn weights(&self) -> [f64; 4] {
        match self {
            Self::Edges(closest) => closest.weights(),
            Self::Face(foot) => foot.all_weights(),
            Self::Patch(point) => point.all_weights(),
            Self::Rim(point) => point.all_weights(),
        }
    }

    /// Normal, from the second body to the first.
    pub(crate) fn normal(&self) -> Vector3 {
        match self {
            Self::Edges(closest) => closest.normal(),
            Self::Face(foot) => foot.normal,
            Self::Patch(point) => point.normal,
            Self::Rim(point) => point.normal(),
        }
    }

    /// The normal with length 1.
    pub(crate) fn unit_normal(&self) -> Vector3 {
        match self {
            Self::Patch(point) => point.normal.normalize(),
            _ => self.normal(),
        }
    }

    /// Motion of the contact with its nodes at these positions; normal and contact points are
    /// fixed unless it `turns`. The foot on a curved face moves as given by `bend`.
    /// Corners of a face are at rest: see [`Foot::motion_with`] for those of a free body.
    pub(crate) fn motion(
        &self,
        nodes: &[Vector3; 4],
        turns: bool,
        bend: &PatchBend,
    ) -> ContactMotion {
        let mut motion = ContactMotion {
            weights: self.weights(),
            ..ContactMotion::over_plane(&self.normal())
        };
        match self {
            Self::Edges(closest) => {
                let distance = DistanceDerivatives::of(nodes, closest);
                motion.gap_gradient = distance.gradient();
                if turns {
                    motion.normal_jacobian = distance.normal_jacobian;
                    motion.weight_rates = std::array::from_fn(|corner| {
                        distance.ratio_gradients[corner / 2].map(|rate| WEIGHT_RATES[corner] * rate)
                    });
                }
            }
            Self::Face(_) => {}
            Self::Patch(_) => {
                motion.normal_jacobian = bend.normal_jacobian();
                motion.weight_rates = bend.weight_rates();
            }
            Self::Rim(point) => {
                motion.gap_gradient = point.gradient();
                if turns {
                    let derivatives = point.derivatives();
                    motion.normal_jacobian = derivatives.normal;
                    motion.weight_rates =
                        (point.all_rates()).map(|rate| derivatives.ratio.map(|along| rate * along));
                }
            }
        }
        motion
    }

    /// A pair with the bodies that touch: for a smooth part of a mesh, with the vertices of the face
    /// that is touched.
    pub(crate) fn settled(&self, surface: &ContactSurface, pair: &CandidatePair) -> CandidatePair {
        match self {
            Self::Patch(point) => surface.settled(pair, point),
            _ => *pair,
        }
    }

    /// Position of a rim contact on the piece of a rod, from 0 to 1, if it may be anywhere on the
    /// piece.
    pub(crate) fn along_piece(&self) -> Option<f64> {
        match self {
            Self::Rim(point) => Some(point.all_rates()[2]),
            _ => None,
        }
    }
}

/// Distance of the centrelines of two rods, or of the centreline of a rod from the surface of an
/// obstacle, m. `None` if a node is not over its face or not within the ends of its tube, or if a
/// rim does not act.
pub(super) fn separation(
    surface: &ContactSurface,
    pair: &CandidatePair,
    points: &Points,
) -> Option<f64> {
    let nearest = NearestPoints::of(surface, pair, points, 0.0)?;
    Some(nearest.distance() - surface.core(pair))
}
