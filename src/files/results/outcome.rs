//! Outcome of a case: the numbers of `summary.csv` and of the manifest.

use super::NamedValues;
use serde::{Deserialize, Serialize};

/// Scalar outcomes of a case, which depend on the scenario, not on the load of the machine.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CaseOutcome {
    /// Simulated time reached, s.
    pub simulated_time: f64,
    /// Accepted steps.
    pub steps: u64,
    /// Newton iterations of all steps, retries included.
    pub newton_iterations: u64,
    /// Number of times a step was halved before it was accepted.
    pub retries: u64,
    /// Krylov iterations of all fluid solves.
    pub fluid_iterations: u64,
    /// Number of steps that ended with at least one contact with a force.
    pub steps_with_contact: u64,
    /// Newton iterations of those steps.
    pub newton_iterations_with_contact: u64,
    /// End of the first step with contact, s.
    pub first_contact: Option<f64>,
    /// Smallest distance between bodies, including planes, m.
    pub minimum_distance: Option<f64>,
    /// Ratio of that distance to the one at which the surfaces of these bodies touch.
    pub minimum_distance_ratio: Option<f64>,
    /// Mean gap between surfaces in contact, weighted by their normal forces, over the outputs
    /// with contact, m.
    #[serde(default)]
    pub mean_gap: Option<f64>,
    /// Energy of stretching, bending and twisting at the last output, J.
    pub elastic_energy: Option<f64>,
    /// Gravitational potential at the last output, J.
    pub gravitational_energy: Option<f64>,
    /// Path parameter of the first fold, bifurcation or onset of flutter of a path of equilibria.
    pub critical_parameter: Option<f64>,
    /// Values of observers of the run: further columns of the summary. Named `knot` in earlier
    /// versions, which observed knots only.
    #[serde(default, alias = "knot")]
    pub observed: NamedValues,
    /// Remarks on the case, a sentence each, such as strains beyond rod theory.
    #[serde(default)]
    pub remarks: Vec<String>,
    /// Why the run ended early on purpose; `None` if it did not.
    #[serde(default)]
    pub ending: Option<Ending>,
}

/// The early end of a run that has reached its goal.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ending {
    /// A word for tables, such as `inverted`.
    pub word: String,
    /// A sentence for users.
    pub sentence: String,
}

impl CaseOutcome {
    /// Newton iterations per step; `None` before the first step.
    pub fn newton_iterations_mean(&self) -> Option<f64> {
        mean(self.newton_iterations, self.steps)
    }

    /// Newton iterations per step with contact; `None` without such steps.
    pub fn newton_iterations_mean_with_contact(&self) -> Option<f64> {
        mean(self.newton_iterations_with_contact, self.steps_with_contact)
    }

    /// Krylov iterations of the fluid solves per step; `None` before the first step.
    pub fn fluid_iterations_mean(&self) -> Option<f64> {
        mean(self.fluid_iterations, self.steps)
    }
}

fn mean(total: u64, count: u64) -> Option<f64> {
    (count > 0).then(|| total as f64 / count as f64)
}
