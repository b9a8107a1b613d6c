//! Rods that are fed out of sheaths ([`crate::mechanics::scene::Sheath`]).
//!
//! Nodes are material points. The edges whose midpoints are in the sheath are held on its axis,
//! with their frames, and move along it; those outside are free. An edge that leaves is released,
//! and one that returns is held, from one step to the next, so that each length, mass and momentum
//! of the rod is conserved.
//!
//! [`mouth`] places the mouth between nodes, and derives the force of the sheath; [`pushed`] finds the
//! length that is fed out by a given force.

mod mouth;
mod placed;
mod pushed;

use super::System;
use super::build::Assembly;
use super::clamps::list_corners;
use super::demand::Demand;
use super::events::Event;
use super::term::{Configuration, Kind, Term};
use crate::mechanics::SceneError;
use crate::mechanics::fluid::FluidModel;
use crate::mechanics::rod::{ElasticEnergy, ElasticRods, RodGeometry};
use crate::mechanics::scene::{Scene, Sheath};
use placed::{Fault, PlacedSheath};

const NO_PATH: SceneError = SceneError::Unsuitable(
    "a path of equilibria does not support sheaths, whose rods change their free nodes",
);

const NO_EQUILIBRIUM: SceneError = SceneError::Unsuitable(
    "an equilibrium with a force that feeds a rod (pushed) is not searched: run dynamically with damping",
);

const NO_START: SceneError =
    SceneError::Unsuitable("a scene with sheaths cannot start from the end of another run");

const NO_MIDPOINT: SceneError = SceneError::Unsuitable(
    "sheaths need time.scheme = \"implicit-euler\" or \"backward-differences\"",
);

/// The sheaths of a scene.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sheaths(Vec<PlacedSheath>);

/// Checks the sheaths of a scene.
///
/// # Errors
/// [`SceneError::Sheath`] for the first one that cannot hold its rod, or another fault of the scene.
pub fn check_sheaths(scene: &Scene) -> Result<(), SceneError> {
    let mut assembly = Assembly::new(scene)?;
    Sheaths::new(scene, &mut assembly).map(drop)
}

impl Sheaths {
    /// Marks the unknowns that are held at a time, s. Returns whether any changed.
    fn mark(&mut self, time: f64, held: &mut [bool]) -> bool {
        let changed = self.0.iter_mut().map(|sheath| sheath.mark(time, held));
        changed.fold(false, |any, changed| any | changed)
    }

    /// Whether the scene has none.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl Term for Sheaths {
    /// # Errors
    /// [`SceneError::Sheath`] names a sheath that cannot hold its rod.
    fn new(scene: &Scene, assembly: &mut Assembly) -> Result<Self, SceneError> {
        let by_stokeslets = matches!(scene.fluid, Some(FluidModel::RegularizedStokeslets { .. }));
        let mut rods: Vec<usize> = Vec::new();
        let place = |sheath: &Sheath| {
            let fault = |(field, reason): Fault| SceneError::Sheath {
                name: sheath.name.clone(),
                field,
                reason,
            };
            let of_rod = |reason: &str| Err(fault(("rod", reason.to_owned())));
            let Some(rod) = scene.rods.get(sheath.rod) else {
                return of_rod("its rod does not exist");
            };
            if rods.contains(&sheath.rod) {
                return of_rod("another sheath holds its rod");
            }
            if (scene.actuations.iter()).any(|actuation| actuation.rod == sheath.rod) {
                return of_rod("its rod is actuated");
            }
            if by_stokeslets {
                return of_rod(
                    "regularized Stokeslets do not support rods in sheaths; fluid.model = \"resistive\" does",
                );
            }
            rods.push(sheath.rod);
            PlacedSheath::new(sheath, rod, assembly).map_err(fault)
        };
        let placed: Result<Vec<_>, _> = scene.sheaths.iter().map(place).collect();
        let sheaths = Self(placed?);
        sheaths.0.iter().for_each(|sheath| sheath.begin(assembly));
        Ok(sheaths)
    }

    fn kind(&self) -> Kind {
        Kind::Elastic
    }

    fn has_copies(&self) -> bool {
        self.is_empty()
    }

    /// Stiffens the vertices at the mouths.
    fn drive(&mut self, time: f64, rods: &mut ElasticRods, geometry: &mut RodGeometry) {
        if !self.is_empty() {
            (self.0.iter_mut()).for_each(|sheath| sheath.stiffen(time, rods));
            geometry.take_natural_strains(rods);
        }
    }

    fn energy(&self, assembly: &Assembly, _: &RodGeometry) -> ElasticEnergy {
        let inside = self.0.iter().map(|sheath| sheath.energy_inside(assembly));
        ElasticEnergy {
            bending: inside.sum(),
            ..ElasticEnergy::default()
        }
    }

    /// A sheath changes the stiffness of rods, and holds nodes; the term itself adds no forces.
    fn add_forces(&self, _: &Configuration, _: &mut [f64]) {}

    fn commit(&mut self) {
        self.0.iter_mut().for_each(PlacedSheath::commit);
    }

    fn list_events(&self, events: &mut Vec<Event>) {
        for sheath in &self.0 {
            list_corners(&sheath.fed, |from, to| (to - from).abs(), events);
            let around = |from: &f64, to: &f64| (to - from).abs() * sheath.radius;
            list_corners(&sheath.turned, around, events);
            // Forces change no velocity at once, but steps end where their schedule has corners.
            list_corners(sheath.pushes(), |_, _| 0.0, events);
        }
    }

    fn refuses(&self, demand: Demand) -> Option<SceneError> {
        if self.is_empty() {
            return None;
        }
        match demand {
            Demand::Path => Some(NO_PATH),
            Demand::Start => Some(NO_START),
            Demand::ImplicitMidpoint => Some(NO_MIDPOINT),
            Demand::Equilibrium | Demand::NearbyEquilibrium
                if self.0.iter().any(|sheath| sheath.push.is_some()) =>
            {
                Some(NO_EQUILIBRIUM)
            }
            _ => None,
        }
    }
}

impl System {
    /// Holds the nodes that are in sheaths at a time, s, and sets their positions and frames.
    pub(super) fn hold_in_sheaths(&mut self, time: f64, unknowns: &mut [f64]) {
        if self.terms.sheaths.is_empty() {
            return;
        }
        for sheath in &mut self.terms.sheaths.0 {
            sheath.predict(unknowns);
        }
        if self.terms.sheaths.mark(time, &mut self.assembly.held) {
            self.note_prescribed_nodes();
            self.matrix.adapt(&self.assembly);
        }
        let committed = self.committed_time;
        for sheath in &mut self.terms.sheaths.0 {
            sheath.apply(time, committed, &self.reference, unknowns);
        }
    }

    /// The frames of held edges are those of a configuration that was committed before.
    pub(super) fn resume_sheaths(&mut self, unknowns: &[f64]) {
        for sheath in &mut self.terms.sheaths.0 {
            sheath.resume(unknowns);
        }
    }

    /// Natural length of the rod outside of a sheath at the last evaluation, m.
    pub(crate) fn length_outside(&self, sheath: usize) -> f64 {
        let sheath = &self.terms.sheaths.0[sheath];
        sheath.along[sheath.edges.len()] - sheath.mouth_at(self.time)
    }

    /// Force of a sheath on its rod in the direction in which it is fed, N, and moment about this
    /// direction, N m, at the last evaluation.
    pub(crate) fn sheath_force(&self, sheath: usize) -> [f64; 2] {
        let sheath = &self.terms.sheaths.0[sheath];
        sheath.force(&self.assembly, &self.geometry, &self.residual)
    }
}
