//! Paths of equilibria.

use crate::scenario::declaration::keys;
use crate::scenario::section::{FINITE, POSITIVE, Section};
use crate::scenario::units::Dimensionless;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Maximum number of points of a branch.
const MOST_POINTS: usize = 1_000_000;

keys! {
    /// The path of equilibria that time.mode = "continuation" follows. A parameter replaces the
    /// time: moving clamps and loads with a schedule use it as their time.
    table ContinuationKeys "continuation" => #[derive(Copy)] Continuation() {
        /// Parameter at the start.
        from: number(Dimensionless, FINITE) default(0.0),
        /// Value of the parameter at the end of the path. A path that turns back may also end at
        /// its initial value.
        to: number(Dimensionless, FINITE) required,
        /// First step of the parameter. Default: a hundredth of the range.
        step: number(Dimensionless, POSITIVE) derived(0.01 * (to - from).abs()),
        /// Largest step of the parameter. Default: a fiftieth of the range.
        largest_step: number(Dimensionless, POSITIVE) derived(step.max(0.02 * (to - from).abs()).min((to - from).abs())),
        /// "arclength" (the default: passes folds, where the parameter turns back) or "natural" (the parameter
        /// only grows; at a fold the run fails or jumps to a distant equilibrium).
        method: word(PathMethod) default(PathMethod::Arclength),
        /// Whether to follow also the branches that bifurcate from the first branch.
        switch_branches: flag() default(true),
        /// Maximum number of points of a branch.
        most_points: count(2..=MOST_POINTS) default(1000),
    }
}

/// Quantity that a step along a path prescribes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum PathMethod {
    /// The parameter.
    Natural,
    /// The arclength of the path.
    #[default]
    Arclength,
}

/// Resolves the path in `section`.
pub fn continuation(section: &Section<'_>, typed: &ContinuationKeys) -> Continuation {
    let path = typed.resolve(section);
    let range = (path.to - path.from).abs();
    if range == 0.0 {
        section.out_of_range("to", path.to, "any but `from`");
    }
    for (key, step) in [("step", path.step), ("largest_step", path.largest_step)] {
        if step > range {
            let allowed = format_args!("at most |to − from| = {range:?}");
            section.out_of_range(key, step, allowed);
        }
    }
    path
}
