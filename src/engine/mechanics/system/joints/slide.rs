//! A node that slides along a rod.
//!
//! The position of the node is that of a point on the rod's curve ([`Track`]), whose parameter s
//! replaces the position as the unknown:
//!
//! ```text
//! x = X(s, q) = Σ wⱼ(s) xⱼ,    what acts on x, R:   wⱼ R on xⱼ,   R·X' on s
//! ```
//!
//! So without friction ([`super::rubbing`]) the force of the joint is normal to the rod, momentum
//! is conserved, and for every s the node is exactly on the curve. At the ends of an open rod,
//! stops carry the force that pushes s outwards.
//!
//! **Clamped nodes.** The position of a node that a clamp holds is given, so that the rod has to run
//! through it. The joint then yields like an edge of the rod, k = EA/h: it acts with
//! R = k (X(s, q) − x), as above on the rod and on s, and with −R on the node.
//!
//! **From the middle of a step.** The implicit midpoint rule extrapolates from the middle to the
//! end. At the middle the position is x = ½ (xₙ + X(2s − sₙ, 2q − qₙ)), so that the step ends on
//! the curve; forces are transmitted at the middle, at (s, q). For a straight rod at rest this
//! conserves energy exactly. A joint that yields acts as in the middle.

use super::rubbing::Rubbing;
use super::track::{Track, Weights};
use crate::mechanics::Vector3;
use crate::mechanics::rod::{STRIDE, topology::position};
use crate::mechanics::scene::CoulombFriction;

/// Points of an edge among which the nearest one to a node is sought, and iterations of Newton's
/// method from there.
const SAMPLES_PER_EDGE: f64 = 4.0;
const NEAREST_ITERATIONS: usize = 8;

/// A sliding node, at the configuration of the last [`Slide::place`].
#[derive(Clone, Debug)]
pub struct Slide {
    /// The node.
    pub node: usize,
    /// The unknown s.
    pub unknown: usize,
    pub(super) track: Track,
    /// Point at which forces are transmitted.
    pub(super) grip: Grip,
    /// Derivatives of the position of the node with respect to s and q.
    pub(super) follow: Grip,
    /// Residual R of the node from all forces on it, or R = k (X − x) of a joint that yields, N.
    pub(super) residual: Vector3,
    /// k of a joint at a clamped node, N/m.
    pub(super) stiffness: Option<f64>,
    /// Whether a stop carries the force along the rod.
    pub(super) is_stopped: bool,
    /// Friction along the rod.
    pub(super) rubbing: Option<Rubbing>,
}

/// A place on the curve.
#[derive(Clone, Debug)]
pub(super) struct Grip {
    pub weights: Weights,
    /// X' = ∂X/∂s, m.
    pub tangent: Vector3,
    /// X'' = ∂²X/∂s², m.
    pub curvature: Vector3,
}

impl Grip {
    fn new(weights: Weights, position_of: impl Fn(usize) -> Vector3) -> Self {
        let sum = |factors: &[f64; 4]| sum(factors, &weights.nodes, &position_of);
        Self {
            tangent: sum(&weights.slopes),
            curvature: sum(&weights.curvatures),
            weights,
        }
    }
}

fn sum(factors: &[f64; 4], nodes: &[usize; 4], of: impl Fn(usize) -> Vector3) -> Vector3 {
    let terms = factors.iter().zip(nodes);
    terms.map(|(factor, node)| of(*node) * *factor).sum()
}

impl Slide {
    /// Creates the slide of a node at the point given by the unknown.
    pub(crate) fn new(
        [node, unknown]: [usize; 2],
        track: Track,
        friction: Option<&CoulombFriction>,
        unknowns: &[f64],
    ) -> Self {
        let start = unknowns[unknown];
        let weights = track.at(start);
        let grip = Grip::new(weights, |node| position(unknowns, node));
        Self {
            node,
            unknown,
            rubbing: friction
                .map(|law| Rubbing::new(law, [track.edge * track.span(), track.edge], start)),
            track,
            follow: grip.clone(),
            grip,
            residual: Vector3::zeros(),
            stiffness: None,
            is_stopped: false,
        }
    }

    /// Makes the joint yield with a stiffness, N/m, instead of moving the node.
    pub(crate) fn yield_with(&mut self, stiffness: f64) {
        self.stiffness = Some(stiffness);
    }

    /// Energy of a joint that yields, J.
    pub(crate) fn energy(&self) -> f64 {
        let of_force = |stiffness| 0.5 * self.residual.norm_squared() / stiffness;
        self.stiffness.map_or(0.0, of_force)
    }

    /// Nodes of the rod along which it slides.
    pub(crate) fn rail(&self) -> std::ops::Range<usize> {
        self.track.nodes()
    }

    /// Whether it slides along a ring.
    pub(crate) fn is_closed(&self) -> bool {
        self.track.ends().is_none()
    }

    /// Mean edge length of that rod, m: the unit of s.
    pub(crate) fn edge(&self) -> f64 {
        self.track.edge
    }

    /// The parameter at which the curve is nearest to the node, and their distance, m.
    pub(crate) fn nearest(&self, unknowns: &[f64]) -> (f64, f64) {
        let target = position(unknowns, self.node);
        let at = |parameter: f64| {
            let weights = self.track.at(parameter);
            let of = |node: usize| position(unknowns, node);
            let place = sum(&weights.values, &weights.nodes, of);
            (target - place, Grip::new(weights, of).tangent)
        };
        let span = self.track.span();
        let count = (SAMPLES_PER_EDGE * span).ceil() as usize;
        let samples = (0..=count).map(|sample| span * sample as f64 / count as f64);
        let mut nearest = (0.0, f64::INFINITY);
        for parameter in samples {
            let distance = at(parameter).0.norm();
            if distance < nearest.1 {
                nearest = (parameter, distance);
            }
        }
        for _ in 0..NEAREST_ITERATIONS {
            let (apart, tangent) = at(nearest.0);
            let moved = nearest.0 + apart.dot(&tangent) / tangent.norm_squared();
            let moved = (self.track.ends()).map_or(moved, |[from, to]| moved.clamp(from, to));
            nearest = (moved, at(moved).0.norm());
        }
        nearest
    }

    /// Rate of s in a motion with these velocities of the node and the rod.
    pub(crate) fn rate_of(&self, velocity: &[f64]) -> f64 {
        let Weights { nodes, values, .. } = &self.grip.weights;
        let carried = sum(values, nodes, |node| position(velocity, node));
        let relative = position(velocity, self.node) - carried;
        relative.dot(&self.grip.tangent) / self.grip.tangent.norm_squared()
    }

    /// Begins at a configuration with no part of the friction mobilised.
    pub(crate) fn begin(&mut self, unknowns: &[f64]) {
        if let Some(rubbing) = &mut self.rubbing {
            rubbing.begin(unknowns[self.unknown]);
        }
        self.place(unknowns, None);
    }

    /// Force of the joint at the last evaluation, N.
    pub(crate) fn force(&self) -> f64 {
        self.residual.norm()
    }

    /// Least and largest s such that, from the middle of a step from `start`, the step ends within
    /// the rod.
    fn ends(&self, start: Option<&[f64]>) -> Option<[f64; 2]> {
        let ends = self.track.ends()?;
        Some(match start {
            None => ends,
            Some(start) => ends.map(|end| 0.5 * (start[self.unknown] + end)),
        })
    }

    /// Sets the position of the node, and s if a stop holds the node; in the middle of a step from
    /// `start`.
    pub(super) fn complete(&self, unknowns: &mut [f64], start: Option<&[f64]>) {
        if let Some([least, largest]) = self.ends(start) {
            unknowns[self.unknown] = unknowns[self.unknown].clamp(least, largest);
        }
        if self.stiffness.is_some() {
            return;
        }
        let weights = self.track.at(self.parameter(unknowns, start));
        let end = |node: usize| place(unknowns, start, node);
        let end = sum(&weights.values, &weights.nodes, end);
        let here = match start {
            None => end,
            Some(start) => (position(start, self.node) + end) * 0.5,
        };
        let own = STRIDE * self.node;
        unknowns[own..own + 3].copy_from_slice(here.as_slice());
    }

    /// Value of s at the end of a step from `start` with `unknowns` in its middle.
    fn parameter(&self, unknowns: &[f64], start: Option<&[f64]>) -> f64 {
        let now = unknowns[self.unknown];
        start.map_or(now, |start| 2.0 * now - start[self.unknown])
    }

    /// Sets the configuration from `unknowns`, in the middle of a step from `start`.
    pub(super) fn place(&mut self, unknowns: &[f64], start: Option<&[f64]>) {
        let parameter = unknowns[self.unknown];
        let weights = self.track.at(parameter);
        self.grip = Grip::new(weights, |node| position(unknowns, node));
        if let Some(stiffness) = self.stiffness {
            let Weights { nodes, values, .. } = &self.grip.weights;
            let place = sum(values, nodes, |node| position(unknowns, node));
            self.residual = (place - position(unknowns, self.node)) * stiffness;
        }
        if let Some(rubbing) = &mut self.rubbing {
            rubbing.place(parameter);
        }
        self.follow = match start {
            None => self.grip.clone(),
            Some(_) if self.stiffness.is_some() => self.grip.clone(),
            Some(_) => {
                let weights = self.track.at(self.parameter(unknowns, start));
                Grip::new(weights, |node| place(unknowns, start, node))
            }
        };
    }

    /// Stores the residual of the node, and whether a stop at `unknowns` carries its part along
    /// the rod.
    pub(super) fn note(&mut self, residual: &[f64], unknowns: &[f64], start: Option<&[f64]>) {
        if self.stiffness.is_none() {
            self.residual = position(residual, self.node);
        }
        if let Some(rubbing) = &mut self.rubbing {
            rubbing.note(&self.residual, &self.grip.tangent);
        }
        let along = residual[self.unknown] + self.residual.dot(&self.along());
        let place = unknowns[self.unknown];
        self.is_stopped = self.ends(start).is_some_and(|[least, largest]| {
            place <= least && along >= 0.0 || place >= largest && along <= 0.0
        });
    }

    /// What a force on the node adds to the force on s, per force, m: X', and with friction
    /// X' + ∂f/∂R.
    pub(super) fn along(&self) -> Vector3 {
        let rubbing = self.rubbing.as_ref().map(|rubbing| rubbing.over_force);
        self.grip.tangent + rubbing.unwrap_or_default()
    }

    /// What a change of X' adds to the force on s, N: R, and with friction R + ∂f/∂X'.
    pub(super) fn over_tangent(&self) -> Vector3 {
        let rubbing = self.rubbing.as_ref().map(|rubbing| rubbing.over_tangent);
        self.residual + rubbing.unwrap_or_default()
    }

    /// Derivative of the force on s with respect to s at fixed R, N m.
    pub(super) fn over_parameter(&self) -> f64 {
        let rubbing = self
            .rubbing
            .as_ref()
            .map_or(0.0, |rubbing| rubbing.over_parameter);
        self.over_tangent().dot(&self.grip.curvature) + rubbing
    }

    /// Transfers the forces on the node to the rod and to s, including the friction, unless the
    /// joint yields.
    pub(super) fn gather(&self, forces: &mut [f64]) {
        if self.stiffness.is_none() {
            let force = position(forces, self.node);
            self.pull(&force, forces);
        }
    }

    /// Adds the force of a joint that yields to a residual.
    pub(super) fn add_force(&self, residual: &mut [f64]) {
        if self.stiffness.is_some() {
            self.pull(&self.residual, residual);
        }
    }

    /// Removes a force from the node, and adds it to the rod and to s.
    fn pull(&self, force: &Vector3, forces: &mut [f64]) {
        for axis in 0..3 {
            forces[STRIDE * self.node + axis] -= force[axis];
        }
        let Weights { nodes, values, .. } = &self.grip.weights;
        for (node, weight) in nodes.iter().zip(values) {
            for axis in 0..3 {
                forces[STRIDE * node + axis] += weight * force[axis];
            }
        }
        forces[self.unknown] += force.dot(&self.along());
        if self.is_stopped {
            forces[self.unknown] = 0.0;
        }
    }

    /// Moves the node as s and the rod move.
    pub(super) fn spread(&self, moves: &mut [f64]) {
        if self.stiffness.is_some() {
            return;
        }
        let weights = &self.follow.weights;
        let carried = sum(&weights.values, &weights.nodes, |node| {
            position(moves, node)
        });
        let moved = carried + self.follow.tangent * moves[self.unknown];
        let own = STRIDE * self.node;
        moves[own..own + 3].copy_from_slice(moved.as_slice());
    }
}

/// Position of a node at the end of a step from `start` with `unknowns` in its middle.
fn place(unknowns: &[f64], start: Option<&[f64]>, node: usize) -> Vector3 {
    let now = position(unknowns, node);
    start.map_or(now, |start| now * 2.0 - position(start, node))
}
