//! The interface of a force.
//!
//! The residual of a scene and Newton's matrix are sums over its terms,
//!
//! ```text
//! R(q) = Σₖ Rₖ(q, t),     Rₖ = ∂Eₖ/∂q  or  −Fₖ,     J = Σₖ ∂Rₖ/∂q
//! ```
//!
//! over all unknowns q, 4 per node (x, y, z in m and the angle of its edge in rad), then those of frames. [`super::terms`] lists the
//! terms; all other parts of [`super::System`] use that list. A term declares
//!
//! - the entries of its Jacobian outside the band of the rods ([`Term::elements`]);
//! - its state at a time ([`Term::drive`]) and at a configuration ([`Term::update`]);
//! - its energy, and its parts of residual and Jacobian ([`Term::energy`], [`Term::add_forces`], [`Term::add_jacobian`]);
//! - the data that it keeps between steps ([`Term::accept`], [`Term::commit`], [`Term::resume`]), and which of these belong to a
//!   checkpoint ([`Term::memory`]);
//! - the times at which the quantities it depends on change their rate ([`Term::list_events`]);
//! - the demands that it does not support ([`Term::refuses`]).
//!
//! All methods except the residual have default implementations. Calls are virtual, but few: one per term and
//! evaluation.
//!
//! Clamps and joints are not terms: they prescribe or eliminate unknowns ([`super::clamps`], [`super::joints`]), and the reactions on them
//! are what the sum leaves. The flow of a fluid is solved for by the stage; its term is the drag that this gives.

use super::build::Assembly;
use super::demand::Demand;
use super::events::Event;
use super::newton_matrix::Entries;
use super::stage::Stage;
use crate::linalg::Element;
use crate::mechanics::SceneError;
use crate::mechanics::rod::{ElasticEnergy, ElasticRods, ReferenceFrames, RodGeometry};
use crate::mechanics::scene::Scene;

/// Where forces are evaluated.
#[derive(Clone, Copy)]
pub(crate) struct Configuration<'a> {
    pub assembly: &'a Assembly,
    /// Frames and strains at the unknowns.
    pub geometry: &'a RodGeometry,
    /// Frames from which the present step transports.
    pub reference: &'a ReferenceFrames,
    /// s.
    pub time: f64,
    /// q.
    pub unknowns: &'a [f64],
    /// The implicit stage of a time step; `None` in an equilibrium.
    pub stage: Option<&'a Stage>,
}

/// Kind of force of a term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Inertia, damping and drag.
    Motion,
    /// The gradient of an elastic energy.
    Elastic,
    /// External forces and moments.
    Load,
    Contact,
}

/// A force, or what changes others.
pub(crate) trait Term {
    /// Creates the term of a scene whose unknowns are numbered.
    ///
    /// # Errors
    /// [`SceneError`] for an invalid scene.
    fn new(scene: &Scene, assembly: &mut Assembly) -> Result<Self, SceneError>
    where
        Self: Sized;

    /// Kind of force, which error messages name.
    fn kind(&self) -> Kind;

    /// Unknowns that it couples in addition to those in the band of the rods, up to twelve in each element. Their number never changes.
    fn elements(&self, _assembly: &Assembly) -> Vec<Element> {
        Vec::new()
    }

    /// Whether it is part of the equations of many systems at once ([`super::copies`]), or zero in this scene.
    fn has_copies(&self) -> bool {
        false
    }

    /// Whether it couples nodes of different rods, or distant ones of the same.
    fn couples_nodes(&self) -> bool {
        false
    }

    /// Takes on what a time, s, prescribes. It may change the natural strains of rods, with their geometry.
    fn drive(&mut self, _time: f64, _rods: &mut ElasticRods, _geometry: &mut RodGeometry) {}

    /// Takes over a configuration, which residual and energy then are those of.
    fn update(&mut self, _at: &Configuration) {}

    /// Elastic energy at the last update.
    fn energy(&self, _assembly: &Assembly, _geometry: &RodGeometry) -> ElasticEnergy {
        ElasticEnergy::default()
    }

    /// Another potential, J, and the sum of the magnitudes that add up to it: rounding leaves some last digits of these.
    fn potential(&self, _unknowns: &[f64]) -> [f64; 2] {
        [0.0; 2]
    }

    /// Whether its forces have a potential, so that its Jacobian is symmetric.
    fn has_potential(&self) -> bool {
        true
    }

    /// Adds its part of the residual, N and N m, at the last evaluation.
    fn add_forces(&self, at: &Configuration, residual: &mut [f64]);

    /// Adds how its part of the residual changes with the unknowns, N/m.
    fn add_jacobian(&self, _at: &Configuration, _entries: &mut Entries) {}

    /// Evaluates its part of the residual and adds it.
    fn evaluate(&mut self, at: &Configuration, residual: &mut [f64]) {
        self.add_forces(at, residual);
    }

    /// Evaluates its parts of residual and Jacobian and adds them.
    fn linearize(&mut self, at: &Configuration, residual: &mut [f64], entries: &mut Entries) {
        self.add_forces(at, residual);
        self.add_jacobian(at, entries);
    }

    /// Adds to `forces`, N, how large the forces on each unknown are that may balance each other: those of a motion by themselves.
    fn add_sizes(&self, at: &Configuration, forces: &mut [f64]) {
        if self.kind() == Kind::Motion {
            self.add_forces(at, forces);
        }
    }

    /// Keeps what belongs to the end of an accepted step, the last evaluation.
    fn accept(&mut self, _assembly: &Assembly, _geometry: &RodGeometry) {}

    /// Starts the next step, or the next equilibrium, at the present configuration.
    fn commit(&mut self) {}

    /// Continues from a time, s, at which a state was committed.
    fn resume(&mut self, _time: f64) {}

    /// Its data in a checkpoint.
    fn memory(&self) -> Vec<Vec<f64>> {
        Vec::new()
    }

    /// Continues from the next data of a checkpoint, as many as [`Self::memory`] returned.
    ///
    /// # Errors
    /// The difference, if the checkpoint belongs to another scene.
    fn restore(&mut self, _memory: &mut dyn Iterator<Item = Vec<f64>>) -> Result<(), &'static str> {
        Ok(())
    }

    /// Adds the times at which what it depends on changes its rate.
    fn list_events(&self, _events: &mut Vec<Event>) {}

    /// Multiplies a load of the scene by a factor in addition to its schedule.
    fn scale_load(&mut self, _load: usize, _factor: f64) {}

    /// Reason why a scene with it does not meet a demand; `None` if it does.
    fn refuses(&self, _demand: Demand) -> Option<SceneError> {
        None
    }
}
