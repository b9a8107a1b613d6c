//! Derivatives of one result with respect to all fields along the rods: adjoint mode.
//!
//! [`super::sensitivity`] propagates the derivative of the whole state with respect to one
//! parameter forwards, with a solve for each parameter and step. Here the derivative q̄ of one
//! result with respect to the state is propagated backwards, with a solve for each result and
//! step, whatever the number of parameters. A step solves R(q; s, p) = 0 for its end q, from the
//! state s at its start (see there). With the derivative q̄ of the result with respect to q,
//!
//! ```text
//! Jᵀ λ = q̄,     s̄ = −(∂R/∂s)ᵀ λ,     dI/dp += −(∂R/∂p)ᵀ λ,     J = ∂R/∂q
//! ```
//!
//! at the solution of the step, from the last step to the first. J is symmetric if forces have a
//! potential; otherwise the solve uses its transpose.
//!
//! **State.** s consists of unknowns and velocities at present and at the last steps, the strains
//! of dashpots there, and the frames that the step transports in time. With the tangents s and t
//! of an edge at the start and at the end of a step, the spin of its frame about t changes with
//! both,
//!
//! ```text
//! δψ = δθ + δρ + a·δs + c·δt,     a = −(s×t)/((1+s·t) lₛ),     c = −(s×t)/((1+s·t) lₜ)
//! ```
//!
//! per change of the edge vectors of the lengths lₛ and lₜ, with the spin ρ of the transported
//! frame. (a is c with both ends exchanged, since the transport from t to s is the inverse.) The
//! elastic energy depends on θ, ρ and a·δs only through ψ, so the derivatives of R with respect to
//! all three are equal: the column of J at θ without inertia and drag. The force (∂E/∂ψ) c on the
//! edge also depends on s through c. If a clamp holds both nodes of an edge, it prescribes ψ.
//!
//! **Inertia and drag** are linear in the start of the stage and in the velocity there, with
//! symmetric matrices: their transpose is the same formula applied to λ. The dependence of both on
//! the last steps is also linear, and the same for all unknowns; the weights are read off the
//! scheme (`weights`).
//!
//! **Strains.** λ·R = Σ M dε\[λ\] for elastic forces and dashpots, with the derivatives of the
//! strains along λ (`system/virtual_work`); dI/dp for stiffness and natural strains of every
//! vertex follows from these. The relaxing parts q of the strains are part of s; with the
//! derivative q̄ at the end of a step,
//!
//! ```text
//! q = e^(−x) qₙ + r γ (ε − εₙ),     d = q̄ − K dε[λ],     q̄ₙ = e^(−x) d,     ε̄ₙ = −r γ d
//! ```
//!
//! and r γ q̄ acts on the strains at the end like a moment (`system/damping`).
//!
//! **Dependent positions.** Joined and sliding nodes, and the tips of the axes of bodies, are
//! functions of the free unknowns r. With P = ∂q/∂r, q̄ becomes Pᵀ q̄ before the solve, and λ becomes
//! P λ after it (`system/joints/virtual_motion`); all else is the same as without joints.
//!
//! **Midpoint rule.** The solution m of the stage is the middle of the step, which ends at q₁ = 2 m −
//! q₀: m̄ = 2 q̄₁ (`extrapolation`).
//!
//! **Resistive drag** D v also depends on s through D, which is that of the start or of the
//! prediction.
//!
//! **Contact.** Friction acts on the slip since the start of the stage and is transposed with
//! respect to that start like a damper. The contact stiffness k is part of s, and contact forces
//! are proportional to it. A step may adapt k to the force on a node at the prediction; energies
//! may bound k, and a contact may shorten the prediction. The derivative of k is pulled back
//! through all of these (`stiffness_back`). The least stiffness is a constant of the scene. By
//! complementarity the laws of an active set are linear in the positions at the end and at the
//! start of the step; both matrices are transposed.
//!
//! **Cost.** The steps are stored as they are taken. When they fill [`LARGEST_TRACE`], only the
//! states at the starts of parts of the motion are kept, and a part is repeated, bit for bit, when
//! its derivatives are needed. A step back costs one linearisation and factorisation, whereas the
//! step itself took two or three, and a solve for each result.
//!
//! **Not supported**, and rejected: everything that [`super::sensitivity`] rejects, flows, friction
//! at surfaces, rods with actuated length, and sliding nodes with the midpoint rule, which at the
//! middle of a step move by other weights than those of their force.
//!
//! | file | what |
//! |---|---|
//! | `gradient` | the derivatives with respect to fields |
//! | `measured`, `differences` | derivatives of the results with respect to the last state |
//! | `covector` | the derivative with respect to a state |
//! | `charts`, `breaks` | rotation vectors that were reset, joints that broke |
//! | `extrapolation` | the end of a step of the midpoint rule |
//! | `step_back`, `point` | a step back |
//! | `stiffness_back` | the contact stiffness of a step back |
//! | `weights` | the scheme as a linear map |
//! | `trace`, `origin` | the states of the steps, and simulations in them |

mod breaks;
mod charts;
mod covector;
mod differences;
mod extrapolation;
mod gradient;
mod measured;
mod origin;
mod point;
mod step_back;
mod stiffness_back;
mod trace;
mod weights;

pub use gradient::Gradient;

use super::parameters::{IntegrationParameters, Scheme};
use super::report::StepReport;
use super::sensitivity::{Replayed, SensitivityError, Taken};
use super::simulation::Simulation;
use crate::mechanics::contact::{FrictionAt, Geometry};
use crate::mechanics::fluid::FluidModel;
use crate::mechanics::scene::{ActuatedStrain, Scene};
use gradient::Sums;
use origin::Origin;
use step_back::StepBack;
use stiffness_back::StiffnessBack;
use trace::Trace;

/// Largest total size of the stored states of steps, bytes.
pub const LARGEST_TRACE: usize = 256 << 20;

/// A motion that is recorded for derivatives of results at its end.
pub struct Recording {
    simulation: Simulation,
    /// A second simulation of the same scene, which repeats steps.
    centre: Simulation,
    origin: Origin,
    trace: Trace,
    settled: bool,
}

impl Recording {
    /// Sets up a scene at time zero.
    ///
    /// # Errors
    /// [`SensitivityError::Unsuitable`] for a scene that is not supported, [`SensitivityError::Simulation`] for an invalid one.
    pub fn new(
        scene: &Scene,
        parameters: &IntegrationParameters,
    ) -> Result<Self, SensitivityError> {
        let simulation = Simulation::new(scene, parameters)?;
        refuse(scene, &simulation, parameters)?;
        Ok(Self {
            centre: Simulation::new(scene, parameters)?,
            origin: Origin {
                scene: scene.clone(),
                parameters: *parameters,
            },
            trace: Trace::new(&simulation, LARGEST_TRACE),
            simulation,
            settled: false,
        })
    }

    /// The simulation.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Finds the equilibrium at the start of the motion.
    ///
    /// # Errors
    /// The errors of [`Simulation::find_equilibrium`].
    pub fn find_equilibrium(&mut self) -> Result<StepReport, SensitivityError> {
        let report = self.simulation.find_equilibrium()?;
        let largest = self.trace.largest();
        self.trace = Trace::new(&self.simulation, largest);
        self.settled = true;
        Ok(report)
    }

    /// Takes one step that ends no later than `until`, s.
    ///
    /// # Errors
    /// The errors of [`Simulation::advance`].
    pub fn advance(&mut self, until: f64) -> Result<StepReport, SensitivityError> {
        let report = self.simulation.advance(until)?;
        self.trace.add(&self.simulation, &report, until);
        Ok(report)
    }

    /// Derivatives of results at the end of the motion so far. `results` computes them, always the
    /// same number, from the positions, velocities and strains of a simulation; the reactions of
    /// clamps are those of the last step and are not differentiated.
    ///
    /// # Errors
    /// [`SensitivityError::NotRepeated`] and [`SensitivityError::Singular`] if a step has no
    /// derivative.
    pub fn gradients(
        &mut self,
        results: &dyn Fn(&Simulation) -> Vec<f64>,
    ) -> Result<Vec<Gradient>, SensitivityError> {
        let over_all = self.gradients_over(&[f64::INFINITY], results)?;
        Ok(over_all.into_iter().flatten().collect())
    }

    /// Derivatives with respect to fields that change only during a part of the motion, for
    /// controls: a list for each result, with an entry for each part. Parts are given by the times
    /// at which they end, s, in ascending order. A step belongs to the part in which it ends, an
    /// equilibrium to the first part; steps after the last part belong to none.
    ///
    /// # Errors
    /// The errors of [`Self::gradients`].
    pub fn gradients_over(
        &mut self,
        ends: &[f64],
        results: &dyn Fn(&Simulation) -> Vec<f64>,
    ) -> Result<Vec<Vec<Gradient>>, SensitivityError> {
        let (centre, origin) = (&mut self.centre, &self.origin);
        origin.take_up(centre, self.trace.last())?;
        let mut covectors = measured::derivatives(centre, results);
        let zero = vec![Sums::zero(centre); ends.len()];
        let mut sums = vec![zero; covectors.len()];
        self.trace
            .visit_backwards(centre, origin, &mut |centre, start, end| {
                let hinged = breaks::hinged(centre);
                origin.take_up(centre, start)?;
                let contact = end.state.contact.as_ref();
                let taken = Taken {
                    time: end.state.time,
                    unknowns: end.solution(),
                    contact_stiffness: contact.map_or(0.0, |contact| contact.stiffness),
                    pressing: end.pressing.clone(),
                };
                let replayed = Replayed::transposed(&taken, centre)?;
                let mut step = StepBack::new(centre, &replayed, end.solution());
                let part = ends.partition_point(|of_part| *of_part < end.state.time);
                for (covector, sums) in covectors.iter_mut().zip(&mut sums) {
                    let of_hinges = match start.breaks == end.state.breaks {
                        true => Vec::new(),
                        false => covector.before_breaks(centre, &hinged, end.solution()),
                    };
                    covector.before_reset(centre, &replayed.long, start, end);
                    of_hinges.iter().for_each(|one| one.add_to(covector));
                    let along = step.pull_back(covector, centre)?;
                    if let Some(sums) = sums.get_mut(part) {
                        sums.add(&along, step.laws());
                    }
                }
                let matters = covectors.iter().any(|covector| covector.stiffness != 0.0);
                if !replayed.adapts() || !matters {
                    return Ok(());
                }
                let mut stiffness = StiffnessBack::new(centre, &replayed)?;
                for (covector, sums) in covectors.iter_mut().zip(&mut sums) {
                    let along = stiffness.pull_back(covector, centre);
                    if let Some(sums) = sums.get_mut(part) {
                        sums.add(&along, stiffness.laws());
                    }
                }
                Ok(())
            })?;
        origin.take_up(centre, self.trace.first())?;
        let firsts = sums.iter_mut().filter_map(|sums| sums.first_mut());
        if self.settled {
            let unknowns = centre.state.unknowns.clone();
            centre.system.update_candidates(&unknowns);
            centre.system.linearize_transposed(&unknowns, None);
            let singular = SensitivityError::Singular {
                time: centre.state.time,
            };
            centre.system.factor().map_err(|_| singular)?;
            let laws = centre.system.strain_laws();
            for (covector, sums) in covectors.iter().zip(firsts) {
                let along = covector.settle(centre)?;
                sums.add(&along, &laws);
            }
        } else {
            for (covector, sums) in covectors.iter().zip(firsts) {
                sums.start(covector, &centre.system.assembly);
            }
        }
        let assembly = &centre.system.assembly;
        let fields = |sums: &Vec<Sums>| sums.iter().map(|sums| sums.fields(assembly)).collect();
        Ok(sums.iter().map(fields).collect())
    }
}

/// Checks for unsupported features beyond the scene itself.
fn refuse(
    scene: &Scene,
    simulation: &Simulation,
    parameters: &IntegrationParameters,
) -> Result<(), SensitivityError> {
    let system = &simulation.system;
    let lengthens =
        (scene.actuations.iter()).any(|actuation| actuation.strain == ActuatedStrain::Length);
    let refusals = [
        (
            parameters.scheme == Scheme::ImplicitMidpoint && !system.slides().is_empty(),
            "derivatives with respect to fields of rods with [[joints]] of kind \"slide\" need \
             time.scheme = \"implicit-euler\" or \"backward-differences\"",
        ),
        (
            (scene.contact.as_ref())
                .is_some_and(|contact| contact.friction_at == FrictionAt::Surface),
            "derivatives with respect to fields need contact.friction_at = \"centreline\"",
        ),
        (
            (scene.contact.as_ref()).is_some_and(|contact| contact.geometry == Geometry::Smooth),
            "derivatives with respect to fields need contact.geometry = \"polyline\"",
        ),
        (
            (scene.planes.iter()).any(|plane| plane.directed_friction.is_some()),
            "derivatives with respect to fields need planes without directed_friction",
        ),
        (
            system.slides_yield(),
            "derivatives with respect to fields support no joints of kind \"slide\" whose first node a clamp holds",
        ),
        (
            system.slides_rub(),
            "derivatives with respect to fields support no joints of kind \"slide\" with friction",
        ),
        (
            matches!(scene.fluid, Some(FluidModel::RegularizedStokeslets { .. })),
            "derivatives with respect to fields need fluid.model = \"resistive\"",
        ),
        (
            !scene.free_bodies.is_empty(),
            "derivatives over fields support no free bodies",
        ),
        (
            system.yields(),
            "derivatives over fields support no rods that yield",
        ),
        (
            lengthens,
            "derivatives with respect to fields support no rods that lengthen by themselves",
        ),
    ];
    match refusals.into_iter().find(|(refused, _)| *refused) {
        Some((_, reason)) => Err(SensitivityError::Unsuitable(reason)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod comparison;
#[cfg(test)]
mod contact_tests;
#[cfg(test)]
mod joint_tests;
#[cfg(test)]
mod tests;
