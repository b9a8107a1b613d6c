//! Kelvin–Voigt damping: stresses E (ε + T ε̇) with the retardation time T = η/E of the material of a rod.
//!
//! A dashpot lies beside every spring of the discrete rod, K T ε̇ beside K (ε − ε̃), for the strains of the vertices and the
//! lengths of the edges. They turn with the rod, so that a motion as a rigid body meets no resistance, however large. In an
//! implicit stage of the size H the rate is the difference of the scheme, taken of the strains themselves:
//!
//! ```text
//! ε̇ = (ε − ε̂)/H,     ε̂ = εₙ + α₁ (εₙ₋₁ − εₙ) + α₂ (εₙ₋₂ − εₙ)
//! ```
//!
//! with α = 0 for implicit Euler and the weights of backward differences otherwise. What both bear is then the gradient of
//! a square again,
//!
//! ```text
//! ½ K (ε − ε̃)² + ½ K T/H (ε − ε̂)² = ½ K (1 + T/H) (ε − ε*)² + const,     ε* = (ε̃ + T/H ε̂)/(1 + T/H)
//! ```
//!
//! so that a damped rod is in each stage an elastic one of another stiffness and other natural strains: gradient and Hessian are
//! those of [`crate::mechanics::rod`], exact, symmetric and banded. For an edge, whose strain is l/l̃ − 1, the stiffness is
//! EA (1 + T/H)(1 + ε*) and the natural length l̃ (1 + ε*).
//!
//! Each step of implicit Euler loses T/H K (εₙ₊₁ − εₙ)² ≥ 0. The midpoint rule would need the rate in the middle of the step,
//! which is no such difference where strains are not linear in the unknowns: it is refused.

use super::System;
use super::build::Assembly;
use crate::mechanics::rod::ElasticRods;
use crate::mechanics::scene::Scene;

/// Strains that are kept of a vertex.
const OF_VERTEX: usize = 5;

/// Dashpots of all rods.
#[derive(Clone, Debug, Default)]
pub struct Damping {
    /// Retardation time of each rod, s; empty where none is damped.
    times: Vec<f64>,
    /// Strains of the vertices, then lengths of the edges (m), at the starts of the last steps, the latest first.
    history: [Vec<f64>; 3],
    /// The stage that the rods are in; `None` at rest.
    stage: Option<Difference>,
    /// The rods as elastic ones of that stage.
    acting: ElasticRods,
}

/// How a stage takes rates.
#[derive(Clone, Copy, Debug)]
struct Difference {
    /// H, s.
    step: f64,
    /// α₁ and α₂.
    weights: [f64; 2],
}

impl Damping {
    /// Of the rods of a scene.
    pub fn new(scene: &Scene) -> Self {
        let times = scene.rods.iter().map(|rod| rod.retardation_time);
        let times: Vec<f64> = times.collect();
        let is_damped = times.iter().any(|time| *time > 0.0);
        Self {
            times: if is_damped { times } else { Vec::new() },
            ..Self::default()
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// Strains at the starts of the steps before the present one; what a checkpoint holds.
    pub fn memory(&self) -> Vec<Vec<f64>> {
        match self.is_empty() {
            true => Vec::new(),
            false => self.history[1..].to_vec(),
        }
    }

    /// Goes on from a checkpoint.
    ///
    /// # Errors
    /// What of it does not fit.
    pub fn restore(&mut self, memory: Vec<Vec<f64>>) -> Result<(), &'static str> {
        if self.is_empty() != memory.is_empty() {
            return Err("damping");
        }
        for (kept, strains) in self.history[1..].iter_mut().zip(memory) {
            *kept = strains;
        }
        self.stage = None;
        Ok(())
    }

    /// A step was accepted: the strains at its start are those of the step before.
    pub fn accept(&mut self) {
        self.history.rotate_right(1);
    }

    /// The rods without their dashpots are in no stage.
    pub fn rest(&mut self) {
        self.stage = None;
    }

    /// How many times as stiff a rod is in the present stage as at rest, 1 + T/H.
    pub fn stiffening(&self, rod: usize) -> f64 {
        1.0 + self.ratio(rod)
    }

    /// T/H of a rod.
    fn ratio(&self, rod: usize) -> f64 {
        let time = self.times.get(rod).copied().unwrap_or(0.0);
        self.stage.map_or(0.0, |stage| time / stage.step)
    }

    /// ε̂ of one of the strains.
    fn before(&self, strain: usize) -> f64 {
        let [now, last, earlier] = &self.history;
        let start = now[strain];
        let Some(Difference { weights, .. }) = self.stage else {
            return start;
        };
        let change = |of: &[f64], weight: f64| match weight {
            // There may be none, or of other vertices.
            0.0 => 0.0,
            _ => weight * (of[strain] - start),
        };
        start + change(last, weights[0]) + change(earlier, weights[1])
    }

    /// Makes the rods elastic ones of the present stage.
    fn stiffen(&mut self, assembly: &Assembly) {
        let rods = &assembly.rods;
        let mut acting = std::mem::take(&mut self.acting);
        acting.vertices.clone_from(&rods.vertices);
        acting.edges.clone_from(&rods.edges);
        for (index, vertex) in acting.vertices.iter_mut().enumerate() {
            let ratio = self.ratio(rod_of(assembly, vertex.before.min(vertex.after)));
            let between = |natural: f64, strain: usize| {
                (natural + ratio * self.before(OF_VERTEX * index + strain)) / (1.0 + ratio)
            };
            let natural = &mut vertex.natural;
            for (strain, own) in natural.curvature.iter_mut().enumerate() {
                *own = between(*own, strain);
            }
            natural.twist = between(natural.twist, OF_VERTEX - 1);
            vertex.stiffness.bending = vertex.stiffness.bending.map(|own| own * (1.0 + ratio));
            vertex.stiffness.twisting *= 1.0 + ratio;
        }
        let first = OF_VERTEX * acting.vertices.len();
        for (index, edge) in acting.edges.iter_mut().enumerate() {
            let ratio = self.ratio(rod_of(assembly, edge.start));
            let before = self.before(first + index) / edge.natural_length - 1.0;
            let natural = 1.0 + ratio * before / (1.0 + ratio);
            edge.stretching *= (1.0 + ratio) * natural;
            edge.natural_length *= natural;
        }
        self.acting = acting;
    }
}

/// Rod of an edge.
fn rod_of(assembly: &Assembly, edge: usize) -> usize {
    assembly.locate(edge).0
}

impl System {
    /// Whether a rod is damped by its material.
    pub fn is_damped(&self) -> bool {
        !self.damping.is_empty()
    }

    /// Takes note of the strains at `unknowns`, where a step starts.
    pub fn begin_damping(&mut self, unknowns: &[f64]) {
        if self.damping.is_empty() {
            return;
        }
        self.update_geometry(unknowns);
        let mut strains = std::mem::take(&mut self.damping.history[0]);
        self.write_strains(&mut strains);
        self.damping.history[0] = strains;
    }

    /// Sets up the dashpots of a stage of the size `step` (s), whose differences weigh earlier strains with `weights`.
    pub fn damp(&mut self, step: f64, weights: [f64; 2]) {
        if self.damping.is_empty() {
            return;
        }
        self.damping.stage = Some(Difference { step, weights });
        self.damping.stiffen(&self.assembly);
        self.geometry.take_natural_strains(&self.damping.acting);
    }

    /// Without a stage dashpots bear nothing.
    pub(super) fn undamp(&mut self) {
        if self.damping.stage.take().is_some() {
            self.geometry.take_natural_strains(&self.assembly.rods);
        }
    }

    /// The rods with what their dashpots bear in the last stage.
    pub(super) fn acting_rods(&self) -> &ElasticRods {
        match self.damping.stage {
            Some(_) => &self.damping.acting,
            None => &self.assembly.rods,
        }
    }

    /// What dashpots take from the start of a step to the last evaluation, where it ends, J.
    pub fn viscous_loss(&self) -> f64 {
        if self.damping.stage.is_none() {
            return 0.0;
        }
        let mut strains = Vec::new();
        self.write_strains(&mut strains);
        // (ε − ε̂)(ε − εₙ) of one of them.
        let product = |strain: usize| {
            let end = strains[strain];
            (end - self.damping.before(strain)) * (end - self.damping.history[0][strain])
        };
        let rods = &self.assembly.rods;
        let mut sum = 0.0;
        for (index, vertex) in rods.vertices.iter().enumerate() {
            let ratio = self
                .damping
                .ratio(rod_of(&self.assembly, vertex.before.min(vertex.after)));
            let first = OF_VERTEX * index;
            for axis in 0..4 {
                sum += ratio * vertex.stiffness.bending[axis % 2] * product(first + axis);
            }
            sum += ratio * vertex.stiffness.twisting * product(first + OF_VERTEX - 1);
        }
        let first = OF_VERTEX * rods.vertices.len();
        for (index, edge) in rods.edges.iter().enumerate() {
            let ratio = self.damping.ratio(rod_of(&self.assembly, edge.start));
            sum += ratio * edge.stretching / edge.natural_length * product(first + index);
        }
        sum
    }

    /// Strains of the vertices and lengths of the edges at the last evaluation.
    fn write_strains(&self, strains: &mut Vec<f64>) {
        strains.clear();
        let rods = &self.assembly.rods;
        for (index, vertex) in rods.vertices.iter().enumerate() {
            let turning = vertex.strain.of(&self.strains(index, vertex));
            strains.extend(turning.curvature);
            strains.push(turning.twist);
        }
        let lengths = rods
            .edges
            .iter()
            .map(|edge| self.geometry.edges[edge.start].length);
        strains.extend(lengths);
    }
}
