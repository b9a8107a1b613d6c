//! The nearest points of a candidate pair: of two edges, or of a node and a face of an obstacle.

use super::closest_points::ClosestPoints;
use super::contact_system::ContactSystem;
use super::contacts::{CandidatePair, EDGE, TUBE};
use super::foot::{Foot, Points};
use super::surface::ContactSurface;
use crate::mechanics::Vector3;

/// Nearest points of two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum NearestPoints {
    /// On two edges, or of a node and the axis of a tube around it.
    Edges(ClosestPoints),
    /// A node, and its foot on a face.
    Face(Foot),
}

impl NearestPoints {
    /// Those of a pair whose nodes are at `points`, smoothed over parallel edges by c (m²); `None` where the node of a pair
    /// with a face is not over it, or not within the ends of a tube.
    pub fn of(pair: &CandidatePair, points: &[Vector3; 4], smoothing: f64) -> Option<Self> {
        match pair.side {
            EDGE => Some(Self::Edges(ClosestPoints::smoothed(points, smoothing))),
            TUBE => ClosestPoints::in_tube(points).map(Self::Edges),
            side => Foot::of(points, f64::from(side)).map(Self::Face),
        }
    }

    /// Distance, m; negative for a node on the other side of a face, and in a tube.
    pub fn distance(&self) -> f64 {
        match self {
            Self::Edges(closest) => closest.distance(),
            Self::Face(foot) => foot.distance,
        }
    }

    /// Weights of the four nodes in the separation.
    pub fn weights(&self) -> [f64; 4] {
        match self {
            Self::Edges(closest) => closest.weights(),
            Self::Face(foot) => foot.all_weights(),
        }
    }

    /// Normal, from the second body to the first.
    pub fn normal(&self) -> Vector3 {
        match self {
            Self::Edges(closest) => closest.normal(),
            Self::Face(foot) => foot.normal,
        }
    }
}

/// Distance of the centrelines of two rods, or of that of a rod from the surface of an obstacle, m; `None` where a node is not
/// over its face, or not within the ends of its tube.
pub(super) fn separation(
    surface: &ContactSurface,
    pair: &CandidatePair,
    points: &Points,
) -> Option<f64> {
    let nearest = NearestPoints::of(pair, &points.of(pair.nodes), 0.0)?;
    Some(nearest.distance() - surface.core(pair.edges))
}

impl ContactSystem {
    /// Distance between the surfaces of a pair at which the gap that the force law sees is zero, m.
    pub(super) fn standoff(&self, pair: &CandidatePair) -> f64 {
        if pair.side == EDGE {
            self.parameters.standoff()
        } else {
            0.0
        }
    }
}
