//! Contacts as the evaluation of their forces leaves them. Their Jacobians follow without another
//! search for nearest points.

use super::body_turns::Spin;
use super::contacts::CandidatePair;
use super::edge_contact::Sliding;
use super::nearest_points::NearestPoints;
use super::normal_law::NormalLaw;
use super::normal_response::NormalResponse;
use super::turning::Turning;
use crate::mechanics::Vector3;

/// A candidate pair whose bodies are within reach of each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct EvaluatedPair {
    pub candidate: usize,
    /// The pair, at an obstacle with the face that is touched.
    pub pair: CandidatePair,
    pub nodes: [Vector3; 4],
    pub nearest: NearestPoints,
    /// Distance of the cores of both bodies, without the smoothing of parallel edges, and the
    /// distance at which the surfaces touch, m.
    pub distance: f64,
    pub threshold: f64,
    /// Gap of the force law, m.
    pub gap: f64,
    pub law: NormalLaw,
    pub response: NormalResponse,
    pub sliding: Option<Sliding>,
    /// Relative velocity of the contact points along the surfaces, m/s; zero without friction.
    pub slip: Vector3,
    /// Friction per normal force.
    pub traction: Vector3,
    /// Force on the four nodes, N.
    pub force: [f64; 12],
    /// Sign: −1 for a counter-pair.
    pub sign: f64,
}

/// How the bodies of a contact turn in a step with friction. It is large, rare and cheap to compute
/// again, and is therefore not kept.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rotation {
    /// Rotation of the surfaces, if friction acts at them.
    pub turning: Option<Turning>,
    /// Rotation of the free bodies.
    pub spin: Option<Spin>,
}
