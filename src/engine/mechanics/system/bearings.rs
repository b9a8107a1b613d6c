//! Moments about the axles of free bodies: those that drive them, and the friction of bearings.
//!
//! The friction of a bearing is that of Coulomb with the largest moment M. Before the body turns,
//! it sticks like a spring (L. Prandtl 1928), with the values z⁰ and α⁰ at the start of the step:
//!
//! ```text
//! T(t) − M z,     z = clamp(z⁰ + (α − α⁰)/δ, −1, 1),     δ = 10⁻⁵ rad
//! ```
//!
//! It does not depend on the force on the axle.

use super::Assembly;
use super::events::Event;
use super::newton_matrix::Entries;
use super::term::{Configuration, Kind, Term};
use crate::mechanics::SceneError;
use crate::mechanics::rod::topology::add_to_node;
use crate::mechanics::rod::{ElasticRods, RodGeometry, STRIDE};
use crate::mechanics::scene::{Axle, FreeBody, Scene, piecewise_linear};

/// δ, rad.
const PRESLIDING: f64 = 1e-5;

/// All axles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bearings(Vec<Bearing>);

/// The axle of a body.
#[derive(Clone, Debug)]
struct Bearing {
    /// Index of the frame of the body.
    frame: usize,
    axle: Axle,
    /// T, N m.
    torque: f64,
    /// z.
    state: f64,
    /// z⁰.
    committed: f64,
}

impl Bearing {
    /// Whether its friction depends on the angle.
    fn sticks(&self) -> bool {
        self.axle.brake > 0.0 && self.state.abs() < 1.0
    }
}

impl Term for Bearings {
    fn new(scene: &Scene, assembly: &mut Assembly) -> Result<Self, SceneError> {
        let bodies = scene.free_bodies.iter().zip(&assembly.joints.bodies);
        let bearing = |(body, frame): (&FreeBody, &usize)| {
            Some(Bearing {
                frame: *frame,
                axle: body.axle.clone()?,
                torque: 0.0,
                state: 0.0,
                committed: 0.0,
            })
        };
        Ok(Self(bodies.filter_map(bearing).collect()))
    }

    fn kind(&self) -> Kind {
        Kind::Load
    }

    fn has_copies(&self) -> bool {
        self.0.is_empty()
    }

    fn drive(&mut self, time: f64, _: &mut ElasticRods, _: &mut RodGeometry) {
        for bearing in &mut self.0 {
            bearing.torque = piecewise_linear(&bearing.axle.torque, time).unwrap_or(0.0);
        }
    }

    fn update(&mut self, at: &Configuration) {
        let joints = &at.assembly.joints;
        for bearing in &mut self.0 {
            let angle = joints.frames[bearing.frame].hinge_turn();
            bearing.state = (bearing.committed + angle / PRESLIDING).clamp(-1.0, 1.0);
        }
    }

    fn add_forces(&self, at: &Configuration, residual: &mut [f64]) {
        for bearing in &self.0 {
            let moment = bearing.torque - bearing.axle.brake * bearing.state;
            let place = at.assembly.joints.frames[bearing.frame].first_unknown / STRIDE;
            add_to_node(residual, place, &(bearing.axle.direction * -moment));
        }
    }

    fn add_jacobian(&self, at: &Configuration, entries: &mut Entries) {
        for bearing in self.0.iter().filter(|bearing| bearing.sticks()) {
            let angle = at.assembly.joints.frames[bearing.frame].first_unknown + 3;
            entries.columns()[angle][0] += bearing.axle.brake / PRESLIDING;
        }
    }

    fn commit(&mut self) {
        for bearing in &mut self.0 {
            bearing.committed = bearing.state;
        }
    }

    fn memory(&self) -> Vec<Vec<f64>> {
        if self.0.is_empty() {
            return Vec::new();
        }
        vec![self.0.iter().map(|bearing| bearing.committed).collect()]
    }

    fn restore(&mut self, memory: &mut dyn Iterator<Item = Vec<f64>>) -> Result<(), &'static str> {
        if self.0.is_empty() {
            return Ok(());
        }
        let states = memory.next().unwrap_or_default();
        if states.len() != self.0.len() {
            return Err("axles");
        }
        for (bearing, state) in self.0.iter_mut().zip(states) {
            (bearing.committed, bearing.state) = (state, state);
        }
        Ok(())
    }

    fn list_events(&self, events: &mut Vec<Event>) {
        let corners = self.0.iter().flat_map(|bearing| &bearing.axle.torque);
        events.extend(corners.map(|(time, _)| Event::of_load(*time)));
    }
}
