//! The interface of a force.
//!
//! The residual of a scene and Newton's matrix are sums over its terms,
//!
//! ```text
//! R(q) = Σₖ Rₖ(q, t),     Rₖ = ∂Eₖ/∂q  or  −Fₖ,     J = Σₖ ∂Rₖ/∂q
//! ```
//!
//! over all unknowns q: 4 per node (x, y, z in m and the angle of its edge in rad), followed by
//! those of frames. [`super::terms`] lists the terms; all other parts of [`super::System`] use
//! that list. A term declares
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
//! Clamps and joints are not terms: they prescribe or eliminate unknowns ([`super::clamps`],
//! [`super::joints`]), and their reactions are the remaining residual. The stage solves for the
//! flow of a fluid; the term of the fluid is the resulting drag.

use super::build::Assembly;
use super::demand::Demand;
use super::events::Event;
use super::newton_matrix::Entries;
use super::stage::Stage;
use crate::linalg::Element;
use crate::mechanics::SceneError;
use crate::mechanics::rod::{ElasticEnergy, ElasticRods, ReferenceFrames, RodGeometry};
use crate::mechanics::scene::Scene;

/// Configuration at which forces are evaluated.
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

/// A force, or a part of a scene that changes other forces.
pub(crate) trait Term {
    /// Creates the term of a scene with numbered unknowns.
    ///
    /// # Errors
    /// [`SceneError`] for an invalid scene.
    fn new(scene: &Scene, assembly: &mut Assembly) -> Result<Self, SceneError>
    where
        Self: Sized;

    /// Kind of force, as named in error messages.
    fn kind(&self) -> Kind;

    /// Unknowns that the term couples in addition to those in the band of the rods, up to twelve
    /// in each element. The number of elements never changes.
    fn elements(&self, _assembly: &Assembly) -> Vec<Element> {
        Vec::new()
    }

    /// Whether the term is zero in this scene or supports the equations of many systems at once
    /// ([`super::copies`]).
    fn has_copies(&self) -> bool {
        false
    }

    /// Whether the term couples nodes of different rods, or distant nodes of one rod.
    fn couples_nodes(&self) -> bool {
        false
    }

    /// Applies the values prescribed at a time, s. A term may change the natural strains of rods;
    /// `_geometry` is for this purpose.
    fn drive(&mut self, _time: f64, _rods: &mut ElasticRods, _geometry: &mut RodGeometry) {}

    /// Sets the configuration for which residual and energy are then evaluated.
    fn update(&mut self, _at: &Configuration) {}

    /// Elastic energy at the last update.
    fn energy(&self, _assembly: &Assembly, _geometry: &RodGeometry) -> ElasticEnergy {
        ElasticEnergy::default()
    }

    /// Another potential, J, and the sum of the magnitudes of its summands: the rounding error is
    /// a few units in the last place of that sum.
    fn potential(&self, _unknowns: &[f64]) -> [f64; 2] {
        [0.0; 2]
    }

    /// Whether the forces of the term have a potential, so that its Jacobian is symmetric.
    fn has_potential(&self) -> bool {
        true
    }

    /// Adds its part of the residual, N and N m, at the last evaluation.
    fn add_forces(&self, at: &Configuration, residual: &mut [f64]);

    /// Adds the derivative of its part of the residual with respect to the unknowns, N/m.
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

    /// Adds to `forces`, N, the magnitudes of forces on each unknown that may balance each other,
    /// such as those of a motion alone.
    fn add_sizes(&self, at: &Configuration, forces: &mut [f64]) {
        if self.kind() == Kind::Motion {
            self.add_forces(at, forces);
        }
    }

    /// Stores data of the last evaluation, which is the end of an accepted step.
    fn accept(&mut self, _assembly: &Assembly, _geometry: &RodGeometry) {}

    /// Starts the next step, or the next equilibrium, at the present configuration.
    fn commit(&mut self) {}

    /// Restores a state that was committed at a time, s.
    fn resume(&mut self, _time: f64) {}

    /// Data of the term in a checkpoint.
    fn memory(&self) -> Vec<Vec<f64>> {
        Vec::new()
    }

    /// Restores the term from the next values of a checkpoint, as many as [`Self::memory`]
    /// returned.
    ///
    /// # Errors
    /// The difference if the checkpoint belongs to another scene.
    fn restore(&mut self, _memory: &mut dyn Iterator<Item = Vec<f64>>) -> Result<(), &'static str> {
        Ok(())
    }

    /// Adds the times at which the rates of its prescribed values change.
    fn list_events(&self, _events: &mut Vec<Event>) {}

    /// Multiplies a load of the scene by a factor in addition to its schedule.
    fn scale_load(&mut self, _load: usize, _factor: f64) {}

    /// Reason why a scene with this term does not meet a demand; `None` if it does.
    fn refuses(&self, _demand: Demand) -> Option<SceneError> {
        None
    }
}
