//! Damping by the material: Kelvin–Voigt, stresses E (ε + T ε̇) with the retardation time T = η/E, and the standard linear solid.
//!
//! A dashpot acts in parallel to every spring of the discrete rod: K T ε̇ in parallel to K (ε −
//! ε̃), for the strains of the vertices and the lengths of the edges. Dashpots turn with the rod,
//! so that a rigid motion meets no resistance, however large it is. In an implicit stage of the
//! size H the rate is the difference formula of the scheme, applied to the strains themselves:
//!
//! ```text
//! ε̇ = (ε − ε̂)/H,     ε̂ = εₙ + α₁ (εₙ₋₁ − εₙ) + α₂ (εₙ₋₂ − εₙ)
//! ```
//!
//! with α = 0 for implicit Euler and the weights of backward differences otherwise. In the
//! standard linear solid (Zener) a spring of the stiffness rK and a dashpot in series, with the
//! relaxation time τ, act in parallel to the spring. Their force K q follows q̇ = r ε̇ − q/τ. If
//! strains are linear in a step of the size Δt, it is exactly, at the end of the step,
//!
//! ```text
//! q = e^(−x) qₙ + r γ (ε − εₙ),     x = Δt/τ,     γ = (1 − e^(−x))/x
//! ```
//!
//! (Simo and Hughes 1998, Eq. 10.3.12). The total force is then the gradient of a square again,
//!
//! ```text
//! ½ K (ε − ε̃)² + ½ K T/H (ε − ε̂)² + ½ K r γ (ε − εₙ)² + K e^(−x) qₙ ε = ½ K (1 + T/H + r γ) (ε − ε*)² + const,
//! ε* = (ε̃ + T/H ε̂ + r γ εₙ − e^(−x) qₙ)/(1 + T/H + r γ)
//! ```
//!
//! so that in each stage a damped rod is equivalent to an elastic one with another stiffness and
//! other natural strains: gradient and Hessian are those of [`crate::mechanics::rod`], exact,
//! symmetric and banded. For an edge, whose strain is its length l, K is EA/l̃, the natural length
//! l* and the stretching stiffness EA (1 + T/H + r γ) l*/l̃.
//!
//! Each step of implicit Euler loses T/H K (εₙ₊₁ − εₙ)² ≥ 0 in the dashpots parallel to the
//! springs. The midpoint rule is rejected: it needs the rate in the middle of the step, which is
//! not such a difference if strains are nonlinear in the unknowns.

use super::System;
use super::build::Assembly;
use super::demand::Demand;
use super::term::{Configuration, Kind, Term};
use super::virtual_work::OF_VERTEX;
use crate::mechanics::SceneError;
use crate::mechanics::rod::{ElasticEnergy, ElasticRods, RodGeometry};
use crate::mechanics::scene::{Relaxation, Scene};

/// Ratio of step to relaxation time below which (1 − γ)/x equals ½ − x/6 to all significant
/// digits.
const SHORT: f64 = 1e-6;

/// The midpoint rule does not define the rate of a strain that is nonlinear in the unknowns.
const NO_MIDPOINT: SceneError = SceneError::Unsuitable(
    "viscous rods need time.scheme = \"implicit-euler\" or \"backward-differences\"",
);

/// Dashpots of all rods.
#[derive(Clone, Debug, Default)]
pub(crate) struct Damping {
    /// Retardation time, s, and relaxation of each rod; empty if no rod is damped.
    rods: Vec<(f64, Option<Relaxation>)>,
    /// Strains of the vertices, then lengths of the edges (m), at the starts of the last steps, the latest first.
    history: [Vec<f64>; 3],
    /// q of all strains, at the start of the present step; empty without viscous parts.
    relaxing: Vec<f64>,
    /// Vertices to which q belongs: their nodes, and flags for edges that are those of clamps.
    places: Vec<(usize, [bool; 2])>,
    /// The present stage of the rods; `None` at rest.
    stage: Option<Difference>,
    /// The equivalent elastic rods of that stage.
    acting: ElasticRods,
    /// Scratch: strains of the last evaluation.
    strains: Vec<f64>,
}

/// Rate formula of a stage.
#[derive(Clone, Copy, Debug)]
struct Difference {
    /// H, s.
    step: f64,
    /// α₁ and α₂.
    weights: [f64; 2],
    /// Δt, s.
    size: f64,
}

/// Dashpots parallel to the springs of a rod in a stage.
#[derive(Clone, Copy, Debug, Default)]
struct Beside {
    /// T/H.
    dashpot: f64,
    /// r γ.
    relaxing: f64,
    /// e^(−x).
    kept: f64,
    /// r.
    ratio: f64,
    /// x.
    steps: f64,
}

impl Beside {
    /// Ratio of the additional stiffness to that of the springs.
    fn stiffness(&self) -> f64 {
        self.dashpot + self.relaxing
    }

    /// Value of q at the end of a step in which a strain changes by a given amount, from its value
    /// at the start.
    fn relaxed(&self, start: f64, change: f64) -> f64 {
        self.kept * start + self.relaxing * change
    }

    /// Mean of q in that step, γ qₙ + r (1 − γ)/x Δε.
    fn mean(&self, start: f64, change: f64) -> f64 {
        let (slope, x) = (self.relaxing / self.ratio, self.steps);
        let grown = match x < SHORT {
            true => 0.5 - x / 6.0,
            false => (1.0 - slope) / x,
        };
        slope * start + self.ratio * grown * change
    }
}

impl Damping {
    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.rods.is_empty()
    }

    /// Whether any rod has a spring and a dashpot in series.
    pub(crate) fn relaxes(&self) -> bool {
        self.rods.iter().any(|rod| rod.1.is_some())
    }

    /// Resets the rods to rest, without dashpots.
    pub(crate) fn rest(&mut self) {
        self.stage = None;
    }

    /// Ratio of the stiffness of a rod in the present stage to that at rest, 1 + T/H + r γ.
    pub(crate) fn stiffening(&self, rod: usize) -> f64 {
        1.0 + self.beside(rod).stiffness()
    }

    /// Dashpots parallel to the springs of a rod.
    fn beside(&self, rod: usize) -> Beside {
        let (Some(stage), Some(&(time, relaxation))) = (self.stage, self.rods.get(rod)) else {
            return Beside::default();
        };
        let dashpot = time / stage.step;
        let Some(Relaxation { ratio, time }) = relaxation else {
            return Beside {
                dashpot,
                ..Beside::default()
            };
        };
        let steps = stage.size / time;
        Beside {
            dashpot,
            relaxing: -ratio * libm::expm1(-steps) / steps,
            kept: libm::exp(-steps),
            ratio,
            steps,
        }
    }

    /// K T/H of each strain in the present stage; `None` if no rod is damped.
    pub(super) fn dashpots(&self, assembly: &Assembly) -> Option<Vec<f64>> {
        self.stage?;
        let strains = all_strains(assembly);
        Some(
            strains
                .map(|(_, rod, stiffness)| stiffness * self.beside(rod).dashpot)
                .collect(),
        )
    }

    /// r γ and e^(−x) of each strain in the present stage, and the products of both with K; `None`
    /// if no rod relaxes.
    pub(super) fn relaxation(&self, assembly: &Assembly) -> Option<[Vec<f64>; 4]> {
        if self.stage.is_none() || !self.relaxes() {
            return None;
        }
        let of = |value: &dyn Fn(&Beside, f64) -> f64| {
            let strains = all_strains(assembly);
            let values = strains.map(|(_, rod, stiffness)| value(&self.beside(rod), stiffness));
            values.collect()
        };
        Some([
            of(&|beside, _| beside.relaxing),
            of(&|beside, _| beside.kept),
            of(&|beside, stiffness| stiffness * beside.relaxing),
            of(&|beside, stiffness| stiffness * beside.kept),
        ])
    }

    /// Weights in ε̂ of the strains at the starts of the present step and of the two before it.
    pub(super) fn start_weights(&self) -> [f64; 3] {
        let [last, earlier] = self.stage.map_or([0.0; 2], |stage| stage.weights);
        [1.0 - last - earlier, last, earlier]
    }

    /// ε̂ of one of the strains.
    fn before(&self, strain: usize) -> f64 {
        let [now, last, earlier] = &self.history;
        let start = now[strain];
        let Some(Difference { weights, .. }) = self.stage else {
            return start;
        };
        let change = |of: &[f64], weight: f64| match weight {
            // There may be no stored strains, or those of other vertices.
            0.0 => 0.0,
            _ => weight * (of[strain] - start),
        };
        start + change(last, weights[0]) + change(earlier, weights[1])
    }

    /// ε* of one of the strains.
    fn natural(&self, beside: &Beside, natural: f64, strain: usize) -> f64 {
        let relaxing = match beside.ratio {
            0.0 => 0.0,
            _ => beside.relaxing * self.history[0][strain] - beside.kept * self.relaxing[strain],
        };
        let pulled = natural + beside.dashpot * self.before(strain) + relaxing;
        pulled / (1.0 + beside.stiffness())
    }

    /// Replaces the rods by the equivalent elastic ones of the present stage.
    fn stiffen(&mut self, assembly: &Assembly) {
        let rods = &assembly.rods;
        let mut acting = std::mem::take(&mut self.acting);
        acting.vertices.clone_from(&rods.vertices);
        acting.edges.clone_from(&rods.edges);
        for (index, vertex) in acting.vertices.iter_mut().enumerate() {
            let beside = self.beside(rod_of(assembly, vertex.before.min(vertex.after)));
            let first = OF_VERTEX * index;
            let natural = &mut vertex.natural;
            for (strain, own) in natural.curvature.iter_mut().enumerate() {
                *own = self.natural(&beside, *own, first + strain);
            }
            natural.twist = self.natural(&beside, natural.twist, first + OF_VERTEX - 1);
            let factor = 1.0 + beside.stiffness();
            vertex.stiffness = vertex.stiffness.times(factor);
        }
        let first = OF_VERTEX * acting.vertices.len();
        for (index, edge) in acting.edges.iter_mut().enumerate() {
            let beside = self.beside(rod_of(assembly, edge.start));
            let natural = self.natural(&beside, edge.natural_length, first + index);
            edge.stretching *= (1.0 + beside.stiffness()) * natural / edge.natural_length;
            edge.natural_length = natural;
        }
        self.acting = acting;
    }
}

/// Rod of an edge.
fn rod_of(assembly: &Assembly, edge: usize) -> usize {
    assembly.locate(edge).0
}

/// Kind of a strain, to which its energy is attributed.
#[derive(Clone, Copy, PartialEq)]
enum StrainKind {
    Stretching,
    Bending,
    Twisting,
}

/// Kind, rod and stiffness K of each strain, in storage order.
fn all_strains(assembly: &Assembly) -> impl Iterator<Item = (StrainKind, usize, f64)> {
    let rods = &assembly.rods;
    let of_vertices = rods.vertices.iter().flat_map(|vertex| {
        let rod = rod_of(assembly, vertex.before.min(vertex.after));
        (0..OF_VERTEX).map(move |strain| match strain {
            0..4 => (
                StrainKind::Bending,
                rod,
                vertex.stiffness.bending[strain % 2],
            ),
            _ => (StrainKind::Twisting, rod, vertex.stiffness.twisting),
        })
    });
    let of_edges = rods.edges.iter().map(|edge| {
        let stiffness = edge.stretching / edge.natural_length;
        (
            StrainKind::Stretching,
            rod_of(assembly, edge.start),
            stiffness,
        )
    });
    of_vertices.chain(of_edges)
}

impl Damping {
    /// Records the strains of the geometry at the start of a step.
    fn begin(&mut self, assembly: &Assembly, geometry: &RodGeometry) {
        let mut strains = std::mem::take(&mut self.history[0]);
        write_strains(assembly, geometry, &mut strains);
        if self.relaxes() {
            if self.places.is_empty() {
                self.place(assembly);
            }
            self.relaxing.resize(strains.len(), 0.0);
        }
        self.history[0] = strains;
    }

    /// Assigns q to the vertices after clamps were added or removed; a new vertex has a relaxed q.
    pub(super) fn place(&mut self, assembly: &Assembly) {
        if !self.relaxes() {
            return;
        }
        let vertices = assembly.rods.vertices.iter();
        let places = vertices.map(|vertex| assembly.place_of(vertex)).collect();
        let before = std::mem::replace(&mut self.places, places);
        if before.is_empty() || self.relaxing.is_empty() {
            return;
        }
        let old = std::mem::take(&mut self.relaxing);
        let mut relaxing = Vec::with_capacity(old.len());
        for place in &self.places {
            let own = before.iter().position(|earlier| earlier == place);
            match own.map(|own| OF_VERTEX * own) {
                Some(first) => relaxing.extend_from_slice(&old[first..first + OF_VERTEX]),
                None => relaxing.extend([0.0; OF_VERTEX]),
            }
        }
        relaxing.extend_from_slice(&old[OF_VERTEX * before.len()..]);
        self.relaxing = relaxing;
    }

    /// Accepts a step. The strains at its start become those of the step before. The relaxing parts
    /// q relax up to the last evaluation, or completely if that evaluation had no stage.
    pub(crate) fn keep(&mut self, assembly: &Assembly, geometry: &RodGeometry) {
        if self.relaxes() {
            let mut relaxing = std::mem::take(&mut self.relaxing);
            let mut strains = std::mem::take(&mut self.strains);
            write_strains(assembly, geometry, &mut strains);
            let start = &self.history[0];
            for (index, (_, rod, _)) in all_strains(assembly).enumerate() {
                if let (Some(own), Some(start)) = (relaxing.get_mut(index), start.get(index)) {
                    *own = self.beside(rod).relaxed(*own, strains[index] - start);
                }
            }
            self.strains = strains;
            self.relaxing = relaxing;
        }
        self.history.rotate_right(1);
    }

    /// Energy of the springs in series with a dashpot, of one rod or of all, ½ K q²/r, at the end
    /// of the last step, J.
    pub(super) fn relaxing_energy(&self, assembly: &Assembly, of: Option<usize>) -> ElasticEnergy {
        let mut energy = ElasticEnergy::default();
        for (relaxing, (kind, rod, stiffness)) in self.relaxing.iter().zip(all_strains(assembly)) {
            let Some(Relaxation { ratio, .. }) = self.rods[rod].1 else {
                continue;
            };
            if of.is_none_or(|of| of == rod) {
                let sum = match kind {
                    StrainKind::Stretching => &mut energy.stretching,
                    StrainKind::Bending => &mut energy.bending,
                    StrainKind::Twisting => &mut energy.twisting,
                };
                *sum += 0.5 * stiffness * relaxing * relaxing / ratio;
            }
        }
        energy
    }
}

/// Strains of the vertices and lengths of the edges.
fn write_strains(assembly: &Assembly, geometry: &RodGeometry, strains: &mut Vec<f64>) {
    strains.clear();
    let rods = &assembly.rods;
    for (index, vertex) in rods.vertices.iter().enumerate() {
        let turning = vertex.strain.of(&geometry.strains(index, vertex));
        strains.extend(turning.curvature);
        strains.push(turning.twist);
    }
    let edges = rods.edges.iter();
    strains.extend(edges.map(|edge| geometry.edges[edge.start].length));
}

impl Term for Damping {
    fn new(scene: &Scene, _: &mut Assembly) -> Result<Self, SceneError> {
        let rods = scene.rods.iter();
        let rods: Vec<_> = rods
            .map(|rod| (rod.retardation_time, rod.relaxation))
            .collect();
        let is_damped = |rod: &(f64, Option<Relaxation>)| rod.0 > 0.0 || rod.1.is_some();
        Ok(Self {
            rods: match rods.iter().any(is_damped) {
                true => rods,
                false => Vec::new(),
            },
            ..Self::default()
        })
    }

    fn kind(&self) -> Kind {
        Kind::Motion
    }

    fn has_copies(&self) -> bool {
        true
    }

    /// Energy of the viscous parts.
    fn energy(&self, assembly: &Assembly, _: &RodGeometry) -> ElasticEnergy {
        self.relaxing_energy(assembly, None)
    }

    /// The equivalent elastic rods of the stage include the forces of the dashpots; the term
    /// itself adds no forces.
    fn add_forces(&self, _: &Configuration, _: &mut [f64]) {}

    fn accept(&mut self, assembly: &Assembly, geometry: &RodGeometry) {
        self.keep(assembly, geometry);
    }

    /// Strains at the starts of the steps before the present one, and the relaxing parts q.
    fn memory(&self) -> Vec<Vec<f64>> {
        if self.is_empty() {
            return Vec::new();
        }
        let mut memory = self.history[1..].to_vec();
        if self.relaxes() {
            memory.push(self.relaxing.clone());
        }
        memory
    }

    fn restore(&mut self, memory: &mut dyn Iterator<Item = Vec<f64>>) -> Result<(), &'static str> {
        if self.is_empty() {
            return Ok(());
        }
        for kept in &mut self.history[1..] {
            *kept = memory.next().ok_or("damping")?;
        }
        if self.relaxes() {
            self.relaxing = memory.next().ok_or("damping")?;
            self.places.clear();
        }
        self.stage = None;
        Ok(())
    }

    fn refuses(&self, demand: Demand) -> Option<SceneError> {
        (demand == Demand::ImplicitMidpoint && !self.is_empty()).then_some(NO_MIDPOINT)
    }
}

impl System {
    /// Records the strains at `unknowns`, at the start of a step.
    pub(crate) fn begin_damping(&mut self, unknowns: &[f64]) {
        if self.terms.damping.is_empty() {
            return;
        }
        self.update_geometry(unknowns);
        self.terms.damping.begin(&self.assembly, &self.geometry);
    }

    /// Sets up the dashpots for a stage of the length `step` (s) in a step of the length `size`
    /// (s); `weights` are those of earlier strains in its differences.
    pub(crate) fn damp(&mut self, step: f64, size: f64, weights: [f64; 2]) {
        let damping = &mut self.terms.damping;
        if damping.is_empty() {
            return;
        }
        damping.stage = Some(Difference {
            step,
            weights,
            size,
        });
        damping.stiffen(&self.assembly);
        self.geometry.take_natural_strains(&damping.acting);
    }

    /// Without a stage dashpots carry no force.
    pub(crate) fn undamp(&mut self) {
        if self.terms.damping.stage.take().is_some() {
            self.geometry.take_natural_strains(&self.assembly.rods);
        }
    }

    /// The equivalent elastic rods of the last stage, which include the forces of their dashpots.
    pub(super) fn acting_rods(&self) -> &ElasticRods {
        match self.terms.damping.stage {
            Some(_) => &self.terms.damping.acting,
            None => &self.assembly.rods,
        }
    }

    /// Energy that dashpots dissipate from the start of a step to the last evaluation, at its end,
    /// J.
    pub(crate) fn viscous_loss(&self) -> f64 {
        let damping = &self.terms.damping;
        if damping.stage.is_none() {
            return 0.0;
        }
        let mut strains = Vec::new();
        write_strains(&self.assembly, &self.geometry, &mut strains);
        let loss = |(index, (_, rod, stiffness)): (usize, (StrainKind, usize, f64))| {
            let beside = damping.beside(rod);
            let end = strains[index];
            let change = end - damping.history[0][index];
            let mut loss = beside.dashpot * (end - damping.before(index)) * change;
            if beside.ratio > 0.0 {
                // The spring in series stores part of the work of the mean force.
                let start = damping.relaxing[index];
                let end = beside.relaxed(start, change);
                let kept = 0.5 * (end * end - start * start) / beside.ratio;
                loss += beside.mean(start, change) * change - kept;
            }
            stiffness * loss
        };
        all_strains(&self.assembly).enumerate().map(loss).sum()
    }
}
