//! The keys of samples of optimal grasps: modules `typed` and `resolved`, and the conversion
//! between them here.

mod resolved;
mod typed;

pub use resolved::{GraspSamples, Points};

use crate::experiment::data_set::Span;
use crate::scenario::keys::{FINITE, OwnTable, Request, Section};
use rodlab_engine::random::MOST_POINTS;
use rodlab_planning::plan::grasp::GraspProblem;
use serde::Serialize;

/// The table of this experiment.
pub static TABLES: [OwnTable; 1] = [OwnTable::new::<typed::GraspSamples>(
    "grasp_samples",
    "Points of the experiment \"grasp-samples\".",
)];

/// Most points.
const MOST_SAMPLES: usize = 10_000_000;

/// Keys that this experiment reads.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SampleTables {
    /// The points.
    pub grasp_samples: GraspSamples,
}

/// Resolves the table of this experiment; `None` after a fault, which is reported.
pub fn resolve(request: &Request<'_>) -> Option<SampleTables> {
    let typed: &typed::GraspSamples = request.table("grasp_samples")?;
    let section = request.top.below("grasp_samples");
    let points = points(&section, typed.points.as_ref());
    let span = |key: &str, typed: &Option<typed::Span>, default: [f64; 2], allowed: [f64; 2]| {
        span(&section, key, typed.as_ref(), default, allowed)
    };
    let suspended_length = span(
        "suspended_length",
        &typed.suspended_length,
        [0.5, 50.0],
        GraspProblem::LENGTHS,
    );
    let curvature = span(
        "curvature",
        &typed.curvature,
        [0.0, 2.0],
        [
            -GraspProblem::LARGEST_CURVATURE,
            GraspProblem::LARGEST_CURVATURE,
        ],
    );
    let stretch_compliance = span(
        "stretch_compliance",
        &typed.stretch_compliance,
        [0.0, 0.003],
        [0.0, 1.0 / GraspProblem::LEAST_STIFFNESS],
    );
    Some(SampleTables {
        grasp_samples: GraspSamples {
            points: points?,
            suspended_length: suspended_length?,
            curvature: curvature?,
            stretch_compliance: stretch_compliance?,
        },
    })
}

fn points(section: &Section<'_>, typed: Option<&typed::Points>) -> Option<Points> {
    let kinds =
        "{ kind = \"sobol\", count = 6358 } or { kind = \"grid\", suspended_lengths = 50, ... }";
    let typed = section.needed("points", typed, kinds)?;
    let below = section.below("points");
    let count = |key, typed| below.count(key, typed, 1..=MOST_SAMPLES);
    match typed {
        typed::Points::Sobol(typed) => {
            let number = count("count", typed.count);
            let last = usize::try_from(MOST_POINTS).unwrap_or(usize::MAX) - MOST_SAMPLES;
            let first = below.count("first", typed.first.or(Some(0)), 0..=last);
            Some(Points::Sobol {
                count: number?,
                first: first? as u64,
            })
        }
        typed::Points::Grid(typed) => {
            let [suspended_lengths, curvatures, stretch_compliances] = [
                count("suspended_lengths", typed.suspended_lengths),
                count("curvatures", typed.curvatures),
                count("stretch_compliances", typed.stretch_compliances.or(Some(1))),
            ];
            let sides = [suspended_lengths?, curvatures?, stretch_compliances?];
            let product = sides
                .iter()
                .try_fold(1_usize, |all, side| all.checked_mul(*side));
            if product.is_none_or(|product| product > MOST_SAMPLES) {
                section.fault(
                    "points",
                    format!(
                        "{} × {} × {} points; allowed: {MOST_SAMPLES} in all",
                        sides[0], sides[1], sides[2]
                    ),
                );
                return None;
            }
            Some(Points::Grid {
                suspended_lengths: sides[0],
                curvatures: sides[1],
                stretch_compliances: sides[2],
            })
        }
    }
}

fn span(
    section: &Section<'_>,
    key: &str,
    typed: Option<&typed::Span>,
    default: [f64; 2],
    allowed: [f64; 2],
) -> Option<Span> {
    let below = section.below(key);
    let none = typed::Span::default();
    let typed = typed.unwrap_or(&none);
    let from = below.with_default("from", &typed.from, FINITE, default[0]);
    let to = below.with_default("to", &typed.to, FINITE, default[1]);
    if from.is_nan() || to.is_nan() {
        return None;
    }
    if !(from <= to && allowed[0] <= from && to <= allowed[1]) {
        section.fault(
            key,
            format!(
                "from {from:?} to {to:?} is out of range; allowed: from the lesser to the larger, between {} and {}",
                allowed[0], allowed[1]
            ),
        );
        return None;
    }
    Some(Span { from, to })
}
