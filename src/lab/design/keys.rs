//! Numbers of a key: the key itself, the components of a vector, or the pose of a clamp.

use super::error::DesignError;
use crate::scenario::{CaseSet, Hold, ScenarioError};

/// Keys of the position and the rotation of a clamp.
const OFFSET: &str = "offset";
const ROTATION: &str = "rotation";

/// Resolves `vary` into the dotted keys of single numbers. Also returns the scenario with all of
/// them stated.
///
/// # Errors
/// Keys without numbers, and numbers that are named twice.
pub fn numeric_keys(
    scenario: &CaseSet,
    vary: &[String],
) -> Result<(CaseSet, Vec<String>), DesignError> {
    let mut stated = scenario.clone();
    let mut keys: Vec<String> = Vec::new();
    for key in vary {
        for vector in vectors(scenario, key)? {
            stated = with_default(stated, &vector)?;
            for number in components(&stated, &vector)? {
                if keys.contains(&number) {
                    let message = format!("--vary {key}: `{number}` is named twice; name it once");
                    return Err(DesignError::Input(message));
                }
                keys.push(number);
            }
        }
    }
    Ok((stated, keys))
}

/// The keys of the pose that the clamp holds, or the key itself.
fn vectors(scenario: &CaseSet, key: &str) -> Result<Vec<String>, DesignError> {
    let steps: Vec<&str> = key.split('.').collect();
    let ["clamps", number, rest @ ..] = steps.as_slice() else {
        return Ok(vec![key.to_owned()]);
    };
    let clamps = scenario.scenario_with(&[])?.scenario.clamps;
    let fault = |what: &str, allowed: String| {
        Err(DesignError::Input(format!(
            "--vary {key}: {what}; allowed: {allowed}"
        )))
    };
    let Some(clamp) = number.parse().ok().and_then(|at: usize| clamps.get(at)) else {
        let numbers: Vec<String> = (0..clamps.len())
            .map(|at| format!("clamps.{at}.pose"))
            .collect();
        let allowed = match numbers.is_empty() {
            true => "keys of scenarios with [[clamps]]".to_owned(),
            false => numbers.join(", "),
        };
        return fault("no such clamp", allowed);
    };
    let held: &[&str] = match clamp.hold {
        Hold::Both => &[OFFSET, ROTATION],
        Hold::Position => &[OFFSET],
        Hold::Frame => &[ROTATION],
    };
    match rest {
        ["pose"] => Ok(held
            .iter()
            .map(|one| format!("clamps.{number}.{one}"))
            .collect()),
        [one, ..] if [OFFSET, ROTATION].contains(one) && !held.contains(one) => fault(
            "the clamp does not hold it",
            format!("clamps.{number}.{}", held[0]),
        ),
        _ => Ok(vec![key.to_owned()]),
    }
}

/// The scenario, with the value of a key stated even if the scenario leaves it to its default.
fn with_default(scenario: CaseSet, key: &str) -> Result<CaseSet, DesignError> {
    let (vector, _) = split(key);
    if !components_of(&scenario, vector)?.is_empty() || scenario.number(key)?.is_some() {
        return Ok(scenario);
    }
    let loaded = scenario.scenario_with(&[])?;
    let is_pose =
        vector.starts_with("clamps.") && [OFFSET, ROTATION].iter().any(|one| vector.ends_with(one));
    let defaults: Vec<String> = (0..3)
        .map_while(|axis| loaded.number(&format!("{vector}.{axis}")))
        .map(|number| format!("{number:?}"))
        .collect();
    let change = match loaded.number(key) {
        _ if is_pose => format!("{vector}=[0.0, 0.0, 0.0]"),
        _ if !defaults.is_empty() => format!("{vector}=[{}]", defaults.join(", ")),
        Some(number) => format!("{key}={number:?}"),
        None => return Err(no_number(&scenario, key)),
    };
    Ok(scenario.changed(&[change])?)
}

/// The error for a key without a number. Setting the key detects unknown keys.
fn no_number(scenario: &CaseSet, key: &str) -> DesignError {
    match scenario.scenario_with(&[(key, 1.0)]) {
        Err(error) => error.into(),
        Ok(_) => DesignError::Input(format!(
            "--vary {key}: the scenario has no value for this key; give a start value by --set {key}=VALUE"
        )),
    }
}

/// Splits the number of a component off the end of a key.
fn split(key: &str) -> (&str, bool) {
    match key.rsplit_once('.') {
        Some((vector, axis)) if axis.parse::<usize>().is_ok() => (vector, true),
        _ => (key, false),
    }
}

/// The key itself if it is a number, else its components.
fn components(scenario: &CaseSet, key: &str) -> Result<Vec<String>, DesignError> {
    if scenario.number(key)?.is_some() {
        return Ok(vec![key.to_owned()]);
    }
    let found = components_of(scenario, key)?;
    match found.is_empty() {
        true => Err(no_number(scenario, key)),
        false => Ok(found),
    }
}

fn components_of(scenario: &CaseSet, key: &str) -> Result<Vec<String>, ScenarioError> {
    let mut found = Vec::new();
    for axis in 0..3 {
        let component = format!("{key}.{axis}");
        if scenario.number(&component)?.is_none() {
            break;
        }
        found.push(component);
    }
    Ok(found)
}
