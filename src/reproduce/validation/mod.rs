//! Well-known published cases, each compared with a value by an independent method.
//!
//! | file | contents |
//! |---|---|
//! | `scenes` | the scenarios, which users can run |
//! | `bending`, `limit_loads`, `buckling` | the cases |
//! | `planar_frame` | limit loads by shooting |
//! | `benchmark` | a case, its runs and its page |
//! | `overview` | the table of all cases |

mod benchmark;
mod bending;
mod buckling;
mod limit_loads;
mod overview;
mod planar_frame;

use super::Artifact;
use benchmark::Benchmark;

/// All cases.
static BENCHMARKS: &[&Benchmark] = &[
    &bending::ROLL_UP,
    &bending::TIP_FORCE,
    &bending::BEND_OF_45_DEGREES,
    &limit_loads::DEEP_ARCH,
    &limit_loads::LEES_FRAME,
    &buckling::HEAVY_COLUMN,
    &buckling::STRIP_ON_EDGE,
    &buckling::TWISTED_RING,
];

/// The table of all cases, and the page of each.
pub(super) fn artifacts() -> impl Iterator<Item = Artifact> {
    let pages = BENCHMARKS.iter().map(|case| Artifact {
        name: case.name,
        title: case.title,
        recipe: case,
    });
    std::iter::once(overview::ARTIFACT).chain(pages)
}
