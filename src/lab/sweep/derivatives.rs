//! Columns `d_COLUMN_d_KEY` of the summary: derivatives of probes at the end of each case.

use crate::run::{Finding, Observer, Sample};
use crate::scenario::{CaseSet, Loaded, ScenarioError, SweptDerivatives};
use crate::sensitivity::{SensitivityError, derivatives_at, refuse_unsuitable};
use rodlab_files::results::{NamedValues, SeriesRow, Value};
use serde::{Deserialize, Serialize};

/// Checks that a case has the derivatives that the sweep requests.
///
/// # Errors
/// The reason why there are no derivatives, at their place in the scenario.
pub(super) fn check(
    case_set: &CaseSet,
    index: usize,
    searched: Option<f64>,
) -> Result<(), ScenarioError> {
    let Some(asked) = case_set.derivatives() else {
        return Ok(());
    };
    let source = |more: &[String]| case_set.changed_scenario(index, searched, more);
    refuse_unsuitable(&source, &asked.of, &asked.to).map_err(|error| match error {
        // The case itself is valid: the fault is in a key whose value was changed by ε.
        SensitivityError::Scenario(ScenarioError(faults)) => {
            let fault = faults.into_iter().next().map(|located| located.issue);
            let message = fault.as_ref().map(ToString::to_string).unwrap_or_default();
            case_set.refuse_derivatives(&message, fault.and_then(|issue| issue.help))
        }
        other => case_set.refuse_derivatives(&other.to_string(), None),
    })
}

/// The derivatives of one case as outcomes of its run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct CaseDerivatives {
    columns: Vec<(String, Option<f64>)>,
    /// Why there are none.
    failure: Option<String>,
}

impl CaseDerivatives {
    /// Computes the requested derivatives. A failure becomes a remark; `None` if `goes_on`
    /// returned false.
    pub fn of_case(
        asked: &SweptDerivatives,
        source: &Source<'_>,
        goes_on: &dyn Fn() -> bool,
    ) -> Option<Self> {
        let found = derivatives_at(source, &asked.of, &asked.to, None, goes_on);
        Some(match found {
            Err(SensitivityError::Interrupted) => return None,
            Err(error) => Self {
                columns: Vec::new(),
                failure: Some(error.to_string()),
            },
            Ok(found) => {
                let mut columns = Vec::new();
                for (column, name) in found.columns.iter().enumerate() {
                    for (key, asked) in found.keys.iter().enumerate() {
                        let last = found.rows.last();
                        let value = last.and_then(|row| row.derivatives[key][column]);
                        columns.push((format!("d_{name}_d_{}", asked.key), value));
                    }
                }
                Self {
                    columns,
                    failure: None,
                }
            }
        })
    }
}

/// Reads the scenario of a case with further overrides.
type Source<'a> = dyn Fn(&[String]) -> Result<Loaded, ScenarioError> + 'a;

impl Observer for CaseDerivatives {
    fn name(&self) -> &str {
        "derivatives"
    }

    fn measure(&mut self, _sample: &Sample<'_>, _row: &SeriesRow) -> (Vec<Value>, Finding) {
        (Vec::new(), Finding::GoOn)
    }

    fn outcomes(&self) -> NamedValues {
        let columns = self.columns.iter();
        let value = |value: Option<f64>| value.map_or(Value::Empty, Value::Number);
        NamedValues(
            columns
                .map(|(name, number)| (name.clone(), value(*number)))
                .collect(),
        )
    }

    fn remarks(&self) -> Vec<String> {
        let failure = self.failure.iter();
        failure
            .map(|reason| format!("no derivatives: {reason}"))
            .collect()
    }
}
