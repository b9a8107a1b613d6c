//! Inverse design with the method that fits the keys.

use super::error::DesignError;
use super::keys::numeric_keys;
use super::numbers::{DesignedNumbers, numbers};
use super::request::Request;
use super::task::{Designed, named_rod, natural_shape};
use rodlab_engine::mechanics::Vector3;
use serde::Serialize;

/// Result of an inverse design.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum Design {
    /// A natural shape.
    Shape(Designed),
    /// Numbers.
    Numbers(DesignedNumbers),
}

impl Design {
    /// The designed scenario.
    pub fn scenario_toml(&self) -> &str {
        match self {
            Self::Shape(designed) => &designed.scenario_toml,
            Self::Numbers(designed) => &designed.scenario_toml,
        }
    }

    /// Nodes of the target curve, in equilibrium, and without loads or before the design, m.
    pub fn nodes(&self) -> &[Vec<Vector3>; 3] {
        match self {
            Self::Shape(designed) => &designed.nodes,
            Self::Numbers(designed) => &designed.nodes,
        }
    }
}

/// Designs the requested keys and checks them with the equilibrium of the scenario.
///
/// # Errors
/// [`DesignError`]: a curve that does not fit the rod, keys that cannot be used, or a curve that
/// no natural shape holds.
pub fn design(
    request: &Request<'_>,
    goes_on: &(dyn Fn() -> bool + Sync),
) -> Result<Design, DesignError> {
    if request.scenario.is_sweep() {
        let message = format!(
            "`{}` is a sweep; allowed: a scenario of one case",
            request.scenario.name()
        );
        return Err(DesignError::Input(message));
    }
    let of_shape = request.vary.iter().find(|key| named_rod(key).is_some());
    match (of_shape, request.vary) {
        (Some(key), [_]) => Ok(Design::Shape(natural_shape(request, key)?)),
        (Some(key), _) => Err(DesignError::Input(format!(
            "--vary {key}: the natural shape along the rod meets the curve by itself; allowed: this key alone, or numbers such as {key}.0"
        ))),
        (None, keys) => {
            let (scenario, keys) = numeric_keys(request.scenario, keys)?;
            Ok(Design::Numbers(numbers(
                request, &scenario, &keys, goes_on,
            )?))
        }
    }
}
