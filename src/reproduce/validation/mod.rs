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
use benchmark::{Benchmark, BenchmarkPage};

/// All cases.
static BENCHMARKS: [&Benchmark; 8] = [
    &bending::ROLL_UP,
    &bending::TIP_FORCE,
    &bending::BEND_OF_45_DEGREES,
    &limit_loads::DEEP_ARCH,
    &limit_loads::LEES_FRAME,
    &buckling::HEAVY_COLUMN,
    &buckling::STRIP_ON_EDGE,
    &buckling::TWISTED_RING,
];

/// The table of all cases.
pub(super) const OVERVIEW: Artifact = overview::ARTIFACT;
/// The pages of the cases.
pub(super) const ROLL_UP: Artifact = const { &BenchmarkPage(&bending::ROLL_UP) }.artifact();
pub(super) const TIP_FORCE: Artifact = const { &BenchmarkPage(&bending::TIP_FORCE) }.artifact();
pub(super) const BEND_OF_45_DEGREES: Artifact =
    const { &BenchmarkPage(&bending::BEND_OF_45_DEGREES) }.artifact();
pub(super) const DEEP_ARCH: Artifact = const { &BenchmarkPage(&limit_loads::DEEP_ARCH) }.artifact();
pub(super) const LEES_FRAME: Artifact =
    const { &BenchmarkPage(&limit_loads::LEES_FRAME) }.artifact();
pub(super) const HEAVY_COLUMN: Artifact =
    const { &BenchmarkPage(&buckling::HEAVY_COLUMN) }.artifact();
pub(super) const STRIP_ON_EDGE: Artifact =
    const { &BenchmarkPage(&buckling::STRIP_ON_EDGE) }.artifact();
pub(super) const TWISTED_RING: Artifact =
    const { &BenchmarkPage(&buckling::TWISTED_RING) }.artifact();
