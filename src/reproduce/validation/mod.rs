//! Well-known published cases, each compared with a value by an independent method.
//!
//! | file | contents |
//! |---|---|
//! | `scenes` | the scenarios, which users can run |
//! | `bending`, `elasticas`, `princeton`, `curls`, `tubes` | cases of large bending and twist |
//! | `tops`, `cables`, `rotating`, `capstan`, `stick_slip`, `coiling`, `plectoneme`, `flow` | motion, contact and fluid |
//! | `limit_loads`, `toggle`, `buckling`, `flutter` | critical loads |
//! | `planar_frame` | limit loads by shooting |
//! | `buckled_sideways` | loss of stability of planar shapes by shooting |
//! | `links` | motion of chains of rigid links |
//! | `filament` | rigid filaments in viscous flow |
//! | `root` | roots of several equations |
//! | `measured` | quantities from the results of runs |
//! | `benchmark`, `case_page` | a case with its runs, and its page |
//! | `peers` | the cases by other programs |
//! | `overview` | the table of all cases |

mod benchmark;
mod bending;
mod buckled_sideways;
mod buckling;
mod cables;
mod capstan;
mod case_page;
mod coiling;
mod curls;
mod elasticas;
mod filament;
mod flow;
mod flutter;
mod limit_loads;
mod links;
mod measured;
mod overview;
mod peers;
mod planar_frame;
mod plectoneme;
mod princeton;
mod root;
mod rotating;
mod stick_slip;
mod toggle;
mod tops;
mod tubes;

use super::Artifact;
use benchmark::Benchmark;

/// All cases.
static BENCHMARKS: &[&Benchmark] = &[
    &bending::ROLL_UP,
    &bending::TIP_FORCE,
    &bending::BEND_OF_45_DEGREES,
    &elasticas::HEAVY_CANTILEVERS,
    &elasticas::BUCKLED_COLUMNS,
    &princeton::PRINCETON_BEAM,
    &toggle::TOGGLE,
    &limit_loads::DEEP_ARCH,
    &limit_loads::LEES_FRAME,
    &buckling::HEAVY_COLUMN,
    &buckling::STRIP_ON_EDGE,
    &buckling::STRIP_WITH_TIP_LOAD,
    &buckling::BENT_STRIP,
    &flutter::BECKS_COLUMN,
    &buckling::TWISTED_ROD,
    &buckling::TWISTED_RING,
    &curls::SUSPENDED_CURL,
    &curls::CURVED_STRIP,
    &curls::FOLDED_RING,
    &curls::HELICAL_SPRING,
    &tubes::GUIDEWIRE,
    &tubes::CONCENTRIC_TUBES,
    &tops::HEAVY_TOP,
    &tops::INTERMEDIATE_AXIS,
    &cables::SWINGING_CHAIN,
    &cables::SWINGING_CABLE,
    &cables::FLYING_ROD,
    &rotating::ROTATING_BEAM,
    &rotating::ROTATING_BEAM_FLAP,
    &capstan::CAPSTAN,
    &capstan::CLASP,
    &stick_slip::STICK_SLIP,
    &coiling::COILING,
    &plectoneme::PLECTONEME,
    &flow::HELIX_IN_FLOW,
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
