//! The keys of samples of folds: modules `typed` and `resolved`, and the conversion between them
//! here.

mod resolved;
mod typed;

pub use resolved::{FoldSamples, Points};

use crate::experiment::data_set::Span;
use crate::scenario::keys::{FINITE, OwnTable, Request, Section};
use rodlab_planning::plan::fold::Workspace;
use serde::Serialize;

/// The table of this experiment.
pub static TABLES: [OwnTable; 1] = [OwnTable::new::<typed::FoldSamples>(
    "fold_samples",
    "Places of the gripper of the experiment \"fold-samples\".",
)];

/// Maximum number of points, and largest number of the first one.
const MOST_SAMPLES: usize = 10_000_000;
/// Least and largest spacing of a grid, L_gb.
const SPACINGS: [f64; 2] = [0.005, 0.5];
/// Suspended lengths (upper bound from thesis 4.3.3), and the penalty region (4.6.5), L_gb.
const LENGTHS: [f64; 2] = [0.5, 6.84];
const PENALTY: f64 = 0.958;

/// Keys that this experiment reads.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SampleTables {
    /// Places of the gripper.
    pub fold_samples: FoldSamples,
}

/// Resolves the table of this experiment; `None` after a fault, which is reported.
pub fn resolve(request: &Request<'_>) -> Option<SampleTables> {
    let typed: &typed::FoldSamples = request.table("fold_samples")?;
    let section = request.top.below("fold_samples");
    let points = points(&section, typed.points.as_ref());
    let suspended_length = lengths(&section, typed.suspended_length.as_ref());
    let key = "least_suspended_length";
    let penalty = section.with_default(key, &typed.least_suspended_length, FINITE, PENALTY);
    let penalty = within(&section, key, penalty, Workspace::LENGTHS);
    Some(SampleTables {
        fold_samples: FoldSamples {
            points: points?,
            suspended_length: suspended_length?,
            least_suspended_length: penalty?,
        },
    })
}

fn points(section: &Section<'_>, typed: Option<&typed::Points>) -> Option<Points> {
    let kinds = "{ kind = \"sobol\", count = 100000 } or { kind = \"grid\", spacing = 0.0548 }";
    let typed = section.needed("points", typed, kinds)?;
    let below = section.below("points");
    match typed {
        typed::Points::Sobol(typed) => {
            let count = below.count("count", typed.count, 1..=MOST_SAMPLES);
            let first = below.count("first", typed.first.or(Some(0)), 0..=MOST_SAMPLES);
            Some(Points::Sobol {
                count: count?,
                first: first?,
            })
        }
        typed::Points::Grid(typed) => {
            let needed = below.needed("spacing", typed.spacing.as_ref(), "such as 0.0548, in L_gb");
            let spacing = below.number("spacing", needed?, FINITE);
            Some(Points::Grid {
                spacing: within(&below, "spacing", spacing, SPACINGS)?,
            })
        }
    }
}

fn within(section: &Section<'_>, key: &str, value: f64, [from, to]: [f64; 2]) -> Option<f64> {
    if value.is_nan() {
        return None;
    }
    let allowed = (from..=to).contains(&value);
    if !allowed {
        section.fault(
            key,
            format!("{value:?} is out of range; allowed: {from} to {to}"),
        );
    }
    allowed.then_some(value)
}

fn lengths(section: &Section<'_>, typed: Option<&typed::Lengths>) -> Option<Span> {
    let key = "suspended_length";
    let below = section.below(key);
    let none = typed::Lengths::default();
    let typed = typed.unwrap_or(&none);
    let from = below.with_default("from", &typed.from, FINITE, LENGTHS[0]);
    let to = below.with_default("to", &typed.to, FINITE, LENGTHS[1]);
    if from.is_nan() || to.is_nan() {
        return None;
    }
    let [least, largest] = Workspace::LENGTHS;
    if !(least <= from && from < to && to <= largest) {
        section.fault(
            key,
            format!(
                "from {from:?} to {to:?} is out of range; allowed: from the shorter to the longer, between {least} and {largest}"
            ),
        );
        return None;
    }
    Some(Span { from, to })
}
