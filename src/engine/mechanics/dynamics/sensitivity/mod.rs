//! Derivatives of motions and equilibria with respect to parameters of the scene: forward mode.
//!
//! A step solves R(q; s, p) = 0 for the unknowns q at the end of its stage, where s is the state
//! at its start: unknowns and velocities at present and at the last steps, frames that were
//! transported in time, strains of dashpots, contact stiffness. By the implicit function theorem
//!
//! ```text
//! J dq/dp = −(∂R/∂s ds/dp + ∂R/∂p),     J = ∂R/∂q
//! ```
//!
//! with the Newton matrix J of the step at its solution, which is factored once for all
//! parameters; for an equilibrium the same holds without s. The right-hand side is a derivative
//! along one direction, (ds/dp, 1), at fixed q:
//!
//! - Inertia and drag are linear in the start q̂ of the stage and the velocity v̂ there. Their
//!   part is their own formula applied to (dq̂/dp, dv̂/dp), which follow from the derivatives of
//!   the last steps by the formulas of the scheme. This part is exact; in a difference, rounding
//!   errors would be divided by the square of the step.
//! - For everything else there are two neighbours for each parameter: the scenes with p ± ε, in
//!   the states s ± ε ds/dp. The derivative is (R₊ − R₋)/2ε at the q of the step. The neighbours
//!   take the same steps as the scene itself with the same code, but use q ± ε dq/dp instead of
//!   solving for their own solution. So their frames, strains and contacts are those of a motion
//!   along the derivative.
//!
//! **Frames.** The spin of a material frame about its tangent t depends on old and new tangents
//! through the holonomy of parallel transport ([`crate::mechanics::rod`], `holonomy`). The angle
//! in q is measured from the frame that was transported in time. Each neighbour transports its own
//! frame along its own tangents, which gives the change of the transported frame without a formula
//! for it.
//!
//! **Accuracy.** A difference over ±ε has an error of ε² ∂³R/6 and of rounding errors over ε. The
//! relative ε of 2e-5 that [`Variation`] recommends leaves 1e-10 to 3e-8 of both in positions and
//! velocities; [`Sensitivity::amplitude`] reports how far the neighbours have moved away. The step
//! sizes and the states of switches are those of the scene itself, as if they did not depend on p.
//! A force with a kink exactly there gets the mean of its two derivatives.
//!
//! **Reactions.** The reaction at a held unknown is its row of R, so its derivative is J dq/dp +
//! ∂R/∂s ds/dp + ∂R/∂p with this row. A difference of the neighbours would have an error of EA ε²,
//! since an edge that turns by ε on a straight path stretches by ε²/2.
//!
//! **Observables.** Every quantity that can be measured in a simulation can also be measured in
//! [`Sensitivity::neighbours`]: its derivative is the difference over 2ε
//! ([`Sensitivity::derivative`]). Tensions of single edges have an error of 1e-9 EA for the reason
//! above.
//!
//! **Cost.** For each parameter and step: one back-substitution, two evaluations of the residual
//! at q, and two at the ends of the neighbours' steps.
//!
//! **Joints and bodies.** Dependent positions, such as the tips of the axes of bodies, have the
//! differences of the neighbours at the ends of their steps. In all neighbours, rotation vectors
//! are reset and joints break in the same steps as in the simulation itself. Like the step sizes,
//! these steps do not depend on p.
//!
//! **Flow.** The operator of regularized Stokeslets is stored in single precision. A relative ε of
//! 2e-3 leaves errors of 1e-6 to 1e-5 from its rounding and from truncation.
//!
//! **Complementarity.** A step is differentiated with the contacts that press in it, each of which
//! sticks or slides. These equations are written as force laws near the solution
//! ([`crate::mechanics::contact`], `active_set`), which the centre and all neighbours use instead
//! of searching for the forces. This gives errors of 1e-7 in motions; contact forces are not
//! differentiated.
//!
//! **Not supported**, and rejected: flows by clusters, controllers and other interventions. A step
//! that the neighbours cannot repeat is an error. Examples are a step of the midpoint rule that an
//! impact ended, and a step within which the drag of a flow is solved for.
//!
//! | file | what |
//! |---|---|
//! | `error` | what is refused, and what can fail |
//! | `replay` | a simulation takes the step of another one |
//! | `variation` | a parameter as two scenes |
//! | `parameter` | one parameter: its neighbours and the derivative of the state |

mod error;
mod parameter;
mod replay;
mod variation;

pub use error::SensitivityError;
pub use variation::Variation;

use super::parameters::IntegrationParameters;
use super::report::{Exchange, StepReport};
use super::simulation::Simulation;
use crate::mechanics::Vector3;
use crate::mechanics::scene::Scene;
use parameter::Parameter;
pub(super) use replay::{Replayed, Taken};

/// Relative residual of the flow of regularized Stokeslets; divided by ε it is an error of the
/// derivatives of the drag.
const FLOW_TOLERANCE: f64 = 1e-11;

/// A simulation with the derivatives of its state with respect to parameters.
pub struct Sensitivity {
    /// The simulation itself.
    base: Simulation,
    /// A second simulation of the same scene, which repeats each step for its Newton matrix.
    centre: Simulation,
    parameters: Vec<Parameter>,
}

impl Sensitivity {
    /// Sets up a scene at time zero with the derivatives of its initial state.
    ///
    /// # Errors
    /// [`SensitivityError::Unsuitable`] for a scene whose derivatives are not supported, and for
    /// neighbours that differ in more than values; [`SensitivityError::Simulation`] for an invalid
    /// scene.
    pub fn new(
        scene: &Scene,
        parameters: &IntegrationParameters,
        variations: &[Variation],
    ) -> Result<Self, SensitivityError> {
        let base = sharp(scene, parameters)?;
        let of = |variation: &Variation| Parameter::new(variation, parameters, &base);
        let parameters_of = variations.iter().map(of).collect::<Result<_, _>>()?;
        Ok(Self {
            centre: sharp(scene, parameters)?,
            base,
            parameters: parameters_of,
        })
    }

    /// The simulation itself.
    pub fn base(&self) -> &Simulation {
        &self.base
    }

    /// The simulations with p + ε and p − ε of a parameter, along its derivative.
    pub fn neighbours(&self, parameter: usize) -> [&Simulation; 2] {
        let [plus, minus] = &self.parameters[parameter].neighbours;
        [plus, minus]
    }

    /// Work and losses of the two neighbours in the last step.
    pub fn exchanges(&self, parameter: usize) -> [Exchange; 2] {
        self.parameters[parameter].exchanges
    }

    /// ε of a parameter, in its unit.
    pub fn step(&self, parameter: usize) -> f64 {
        self.parameters[parameter].step
    }

    /// Derivative of a measurement with respect to a parameter.
    pub fn derivative(&self, parameter: usize, of: impl Fn(&Simulation) -> f64) -> f64 {
        let [plus, minus] = self.neighbours(parameter).map(of);
        (plus - minus) / (2.0 * self.step(parameter))
    }

    /// Derivatives of the positions of all nodes with respect to a parameter, m per its unit.
    pub fn positions(&self, parameter: usize) -> Vec<Vector3> {
        self.parameters[parameter].positions()
    }

    /// Derivatives of the velocities of all nodes with respect to a parameter, m/s per its unit.
    pub fn velocities(&self, parameter: usize) -> Vec<Vector3> {
        self.parameters[parameter].velocities()
    }

    /// Largest turn (rad) or stretch of an edge by which the neighbours of a parameter have
    /// differed from the simulation so far. The square of this number is about the relative error
    /// of the derivatives; below 1e-8 rounding errors dominate.
    pub fn amplitude(&self, parameter: usize) -> f64 {
        self.parameters[parameter].amplitude
    }

    /// Finds the equilibrium at the present time, with its derivatives.
    ///
    /// # Errors
    /// The errors of [`Simulation::find_equilibrium`], and [`SensitivityError::Singular`] if the
    /// Newton matrix is singular there.
    pub fn find_equilibrium(&mut self) -> Result<StepReport, SensitivityError> {
        let report = self.base.find_equilibrium()?;
        let jacobian = self.centre.settle_like(&self.base);
        if self.centre.system.factor().is_err() {
            return Err(SensitivityError::Singular {
                time: self.base.time(),
            });
        }
        for parameter in &mut self.parameters {
            parameter.settle(&self.base, &mut self.centre, &jacobian)?;
        }
        self.centre.rest_like(&self.base);
        Ok(report)
    }

    /// Takes one step that ends no later than `until`, with its derivatives.
    ///
    /// # Errors
    /// The errors of [`Simulation::advance`], and [`SensitivityError::NotRepeated`] if the
    /// derivative of the step is not defined.
    pub fn advance(&mut self, until: f64) -> Result<StepReport, SensitivityError> {
        let report = self.base.advance(until)?;
        let goal = self.base.time();
        if report.step == 0.0 {
            // The step contains only rounding errors of the time.
            let neighbours = self.parameters.iter_mut().flat_map(|p| &mut p.neighbours);
            for simulation in neighbours.chain([&mut self.centre]) {
                simulation.state.time = goal;
            }
            return Ok(report);
        }
        let replayed = Replayed::new(&Taken::last_of(&self.base), &mut self.centre)?;
        for parameter in &mut self.parameters {
            parameter.step(&replayed, &self.base, &mut self.centre)?;
        }
        self.centre.finish_like(&self.base, &replayed)?;
        if self.centre.break_like(&self.base) {
            let parameters = self.parameters.iter_mut();
            parameters.for_each(|parameter| parameter.break_like(&self.base));
        }
        Ok(report)
    }
}

/// Creates a simulation whose flow is solved accurately enough for differences of neighbours to be
/// derivatives.
///
/// # Errors
/// An invalid scene, or a flow by clusters.
fn sharp(
    scene: &Scene,
    parameters: &IntegrationParameters,
) -> Result<Simulation, SensitivityError> {
    let mut simulation = Simulation::new(scene, parameters)?;
    if simulation.system.yields() {
        return Err(SensitivityError::Unsuitable(
            "derivatives support no rods that yield",
        ));
    }
    if simulation.system.slides_rub() {
        return Err(SensitivityError::Unsuitable(
            "derivatives support no joints of kind \"slide\" with friction",
        ));
    }
    if simulation.system.slides_yield() {
        return Err(SensitivityError::Unsuitable(
            "derivatives support no joints of kind \"slide\" whose first node a clamp holds",
        ));
    }
    let parts = [
        scene.tendons.len(),
        scene.sheaths.len(),
        scene.free_bodies.len(),
    ];
    if parts != [0; 3] {
        return Err(SensitivityError::Unsuitable(
            "derivatives support no tendons, sheaths and free bodies",
        ));
    }
    match simulation.integrator.fluid.sharpen(FLOW_TOLERANCE) {
        true => Ok(simulation),
        false => Err(SensitivityError::Unsuitable(
            "derivatives need the exact flow, fluid.far_field_error = 0",
        )),
    }
}

#[cfg(test)]
pub(super) mod joint_tests;
#[cfg(test)]
mod tests;
