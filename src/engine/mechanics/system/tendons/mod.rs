//! Tendons: cables through eyelets ([`crate::mechanics::scene::Tendon`]).
//!
//! The length of a tendon is the sum ℓ = Σ ‖pᵢ₊₁ − pᵢ‖ over its eyelets p ([`eyelet`]), and its
//! energy is E(ℓ): T ℓ under a given tension T, ½ (EA/L) (ℓ − L)² for one that stretches and is not
//! slack. Without friction ([`capstan`]) the tension is the same along all of it. With the unit
//! vectors u of its straight parts of length r,
//!
//! ```text
//! ∂E/∂pᵢ = T (uᵢ₋₁ − uᵢ),     ∂²E/∂q² = T ∂²ℓ/∂q² + (EA/L) ∂ℓ/∂q ∂ℓ/∂qᵀ
//! T ∂²ℓ/∂q² = Σ T/r ∂(pᵢ₊₁ − pᵢ)ᵀ (1 − u uᵀ) ∂(pᵢ₊₁ − pᵢ) + Σ ∂²(∂E/∂pᵢ · p)/∂q²
//! ```
//!
//! The product of gradients couples all eyelets of a tendon that stretches; a given tension couples
//! neighbouring eyelets only.
//!
//! Tendons along an elastic rod bend and twist it as in the model of D. C. Rucker and R. J. Webster
//! (2011), *Statics and dynamics of continuum robots with general tendon routing and external
//! loading*, IEEE Transactions on Robotics 27, 1033, with straight parts between eyelets.

mod capstan;
mod entries;
mod eyelet;
mod friction;
#[cfg(test)]
mod tests;

use super::System;
use super::build::Assembly;
use super::demand::Demand;
use super::events::Event;
use super::newton_matrix::Entries;
use super::term::{Configuration, Kind, Term};
use crate::linalg::Element;
use crate::mechanics::rod::{ElasticEnergy, ElasticRods, RodGeometry};
use crate::mechanics::scene::{Eyelet, Pull, Scene, Tendon, piecewise_linear};
use crate::mechanics::{Matrix3, SceneError, Vector3};
use capstan::Capstans;
use entries::TendonEntries;
use eyelet::{CarryingEdge, RodEyelet};

const NO_PATH: SceneError = SceneError::Unsuitable(
    "a path of equilibria does not support tendons that stretch: their stiffness jumps where they become slack; prescribe their tension",
);

const NO_EQUILIBRIUM: SceneError = SceneError::Unsuitable(
    "an equilibrium does not determine the friction of tendons in their eyelets: run dynamically",
);

const NO_START: SceneError = SceneError::Unsuitable(
    "a scene that starts from the end of another run needs the rest length of each tendon that stretches",
);

/// The tendons of a scene, at the configuration of the last update.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tendons(Vec<PlacedTendon>);

#[derive(Clone, Debug)]
struct PlacedTendon {
    eyelets: Vec<PlacedEyelet>,
    pull: Pull,
    /// L without what is taken in, m; not used under a given tension.
    rest_length: f64,
    entries: TendonEntries,
    /// Tension that is given, N, or L, m, at the present time.
    given: f64,
    /// ℓ, m.
    length: f64,
    /// Friction in the eyelets, if any.
    capstans: Option<Capstans>,
    /// Between the eyelets.
    parts: Vec<StraightPart>,
}

/// A straight part of a tendon between two eyelets.
#[derive(Clone, Copy, Debug)]
struct StraightPart {
    /// u; zero where the eyelets meet.
    direction: Vector3,
    /// r, m.
    length: f64,
    /// T, N.
    tension: f64,
}

#[derive(Clone, Debug)]
struct PlacedEyelet {
    /// The rod that carries it; `None` for a point that does not move.
    on_rod: Option<RodEyelet>,
    /// p, m.
    place: Vector3,
    /// Indices of the unknowns on which it depends among those of the tendon, and ∂p/∂q.
    rates: Vec<(usize, Vector3)>,
}

impl PlacedTendon {
    /// # Errors
    /// [`SceneError::Tendon`] if it has less than two eyelets, or if a node does not exist.
    fn new(tendon: &Tendon, assembly: &Assembly) -> Result<Self, SceneError> {
        let invalid = || SceneError::Tendon(tendon.name.clone());
        let place = |eyelet: &Eyelet| match *eyelet {
            Eyelet::Fixed(place) => Some((None, place)),
            Eyelet::OnRod { at, offset } => {
                let rod = assembly.rods.rods.get(at.rod)?;
                let node = (at.node < rod.nodes).then_some(rod.first_node + at.node)?;
                let edges = if offset == [0.0; 2] {
                    Vec::new()
                } else {
                    let beside = rod.edges_at(node);
                    let weight = 1.0 / beside.len() as f64;
                    let carrying = |[start, end]: [usize; 2]| CarryingEdge { start, end, weight };
                    beside.into_iter().map(carrying).collect()
                };
                let eyelet = RodEyelet {
                    node,
                    offset,
                    edges,
                };
                Some((Some(eyelet), Vector3::zeros()))
            }
        };
        let placed: Option<Vec<_>> = tendon.eyelets.iter().map(place).collect();
        let placed = placed.filter(|placed| placed.len() > 1);
        let placed = placed.ok_or_else(invalid)?;
        let rubs = tendon.friction.is_some();
        let unknowns = |(eyelet, _): &(Option<RodEyelet>, Vector3)| {
            let own = eyelet.iter().flat_map(RodEyelet::unknowns);
            own.collect::<Vec<usize>>()
        };
        let unknowns: Vec<Vec<usize>> = placed.iter().map(unknowns).collect();
        let (entries, places) = TendonEntries::new(&unknowns, tendon.pull.stretches() || rubs);
        let eyelets = placed.into_iter().zip(places);
        let eyelets: Vec<_> = eyelets
            .map(|((on_rod, place), slots)| PlacedEyelet {
                on_rod,
                place,
                rates: slots
                    .into_iter()
                    .map(|slot| (slot, Vector3::zeros()))
                    .collect(),
            })
            .collect();
        Ok(Self {
            parts: Vec::with_capacity(eyelets.len() - 1),
            capstans: tendon.friction.map(|law| Capstans::new(law, eyelets.len())),
            eyelets,
            pull: tendon.pull.clone(),
            rest_length: 0.0,
            entries,
            given: 0.0,
            length: 0.0,
        })
    }

    /// Sets places and rates of eyelets, the length, and the forces.
    fn update(&mut self, unknowns: &[f64], geometry: &RodGeometry) {
        for eyelet in &mut self.eyelets {
            if let Some(on_rod) = &eyelet.on_rod {
                eyelet.place = on_rod.place(unknowns, geometry);
                let mut rates = eyelet.rates.iter_mut();
                on_rod.rates(geometry, |rate| {
                    rates.next().expect("a slot for each rate").1 = rate;
                });
            }
        }
        let parts = self.eyelets.windows(2).map(StraightPart::between);
        self.parts.clear();
        self.parts.extend(parts);
        self.length = self.parts.iter().map(|part| part.length).sum();
        let tension = self.tension();
        self.parts
            .iter_mut()
            .for_each(|part| part.tension = tension);
        let Some(mut capstans) = self.capstans.take() else {
            return;
        };
        capstans.turn(&self.parts);
        match self.pull {
            Pull::Tension(_) => self.pass_tension(&mut capstans),
            Pull::Stretching { stiffness, .. } => self.find_tensions(stiffness, &mut capstans),
        }
        self.capstans = Some(capstans);
    }

    /// Takes the present length as rest length if the scene has none. Returns whether some is left
    /// at all times.
    fn set_rest_length(&mut self) -> bool {
        let Pull::Stretching {
            rest_length,
            taken_in,
            ..
        } = &self.pull
        else {
            return true;
        };
        self.rest_length = rest_length.unwrap_or(self.length);
        taken_in.iter().all(|corner| corner.1 < self.rest_length)
    }

    /// Adds the rounding errors of its forces to those of `assembly`.
    fn round(&self, assembly: &mut Assembly) {
        for (ends, part) in self.eyelets.windows(2).zip(&self.parts) {
            let stiffness = match self.pull {
                Pull::Stretching { stiffness, .. } => stiffness / self.given,
                Pull::Tension(_) => self.given / part.length,
            };
            for eyelet in ends {
                if let (Some(on_rod), true) = (&eyelet.on_rod, stiffness.is_finite()) {
                    assembly.round(on_rod.node, stiffness);
                }
            }
        }
    }

    /// Sets what is given at a time, s.
    fn drive(&mut self, time: f64) {
        let at = |corners: &[(f64, f64)]| piecewise_linear(corners, time).unwrap_or(0.0);
        self.given = match &self.pull {
            Pull::Tension(corners) => at(corners),
            Pull::Stretching { taken_in, .. } => self.rest_length - at(taken_in),
        };
    }

    /// T, N.
    fn tension(&self) -> f64 {
        match self.pull {
            Pull::Tension(_) => self.given,
            Pull::Stretching { stiffness, .. } => {
                (stiffness * (self.length / self.given - 1.0)).max(0.0)
            }
        }
    }

    /// ∂T/∂ℓ, N/m: that of the taut tendon where ℓ = L.
    fn stiffness(&self) -> f64 {
        match self.pull {
            Pull::Stretching { stiffness, .. } if self.length >= self.given => {
                stiffness / self.given
            }
            _ => 0.0,
        }
    }

    /// Elastic energy, J.
    fn energy(&self) -> f64 {
        match self.pull {
            Pull::Tension(_) => 0.0,
            Pull::Stretching { stiffness, .. } if self.capstans.is_some() => {
                let of_part = |part: &StraightPart| {
                    let strain = part.tension / stiffness;
                    0.5 * part.tension * strain * part.length / (1.0 + strain)
                };
                self.parts.iter().map(of_part).sum()
            }
            Pull::Stretching { .. } => 0.5 * self.tension() * (self.length - self.given),
        }
    }

    /// Adds ∂²E/∂q² to the matrices of its elements.
    fn add_hessian(&self, at: &Configuration, entries: &mut Entries, first: usize) {
        let matrices = &mut entries.elements()[first..first + self.entries.count()];
        for (number, part) in self.parts.iter().enumerate() {
            let StraightPart {
                direction: along,
                length,
                tension,
            } = part;
            if *length == 0.0 {
                continue;
            }
            let across = (Matrix3::identity() - along * along.transpose()) * (tension / length);
            for (column, rate) in self.span(number) {
                let turned = across * rate;
                for (row, rate) in self.span(number) {
                    self.entries.add(matrices, row, column, rate.dot(&turned));
                }
            }
        }
        let sources = &at.reference.tangent;
        for (number, eyelet) in self.eyelets.iter().enumerate() {
            if let Some(on_rod) = &eyelet.on_rod {
                let force = self.sum_at(number, |part| part.tension);
                on_rod.curvature(&force, at.geometry, sources, |row, column, value| {
                    let [row, column] = [row, column].map(|k| eyelet.rates[k].0);
                    self.entries.add(matrices, row, column, value);
                });
            }
        }
        if let Some(capstans) = &self.capstans {
            self.add_friction(capstans, matrices);
            return;
        }
        let stiffness = self.stiffness();
        if stiffness > 0.0 {
            for (column, slope) in self.slopes() {
                for (row, other) in self.slopes() {
                    (self.entries).add(matrices, row, column, stiffness * slope * other);
                }
            }
        }
    }

    /// The rates of the span of a straight part over the unknowns, with their indices among those of
    /// the tendon.
    fn span(&self, part: usize) -> impl Iterator<Item = (usize, Vector3)> {
        let (from, to) = (self.eyelets[part].rates.iter(), &self.eyelets[part + 1]);
        let from = from.map(|&(slot, rate)| (slot, -rate));
        from.chain(to.rates.iter().copied())
    }

    /// ∂r/∂q of a straight part, with the indices of the unknowns.
    fn lengthening(&self, part: usize) -> impl Iterator<Item = (usize, f64)> {
        let direction = self.parts[part].direction;
        self.span(part)
            .map(move |(slot, rate)| (slot, direction.dot(&rate)))
    }

    /// Σ w ∂r/∂p over the straight parts at an eyelet, with weights w of the parts.
    fn sum_at(&self, eyelet: usize, weight: impl Fn(&StraightPart) -> f64) -> Vector3 {
        let before = eyelet.checked_sub(1).map(|part| &self.parts[part]);
        let of = |part: &StraightPart| part.direction * weight(part);
        let [before, after] = [before, self.parts.get(eyelet)].map(|part| part.map(of));
        before.unwrap_or_default() - after.unwrap_or_default()
    }

    /// Σ w ∂r/∂q over all straight parts, with the indices of the unknowns among those of the tendon;
    /// entries of the same unknown add up.
    fn sums(
        &self,
        weight: impl Fn(&StraightPart) -> f64 + Copy,
    ) -> impl Iterator<Item = (usize, f64)> {
        let eyelets = self.eyelets.iter().enumerate();
        eyelets.flat_map(move |(number, eyelet)| {
            let sum = self.sum_at(number, weight);
            let rates = eyelet.rates.iter();
            rates.map(move |(slot, rate)| (*slot, sum.dot(rate)))
        })
    }

    /// ∂ℓ/∂q.
    fn slopes(&self) -> impl Iterator<Item = (usize, f64)> {
        self.sums(|_| 1.0)
    }

    /// The residual, ∂E/∂q without friction.
    fn forces(&self) -> impl Iterator<Item = (usize, f64)> {
        self.sums(|part| part.tension)
    }
}

impl StraightPart {
    /// The part between two eyelets, without tension.
    fn between(ends: &[PlacedEyelet]) -> Self {
        let span = ends[1].place - ends[0].place;
        Self {
            direction: span.try_normalize(0.0).unwrap_or_else(Vector3::zeros),
            length: span.norm(),
            tension: 0.0,
        }
    }
}

impl Tendons {
    /// Whether a straight part turns, or is stretched, by more than `part` of its length under a
    /// motion of nodes.
    pub(crate) fn turn_by(&self, part: f64, moved: impl Fn(usize) -> Vector3) -> bool {
        let moved = |eyelet: &PlacedEyelet| {
            let node = eyelet.on_rod.as_ref().map(|on_rod| on_rod.node);
            node.map_or_else(Vector3::zeros, &moved)
        };
        self.0.iter().any(|tendon| {
            let mut ends = tendon.eyelets.windows(2).zip(&tendon.parts);
            ends.any(|(ends, own)| (moved(&ends[1]) - moved(&ends[0])).norm() > part * own.length)
        })
    }
}

impl Term for Tendons {
    /// # Errors
    /// [`SceneError::Tendon`] if a tendon is invalid.
    fn new(scene: &Scene, assembly: &mut Assembly) -> Result<Self, SceneError> {
        if scene.tendons.is_empty() {
            return Ok(Self::default());
        }
        let mut geometry = RodGeometry::new(&assembly.rods);
        let (unknowns, reference) = (&assembly.unknowns, &assembly.reference);
        geometry.update(&assembly.rods, unknowns, reference, &assembly.ghosts);
        let mut tendons = Vec::new();
        for tendon in &scene.tendons {
            let mut placed = PlacedTendon::new(tendon, assembly)?;
            placed.update(unknowns, &geometry);
            if !placed.set_rest_length() {
                return Err(SceneError::Tendon(tendon.name.clone()));
            }
            placed.drive(0.0);
            placed.begin_friction();
            tendons.push(placed);
        }
        tendons.iter().for_each(|tendon| tendon.round(assembly));
        Ok(Self(tendons))
    }

    fn kind(&self) -> Kind {
        Kind::Elastic
    }

    fn has_copies(&self) -> bool {
        self.0.is_empty()
    }

    fn elements(&self, _: &Assembly) -> Vec<Element> {
        let elements = self.0.iter().flat_map(|tendon| tendon.entries.elements());
        elements.collect()
    }

    fn couples_nodes(&self) -> bool {
        !self.0.is_empty()
    }

    fn drive(&mut self, time: f64, _: &mut ElasticRods, _: &mut RodGeometry) {
        self.0.iter_mut().for_each(|tendon| tendon.drive(time));
    }

    fn update(&mut self, at: &Configuration) {
        for tendon in &mut self.0 {
            tendon.update(at.unknowns, at.geometry);
        }
    }

    /// Counts as stretching.
    fn energy(&self, _: &Assembly, _: &RodGeometry) -> ElasticEnergy {
        ElasticEnergy {
            stretching: self.0.iter().map(PlacedTendon::energy).sum(),
            ..ElasticEnergy::default()
        }
    }

    /// T ℓ of tendons under a given tension, at the last update.
    fn potential(&self, _: &[f64]) -> [f64; 2] {
        let given = self.0.iter().filter(|tendon| !tendon.pull.stretches());
        let potential: f64 = given.map(|tendon| tendon.given * tendon.length).sum();
        [potential, potential.abs()]
    }

    fn has_potential(&self) -> bool {
        self.0.iter().all(|tendon| tendon.capstans.is_none())
    }

    fn commit(&mut self) {
        let capstans = self.0.iter_mut().filter_map(|one| one.capstans.as_mut());
        capstans.for_each(Capstans::commit);
    }

    fn memory(&self) -> Vec<Vec<f64>> {
        let capstans = self.0.iter().filter_map(|one| one.capstans.as_ref());
        capstans.map(Capstans::memory).collect()
    }

    fn restore(&mut self, memory: &mut dyn Iterator<Item = Vec<f64>>) -> Result<(), &'static str> {
        for capstans in self.0.iter_mut().filter_map(|one| one.capstans.as_mut()) {
            let fits = memory.next().is_some_and(|one| capstans.restore(&one));
            fits.then_some(()).ok_or("friction of tendons")?;
        }
        Ok(())
    }

    fn add_forces(&self, _: &Configuration, residual: &mut [f64]) {
        for tendon in &self.0 {
            for (slot, force) in tendon.forces() {
                residual[tendon.entries.unknown(slot)] += force;
            }
        }
    }

    fn add_jacobian(&self, at: &Configuration, entries: &mut Entries) {
        let mut first = 0;
        for tendon in &self.0 {
            tendon.add_hessian(at, entries, first);
            first += tendon.entries.count();
        }
    }

    fn add_sizes(&self, _: &Configuration, forces: &mut [f64]) {
        for tendon in &self.0 {
            for (slot, force) in tendon.forces() {
                forces[tendon.entries.unknown(slot)] += force.abs();
            }
        }
    }

    fn list_events(&self, events: &mut Vec<Event>) {
        for tendon in &self.0 {
            let (Pull::Tension(corners)
            | Pull::Stretching {
                taken_in: corners, ..
            }) = &tendon.pull;
            events.extend(corners.iter().map(|corner| Event::of_load(corner.0)));
        }
    }

    fn refuses(&self, demand: Demand) -> Option<SceneError> {
        let mut pulls = self.0.iter().map(|tendon| &tendon.pull);
        let rub = !self.has_potential();
        match demand {
            Demand::Equilibrium | Demand::NearbyEquilibrium | Demand::Path if rub => {
                Some(NO_EQUILIBRIUM)
            }
            Demand::Path => pulls.any(Pull::stretches).then_some(NO_PATH),
            Demand::Start => pulls
                .any(|pull| {
                    matches!(
                        pull,
                        Pull::Stretching {
                            rest_length: None,
                            ..
                        }
                    )
                })
                .then_some(NO_START),
            _ => None,
        }
    }
}

impl System {
    /// Tension of a tendon at the last evaluation in its first and in its last straight part, N.
    pub(crate) fn tendon_tensions(&self, tendon: usize) -> [f64; 2] {
        let parts = &self.terms.tendons.0[tendon].parts;
        [0, parts.len() - 1].map(|part| parts[part].tension)
    }

    /// Length of a tendon at the last evaluation, m.
    pub(crate) fn tendon_length(&self, tendon: usize) -> f64 {
        self.terms.tendons.0[tendon].length
    }
}
