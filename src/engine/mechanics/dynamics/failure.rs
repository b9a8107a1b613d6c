//! Failures of steps and equilibria, and their error messages.

use super::report::SimulationError;
use crate::mechanics::Overlap;
use crate::mechanics::rod::STRIDE;
use crate::mechanics::system::{Divergence, Stage, System, Turn};
use std::fmt;

/// Reason why one attempt at a step failed.
#[derive(Debug)]
pub(super) enum Failure {
    /// Newton's method does not converge.
    Newton(Divergence),
    /// Surfaces overlap by more than is allowed.
    Penetration { iterations: usize, overlap: Overlap },
    /// No contact forces satisfy the laws of Signorini and Coulomb, or none were found.
    NoContactForces { iterations: usize },
    /// The drag for the motion within the step was not found.
    NoDrag { iterations: usize },
    /// The length that a force feeds out of a sheath within the step was not found.
    NoPush { iterations: usize },
    /// Forces would add energy, J.
    Work {
        iterations: usize,
        forces: Forces,
        work: f64,
    },
    /// The motion would make surfaces cross.
    Crossing {
        iterations: usize,
        crossing: Crossing,
    },
    /// An edge or a free body rotates too far.
    Turn { iterations: usize, turn: Turn },
}

/// Forces that would add energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Forces {
    Contact,
    Elastic,
    /// Forces of the fluid.
    Drag,
}

/// How a motion would make surfaces cross.
#[derive(Debug)]
pub(super) enum Crossing {
    /// A clamp prescribes it.
    Clamp,
    /// The extrapolation of the midpoint rule from the middle of the step to its end passes
    /// through a contact.
    Extrapolation,
    /// Surfaces overlap by more than is allowed at the end of the step.
    Overlap(Overlap),
    /// Two edges pass through each other within the step.
    Passage([String; 2]),
}

impl fmt::Display for Crossing {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Clamp => {
                formatter.write_str("the prescribed motion of a clamp passes through a contact")
            }
            Self::Extrapolation => formatter
                .write_str("the extrapolation of the midpoint rule passes through a contact"),
            Self::Overlap(overlap) => overlap.fmt(formatter),
            Self::Passage([first, second]) => {
                write!(
                    formatter,
                    "{first} and {second} would pass through each other"
                )
            }
        }
    }
}

impl Failure {
    /// Number of Newton iterations taken.
    pub(crate) fn iterations(&self) -> usize {
        match self {
            Self::Newton(divergence) => divergence.iterations,
            Self::Penetration { iterations, .. }
            | Self::NoContactForces { iterations }
            | Self::NoDrag { iterations }
            | Self::NoPush { iterations }
            | Self::Work { iterations, .. }
            | Self::Turn { iterations, .. }
            | Self::Crossing { iterations, .. } => *iterations,
        }
    }

    /// Whether contact forces would add energy.
    pub(crate) fn is_work_of_contact(&self) -> bool {
        matches!(
            self,
            Self::Work {
                forces: Forces::Contact,
                ..
            }
        )
    }

    /// Adds the number of failed iterations.
    pub(crate) fn after(mut self, vain: usize) -> Self {
        match &mut self {
            Self::Newton(divergence) => divergence.iterations += vain,
            Self::Penetration { iterations, .. }
            | Self::NoContactForces { iterations }
            | Self::NoDrag { iterations }
            | Self::NoPush { iterations }
            | Self::Work { iterations, .. }
            | Self::Turn { iterations, .. }
            | Self::Crossing { iterations, .. } => *iterations += vain,
        }
        self
    }

    /// Converts to the error of a run in which a step of a size (s) from `time` (s) failed;
    /// `trial` is the last iterate of Newton's method.
    pub(crate) fn into_error(
        self,
        system: &mut System,
        trial: &[f64],
        stage: &Stage,
        [time, step]: [f64; 2],
    ) -> SimulationError {
        match self {
            Self::Newton(divergence) => {
                let place = Place::of(system, trial, Some(stage), divergence.unknown);
                SimulationError::NoConvergence {
                    time,
                    step,
                    residual: divergence.residual,
                    term: place.term,
                    rod: place.rod,
                    node: place.node,
                }
            }
            Self::NoContactForces { .. } => SimulationError::NoContactForces { time, step },
            Self::NoDrag { .. }
            | Self::NoPush { .. }
            | Self::Penetration { .. }
            | Self::Work { .. }
            | Self::Turn { .. }
            | Self::Crossing { .. } => {
                SimulationError::Unphysical(format!("at t = {time:.6e} s {self}"))
            }
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Newton(divergence) => write!(
                formatter,
                "no convergence in {} iterations, residual {:.3e} N",
                divergence.iterations, divergence.residual
            ),
            Self::Penetration { overlap, .. } => overlap.fmt(formatter),
            Self::NoContactForces { .. } => {
                formatter.write_str("no contact forces satisfy the laws of Signorini and Coulomb")
            }
            Self::NoDrag { iterations } => write!(
                formatter,
                "the drag of the fluid and the motion of the rods did not agree after {iterations} iterations"
            ),
            Self::NoPush { iterations } => write!(
                formatter,
                "the length that a force feeds out of a sheath was not found in {iterations} iterations"
            ),
            Self::Work { forces, work, .. } => match forces {
                Forces::Contact => write!(
                    formatter,
                    "rods slide so far around each other within a step that contact forces add {work:.3e} J"
                ),
                Forces::Elastic => write!(
                    formatter,
                    "rods turn so far within a step that elastic forces add {work:.3e} J"
                ),
                Forces::Drag => write!(
                    formatter,
                    "the drag of the fluid adds {work:.3e} J: parts of rods in the fluid overlap, where the drag model is not valid"
                ),
            },
            Self::Crossing { crossing, .. } => crossing.fmt(formatter),
            Self::Turn { turn, .. } => write!(
                formatter,
                "{} turns by {:.0}° within a step: {}",
                turn.what,
                turn.angle.to_degrees(),
                turn.consequence
            ),
        }
    }
}

/// Location of the largest residual when Newton's method failed.
struct Place {
    /// The largest term of the residual there.
    term: &'static str,
    rod: String,
    /// Node along the rod.
    node: usize,
}

impl Place {
    fn of(system: &mut System, trial: &[f64], stage: Option<&Stage>, unknown: usize) -> Self {
        let term = system.largest_term(trial, stage, unknown);
        let (rod, node) = system.assembly.locate(unknown / STRIDE);
        Self {
            term,
            rod: system.assembly.names[rod].clone(),
            node,
        }
    }
}

/// The error of a search for an equilibrium that ended at `trial`.
pub(super) fn no_equilibrium(
    system: &mut System,
    trial: &[f64],
    divergence: &Divergence,
) -> SimulationError {
    let advice = if system.terms.loads.are_forces() {
        "increase the loads gradually with time.mode = \"continuation\", or run dynamically with damping"
    } else {
        "run dynamically with damping"
    };
    not_found(system, trial, divergence, advice)
}

/// The error of a path of equilibria that ended at `trial`.
pub(super) fn no_next_point(
    system: &mut System,
    trial: &[f64],
    divergence: &Divergence,
) -> SimulationError {
    let advice = "try a smaller continuation.step and continuation.largest_step";
    not_found(system, trial, divergence, advice)
}

fn not_found(
    system: &mut System,
    trial: &[f64],
    divergence: &Divergence,
    advice: &'static str,
) -> SimulationError {
    let place = Place::of(system, trial, None, divergence.unknown);
    SimulationError::NoEquilibrium {
        iterations: divergence.iterations,
        residual: divergence.residual,
        term: place.term,
        rod: place.rod,
        node: place.node,
        advice,
    }
}
