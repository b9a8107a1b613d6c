//! The keys of knots: modules `typed` and `resolved`, and the conversion between them here.

mod resolved;
mod start;
mod typed;

pub use resolved::{Knot, KnotEnds, KnotKind, KnotStart};

use crate::scenario::keys::{OwnTable, Request};
use crate::scenario::{BuilderRod, CrossSection, Material, Time};
use serde::Serialize;
use start::{PlacedKnot, knot_start};
use std::f64::consts::{PI, TAU};

/// Minimum number of nodes that resolves a loop.
const FEWEST_NODES: usize = 51;
/// Most nodes of the rod.
const MOST_NODES: usize = 100_000;
/// Largest kinetic energy of a pull over ½ ρAL v² with the speed v of the ends. The ends set the
/// loop in motion suddenly, so that it swings. Measured values are 3 to 5 for a loop at rest.
const SWING: f64 = 6.0;
/// Fraction of drag in the traction by "auto".
const DRAG_SHARE: f64 = 0.002;
/// Default of the settling time in periods R² √(ρA/EI), and its minimum, s. Loose loops turn over
/// before they are at rest: after 6 periods the kinetic energy of a trefoil is still 2e-4 of the
/// elastic energy, after 12 it is 2e-6.
const SETTLING: (f64, f64) = (12.0, 2.0);

/// The table of both experiments with knots.
pub static TABLES: [OwnTable; 1] = [OwnTable::new::<typed::Knot>(
    "knot",
    "The knot of the experiments \"knot-tightening\" and \"knot-inversion\" and how it is pulled tight.",
)
.with_curve("curve")];

/// Everything that these experiments read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KnotTables {
    /// Material of the rods.
    pub material: Material,
    /// Radius and nodes of each rod.
    pub rod: BuilderRod,
    /// The knot and how it is pulled.
    pub knot: Knot,
}

/// Resolves the knotted rod and how it is pulled; `None` after a faulty whole number, which is
/// reported.
pub fn resolve(request: &Request<'_>) -> Option<KnotTables> {
    let (top, time) = (request.top, request.time);
    let built = request.needs_rod();
    let typed: Option<&typed::Knot> = request.table("knot");
    let typed = typed.filter(|_| built)?;
    let section = top.below("knot");
    let PlacedKnot {
        start,
        length,
        end_to_end,
    } = knot_start(request, &section, typed);
    let built = request.rod(FEWEST_NODES..=MOST_NODES)?;
    let (material, stiffness) = (built.material, built.stiffness);
    if end_to_end >= length {
        section.out_of_range(
            "end_to_end",
            format_args!("{end_to_end:?} m"),
            format_args!("less than the length of the rod, {length:?} m"),
        );
    }
    // Bending waves of the loop, approximated by a circle.
    let loop_radius = (length - end_to_end) / TAU;
    let mass_per_length = material.density * CrossSection::Circle.area(built.radius);
    let diffusivity = (stiffness.bending_1 / mass_per_length).sqrt();
    let kinetic_bound = typed.kinetic_bound(&section);
    let given_speed = typed.pull_speed.as_ref();
    let pull_speed = match given_speed.filter(|typed| !typed.is_word("auto")) {
        Some(_) => typed.pull_speed(&section, f64::NAN),
        None => {
            let elastic_energy = PI * stiffness.bending_1 / loop_radius;
            (2.0 * kinetic_bound * elastic_energy / (SWING * mass_per_length * length)).sqrt()
        }
    };
    let (periods, least) = SETTLING;
    let usual = (periods * loop_radius * loop_radius / diffusivity).max(least);
    let settling_time = typed.settling_time(&section, usual);
    let given_damping = typed.damping.as_ref();
    let damping = match given_damping.filter(|typed| !typed.is_word("auto")) {
        Some(_) => typed.damping(&section, f64::NAN),
        None => {
            let traction = 0.5 * stiffness.bending_1 / (loop_radius * loop_radius);
            DRAG_SHARE * traction / (0.5 * pull_speed * length)
        }
    };
    if let Time::Dynamic { end, .. } = time {
        let pulled = end_to_end + 2.0 * pull_speed * (end - settling_time).max(0.0);
        if end_to_end < length && pulled >= length {
            let latest = settling_time + 0.5 * (length - end_to_end) / pull_speed;
            top.below("time").fault(
                "end",
                format!(
                    "the ends would be pulled {pulled:.4} m apart, beyond the length of the rod; allowed: less than {latest:.4} s"
                ),
            );
        }
    } else {
        top.below("time")
            .fault("mode", "pulling a knot tight takes time: use \"dynamic\"");
    }
    let knot = Knot {
        start: start?,
        length,
        end_to_end,
        ends: typed.ends(&section),
        pull_speed,
        kinetic_bound,
        settling_time,
        damping,
    };
    Some(KnotTables {
        material,
        rod: built.rod()?,
        knot,
    })
}
